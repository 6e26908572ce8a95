"""Drives by rate and speed: their coordinate is the start's and the integral, and all else is as if that were given."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved

TIMES = [0.0, 0.11, 0.25, 0.45, 0.52, 0.77, 1.0, 1.2]
TABLE = "tables: {v: {x: [0, 0.4, 0.9, 3], y: [0, 2, 0.5, 0.5]}}\n"
# of a rate and of its integral from 0, a function of t each; one more for the table
LAWS = {
    "constant": ("1.7", "1.7*t"),
    "ramp": ("2*t - 0.3", "t**2 - 0.3*t"),
    "trapezoid": ("min(4*t, 2, 4*(1.1 - t))",
                  "2*t**2 if t < 0.5 else (0.5 + 2*(t - 0.5) if t < 0.6 else 0.7 + 2*(0.25 - (1.1 - t)**2))"),
    "sine": ("1.5*sin(9*t + 0.4)", "1.5*(cos(0.4) - cos(9*t + 0.4))/9"),
    "run-up": ("2*(1 - exp(-5*t))", "2*t - 0.4*(1 - exp(-5*t))"),
    "S-curve": ("2*(t/0.8)**3*(10 - 15*t/0.8 + 6*(t/0.8)**2) if t < 0.8 else 2",
                "1.6*(2.5*(t/0.8)**4 - 3*(t/0.8)**5 + (t/0.8)**6) if t < 0.8 else 0.8 + 2*(t - 0.8)"),
    "jump": ("1 if t < 0.5 else -0.5", "t if t < 0.5 else 0.5 - 0.5*(t - 0.5)"),
    "reversing": ("sign(0.7 - t)*t", "t**2/2 if t < 0.7 else 0.49 - t**2/2"),
    "table": ("table(v, t)", "2.5*t**2 if t < 0.4 else (0.4 + 2*(t - 0.4) - 1.5*(t - 0.4)**2 if t < 0.9 else"
              " 1.025 + 0.5*(t - 0.9))"),
}  # fmt: skip
HEAD = "heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0], G: [2.2, 0, 0], S: [0.2, 0, 1.5]}}\n" + TABLE
ARM = "  arm: {mass: 2, center: [0.4, 0.05, 0], inertia: [0.1, 0.2, 0.25], points: {O: [0, 0, 0], E: [1, 0, 0]}}\n"
HAND = "  hand: {mass: 1, center: [1.3, 0.1, 0], inertia: [0.1, 0.2, 0.25], points: {E: [1, 0, 0], H: [2.2, 0, 0]}}\n"
# bodies and joints; the joint, the key of the coordinate and of its rate, the coordinate at the start
MACHINES: dict[str, tuple[str, str, str, str, str, float]] = {
    "a pin, and what hangs on it": (
        ARM + HAND, "  j: {type: pin, from: ground.O, to: arm.O, axis: [0, 1, 0.3], initial: {angle: 0.4}}\n"
        "  k: {type: ball, from: arm.E, to: hand.E}\n", "j", "angle", "rate", 0.4),
    "the crank of a slider-crank": (
        ARM + HAND, "  j: {type: pin, from: ground.O, to: arm.O, axis: [0, -1, 0], initial: {angle: 0.4}}\n"
        "  k: {type: pin, from: arm.E, to: hand.E, axis: [0, 1, 0]}\n"
        "  l: {type: line, from: ground.G, to: hand.H, axis: [1, 0, 0]}\n", "j", "angle", "rate", 0.4),
    "a slide, as it is drawn": (
        ARM + HAND, "  j: {type: slide, from: ground.O, to: arm.O, axis: [1, 0, 1]}\n"
        "  k: {type: universal, from: arm.E, to: hand.E, axis: [0, 1, 0], to_axis: [0, 0, 1]}\n",
        "j", "travel", "speed", 0.0),
    "a cylinder's sliding": (
        ARM, "  j: {type: cylinder, from: ground.O, to: arm.O, axis: [0, 1, 0],"
        " initial: {travel: 0.3, angle: -0.2}}\n", "j", "travel", "speed", 0.3),
    "a rod, as it is assembled": (
        ARM + HAND, "  j: {type: rod, from: ground.S, to: arm.E}\n  a: {type: pin, from: ground.O, to: arm.O,"
        " axis: [0, 1, 0]}\n  k: {type: pin, from: arm.E, to: hand.E, axis: [0, 1, 0.2]}\n",
        "j", "length", "speed", 1.7),
}  # fmt: skip


def run(machine: str, drive: str) -> Results:
    bodies, joints = MACHINES[machine][:2]
    analysis = f"analysis: {{times: {TIMES}, tolerance: 1e-11}}\n"
    return solved(f"{HEAD}bodies:\n{bodies}joints:\n{joints}drives:\n  motor: {drive}\n{analysis}")


# the first two, integrated and followed, with all laws, the others with a smooth one and one with a blow
CASES = [(m, law) for n, m in enumerate(MACHINES) for law in (LAWS if n < 2 else ("sine", "jump"))]


@pytest.mark.parametrize(("machine", "law"), CASES)
@pytest.mark.third
def test_as_if_the_coordinate_were_given(machine: str, law: str) -> None:
    """All numbers of a run are those of the same drive by its integral, blows at jumps of the rate included."""
    *_, joint, key, rate, start = MACHINES[machine]
    shrink = 0.1 if key == "length" else 0.3  # the crank stays off its dead centre, the rod keeps its triangle
    by_rate = run(machine, f"{{joint: {joint}, {rate}: '{shrink}*({LAWS[law][0]})'}}")
    given = run(machine, f"{{joint: {joint}, {key}: '{start} + {shrink}*({LAWS[law][1]})'}}")
    assert given.work["steps"] > 0
    assert [b["time"] for b in by_rate.impulses] == pytest.approx([b["time"] for b in given.impulses], rel=1e-15)
    integrated = given.model["freedoms"] > 0
    compare(blocks(by_rate), blocks(given), 1e-9 if integrated else 3e-13)
    if law in ("jump", "reversing"):
        assert [b["names"] for b in by_rate.impulses] == [["motor"]]


def blocks(results: Results) -> dict[str, Any]:
    return {"coordinates": results.coordinates, "joints": results.joints, "foundation": results.foundation,
            "energy": results.energy, "impulses": {str(n): b for n, b in enumerate(results.impulses)}}  # fmt: skip


def compare(one: Any, other: Any, error: float, path: str = "") -> None:
    """The same numbers, block by block, each against its own largest."""
    if isinstance(one, dict):
        assert one.keys() == other.keys(), path
        for key in one.keys() - {"open", "names", "time", "axis", "certain_sums"}:
            compare(one[key], other[key], error, f"{path}.{key}")
    elif one is not None:
        a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
        assert (np.isnan(a) == np.isnan(b)).all(), path
        a, b = np.nan_to_num(a), np.nan_to_num(b)
        near(a, b, max(1.0, float(np.abs(b).max(initial=0.0))), error)


def test_a_steady_rate_is_exact() -> None:
    """1500 rpm for ten seconds: the angle is the product, bit for bit, counted on over 250 turns."""
    body = "  r: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}\n"
    joint = "  j: {type: pin, from: ground.O, to: r.c, axis: [0, 0, 1]}\n"
    text = f"{HEAD}bodies:\n{body}joints:\n{joint}drives: {{motor: {{joint: j, rate: 1500 rpm}}}}\n"
    found = solved(f"{text}analysis: {{times: [0, 3.3, 10]}}\n").coordinates["j"]
    assert found["angle"].tolist() == [t * (1500 * math.pi / 30) for t in (0.0, 3.3, 10.0)]
    assert found["rate"].tolist() == [1500 * math.pi / 30] * 3


def test_counted_from_the_start() -> None:
    """An angle of more than a turn, held at the start, is counted on; zero: assembled counts from there."""
    body = "  r: {mass: 1, center: [0.1, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}\n"
    tail = "drives: {motor: {joint: j, rate: 2*tMORE}}\nanalysis: {times: [0, 3]}\n"
    for initial, more, start in ((", initial: {angle: 10}", "", 10.0), ("", ", zero: assembled", 0.0)):
        joint = f"  j: {{type: pin, from: ground.O, to: r.c, axis: [0, 0, 1]{initial}}}\n"
        found = solved(f"{HEAD}bodies:\n{body}joints:\n{joint}{tail.replace('MORE', more)}").coordinates["j"]
        near(found["angle"], np.array([start, start + 9.0]), 10.0, 1e-15)


@pytest.mark.parametrize("drive", ["travel: 't**2', zero: assembled", "speed: '2*t', zero: assembled", "speed: '2*t'"])
def test_a_travel_counted_from_where_it_is_drawn(drive: str) -> None:
    """What is drawn 0.3 along its slide starts there, and its travel is that of its points all the same."""
    body = "  b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0.3, 0, 0]}}\n"
    joint = "  j: {type: slide, from: ground.O, to: b.p, axis: [1, 0, 0]}\n"
    text = f"{HEAD}bodies:\n{body}joints:\n{joint}drives: {{motor: {{joint: j, {drive}}}}}\n"
    found = solved(text + "analysis: {times: [0, 1]}\n")
    near(found.bodies["b"]["position"][:, 0], [0.0, 1.0], 1.0, 1e-15)
    near(found.coordinates["j"]["travel"], [0.3, 1.3], 1.0, 1e-15)


FROM_THE_START = {  # joint, what is driven, where it is drawn to stand, and what its results tell there
    "pin": ("pin, axis: [0, 0, 1]", "angle", (0.0, 0.7), 0.0),
    "slide": ("slide, axis: [1, 0, 0]", "travel", (0.3, 0.0), 0.3),
    "cylinder": ("cylinder, axis: [1, 0, 0]", "travel", (0.3, 0.0), 0.3),
}


def counted(kind: str, value: str, initial: str = "") -> str:
    """A body drawn away from where its joint's coordinate is zero, driven from the assembled start."""
    joint, quantity, (place, turn), _ = FROM_THE_START[kind]
    start = f"position: [{place}, 0, 0], orientation: {{axis: [0, 0, 1], angle: {turn}}}"
    held = f", initial: {{{quantity}: {initial}}}" if initial else ""
    return f"""{HEAD}bodies:
  b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}, {start}}}
joints: {{j: {{type: {joint}, from: ground.O, to: b.p{held}}}}}
drives: {{motor: {{joint: j, {quantity}: {value}, zero: assembled}}}}
analysis: {{times: [0, 0.5, 2]}}
"""


