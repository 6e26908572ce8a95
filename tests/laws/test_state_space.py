"""A of a state space is how accelerations change beside the state, also where that moves: by central differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.analyses.lagrange.coordinate_rates import compute_accelerations
from heuncli.analyses.lagrange.coordinates import choose_coordinates
from heuncli.analyses.lagrange.freed_scene import Instant, make_instant
from heuncli.analyses.lagrange.study import LagrangeOptions, compute_results, solve_lagrange
from heuncli.base.errors import SolveError
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.linearise import linearise
from heuncli.multibody.tree.layout import rate_indices
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.loops import loop_scene
from tests.shared.trees import tree_scene

H = 1e-5  # [rad], [m], and of their rates: its square, and rounding over it, are below SAME
SAME = 1e-6  # of the largest entry
PINS: dict[str, Any] = {"kinds": ("pin", "slide"), "free": 0.0}


def at_rates(at: Instant, names: tuple[str, ...], dq: Any, rates: Any) -> Any:
    """q'' at coordinates moved by dq, with these rates."""
    layout, runner = at.freed_scene.layout, at.freed_scene.runner
    by = choose_coordinates(at.freed_scene.scene, at.linear_equations, at.freed_scene.driven_coordinates, names)
    moved = displace(layout, at.state, by.S @ dq)
    times = np.array([at.t])
    y = runner.evaluate(times, moved[None], holding=at.holding).states[0].copy()
    there = choose_coordinates(
        at.freed_scene.scene, linearise(layout, at.t, y, at.holding), at.freed_scene.driven_coordinates, names
    )
    place = rate_indices(layout)
    y[place[place >= 0]] = there.S @ rates
    found = runner.evaluate(times, y[None], holding=at.holding)
    return compute_accelerations(layout, names, make_body_states(layout, found))[0]


@pytest.mark.parametrize(("kind", "seed"), [*(("tree", k) for k in range(10)), *(("loop", k) for k in range(10))])
@pytest.mark.third
def test_by_differences(kind: str, seed: int) -> None:
    scene, _ = tree_scene(seed, **PINS) if kind == "tree" else loop_scene(seed, **PINS)
    spec = load("scene.yaml", to_yaml({**scene, "analysis": {"type": "state"}}))
    at = make_instant(spec, None, None)
    found = compute_results(spec, at, LagrangeOptions(state_space=True))
    assert found.state_space is not None
    f = len(found.names)
    steps = H * np.eye(f)
    still = np.zeros(f)
    columns = [(at_rates(at, found.names, e, found.rates) - at_rates(at, found.names, -e, found.rates)) for e in steps]
    columns += [
        at_rates(at, found.names, still, found.rates + e) - at_rates(at, found.names, still, found.rates - e)
        for e in steps
    ]
    A = found.state_space.A[f:]
    size = max(float(np.abs(A).max()), float(np.abs(found.accelerations).max()), 1.0)
    assert np.abs(np.array(columns).T / (2.0 * H) - A).max() <= SAME * size
    assert np.abs(found.state_space.offset - np.concatenate([found.rates, found.accelerations])).max() <= 1e-9 * size


ARM = """
heun: 1
gravity: [{sideways}, 0, -9.81]
ground: {{points: {{foot: [0, 0, 0.1], top: [-0.2, 0, 0.9]}}}}
bodies:
  arm:
    {{mass: 2, center: [0.3, 0, 0.1], inertia: [0.1, 0.3, 0.25],
      points: {{foot: [0, 0, 0.1], mid: [0.4, 0, 0.1], far: [0.6, 0, 0.1]}}}}
  bob: {{mass: 0.7, center: [0.6, 0, -0.3], inertia: [0.02, 0.03, 0.01], points: {{far: [0.6, 0, 0.1]}}}}
joints:
  {stand}
  hang: {{type: pin, from: arm.far, to: bob.far, axis: [0, 1, 0], initial: {{rate: {rate}}}}}
drives:
  oil: {{joint: stand, {law} + {{acceleration}}*t**2/2}}
