"""What rests on stops: their reactions by hand, on the ground, in sections, by cause; two of them share openly."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved

G = 9.81

LID = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  lid: {{shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 2}}], points: {{a: [0, 0, 0], b: [1, 0, 0]}}}}
joints: {{hinge: {{type: pin, {ends}, axis: [0, -1, 0]}}}}
stops: {{rest: {{joint: hinge, angle: {limits}}}}}
sections: {{lid: {{body: lid, from: a, to: b, count: 3}}}}
"""


@pytest.mark.parametrize(("ends", "limits", "sign"), [
    ("from: ground.O, to: lid.a", "[0, 90 deg]", 1.0), ("from: lid.a, to: ground.O", "[-90 deg, 0]", -1.0),
])  # fmt: skip
def test_a_lid_lies_on_its_stop(ends: str, limits: str, sign: float) -> None:
    """The stop carries m g L/2 about the hinge's axis, ON `to` upward; ON the ground the other way, whichever it is."""
    found = solved(LID.format(ends=ends, limits=limits))
    couple = 2.0 * G * 0.5
    near(found.stops["rest"]["moment"], sign * couple, couple, 1e-14)
    near(found.foundation["elements"]["rest"]["moment"][0], [0.0, couple, 0.0], couple, 1e-14)
    near(found.foundation["supports"]["hinge"]["force"][0], [0.0, 0.0, -2.0 * G], 20.0, 1e-14)
    near(found.foundation["supports"]["hinge"]["moment"][0], np.zeros(3), couple, 1e-14)
    near(found.foundation["moment"][0], [0.0, couple, 0.0], couple, 1e-14)
    near(found.sections["lid"]["M1"][0], [couple, couple / 4.0, 0.0], couple, 1e-13)  # a cantilever's: m g (L - s)^2/2L


STRAP = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{weight: {{mass: 3, center: [0, 0, 0], inertia: [0, 0, 0], points: {{c: [0, 0, 0]}}, position: [0, 0, {z}]}}}}
joints: {{strap: {{type: rod, {ends}}}}}
stops: {{end: {{joint: strap, length: {limits}}}}}
"""


@pytest.mark.parametrize("ends", ["from: ground.O, to: weight.c", "from: weight.c, to: ground.O"])
def test_a_weight_hangs_at_the_end_of_a_strap_or_stands_on_a_strut(ends: str) -> None:
    """Along its length, which a pull shortens: -m g at the longest, +m g at the shortest; between, the weight falls."""
    for z, limits, value in ((-1.0, "[0.5, 1]", -1.0), (1.0, "[1, 2]", 1.0), (-0.8, "[0.5, 1]", 0.0)):
        found = solved(STRAP.format(ends=ends, limits=limits, z=z))
        near(found.stops["end"]["force"], value * 3.0 * G, 30.0, 1e-14)
        near(found.foundation["force"][0, 2], -abs(value) * 3.0 * G, 30.0, 1e-14)
        near(found.foundation["elements"]["end"]["force"][0, 2], -abs(value) * 3.0 * G, 30.0, 1e-14)
        assert not found.joints["strap"]["force"].any()
        assert "tension" not in found.joints["strap"]


STACK = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  low: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  high: {mass: 3, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
joints:
  guide: {type: slide, from: ground.O, to: low.c, axis: [0, 0, 1]}
  between: {type: slide, from: low.c, to: high.c, axis: [0, 0, 1]}
stops:
  floor: {joint: guide, travel: [0, null]}
  bed: {joint: between, travel: [0, 1]}
"""


def test_a_stop_between_bodies_stands_on_the_lower_one() -> None:
    found = solved(STACK)
    near(found.stops["bed"]["force"], 3.0 * G, 50.0, 1e-14)
    near(found.stops["floor"]["force"], 5.0 * G, 50.0, 1e-14)
    assert list(found.foundation["elements"]) == ["floor"]
    near(found.foundation["force"][0], [0.0, 0.0, -5.0 * G], 50.0, 1e-14)