@pytest.mark.parametrize("kind", FROM_THE_START)
def test_zero_assembled_means_one_thing(kind: str) -> None:
    """Bodies start as assembled and move on by what is prescribed, which is 0 there; results keep their own zero."""
    _, quantity, (place, turn), told = FROM_THE_START[kind]
    law = np.array([0.0, 0.25, 4.0])
    for initial in ("", "0"):
        found = solved(counted(kind, "t**2", initial))
        moved, turned = (law, 0.0 * law) if quantity == "travel" else (0.0 * law, law)
        near(found.bodies["b"]["position"][:, 0], place + moved, 1.0, 1e-14)
        near(found.bodies["b"]["rotation"][:, 1, 0], np.sin(turn + turned), 1.0, 1e-14)
        near(found.coordinates["j"][quantity], told + law, 4.0, 1e-15)


@pytest.mark.parametrize("kind", FROM_THE_START)
@pytest.mark.parametrize(("value", "initial"), [("0.2 + t", ""), ("t", "0.1")])
def test_what_is_counted_from_the_start_is_zero_there(kind: str, value: str, initial: str) -> None:
    with pytest.raises(SolveError, match="where it is zero by definition") as caught:
        solved(counted(kind, value, initial))
    assert [problem.code for problem in caught.value.problems] == ["held-conflict"]