analysis: {{type: state}}
"""
HELD = {  # an arm that is driven, and a pendulum that hangs on it: the one moves, the other rests
    "cylinder": ARM.format(
        sideways=1.0, rate=-1.1, law="travel: -0.3*t",
        stand="stand: {type: cylinder, from: ground.foot, to: arm.foot, axis: [0, 0, 1], initial: {rate: 0.4}}",
    ),
    "rod": ARM.format(
        sideways=0.0, rate=0.0, law="length: 1",
        stand="hinge: {type: pin, from: ground.foot, to: arm.foot, axis: [0, 1, 0]}\n"
        "  stand: {type: rod, from: ground.top, to: arm.mid}",
    ),
}  # fmt: skip


@pytest.mark.parametrize("driven", HELD)
def test_what_a_drive_exerts_holds_it(driven: str) -> None:
    still, moved = (load("scene.yaml", HELD[driven].replace("{acceleration}", word)) for word in ("0", "1"))
    at = make_instant(still, None, None)
    given, held = (
        compute_results(still, at, LagrangeOptions(state_space=True, inputs=words)) for words in (("oil",), ())
    )
    assert given.state_space is not None and held.state_space is not None
    free = [i for i, is_driven in enumerate(given.is_driven) if not is_driven]
    assert np.allclose(held.state_space.offset[len(free) :], given.accelerations[free], rtol=1e-11, atol=1e-11)
    jump = (
        compute_results(moved, make_instant(moved, None, None), LagrangeOptions()).accelerations - given.accelerations
    )
    assert np.allclose(given.state_space.B[len(jump) :, 0], jump, rtol=1e-11, atol=1e-11)


PENDULUM = """
heun: 1
space: planar
gravity: [1.3, -9.81]
ground: {points: {O: [0.2, 0.1]}}
bodies:
  a: {mass: 1.3, center: [0.4, 0.13], inertia: 0.09, points: {o: [0, 0], e: [1.1, 0]}}
  b: {mass: 0.7, center: [0.3, -0.21], inertia: 0.05, points: {o: [0, 0], tip: [0.9, 0.2]}}
joints:
  p: {type: pin, from: ground.O, to: a.o, initial: {angle: 0.7, rate: 1.9}}
  q: {type: pin, from: a.e, to: b.o, initial: {angle: -1.4, rate: -2.6}}
forces: {f: {type: force, on: b.tip, vector: [3, -2]}}
analysis: {type: state}
"""


def test_the_velocity_of_a_point_changes_with_the_pose() -> None:
    """z = L exp(i p) + c exp(i (p + q)) of the tip: dz'/dp = i z', dz'/dq = -(p' + q') c exp(i (p + q))."""
    spec = load("scene.yaml", PENDULUM)
    outputs = ("b.tip.x", "b.tip.y", "b.tip.vx", "b.tip.vy")
    space = compute_results(
        spec, make_instant(spec, None, None), LagrangeOptions(state_space=True, outputs=outputs)
    ).state_space
    assert space is not None
    first, second = 1.1 * np.exp(0.7j), (0.9 + 0.2j) * np.exp(1j * (0.7 - 1.4))
    by_pose = np.array([1j * (first + second), 1j * second])
    velocity = 1j * 1.9 * first + 1j * (1.9 - 2.6) * second
    of_velocity = np.array([1j * velocity, -(1.9 - 2.6) * second])
    rows = [by_pose.real, by_pose.imag, of_velocity.real, of_velocity.imag]
    none = np.zeros(2)
    rates = [none, none, by_pose.real, by_pose.imag]
    wanted = np.array([np.concatenate(pair) for pair in zip(rows, rates, strict=True)])
    assert np.abs(space.C - wanted).max() <= 1e-14 * np.abs(wanted).max() * 10.0


@pytest.mark.parametrize(
    ("law", "said"),
    [
        ("-10*sqrt(g.travel)", "has no derivative there"),
        ("-10*abs(g.travel)", "has a jump or kink there"),
        ("-10*sign(g.speed)", "has a jump or kink there"),
    ],
)
def test_where_a_load_has_no_derivative_there_are_no_matrices(law: str, said: str) -> None:
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"cart": {"mass": 2, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0]}}},
        "joints": {"g": {"type": "slide", "from": "ground.O", "to": "cart.o", "axis": [1, 0, 0]}},
        "forces": {"pull": {"type": "torque", "joint": "g", "value": law}},
    }
    with pytest.raises(SolveError, match=f"forces.pull {said}"):
        solve_lagrange(load("scene.yaml", to_yaml(scene)), LagrangeOptions(state_space=True))