TWO = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {A: [0, 0, 0], D: [0.8, 0, 0]}}
bodies:
  left: {shapes: [{type: rod, from: [0, 0, 0], to: [0.3, 0, 0], mass: 1}], points: {a: [0, 0, 0], b: [0.3, 0, 0]}}
  right:
    shapes: [{type: rod, from: [0, 0, 0], to: [0.3, 0, 0], mass: 1}]
    points: {a: [0, 0, 0], b: [0.3, 0, 0]}
    near: {orientation: {axis: [0, 0, 1], angle: 30 deg}}
  coupler: {shapes: [{type: rod, from: [0, 0, 0], to: [0.8, 0, 0], mass: 2}], points: {l: [0, 0, 0], r: [0.8, 0, 0]}}
joints:
  A: {type: pin, from: ground.A, to: left.a, initial: {angle: 30 deg}}
  B: {type: pin, from: left.b, to: coupler.l}
  C: {type: pin, from: right.b, to: coupler.r}
  D: {type: pin, from: ground.D, to: right.a}
stops:
  one: {joint: A, angle: [30 deg, null]}
  two: {joint: D, angle: [30 deg, null]}
sections: {left: {body: left, from: a, to: b, count: 3}}
"""
WHOLE = (2.0 * 0.15 + 2.0 * 0.3) * math.cos(math.pi / 6.0) * G  # about the cranks' axes together


def test_what_two_stops_share_is_open() -> None:
    """Both cranks of a parallelogram lie on stops: which one carries the weight is for their elasticity to say."""
    found = solved(TWO)
    elements = found.foundation["elements"]
    for stop, joint in (("one", "A"), ("two", "D")):
        assert np.isnan(found.stops[stop]["moment"]).all()
        assert np.isnan(elements[stop]["moment"][0, 2])
        assert (found.foundation["supports"][joint]["moment"] == 0.0).all()
        assert np.isnan(found.foundation["supports"][joint]["force"][0, 0])
    assert np.isnan(found.sections["left"]["M2"][0]).tolist() == [True, True, False]
    near(found.foundation["moment"][0, 2], -WHOLE - 4.0 * 0.4 * G, 30.0, 1e-13)


def test_a_split_between_two_stops_balances() -> None:
    found = solved(TWO, least_norm=True)
    near([found.stops[stop]["moment"][0] for stop in ("one", "two")], [0.5 * WHOLE] * 2, WHOLE, 1e-12)
    assert found.accuracy["balance_residual"] < 1e-14
    near(sum(sums(found)), found.foundation["moment"][0, 2], 30.0, 1e-13)


def sums(found: Results) -> list[float]:
    """The moments about A of all that stands on the ground."""
    base, at = found.foundation, {"A": 0.0, "D": 0.8}
    return [
        *(part["moment"][0, 2] + at[name] * part["force"][0, 1] for name, part in base["supports"].items()),
        *(part["moment"][0, 2] for part in base["elements"].values()),
    ]


@pytest.mark.parametrize("scene", [LID.format(ends="from: ground.O, to: lid.a", limits="[0, 90 deg]"), STACK])
def test_the_weight_alone_presses_on_stops(scene: str) -> None:
    found = solved(scene, requested_reports=frozenset({"foundation", "shares"}))
    for part in found.foundation["elements"].values():
        for component in ("force", "moment"):
            near(part["shares"]["gravity"][component], part[component], 50.0, 1e-13)


def test_the_model_tells_what_opens_and_closes() -> None:
    assert "contacts that open and close: one, two; closed at the start: one, two" in solved(TWO).model["reasons"]
    hanging = STRAP.format(ends="from: ground.O, to: weight.c", limits="[0.5, 1]", z=-0.8)
    assert "contacts that open and close: end; closed at the start: none" in solved(hanging).model["reasons"]
    assert solved(hanging).model["freedoms"] == 3  # of a point, whose spins are none


BEAD = """
heun: 1
parameters: {w: 5, M: 2, m: 0.3}
ground: {points: {O: [0, 0, 0]}}
bodies:
  rod: {shapes: [{type: rod, from: [0, 0, 0], to: [1.2, 0, 0], mass: M}], points: {a: [0, 0, 0], b: [1.2, 0, 0]}}
  bead: {mass: m, center: [0, 0, 0], inertia: [1e-5, 1e-5, 1e-5], points: {c: [0, 0, 0]}, position: [0.25, 0, 0]}
joints:
  hub: {type: pin, from: ground.O, to: rod.a, axis: [0, 0, 1]}
  bore: {type: slide, from: rod.a, to: bead.c, axis: [1, 0, 0], initial: {travel: 0.25, speed: 0}}
