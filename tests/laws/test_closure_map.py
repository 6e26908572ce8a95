"""The closures in the one linear map: J is the rate of the gaps, the joint loads carried hold the multipliers."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.response import jacobian, multiplier_joint_loads, solve_columns
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vector_array
from heuncli.scene.shapes.rotations import rotation_from_vector
from heuncli.study.model.setup import Setup
from heuncli.study.solve.history import resample
from tests.oracle.turns import Array, cross
from tests.shared import doubles
from tests.shared.loops import loop
from tests.shared.seeds import spared
from tests.shared.trees import TIMES, Case

SCENES = [
    *((loop, seed) for seed in (*range(24), *range(1000, 1012))),
    *((doubles.redundant, seed) for seed in doubles.SEEDS[:60:3]),
]  # fmt: skip
CASES = spared(SCENES, {(loop, 1), (loop, 2), (loop, 1000), (doubles.redundant, 2000), (doubles.redundant, 2003)})
STEP = 1e-5  # its square leaves 1e-10 of the third derivatives, rounding / it leaves 1e-11
PUSH = 3.0  # of the random loads


class Poses(NamedTuple):
    """Attitudes (n, 3, 3) and joint points (n, 3) of all bodies at an instant, tree order."""

    R: Array
    r: Array


@cache
def solved(make: Callable[[int], Case], seed: int) -> tuple[Case, Setup, Evaluation]:
    """A random scene's run, recovered at its instants."""
    c = make(seed)
    return c, c.study.setup, resample(c.study.setup.runner, c.study.history, np.array(TIMES))


def gaps(layout: Layout, at: Poses) -> Array:
    """What the closure rows measure, by their definition: e . (Q - P), e . g, |Q - P|; driven or not."""

    def direction(body: int, a: Array) -> Array:
        return a if body < 0 else at.R[body] @ a

    def place(body: int, p: Array) -> Array:
        return p if body < 0 else at.r[body] + at.R[body] @ p

    found = []
    for row in layout.tables["closures"]:
        e, g, p, q = (vector_array(row[name]) for name in "egpq")
        D = place(row["b"], q) - place(row["a"], p)
        e, g = direction(row["a"], e), direction(row["b"], g)
        found.append({kernel.GUIDE: e @ D, kernel.DOT: e @ g, kernel.ROD: np.sqrt(D @ D)}[int(row["kind"])])
    return np.array(found)


def moved(layout: Layout, at: Poses, body: int, turn: Array, shift: Array) -> Poses:
    """All that hangs on a body, itself included, turned about its joint point and shifted."""
    R, r, T = at.R.copy(), at.r.copy(), rotation_from_vector(turn)
    for i in range(len(r)):
        above = i
        while above > body:
            above = int(layout.bodies["parent"][above])
        if above == body:
            R[i], r[i] = T @ at.R[i], at.r[body] + T @ (at.r[i] - at.r[body]) + shift
    return Poses(R, r)


def free_motions(layout: Layout, at: Poses) -> list[tuple[int, Array, Array]]:
    """Of each freedom, as the answers stand, the body and its turn and shift; of a driven one, none."""
    found = []
    for i, body in enumerate(layout.bodies):
        if body["ball"]:
            found += [(i, e, np.zeros(3)) for e in np.eye(3)]
        for freedom in layout.tables["freedoms"][body["first_freedom"] : body["end_freedom"]]:
            in_body = freedom["kind"] == kernel.TURN_IN_BODY
            of = i if in_body else body["parent"]
            s = vector_array(freedom["direction"]) * (1 - freedom["driven"])
            s = s if of < 0 else at.R[of] @ s
            found.append((i, np.zeros(3), s) if freedom["kind"] == kernel.SHIFT else (i, s, np.zeros(3)))
    return found


@pytest.mark.heavy
@pytest.mark.parametrize("of", CASES)
@pytest.mark.sixth
def test_the_jacobian_is_the_rate_of_the_gaps(of: tuple[Callable[[int], Case], int]) -> None:
    """One freedom moved a little either way, all that hangs on it rigidly along."""
    c, setup, recovered = solved(*of)
    layout = setup.scene.layout
    found = jacobian(setup.runner.workspace, layout, recovered.times, recovered.states)
    rows, freedoms = np.arange(found.shape[0]), np.arange(found.shape[1])
    J = found.block(rows, freedoms)
    assert len(rows) and J.shape == (len(TIMES), len(layout.rows), layout.velocity_count)
    for k in range(len(TIMES)):
        at = Poses(recovered.bodies["R"][k], recovered.bodies["r"][k])
        motions = free_motions(layout, at)
        assert len(motions) == len(freedoms)
        for n, (body, turn, shift) in enumerate(motions):
            ends = (gaps(layout, moved(layout, at, body, h * turn, h * shift)) for h in (STEP, -STEP))
            rate = (next(ends) - next(ends)) / (2.0 * STEP)
            assert np.abs(J[k][:, n] - rate).max() <= 1e-8 * max(c.length, 1.0)
    some = rows[::-2], freedoms[1::2]
    assert np.array_equal(found.block(*some), J[:, some[0]][:, :, some[1]])


