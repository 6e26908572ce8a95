"""Ropes over sheaves against formulas: Atwood's machine, tackles, Weston's, drums, what catches."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import solved

G = 9.81
DIGITS = 1e-12  # of a closed form: some roundings of the largest load


def atwood(slip: str, more: str = "", analysis: str = "{type: state}", rope: str = "") -> str:
    """Two weights on slides below a sheave of 4 kg, J = 0.18, R = 0.3."""
    return f"""
heun: 1
space: planar
gravity: [0, -{G}, 0]
ground: {{points: {{O: [0, 5], A: [-0.3, 0], B: [0.3, 0]}}}}
bodies:
  sheave: {{mass: 4, center: [0, 0], inertia: 0.18, points: {{hub: [0, 0]}}}}
  a: {{mass: 3, center: [0, 0], inertia: 0.1, points: {{top: [0, 0]}}}}
  b: {{mass: 2, center: [0, 0], inertia: 0.1, points: {{top: [0, 0]}}}}
joints:
  axle: {{type: pin, from: ground.O, to: sheave.hub, initial: {{angle: 0.7}}}}
  ga: {{type: slide, from: ground.A, to: a.top, axis: [0, 1]}}
  gb: {{type: slide, from: ground.B, to: b.top, axis: [0, 1]}}
couplings:
  rope: {{type: rope, through: [a.top, {{sheave: sheave.hub, radius: 0.3, slip: {slip}}}, b.top]{rope}}}
{more}
analysis: {analysis}
"""


@pytest.mark.parametrize(("slip", "sheave"), [("none", 0.18 / 0.09), ("free", 0.0)])
def test_atwood(slip: str, sheave: float) -> None:
    """a = (m1 - m2) g / (m1 + m2 + J/R^2), where the sheave turns with the rope; else without J."""
    results = solved(atwood(slip))
    a = G / (5.0 + sheave)
    told = results.couplings["rope"]
    assert told["tension"][0] == pytest.approx(3.0 * (G - a), rel=DIGITS)
    last = told["last_tension"] if slip == "none" else told["tension"]
    assert last[0] == pytest.approx(2.0 * (G + a), rel=DIGITS)
    pull = 3.0 * (G - a) + 2.0 * (G + a)
    assert told["on"]["sheave"]["force"][0] == pytest.approx([0.0, -pull, 0.0], abs=DIGITS * pull)
    assert told["on"]["sheave"]["moment"][0, 2] == pytest.approx(0.3 * (3 * (G - a) - 2 * (G + a)), abs=DIGITS * pull)
    assert results.joints["axle"]["force"][0, 1] == pytest.approx(4.0 * G + pull, rel=DIGITS)


def test_a_drum_counts_its_turns() -> None:
    """A driven drum lowers a weight by R for a radian, over many turns: its drive holds T R, and turns J."""
    text = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 5], B: [0.3, 0]}}
bodies:
  drum: {mass: 4, center: [0, 0], inertia: 0.18, points: {hub: [0, 0]}}
  b: {mass: 2, center: [0, 0], inertia: 0.1, points: {top: [0, 0]}}
joints:
  axle: {type: pin, from: ground.O, to: drum.hub}
  gb: {type: slide, from: ground.B, to: b.top, axis: [0, 1]}
drives: {winch: {joint: axle, angle: "-2*t**2"}}
couplings:
  rope: {type: rope, through: [{sheave: drum.hub, radius: 0.3, side: right, slip: none}, b.top]}
analysis: {duration: 5, samples: 6}
"""
    results = solved(text)
    t = results.time
    assert results.coordinates["gb"]["travel"] == pytest.approx(-0.6 * t**2, abs=1e-8)
    tension = 2.0 * (G - 1.2)
    assert results.couplings["rope"]["tension"] == pytest.approx(np.full(6, tension), rel=1e-8)
    assert results.joints["axle"]["drive"] == pytest.approx(np.full(6, 0.3 * tension - 4.0 * 0.18), rel=1e-8)