drives: {motor: {joint: hub, angle: w*t}}
stops: {end: {joint: bore, travel: [null, 1]}}
sections:
  rod: {body: rod, from: a, to: b, count: 7}
  one: {body: rod, at: [1, 0, 0], normal: [1, 0, 0]SIDE}
analysis: {times: [0, 0.2, 1]}
"""


def test_a_bead_flies_out_to_the_end_of_its_bore() -> None:
    """On a rod that turns evenly it runs as cosh w t, strikes, and pulls at the stop with m w^2 from then on."""
    w, M, m = 5.0, 2.0, 0.3
    found = solved(BEAD.replace("SIDE", ", side: before"))
    (blow,) = found.impulses
    near(blow["time"], math.acosh(4.0) / w, 1.0, 1e-9)
    speed = w * math.sqrt(1.0 - 0.25**2)
    near(blow["stops"]["end"]["force"], -m * speed, m * speed, 1e-9)
    run = found.sections["rod"]
    assert [(round(s, 9), side) for s, side in zip(run["s"], run["side"], strict=True)][5:7] == [
        (1.0, "before"), (1.0, "beyond"),
    ]  # fmt: skip
    beyond = np.array([0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.2])
    own = M * w**2 * (1.2**2 - beyond**2) / 2.4
    bears = np.array([1.0] * 6 + [0.0] * 2)
    near(run["N"][-1], own + m * w**2 * bears, 40.0, 1e-9)
    near(blow["sections"]["rod"]["N"], m * speed * bears, m * speed, 1e-9)
    near(found.sections["one"]["N"][-1], own[5] + m * w**2, 40.0, 1e-9)
    near(found.stops["end"]["force"][-1], -m * w**2, 10.0, 1e-9)


def test_a_cut_where_something_comes_to_its_stop_needs_a_side() -> None:
    with pytest.raises(SpecError, match="stop end lies in the plane of the cut"):
        solved(BEAD.replace("SIDE", ""))


@pytest.mark.parametrize(("up", "spin", "stopped"), [(-1.0, 0.0, 1.0), (1.0, 1.5, 0.0)])
def test_a_blow_presses_a_lid_on_its_stop_or_lifts_it(up: float, spin: float, stopped: float) -> None:
    """Downward all of it goes to stop and hinge; upward the lid turns with 3 H/m L and leaves the stop alone."""
    scene = LID.format(ends="from: ground.O, to: lid.a", limits="[0, 90 deg]")
    found = solved(scene + f"impulses: {{blow: {{on: lid.b, vector: [0, 0, {up}]}}}}\n")
    (blow,) = found.impulses
    near(blow["bodies"]["lid"]["angular_velocity_jump"], [0.0, -spin, 0.0], 1.5, 1e-13)
    near(blow["stops"]["rest"]["moment"], stopped, 1.0, 1e-13)
    near(blow["foundation"]["force"][2], -1.0 if up < 0.0 else -0.5, 1.0, 1e-13)
    near(blow["foundation"]["moment"], [0.0, stopped, 0.0], 1.0, 1e-13)
    near(blow["energy_after"], 0.5 * spin, 1.0, 1e-13)
    near(found.coordinates["hinge"]["rate"], spin, 1.5, 1e-13)
    assert blow["names"] == ["blow", "rest"][: 1 + (up < 0.0)]


def test_two_stops_that_one_motion_strikes_end_it() -> None:
    """Both cranks come to their stops at one instant: nothing moves on, and rounding asks for no accelerations."""
    bare = TWO.replace("gravity: [0, -9.81, 0]\n", "").replace("[30 deg, null]", "[0, 60 deg]")
    moving = bare.replace("initial: {angle: 30 deg}", "initial: {angle: 30 deg, rate: 1}")
    found = solved(moving + "analysis: {duration: 1, samples: 11}\n")
    (blow,) = found.impulses
    near(blow["time"], math.pi / 6.0, 1.0, 1e-12)
    near(blow["energy_after"], 0.0, 1.0, 1e-20)
    near(found.coordinates["A"]["rate"], [1.0] * 6 + [0.0] * 5, 1.0, 1e-12)
    near(found.coordinates["D"]["angle"][6:], np.full(5, math.pi / 3.0), 1.0, 1e-12)
