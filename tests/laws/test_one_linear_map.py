"""The one linear map: what answers single columns of loads adds up to what answers them together, and is reciprocal."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.response import Columns, solve_columns, solve_impulses
from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.shared.loops import loop
from tests.shared.scenes import near
from tests.shared.trees import tree

ANSWERS = ("alpha", "a", "joint_moment", "joint_force")
CASES = [("tree", seed) for seed in (0, 1, 4, 6, 8, 9)] + [("loop", seed) for seed in (1, 2, 3, 4, 8, 1000, 1003)]
ROUNDING = 1e-12  # of the largest of all columns: they cancel in the sum


def recovered(kind: str, seed: int) -> tuple[Study, Evaluation]:
    """A random scene in motion: its last instant."""
    study = (tree if kind == "tree" else loop)(seed).study
    history = study.history.solutions
    return study, study.setup.runner.evaluate(history.times[-1:], history.states[-1:])


def load_columns(study: Study, found: Evaluation) -> Array:
    """Every applied load alone, (n, bodies, 6): moment about the joint point and force on each body."""
    layout, bodies = study.setup.runner.layout, found.bodies[0]
    out = np.zeros((len(layout.tables["loads"]), len(bodies), 6))
    for column, load, answer in zip(out, layout.tables["loads"], found.loads[0], strict=True):
        for body, sign, at in ((load["b"], 1.0, answer["at"]), (load["a"], -1.0, answer["from_at"])):
            if body >= 0:
                column[body, 3:] += sign * answer["force"]
                column[body, :3] += sign * (answer["moment"] + np.cross(at - bodies["r"][body], answer["force"]))
    return out


def answers(study: Study, found: Evaluation, loads: Array, inertial: list[bool]) -> Columns:
    return solve_columns(
        study.setup.runner.workspace, float(found.times[0]), found.states[0], loads, np.array(inertial)
    )


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_shares_add_up(kind: str, seed: int) -> None:
    """Each load alone, and what needs none (weight, velocities, drives): together the motion and all reactions."""
    study, found = recovered(kind, seed)
    loads = load_columns(study, found)
    nothing = np.zeros((1, *loads.shape[1:]))
    shares = answers(study, found, np.concatenate([loads, nothing]), [*([False] * len(loads)), True])
    for name in ANSWERS:
        largest = max(float(np.abs(shares.bodies[name]).max()), 1.0)
        near(shares.bodies[name].sum(axis=0), found.bodies[name][0], largest, 100 * ROUNDING)
    largest = max(float(np.abs(shares.multipliers).max(initial=0.0)), 1.0)
    near(shares.multipliers.sum(axis=0), found.rows["multiplier"][0], largest, 1e4 * ROUNDING)


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_reciprocity(kind: str, seed: int) -> None:
    """Betti's law for accelerations: load i works on the answer to load j as j does on that to i, and never against."""
    study, found = recovered(kind, seed)
    loads = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, found.bodies.shape[1], 6))
    shares = answers(study, found, loads, [False] * 4)
    twists = np.concatenate([shares.bodies["alpha"], shares.bodies["a"]], axis=2)
    work = np.einsum("ibk,jbk->ij", loads, twists)
    # what the closures and drives hold is the difference of two answers, each as large as that of a body let go
    largest = float(np.abs(work).max()) + 1.0 / float(study.setup.runner.layout.bodies["mass"].min())
    near(work, work.T, largest, ROUNDING)
    assert np.linalg.eigvalsh(work + work.T).min() >= -ROUNDING * largest
    twice = answers(study, found, 2.0 * loads[:1], [False])
    near(twice.bodies["alpha"], 2.0 * shares.bodies["alpha"][:1], largest, ROUNDING)


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_columns_meet_the_closures_and_newton(kind: str, seed: int) -> None:
    """Every column balances by itself: the roots' joint forces and the loads together move the masses."""
    study, found = recovered(kind, seed)
    layout = study.setup.runner.layout
    loads = np.random.default_rng(100 + seed).uniform(-1.0, 1.0, (2, found.bodies.shape[1], 6))
    shares = answers(study, found, loads, [False, False])
    mass = layout.bodies["mass"]
    roots = layout.bodies["parent"] < 0
    moments = np.stack([layout.bodies["first_moment"][part] for part in "xyz"], axis=1)  # body axes
    mc = np.einsum("bij,bj->bi", found.bodies["R"][0], moments)
    rate = mass[:, None] * shares.bodies["a"] + np.cross(shares.bodies["alpha"], mc)
    held = shares.bodies["joint_force"][:, roots].sum(axis=1)
    for column, multipliers in enumerate(shares.multipliers):
        for k, row, multiplier in zip(layout.rows, found.rows[0], multipliers, strict=True):
            joint = layout.mechanism.joints[k]
            held[column] += multiplier * row["f"] * ((joint.a == GROUND) * 1.0 - (joint.b == GROUND) * 1.0)
    largest = max(1.0, float(np.abs(rate).max()), float(np.abs(shares.multipliers).max(initial=0.0)))
    near(held + loads[:, :, 3:].sum(axis=1), rate.sum(axis=1), largest, ROUNDING)


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_causes_add_up(kind: str, seed: int) -> None:
    """A column a cause: every load, velocities, drives, weight; each load's as alone, together all."""
    study, found = recovered(kind, seed)
    at = found.times, found.states
    found, whole = study.setup.runner.evaluate(*at), study.setup.runner.evaluate(*at, causes=True)
    assert whole.causes is not None
    for name in ANSWERS:
        np.testing.assert_array_equal(whole.bodies[name], found.bodies[name])  # with causes as without
        columns_of_all = whole.causes.bodies[name][0]
        largest = max(float(np.abs(columns_of_all).max()), 1.0)
        near(columns_of_all.sum(axis=0), found.bodies[name][0], largest, 100 * ROUNDING)
    for name in ("udot", "drive"):
        own = whole.causes.freedoms[name][0].sum(axis=0)
        largest = max(float(np.abs(whole.causes.freedoms[name]).max(initial=0.0)), 1.0)
        near(own, found.freedoms[name][0], largest, 1e4 * ROUNDING)
    multipliers = whole.causes.multipliers[0]
    largest = max(float(np.abs(multipliers).max(initial=0.0)), 1.0)
    near(multipliers.sum(axis=0), found.rows["multiplier"][0], largest, 1e4 * ROUNDING)
    loads = load_columns(study, found)
    alone = answers(study, found, loads, [False] * len(loads))
    np.testing.assert_allclose(whole.causes.bodies["alpha"][0, : len(loads)], alone.bodies["alpha"], 1e-9, 1e-9)


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_a_blow_is_what_its_loads_would_accelerate_at_rest(kind: str, seed: int) -> None:
    """Impulses jump as forces accelerate, without weight and velocities; rates that jump as drives that accelerate."""
    study, found = recovered(kind, seed)
    layout, workspace = study.setup.runner.layout, study.setup.runner.workspace
    loads = np.random.default_rng(seed).uniform(-1.0, 1.0, (2, found.bodies.shape[1], 6))
    jumps = np.zeros((2, len(layout.freedoms) + len(layout.rows)))
    at = float(found.times[0]), found.states[0]
    told = solve_impulses(workspace, *at, loads, jumps)
    alone = solve_columns(workspace, *at, loads, np.array([False, False]))
    assert told.massless_count == 0
    assert told.unmet.max() <= ROUNDING
    for name in ANSWERS:
        largest = max(float(np.abs(alone.bodies[name]).max()), 1.0)
        near(told.columns.bodies[name], alone.bodies[name], largest, 100 * ROUNDING)
    # the drives' accelerations as jumps, and no impulse: the share of the drives
    driven = layout.tables["freedoms"]["driven"] > 0
    whole = study.setup.runner.evaluate(found.times, found.states, causes=True).causes
    assert whole is not None
    rates = np.concatenate([np.where(driven, found.freedoms["udot"][0], 0.0), np.zeros(len(layout.rows))])[None, :]
    alone = solve_impulses(workspace, *at, np.zeros_like(loads[:1]), rates).columns
    for name in ANSWERS:
        largest = max(float(np.abs(whole.bodies[name]).max()), 1.0)
        near(alone.bodies[name][0], whole.bodies[name][0, -2], largest, 100 * ROUNDING)