def tackle(hand: float) -> str:
    """A block of 200 kg on four strands over sheaves of 0.15 m; the hand's weight at the end."""
    return f"""
heun: 1
space: planar
gravity: [0, -{G}, 0]
ground: {{points: {{A: [-0.15, 6], O1: [0.3, 6], O2: [0.9, 6]}}}}
bodies:
  block: {{mass: 200, center: [0, -0.5], inertia: 20, position: [0.3, 1], points: {{one: [-0.3, 0], two: [0.3, 0]}}}}
  hand: {{mass: {hand}, center: [0, 0], inertia: 1, position: [1.05, 2], points: {{top: [0, 0]}}}}
couplings:
  tackle:
    type: rope
    through:
      - ground.A
      - {{sheave: block.one, radius: 0.15, side: under}}
      - {{sheave: ground.O1, radius: 0.15, side: over}}
      - {{sheave: block.two, radius: 0.15, side: under}}
      - {{sheave: ground.O2, radius: 0.15, side: over}}
      - hand.top
analysis: {{type: state}}
"""


@pytest.mark.parametrize("hand", [50.0, 80.0])
def test_block_and_tackle(hand: float) -> None:
    """a_block = (4 m - M) g / (M + 16 m), and the hand moves four times as fast the other way."""
    results = solved(tackle(hand))
    a = (4 * hand - 200) * G / (200 + 16 * hand)
    tension = hand * (G - 4 * a)
    told = results.couplings["tackle"]
    assert told["tension"][0] == pytest.approx(tension, rel=DIGITS)
    assert told["on"]["block"]["force"][0, 1] == pytest.approx(4 * tension, rel=DIGITS)
    assert told["on"]["ground"]["force"][0, 1] == pytest.approx(-5 * tension, rel=DIGITS)


def test_weston() -> None:
    """Two sheaves that turn as one, R and r, and a loop below: lifting by (R - r)/2 for a radian; M = W (R - r)/2."""
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}, 0]
ground: {{points: {{O: [0, 5], G: [-0.02, 0]}}}}
bodies:
  pair: {{mass: 4, center: [0, 0], inertia: 0.18, points: {{hub: [0, 0]}}}}
  block: {{mass: 30, center: [0, 0], inertia: 0.1, points: {{hub: [0, 0]}}}}
joints:
  axle: {{type: pin, from: ground.O, to: pair.hub}}
  guide: {{type: slide, from: ground.G, to: block.hub, axis: [0, 1]}}
couplings:
  chain:
    type: rope
    through:
      - {{sheave: pair.hub, radius: 0.20, side: left, slip: none}}
      - {{sheave: block.hub, radius: 0.18, side: left}}
      - {{sheave: pair.hub, radius: 0.16, side: left, slip: none}}
forces: {{hand: {{type: torque, joint: axle, value: M}}}}
parameters: {{M: "-30*{G}*0.02"}}
analysis: {{type: state}}
"""
    results = solved(text)
    assert results.couplings["chain"]["tension"][0] == pytest.approx(15 * G, rel=1e-9)
    assert results.couplings["chain"]["on"]["block"]["force"][0, 1] == pytest.approx(30 * G, rel=1e-9)


def test_slackens_and_catches() -> None:
    """Kicked up by 3 m/s the rope is slack for 2 u/(2 g); it catches with (1 + e) u / (1/m1 + 1/m2), sheave free."""
    rope = ", tension_only: true, restitution: 0.2"
    kick = "impulses: {kick: {on: a.top, vector: [0, 9], time: 0.1}}"
    results = solved(atwood("free", kick, "{duration: 0.45, samples: 10}", rope))
    caught = results.impulses[1]
    assert caught["time"] == pytest.approx(0.1 + 3.0 / G, rel=1e-9)
    impulse = 1.2 * 3.0 / (1 / 3 + 1 / 2)
    assert caught["couplings"]["rope"]["tension"] == pytest.approx(impulse, rel=1e-9)
    assert caught["joints"]["axle"]["force"] == pytest.approx([0.0, 2 * impulse, 0.0], abs=1e-9)


SWUNG = """
heun: 1
space: planar
gravity: [0, -9.81]
tables: {reel: {x: [0, 0.5, 1], y: [0, 0.1, -0.2]}}
ground: {points: {A: [0, 0]}}
bodies:
  load: {mass: 3, center: [0, 0], inertia: 0.2, position: [0.6, -1.9], velocity: [0.5, 0.1], points: {top: [0, 0.1]}}
