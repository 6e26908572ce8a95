"""Ropes over sheaves in motion: their length as the poses tell it, energy, and the same rope told otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.multibody.response import make_workspace, tangent
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.dual_tangent import dual_tangent
from tests.shared.scenes import solved

HELD = 1e-9  # of the scene: what the run's own tolerance asks for

# A sheave on a swinging jib in space, with a load that hangs free, and swings a little out of the sheave's plane.
JIB = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 5], P: [0, 0, 5]}}
bodies:
  jib: {mass: 4, center: [0.5, 0, 0], inertia: [0.2, 0.3, 0.3], points: {hub: [0, 0, 0], tip: [1, 0, 0]}}
  sheave: {mass: 1, center: [0, 0, 0], inertia: [0.02, 0.03, 0.02], position: [1, 0, 5], points: {hub: [0, 0, 0]}}
  load: {mass: 3, center: [0, 0, 0], inertia: [0.1, 0.2, 0.15], position: [1.2, 0.0, 2], velocity: [0.2, SIDE, 0],
         points: {top: [0.05, 0, 0.1]}}
joints:
  axle: {type: pin, from: ground.O, to: jib.hub, axis: [0, 1, 0]}
  wheel: {type: pin, from: jib.tip, to: sheave.hub, axis: [0, 1, 0]}
couplings:
  rope: {type: rope, through: [ground.P, {sheave: sheave.hub, radius: 0.2, side: over SLIP}, load.top]}
forces:
  hold: {type: turn_spring, joint: axle, stiffness: 300, angle: 0}
analysis: {duration: 0.6, samples: 7}
"""

# A block that hangs free in the plane below a sheave that grips, with a strand between the two.
BLOCK = """
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {O: [0, 5], A: [0.1, 5]}}
bodies:
  upper: {mass: 4, center: [0.01, 0], inertia: 0.18, points: {hub: [0, 0]}}
  lower: {mass: 2, center: [0, 0], inertia: 0.05, position: [0.2, 2], points: {hub: [0, 0], hook: [0, -0.2]}}
  load: {mass: 5, center: [0, -0.3], inertia: 0.3, points: {top: [0, 0]}}
  hand: {mass: 2, center: [0, 0], inertia: 0.1, position: [1.0, 1], points: {top: [0, 0]}}
joints:
  axle: {type: pin, from: ground.O, to: upper.hub, initial: {angle: 0.3}}
  eye: {type: pin, from: lower.hook, to: load.top}
couplings:
  rope: {type: rope, through: [WAY]}
analysis: {duration: 0.5, samples: 6}
"""
THERE = (
    "ground.A",
    "{sheave: lower.hub, radius: 0.15, side: SIDE1}",
    "{sheave: upper.hub, radius: 0.3, side: SIDE2 SLIP}",
    "hand.top",
)
SLIPS = pytest.mark.parametrize("slip", ["", ", slip: none"])
STRETCHES = "it stretches"
KINDS = pytest.mark.parametrize("slip", ["", ", slip: none", STRETCHES])
STRETCHING = "type: rope, stiffness: 4e3, damping: 50"


def block(slip: str = "", back: bool = False, sides: tuple[str, str] = ("under", "over")) -> str:
    """The block, its rope listed from either end."""
    way = ", ".join(reversed(THERE) if back else THERE)
    text = BLOCK.replace("WAY", way).replace("SIDE1", sides[0]).replace("SIDE2", sides[1])
    return kept(text, slip)


def jib(slip: str = "", side: float = 0.02) -> str:
    """The jib; side: speed of the load across the sheave's plane."""
    return kept(JIB.replace("SIDE", str(side)), slip)


def kept(text: str, slip: str) -> str:
    """The scene with a rope that slips, or grips, or stretches."""
    if slip == STRETCHES:
        return text.replace("type: rope", STRETCHING).replace("SLIP", "")
    return text.replace("SLIP", slip)


@pytest.mark.heavy
@KINDS
@pytest.mark.parametrize("scene", [jib, block])
def test_tangent_as_dual_numbers_tell(scene, slip: str) -> None:  # type: ignore[no-untyped-def]
    """At the start, and far beside it, where strands leave their planes."""
    layout = set_up(load("scene.yaml", scene(slip))).scene.layout
    rng = np.random.default_rng(0)
    for t in (0.0, 0.1):
        start = layout.y0 + (0.2 * rng.standard_normal(layout.n_state) if t else 0.0)
        state, exact = dual_tangent(layout, t, start)
        assert np.abs(tangent(make_workspace(layout), t, state) - exact).max() <= 1e-12 * np.abs(exact).max()


@KINDS
@pytest.mark.parametrize("scene", [jib, block])
def test_energy_is_kept(scene, slip: str) -> None:  # type: ignore[no-untyped-def]
    """A rope does no work: its conditions and their derivatives belong together; what stretches keeps or loses it."""
    results = solved(scene(slip))
    energy = results.energy
    total = energy["kinetic"] + energy["potential"] - energy["work"]
    assert (energy["work"][-1] < -0.01) == (slip == STRETCHES)
    assert np.abs(total - total[0]).max() <= 10 * HELD * np.abs(total).max()


