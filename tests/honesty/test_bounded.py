"""The error of a motion, bounded where it is not the largest: nowhere too small, and itself where it counts."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.motion.integration.check.run_comparison import MotionPoints, bound_motion_error, find_motion_error
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import Setup, set_up
from tests.shared.folders import SPECS

NAMES = ("double", "chain", "flat_four_bar", "top")
AT = np.linspace(0.0, 0.5, 201)


def together(setup: Setup, states: list[Array]) -> Evaluation:
    """The answers at the states of some runs, at each instant one after the other."""
    count = len(states)
    return setup.runner.evaluate(np.repeat(AT, count), np.stack(states, axis=1).reshape(count * len(AT), -1))


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("name", NAMES)
def test_never_too_small_and_the_same_at_most(name: str, count: int) -> None:
    setup = set_up(load(SPECS / f"{name}.yaml"))
    runs = [setup.runner.run(MotionTask(AT, local)).states for local in (1e-4, 1e-7, 1e-10)[:count]]
    several, marks, size = together(setup, runs), MotionPoints(setup.scene.layout), setup.scene.layout.size
    error = find_motion_error(marks, several.bodies, count, size)
    bound = bound_motion_error(marks, several, count, size)
    assert (bound >= error).all()
    assert bound.max() == error.max()
    assert error.max() > 1e-9  # there is something to bound


def test_what_may_not_be_claimed_is_told_by_itself() -> None:
    """Where the error may pass CLAIMED it is looked at: the horizon is an instant at which it does."""
    setup = set_up(load(SPECS / "double.yaml"))
    own = setup.runner.run(MotionTask(AT, 1e-9)).states
    growing = own + 1e-6 * np.exp(20.0 * AT)[:, None] * np.sin(np.arange(own.shape[1]))
    several, marks, size = together(setup, [own, growing]), MotionPoints(setup.scene.layout), setup.scene.layout.size
    error = find_motion_error(marks, several.bodies, 2, size)
    bound = bound_motion_error(marks, several, 2, size)
    late = error > tolerances.CLAIMED
    assert late.any() and not late.all()
    assert np.array_equal(bound > tolerances.CLAIMED, late)
    assert np.array_equal(bound[late], error[late])


def test_what_is_no_number_is_unknown() -> None:
    setup = set_up(load(SPECS / "double.yaml"))
    own = setup.runner.run(MotionTask(AT, 1e-9)).states
    other = own.copy()
    other[-1] = np.inf
    with np.errstate(invalid="ignore"):
        bound = bound_motion_error(MotionPoints(setup.scene.layout), together(setup, [own, other]), 2, 1.0)
    assert bound[-1] == tolerances.UNKNOWN