analysis: {duration: 1, samples: 5}
"""
DRAWN_IN = '"sqrt(0.6**2 + 1.8**2) - table(reel, t)"'


def test_a_driven_length_is_a_rods() -> None:
    """A rope between two points with a law is the rod that a drive draws in: motion, work, and the blow at its kink."""
    rope = solved(SWUNG + f"couplings: {{rope: {{type: rope, through: [ground.A, load.top], length: {DRAWN_IN}}}}}")
    rod = solved(
        SWUNG + "joints: {rod: {type: rod, from: ground.A, to: load.top}}\n"
        f"drives: {{winch: {{joint: rod, length: {DRAWN_IN}}}}}"
    )
    stated = rope.accuracy["estimate"]["motion"] + rod.accuracy["estimate"]["motion"]
    assert np.abs(rope.bodies["load"]["position"] - rod.bodies["load"]["position"]).max() <= 4.0 * stated
    assert rope.couplings["rope"]["tension"] == pytest.approx(rod.joints["rod"]["tension"], rel=1e-7)
    assert rope.energy["work"] == pytest.approx(rod.energy["work"], abs=1e-7)
    assert rope.accuracy["energy_drift"] <= 1e-9
    (own,), (other,) = rope.impulses, rod.impulses
    assert own["time"] == 0.5
    assert own["couplings"]["rope"]["tension"] == pytest.approx(other["joints"]["rod"]["tension"], rel=1e-7)


@pytest.mark.parametrize("one_sided", ["", ", tension_only: true"])
def test_a_winch_on_two_falls(one_sided: str) -> None:
    """Drawn in by a t^2/2 the hook rises by half of it: S = m (g + a/2)/2, work S a t^2/2; followed or integrated."""
    through = "ground.dead, {sheave: hook.O, radius: 0.2, side: under}, ground.lead, ground.drum"
    length = '"10 + 0.2*pi + sqrt(2.6**2 + 10**2) - 0.5*t**2"'
    results = solved(f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{dead: [0, 10], lead: [0.4, 10], drum: [3, 0]}}}}
bodies:
  hook: {{mass: 500, center: [0, 0], inertia: 20, position: [0.2, 5], points: {{O: [0, 0]}}}}
joints:
  guide: {{type: slide, from: {{body: ground, at: [0.2, 0]}}, to: hook.O, axis: [0, 1]}}
couplings:
  hoist: {{type: rope, through: [{through}], length: {length}{one_sided}}}
analysis: {{duration: 2, samples: 5}}
""")
    pull = 500 * (G + 0.5) / 2
    assert results.couplings["hoist"]["tension"] == pytest.approx(pull, rel=1e-9)
    assert results.energy["work"] == pytest.approx(pull * 0.5 * np.linspace(0.0, 2.0, 5) ** 2, abs=1e-6)
    assert results.accuracy["energy_drift"] <= 1e-11
    stands, told = results.foundation["elements"]["hoist"], results.couplings["hoist"]["on"]["ground"]
    lever = np.cross(stands["point"] - told["point"], stands["force"])
    assert stands["force"] == pytest.approx(told["force"], abs=1e-9)  # two of its strands run from ground to ground
    assert stands["moment"] + lever == pytest.approx(told["moment"], abs=1e-8)


def test_a_slack_rope_is_drawn_in_and_catches() -> None:
    """0.1 m slack, drawn in at 0.5 m/s: after 0.2 s it jerks a load that lies on a stop, with m v, and lifts it."""
    results = solved(f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{O: [0.3, 5], P: [0.6, 0]}}}}