def test_a_rod_that_is_used_up() -> None:
    """A rod that shortens to nothing is refused with the instant, whether its length is given or as assembled."""
    bodies, joints = MACHINES["a rod, as it is assembled"][:2]
    text = f"{HEAD}bodies:\n{bodies}joints:\n{joints}drives: {{motor: {{joint: j, speed: -2}}}}\n"
    text += "analysis: {duration: 1}\n"
    with pytest.raises(SolveError, match=r"the length of rod j reaches 0 at t = 0\.85"):
        solved(text)


def test_a_rate_without_an_integral() -> None:
    """A pole of the rate is where the run ends, with its instant; a root at its end is none."""
    body = "  r: {mass: 1, center: [0.1, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}\n"
    joint = "  j: {type: pin, from: ground.O, to: r.c, axis: [0, 0, 1]}\n"
    text = f"{HEAD}bodies:\n{body}joints:\n{joint}drives: {{motor: {{joint: j, rate: RATE}}}}\n"
    text += "analysis: {duration: 1}\n"
    with pytest.raises(SpecError, match=r"'1/\(0.6 - t\)' .* t = 0.6"):
        solved(text.replace("RATE", "1/(0.6 - t)"))
    found = solved(text.replace("RATE", "(1.1 - t)**0.5")).coordinates["j"]["angle"]
    near(found[-1], (1.1**1.5 - 0.1**1.5) / 1.5, 1.0, 1e-15)
