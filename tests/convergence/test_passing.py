"""Through flat positions: a parallelogram of bars that turns over, at any speed and tolerance, against its pendulum.

All bars turn alike, so (2/3 + 1) theta'' = 2 g sin(theta) whatever the loop does; at theta = 90 and 270 degrees
the bars lie on one line and the closures lose a row. Steps must keep off those places, or rounding (1e-16 over the
distance squared) takes the place of the motion.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heuncli.motion.integration.check.singular_poses import find_singular_positions
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.parallelogram import parallelogram
from tests.shared.scenes import study
from tests.shared.seeds import spared

TURN = 2.0  # s


@cache
def scene(rate: float, coupler: float = 1.0) -> PreparedScene:
    return set_up(load("scene.yaml", parallelogram(rate, TURN, 5, coupler=coupler))).scene


@cache
def pendulum(rate: float) -> tuple[float, Array]:
    """The bars' angle at the end, and the instants at which they lie flat."""

    def motion(t: float, y: Array) -> list[float]:
        return [y[1], 1.2 * 9.81 * np.sin(y[0])]

    def flat(t: float, y: Array) -> float:
        return float(np.cos(y[0]))

    found = solve_ivp(motion, (0.0, TURN), [0.0, rate], "DOP853", rtol=1e-13, atol=1e-13, events=flat)
    return float(found.y[0, -1]), found.t_events[0]


def run(rate: float, tolerance: float) -> tuple[Trajectory, Runner]:
    runner = Runner(scene(rate).layout)
    return runner.run(MotionTask(np.linspace(0.0, TURN, 5), tolerance, most_steps=3000)), runner


RATES = [1.0, 0.3, 2.9, *np.random.default_rng(17).uniform(0.05, 4.0, 17).tolist()]


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 3e-11, 1e-12, 1e-13])
@pytest.mark.parametrize("seed", spared(range(len(RATES)), (0,)))
def test_the_parallelogram_stays_one(seed: int, tolerance: float) -> None:
    """Bars parallel to rounding, at the pendulum's angle to what the local tolerance makes of two seconds' growth."""
    rate = RATES[seed]
    found, runner = run(rate, tolerance)
    R = runner.evaluate(found.times, found.states).bodies["R"][-1]
    turned = {name: np.arctan2(R[runner.layout.place[i], 0, 1], R[runner.layout.place[i], 0, 0])
              for i, name in enumerate(b.name for b in scene(rate).mechanism.bodies)}  # fmt: skip
    assert abs(np.sin(turned["coupler"])) <= 1e-8  # what a gap of 1e-16 lets it turn in a flat pose
    assert abs(np.sin(turned["left"] - turned["right"])) <= 1e-8
    off = abs((turned["left"] - pendulum(rate)[0] + np.pi) % (2 * np.pi) - np.pi)
    # an error grows like exp(3.43 t) near the top; rounding is magnified by a hundred thousand in a flat pose
    assert off <= 200.0 * tolerance + 1e-10
    assert found.gap <= 1e-14


def test_passages_are_told() -> None:
    """All flat positions of the two seconds, with their instants."""
    for rate in RATES[:4]:
        found, runner = run(rate, 1e-9)
        np.testing.assert_allclose(find_singular_positions(runner, found), pendulum(rate)[1], atol=3e-6)
    warnings = study(parallelogram(1.0, TURN, 5)).results.warnings
    assert any(w.startswith("singular positions at t = 0.70845, 1.21526 s") for w in warnings)


@pytest.mark.parametrize("coupler", [pytest.param(0.97, marks=pytest.mark.heavy), 1.01])
def test_coming_near_is_no_passage(coupler: float) -> None:
    """A coupler a little too short or too long keeps the chain from lying flat."""
    s = study(parallelogram(0.2, TURN, 5, coupler=coupler))
    assert s.history.checked_run is not None
    assert min(s.history.checked_run.run.pivots) < 0.05
    assert s.history.singular == ()