bodies:
  load: {{mass: 40, center: [0, 0], inertia: 1, points: {{top: [0, 0]}}}}
joints:
  guide: {{type: slide, from: {{body: ground, at: [0, 0]}}, to: load.top, axis: [0, 1]}}
stops:
  floor: {{joint: guide, travel: [0, null]}}
couplings:
  hoist:
    type: rope
    through: [load.top, {{sheave: ground.O, radius: 0.3, side: over}}, ground.P]
    length: "10.1 + 0.3*pi - 0.5*t"
    tension_only: true
    restitution: 0
analysis: {{duration: 0.6, samples: 7}}
""")
    tension = results.couplings["hoist"]["tension"]
    assert tension[:2] == pytest.approx(0.0, abs=1e-12)
    assert tension[3:] == pytest.approx(40 * G, rel=1e-9)
    (jerk,) = results.impulses
    assert jerk["time"] == pytest.approx(0.2, rel=1e-9)
    assert jerk["couplings"]["hoist"]["tension"] == pytest.approx(40 * 0.5, rel=1e-9)
    assert results.bodies["load"]["position"][-1, 1] == pytest.approx(0.5 * 0.4, abs=1e-9)


@pytest.mark.parametrize("length", [2.2, 3.2])
def test_rests_on_a_rope_or_beside_it(length: float) -> None:
    """A weight on a spring k comes to rest on the rope, if that is short, else where m g = k d: the rope is slack."""
    results = solved(f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{A: [0.3, 2.9], B: [0.7, 3], hub: [0.5, 3]}}}}
bodies:
  load: {{mass: 5, center: [0, 0], inertia: 0.2, points: {{top: [0, 0]}}}}
joints:
  guide: {{type: slide, from: {{body: ground, at: [0.7, 0]}}, to: load.top, axis: [0, 1], initial: {{travel: 1.4}}}}
forces:
  spring: {{type: spring, from: ground.B, to: load.top, stiffness: 100, length: 1.5}}
couplings:
  rope:
    type: rope
    through: [ground.A, {{sheave: ground.hub, radius: 0.2, side: over}}, load.top]
    length: 0.1 + {length} + 0.2*pi
    tension_only: true
analysis: {{type: rest}}
""")
    hangs = min(length, 1.5 + 5 * G / 100)
    assert results.bodies["load"]["position"][0, 1] == pytest.approx(3.0 - hangs, abs=1e-9)
    assert results.couplings["rope"]["tension"][0] == pytest.approx(5 * G - 100 * (hangs - 1.5), abs=1e-7)


def test_sections_see_where_strands_act() -> None:
    """A jib with a sheave of 0.1 m at its end: the rope runs back above it to the ground, and down to a weight.

    Cut in the middle, the piece beyond has the pulls of both strands: -T along the jib, T down, and their moments.
    """
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{O: [0, 0], P: [0, 0.1]}}}}
bodies:
  jib:
    shapes: [{{type: rod, from: [0, 0], to: [2, 0], mass: 0.001}}]
    points: {{root: [0, 0], tip: [2, 0]}}
  weight: {{mass: 5, center: [0, 0], inertia: 1, position: [2.1, -1], points: {{top: [0, 0]}}}}