def points_of(results: Results, body: str, at: tuple[float, float]) -> Array:
    """World places of a body's point, in the plane."""
    own = results.bodies[body]
    q = own["orientation"] if "orientation" in own else own["quaternion"]
    angle = 2 * np.arctan2(q[:, 3], q[:, 0])
    c, s = np.cos(angle), np.sin(angle)
    return own["position"][:, :2] + np.stack([c * at[0] - s * at[1], s * at[0] + c * at[1]], axis=1)


def test_its_length_as_the_poses_tell_it() -> None:
    """Tangents by Pythagoras and arcs by angles in the plane, from the poses alone."""
    results = solved(block())
    lower, upper = points_of(results, "lower", (0, 0)), np.tile([0.0, 5.0], (6, 1))
    hand, A = points_of(results, "hand", (0, 0)), np.tile([0.1, 5.0], (6, 1))

    def way(P: Array, Q: Array, offset: float) -> tuple[Array, Array]:
        """The length of a tangent and its angle, that of the way between centres less asin(offset/distance)."""
        far, along = np.hypot(*(Q - P).T), np.arctan2(*(Q - P).T[::-1])
        return np.sqrt(far**2 - offset**2), along - np.arcsin(offset / far)

    spreads = []
    for s1, s2 in ((1, 1), (1, -1), (-1, 1), (-1, -1)):  # round which sides; one of them is the rope's way
        l1, first = way(A, lower, s1 * 0.15)
        l2, second = way(lower, upper, s2 * 0.3 - s1 * 0.15)
        l3, third = way(upper, hand, -s2 * 0.3)
        arcs = [0.15 * ((s1 * (second - first)) % (2 * np.pi)), 0.3 * ((s2 * (third - second)) % (2 * np.pi))]
        length = l1 + l2 + l3 + arcs[0] + arcs[1]
        spreads.append(float(np.ptp(length) / length[0]))
    assert sorted(spreads)[0] <= HELD < 1e-6 < sorted(spreads)[1]
    assert np.ptp(hand[:, 1]) > 0.1


@KINDS
def test_listed_from_the_other_end(slip: str) -> None:
    """The same rope; the tensions before and behind what grips change places."""
    there, back = solved(block(slip)), solved(block(slip, back=True))
    one, other = there.couplings["rope"], back.couplings["rope"]
    last = "last_tension" if "none" in slip else "tension"
    assert one["tension"] == pytest.approx(other[last], rel=1e-8)
    assert one[last] == pytest.approx(other["tension"], rel=1e-8)
    assert one["on"]["upper"]["moment"] == pytest.approx(other["on"]["upper"]["moment"], abs=1e-7)


@pytest.mark.heavy
def test_sides_by_hand() -> None:
    """Over and under are left and right as the rope is listed; the other sides make another rope."""
    over = solved(block()).couplings["rope"]["tension"]
    told = []
    for lower in ("left", "right"):
        for upper in ("left", "right"):
            told.append(solved(block(sides=(lower, upper))).couplings["rope"]["tension"])
    same = [bool(np.abs(own - over).max() <= 1e-9 * np.abs(over).max()) for own in told]
    assert same.count(True) == 1


@pytest.mark.heavy
def test_what_leaves_the_plane() -> None:
    """A swing aside of a degree is warned of, one of ten refused; none, and nothing is said."""
    assert not [w for w in solved(jib(side=0.0)).warnings if "plane" in w]
    assert [w for w in solved(jib(side=0.05)).warnings if "leaves a sheave's plane" in w]
    with pytest.raises(SolveError) as error:
        solved(jib(side=1.5))
    assert error.value.problems[0].code == "rope-off-sheave"


def test_what_lifts_off() -> None:
    """A rope whose arc becomes less than none is not held on its sheave."""
    far = float(np.hypot(1.0, 0.05))
    angle = float(np.arctan2(-0.05, 1.0) - np.arcsin(0.1 / far))  # of the strand; the body moves across it
    x, y = -2.0 * float(np.sin(angle)), 2.0 * float(np.cos(angle))
    text = f"""
heun: 1
space: planar
ground: {{points: {{O: [0, 0], A: [-1, -0.05]}}}}
bodies:
  b: {{mass: 1, center: [0, 0], inertia: 1, position: [1, -0.05], velocity: [{x!r}, {y!r}], points: {{top: [0, 0]}}}}
couplings: {{rope: {{type: rope, through: [ground.A, {{sheave: ground.O, radius: 0.1, side: over}}, b.top]}}}}
analysis: {{duration: 1, samples: 5}}
"""
    with pytest.raises(SolveError) as error:
        solved(text)
    assert error.value.problems[0].code == "rope-off-sheave"
