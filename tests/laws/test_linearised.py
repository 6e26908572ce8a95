"""The linear equations are the derivatives of the motion's own: against differences of the kernel that computes."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.multibody.tree.layout import rate_indices
from heuncli.results.results import Array
from heuncli.study.solve.singular_start import rate_derivatives
from tests.shared.loops import loop
from tests.shared.rolling_scenes import rolling
from tests.shared.scenes import study
from tests.shared.trees import tree

OF_KIND = {"tree": tree, "loop": loop, "rolling": rolling}
STEPS = 0.02 / 2.0 ** np.arange(4)  # central differences at these, extrapolated: the error is of h^8
CASES = [("tree", seed) for seed in (0, 1, 3, 4, 5, 7, 8, 9)] + [("loop", seed) for seed in (1, 2, 3, 4, 5, 6, 7)]
CASES += [("rolling", seed) for seed in (2, 5, 7)]


def accelerations(runner: Runner, t: float, state: Array, holding: Array) -> Array:
    """Of the undriven freedoms, by the kernel that computes."""
    place = rate_indices(runner.layout)
    found = runner.evaluate(np.array([t]), state[None, :], holding=holding)
    return rate_derivatives(runner.layout, found)[place[place >= 0]]


def differences(
    runner: Runner, t: float, found: LinearisedEquations, along: Array, rates: Array, holding: Array
) -> Array:
    """d accelerations along displacements and rates that the closures admit, by extrapolated differences."""
    table = []
    for h in STEPS:
        ends = [displace(runner.layout, found.state, s * h * along, s * h * rates) for s in (1.0, -1.0)]
        a, b = (accelerations(runner, t, end, holding) for end in ends)
        table.append((a - b) / (2.0 * h))
    for k in range(1, len(STEPS)):
        table = [(4.0**k * fine - coarse) / (4.0**k - 1.0) for coarse, fine in pairwise(table)]
    return table[0]


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "seed"), CASES)
@pytest.mark.third
def test_against_differences(kind: str, seed: int) -> None:
    """Trees and loops of every kind of joint and load, in motion: along random displacements, and changes of rates."""
    run = OF_KIND[kind](seed).study
    runner, history = run.setup.runner, run.history.solutions
    t, holding = float(history.times[-1]), history.holding[-1]
    found = linearise(runner.layout, t, history.states[-1], holding)
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1.0, 1.0, found.tangent.shape[1])
    ways = [(found.tangent @ x, found.drift @ x), (0.0 * found.tangent @ x, found.tangent @ x)]
    if found.pose_directions is not None:  # what rolls comes to more poses than its speeds lead to at once
        y = rng.uniform(-1.0, 1.0, found.pose_directions.tangent.shape[1])
        ways.append((found.pose_directions.tangent @ y, found.pose_directions.drift @ y))
    for along, rates in ways:
        exact = found.by_place @ along + found.by_rate @ rates
        near = differences(runner, t, found, along, rates, holding)
        # rounding of the accelerations by the least step, and what eight orders leave of steps of 0.02
        largest = np.abs(found.accelerations).max() + np.abs(exact).max()
        assert np.abs(exact - near).max() <= 1e-9 * largest


def beam(n: int) -> dict[str, Any]:
    """Links hinged end to end, with springs across their hinges' two sides."""
    bodies: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    before = "ground.O"
    for k in range(n):
        bodies[f"b{k}"] = {
            "shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1, 0, 0], "mass": 1}],
            "points": {"a": [0, 0, 0], "b": [1, 0, 0]},
        }
        joints[f"j{k}"] = {"type": "pin", "axis": [0, 0, 1], "from": before, "to": f"b{k}.a"}
        before = f"b{k}.b"
    springs = {
        f"s{k}": {"type": "spring", "from": {"body": f"b{k}", "at": [0.3, 0.2, 0]}, "length": 0.5, "damping": 1.0,
                  "to": {"body": f"b{k + 1}", "at": [0.6, 0.1, 0]}, "stiffness": 300.0}
        for k in range(n - 1)
    }  # fmt: skip
    return {"gravity": [0, -9.81, 0], "ground": {"points": {"O": [0, 0, 0]}}, "bodies": bodies,
            "joints": joints, "forces": springs}  # fmt: skip


@pytest.mark.parametrize("reduce", [True, False])
def test_in_the_plane_as_in_space(reduce: bool) -> None:
    """The planar sweep and the spatial one have the same derivatives."""
    runner = study({**beam(4), "space": "planar"}, reduce=reduce).setup.runner
    assert runner.layout.flat is reduce
    flat = linearise(runner.layout, 0.0, runner.layout.y0)
    space = study(beam(4), reduce=False).setup.runner
    full = linearise(space.layout, 0.0, space.layout.y0)
    for name in ("accelerations", "by_place", "by_rate", "mass"):
        a, b = getattr(flat, name), getattr(full, name)
        assert np.abs(a - b).max() <= 1e-13 * np.abs(b).max()


def test_stiffness_is_symmetric_at_rest() -> None:
    """What springs and weight leave of a beam that hangs at rest is the second derivative of a potential."""
    scene = beam(5)
    scene["gravity"] = [9.81, 0, 0]
    for spring in scene["forces"].values():
        spring["length"] = float(np.hypot(1.3, 0.1))  # at ease
    runner = study(scene).setup.runner
    found = linearise(runner.layout, 0.0, runner.layout.y0)
    assert np.abs(found.accelerations).max() <= 1e-11
    K = -found.mass @ found.by_place
    assert np.abs(K - K.T).max() <= 1e-13 * np.abs(K).max()
    C = -found.mass @ found.by_rate
    assert np.abs(C - C.T).max() <= 1e-13 * np.abs(C).max()
    assert np.linalg.eigvalsh(K).min() > 0.0


def slider(**loads: Any) -> LinearisedEquations:
    """Of a mass on a guide at rest at the origin, with loads."""
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"m": {"mass": 2.0, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"c": [0, 0, 0]}}},
        "joints": {"guide": {"type": "slide", "axis": [1, 0, 0], "from": "ground.O", "to": "m.c"}},
        "forces": loads,
    }
    runner = study(scene).setup.runner
    return linearise(runner.layout, 0.0, runner.layout.y0)


def test_friction_begins_as_a_damper() -> None:
    """Coulomb's friction, smoothed: F tanh(v / v0) has the slope F / v0 at rest."""
    found = slider(f={"type": "friction", "joint": "guide", "force": 3.0, "speed": 0.5})
    assert found.by_rate.tolist() == [[-3.0 / 0.5 / 2.0]] and found.by_place.tolist() == [[0.0]]


def test_a_spring_without_length_pulls_back_from_the_first() -> None:
    """Its points coincide, and it has no direction: but its force is k times the distance, from 0 on."""
    found = slider(s={"type": "spring", "from": "ground.O", "to": "m.c", "stiffness": 8.0, "length": 0})
    assert found.by_place.tolist() == [[-8.0 / 2.0]] and found.accelerations.tolist() == [0.0]


@pytest.mark.parametrize("more", [-1, 1])
def test_a_state_of_another_layout_is_refused(more: int) -> None:
    """Whether the work of loads is counted hangs on a scene's loads: two scenes of one mechanism differ in length."""
    layout = study(beam(2)).setup.runner.layout
    state = np.concatenate([layout.y0, np.zeros(1)])[: layout.n_state + more]
    with pytest.raises(ValueError, match=f"{layout.n_state} numbers"):
        linearise(layout, 0.0, state)