joints: {{root: {{type: weld, from: ground.O, to: jib.root}}}}
couplings: {{rope: {{type: rope, through: [ground.P, {{sheave: jib.tip, radius: 0.1, side: over}}, weight.top]}}}}
sections: {{middle: {{body: jib, at: [1, 0, 0], normal: [1, 0, 0]}}}}
analysis: {{type: state}}
"""
    results = solved(text)
    T, own = 5 * G, 0.0005 * G
    section = results.sections["middle"]
    assert section["force"][0] == pytest.approx([-T, -T - own, 0.0], rel=DIGITS)
    assert section["moment"][0, 2] == pytest.approx(0.1 * T - 1.1 * T - 0.5 * own, rel=DIGITS)
    assert results.foundation["force"][0] == pytest.approx([0.0, -T - 2 * own, 0.0], abs=DIGITS * T)


def test_three_bearings_and_what_is_open() -> None:
    """A rope that holds what a second one like it holds, too: how they share is open, and their sum is certain."""
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{A: [-0.1, 3], B: [0.1, 3], O: [0, 3]}}}}
bodies: {{block: {{mass: 5, center: [0, 0], inertia: 1, points: {{hub: [0, 0], eye: [0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: block.hub, axis: [0, 1]}}}}
couplings:
  one: {{type: rope, through: [ground.A, {{sheave: block.hub, radius: 0.1, side: under}}, ground.B]}}
  two: {{type: rope, through: [ground.O, block.eye]}}
analysis: {{type: state}}
"""
    results = solved(text)
    assert "tension" in results.couplings["one"]["open"]
    assert "tension" in results.couplings["two"]["open"]
    sums = [(one["terms"], one["value"][0]) for one in results.certain_sums if "couplings.one.tension" in one["terms"]]
    (terms, value), *_ = sums
    assert 2 * terms["couplings.two.tension"] == pytest.approx(terms["couplings.one.tension"])
    assert value / terms["couplings.two.tension"] == pytest.approx(5 * G, rel=1e-9)


def roped_cage(g: float, analysis: str) -> str:
    """A cage on a rope as long as it is drawn, on rails."""
    return f"""
heun: 1
space: planar
gravity: [0, {g}]
ground: {{points: {{O: [0, 12], b: [0, 0]}}}}
bodies: {{cage: {{mass: 9, center: [0, 0], inertia: 5, points: {{top: [0, 0]}}}}}}
joints: {{rails: {{type: slide, from: ground.b, to: cage.top, axis: [0, 1], initial: {{travel: 3}}}}}}
couplings: {{hoist: {{type: rope, through: [ground.O, cage.top], tension_only: true}}}}
{analysis}
"""


@pytest.mark.parametrize("analysis", ["analysis: {type: state}", "analysis: {duration: 1, samples: 3}"])
@pytest.mark.parametrize("g", [-9.81, 9.81])
def test_a_rope_that_would_have_to_push_is_told(g: float, analysis: str) -> None:
    """Of a cage that falls upward, at one instant and in a motion; not of one that hangs."""
    told = [line for line in solved(roped_cage(g, analysis)).warnings if "rope hoist would have to push" in line]
    assert len(told) == (g > 0.0)


def test_a_rope_that_a_blow_would_have_to_push_is_told_by_its_place() -> None:
    blow = "impulses: {b: {on: cage.top, vector: [0, 5], time: 0}}\nanalysis: {duration: 1, samples: 3}"
    with pytest.raises(SolveError, match="the rope hoist would have to push") as refused:
        solved(roped_cage(-9.81, blow))
    assert refused.value.problems[0].entry_path == "couplings.hoist"


def test_a_law_that_jerks_a_taut_rope_is_told() -> None:
    """With restitution, which lets it go slack; without, it holds through the jump."""
    scene = roped_cage(-9.81, "analysis: {duration: 1, samples: 3}")
    law = 'length: "9 - 0.5*max(t - 0.2, 0)", tension_only: true'
    with pytest.raises(SolveError, match=r"the rate of the length of hoist jumps from 0 to -0\.5 m/s") as refused:
        solved(scene.replace("tension_only: true", f"{law}, restitution: 0"))
    assert refused.value.problems[0].code == "rope-jerked"
    assert solved(scene.replace("tension_only: true", law)).impulses[0]["energy_jump"] == pytest.approx(0.5 * 9 * 0.25)


@pytest.mark.parametrize(("x", "where"), [(0.3, 0.3), (0.1, 0.1)])
def test_an_end_that_lies_on_its_sheave_is_told(x: float, where: float) -> None:
    text = atwood("free").replace("through: [a.top, {", f"through: [{{body: sheave, at: [{x}, 0]}}, {{")
    with pytest.raises(SolveError, match=f"this point is {where:g} m from the axis of the sheave after") as refused:
        solved(text)
    assert refused.value.problems[0].entry_path == "couplings.rope.through.0"