@pytest.mark.parametrize("of", CASES)
@pytest.mark.third
def test_carried_loads_hold_the_multipliers(of: tuple[Callable[[int], Case], int]) -> None:
    """Every body balances: its joint's load, the opposite of those it carries, and its rows' loads; any multipliers."""
    c, setup, recovered = solved(*of)
    layout, rng = setup.scene.layout, np.random.default_rng(of[1])
    n_b, n_t = len(layout.place), len(TIMES)
    lambdas = rng.uniform(-PUSH, PUSH, (n_t, 3, len(layout.rows)))
    loads = multiplier_joint_loads(setup.runner.workspace, recovered.times, recovered.states, lambdas, n_b)
    assert loads.shape == (n_t, 3, n_b, 6) and loads.any()
    for k, j in np.ndindex(n_t, 3):
        r = recovered.bodies["r"][k]
        F, M = np.zeros((n_b, 3)), np.zeros((n_b, 3))  # on each body, moments about the world's origin

        def put(body: int, at: Array, force: Array, moment: Array, F: Array = F, M: Array = M) -> None:
            if body >= 0:
                F[body] += force
                M[body] += moment + cross(at, force)

        for i in range(n_b):
            moment, force = loads[k, j, i, :3], loads[k, j, i, 3:]
            put(i, r[i], force, moment)
            put(int(layout.bodies["parent"][i]), r[i], -force, -moment)
        for row, x, of_row in zip(layout.tables["closures"], lambdas[k, j], recovered.rows[k], strict=True):
            b = int(row["b"])
            Q = vector_array(row["q"])
            Q = Q if b < 0 else r[b] + recovered.bodies["R"][k, b] @ Q
            put(b, Q, x * of_row["f"], x * of_row["m"])
            put(int(row["a"]), Q, -x * of_row["f"], -x * of_row["m"])
        size = PUSH * len(layout.rows)
        assert np.abs(F).max() <= 1e-12 * size
        assert np.abs(M).max() <= 1e-12 * size * c.length


@pytest.mark.parametrize("of", CASES)
@pytest.mark.third
def test_free_directions_take_what_the_jacobian_says(of: tuple[Callable[[int], Case], int]) -> None:
    """Virtual work: the joint loads that multipliers need have, along the freedoms, the parts -J' lambda."""
    c, setup, recovered = solved(*of)
    layout, rng = setup.scene.layout, np.random.default_rng(of[1])
    lambdas = rng.uniform(-PUSH, PUSH, (len(TIMES), 1, len(layout.rows)))
    at = setup.runner.workspace, recovered.times, recovered.states
    loads = multiplier_joint_loads(*at, lambdas, len(layout.place))[:, 0]
    found = jacobian(at[0], layout, *at[1:])
    J = found.block(np.arange(found.shape[0]), np.arange(found.shape[1]))
    for k in range(len(TIMES)):
        motions = free_motions(layout, Poses(recovered.bodies["R"][k], recovered.bodies["r"][k]))
        along = np.array([turn @ loads[k, i, :3] + shift @ loads[k, i, 3:] for i, turn, shift in motions])
        assert np.abs(along + lambdas[k, 0] @ J[k]).max() <= 1e-12 * PUSH * len(layout.rows) * max(c.length, 1.0)


@pytest.mark.heavy
def test_what_was_asked_in_between_changes_nothing() -> None:
    """A recovery is the same bits before and after the doors were used."""
    _, setup, recovered = solved(doubles.redundant, 2003)
    layout, runner = setup.scene.layout, setup.runner
    at = recovered.times, recovered.states
    before = runner.evaluate(*at)
    multiplier_joint_loads(runner.workspace, *at, np.full((len(TIMES), 2, len(layout.rows)), 7.0), len(layout.place))
    jacobian(runner.workspace, layout, *at)
    solve_columns(
        runner.workspace, 0.0, recovered.states[0], np.ones((2, len(layout.place), 6)), np.array([True, False])
    )
    after = runner.evaluate(*at)
    for name in ("states", "bodies", "freedoms", "loads", "rows", "gap"):
        assert getattr(before, name).tobytes() == getattr(after, name).tobytes()
