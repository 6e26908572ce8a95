"""Stops and ropes that catch: what is refused, with its hint, and where the coordinates stand that stops limit."""

from __future__ import annotations

import math

import pytest

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.multibody.mechanism.build import build
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene, prepare
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.rules import references

TOP = """\
heun: 1
ground: {points: {O: [0, 0, 0], Q: [3, 0, 0]}}
bodies:
  bar: {mass: 1, center: [0.5, 0, 0], inertia: [0, 0.08, 0.08], points: {a: [0, 0, 0], b: [1, 0, 0]}}
"""
PIN = "joints: {pivot: {type: pin, from: ground.O, to: bar.a, axis: [0, 0, 1]}}\n"


@pytest.fixture(autouse=True)
def whole_format(monkeypatch: pytest.MonkeyPatch) -> None:
    """The format is read whole, also what is not solved yet."""
    monkeypatch.setattr(references, "NOT_YET", ())


def mechanism(text: str) -> Mechanism:
    return build(load("x.yaml", text=TOP + text), {})


def prepared(text: str) -> PreparedScene:
    return prepare(mechanism(text))


def problems(text: str) -> tuple[Problem, ...]:
    with pytest.raises(HeunError) as caught:
        prepared(text)
    return caught.value.problems


def rod(more: str = "", tail: str = "") -> str:
    return f"joints: {{rope: {{type: rod, from: ground.Q, to: bar.b{more}}}}}\n{tail}"


def test_a_mechanism_has_its_blows_and_stops() -> None:
    found = mechanism(
        PIN
        + """\
impulses:
  hit: {on: bar.b, vector: [0, 1, 0], frame: body, time: 0.5}
  twist: {on: bar.b, couple: [0, 0, 2]}
  spin: {body: bar, couple: [0, 0, 3]}
stops: {s: {joint: pivot, angle: [-1, null], restitution: 0.25}}
analysis: {duration: 1}
"""
    )
    hit, twist, spin = found.impulses
    assert (hit.name, hit.body, hit.in_body, hit.time, hit.kind) == ("hit", 0, True, 0.5, "impulse")
    assert (twist.kind, spin.kind, spin.point) == ("couple", "couple", None)
    assert hit.point is not None
    assert twist.point is not None
    assert [hit.point.tolist(), twist.point.tolist()] == [[1.0, 0.0, 0.0]] * 2
    assert [blow.vector.tolist() for blow in found.impulses] == [[0, 1, 0], [0, 0, 2], [0, 0, 3]]
    (stop,) = found.stops
    assert (stop.name, stop.joint, stop.quantity, stop.low, stop.high, stop.restitution) == (
        "s", 0, "angle", -1.0, None, 0.25,
    )  # fmt: skip


def test_a_rope_that_catches() -> None:
    assert mechanism(rod(", tension_only: true, restitution: 0.3")).joints[0].restitution == 0.3
    assert mechanism(rod(", tension_only: true")).joints[0].restitution is None
    assert [p.code for p in problems(rod(", restitution: 0.3"))] == ["restitution"]
    assert [p.code for p in problems(rod(", tension_only: true, restitution: 2"))] == ["restitution"]


@pytest.mark.parametrize("more", [", length: 2", ", tension_only: true", ", tension_only: true, restitution: 1"])
def test_a_rod_between_limits_is_neither_rigid_nor_a_rope(more: str) -> None:
    (found,) = problems(rod(more, "stops: {s: {joint: rope, length: [1, 3]}}\n"))
    assert found.code == "stop-joint"
    assert "free" in found.message


def test_what_is_driven_has_no_stop() -> None:
    drive = "drives: {pull: {joint: rope, length: 2 + t}}\nstops: {s: {joint: rope, length: [1, 3]}}\n"
    assert [p.code for p in problems(rod("", drive))] == ["stop-joint"]
    turning = """\
joints: {shaft: {type: cylinder, from: ground.O, to: bar.a, axis: [0, 0, 1]}}
drives: {feed: {joint: shaft, travel: t}}
stops: {s: {joint: shaft, angle: [-1, 1]}}
"""
    assert prepared(turning).mechanism.stops[0].quantity == "angle"  # its other coordinate is free


@pytest.mark.parametrize(("text", "hint"), [
    (PIN.replace("axis", "limits: [0, 1], axis"), "stops: {"),
    (PIN.replace("axis", "restitution: 1, axis"), "rod with tension_only, or to a stop"),
    (PIN.replace("pin,", "contact,"), "stops: {"),
    (PIN.replace("pin,", "rope,"), "for 'rope' write type: rod, with tension_only: true"),
    (PIN + "bumpers: {s: {joint: pivot, angle: [0, 1]}}\n", "called stops here"),
    (PIN + "stops: {s: {joint: pivot, angle: [0, 1], e: 1}}\n", "called restitution here"),
    (PIN + "stops: {s: {joint: pivot, angle: 1}}\n", "null means no limit"),
    (PIN + "impulses: {hit: {on: bar.b, moment: [0, 0, 1]}}\n", "called couple here"),
])  # fmt: skip
def test_hints(text: str, hint: str) -> None:
    assert any(hint in (p.hint or "") for p in problems(text))


def test_friction_at_a_strike_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    found = problems(PIN + "stops: {s: {joint: pivot, angle: [0, 1], friction: 0.3}}\n")
    assert "not available yet: friction at impacts" in [p.message for p in found]


# ---- starts
def start(limits: str, quantity: str = "travel", joint: str = "slide", at: str = "", more: str = "") -> str:
    return (
        f"joints: {{j: {{type: {joint}, from: ground.O, to: {{body: bar, at: [0, 0, 0]}}, axis: [0, 0, 1]{more}}}}}\n"
        f"stops: {{s: {{joint: j, {quantity}: {limits}}}}}\n{at}"
    )


def test_a_start_beyond_a_limit_is_refused_with_both_numbers() -> None:
    (found,) = problems(start("[0.25, 1]"))
    assert found.code == "beyond-stop"
    assert "j.travel starts at 0 m, below the limit 0.25 m of stop s" in found.message
    assert [p.code for p in problems(start("[null, -0.25]"))] == ["beyond-stop"]
    assert [p.code for p in problems(rod("", "stops: {s: {joint: rope, length: [null, 1.5]}}\n"))] == ["beyond-stop"]
    assert prepared(rod("", "stops: {s: {joint: rope, length: [2, 2.5]}}\n")).mechanism.stops[0].low == 2.0


@pytest.mark.parametrize(("limit", "fine"), [("0", True), ("1e-12", True), ("1e-6", False)])
def test_a_start_at_its_limit(limit: str, fine: bool) -> None:
    assert float(limit) < tolerances.AT_LIMIT or not fine
    text = start(f"[{limit}, 1]")
    if fine:
        prepared(text)
    else:
        assert [p.code for p in problems(text)] == ["beyond-stop"]


@pytest.mark.parametrize(("limits", "angle"), [
    ("[170 deg, 200 deg]", 190.0), ("[null, -160 deg]", -170.0), ("[500 deg, 600 deg]", 550.0),
    ("[-180 deg, 0]", -170.0),
])  # fmt: skip
def test_turns_are_counted_within_the_limits(limits: str, angle: float) -> None:
    """A lid drawn at 190 deg stands between 170 and 200 deg, not at -170."""
    turned = TOP.replace("{mass: 1", "{orientation: {axis: [0, 0, 1], angle: 190 deg}, mass: 1")
    text = turned + PIN + f"stops: {{s: {{joint: pivot, angle: {limits}}}}}\n"
    scene = prepare(build(load("x.yaml", text=text), {}))
    assert math.degrees(scene.layout.starts[0].angle) == pytest.approx(angle, rel=1e-12)


def test_a_turn_more_brings_no_start_within_one_limit() -> None:
    turned = TOP.replace("{mass: 1", "{orientation: {axis: [0, 0, 1], angle: 40 deg}, mass: 1")
    with pytest.raises(HeunError) as caught:
        prepare(build(load("x.yaml", text=turned + PIN + "stops: {s: {joint: pivot, angle: [null, 30 deg]}}\n"), {}))
    assert [p.code for p in caught.value.problems] == ["beyond-stop"]


def test_a_limited_joint_is_not_cut() -> None:
    """Of a loop of three bars and the ground the pin that would be cut carries the motion where a stop asks for it."""
    text = """\
heun: 1
space: planar
ground: {points: {A: [0, 0, 0], D: [4, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0, 0.5, 0], inertia: 0.1, points: {a: [0, 0, 0], b: [0, 1, 0]}}
  coupler: {mass: 1, center: [2, 1.5, 0], inertia: 1, points: {b: [0, 1, 0], c: [4, 2, 0]}}
  rocker: {mass: 1, center: [4, 1, 0], inertia: 0.4, points: {c: [4, 2, 0], d: [4, 0, 0]}}
joints:
  A: {type: pin, from: ground.A, to: crank.a}
  B: {type: pin, from: crank.b, to: coupler.b}
  C: {type: pin, from: coupler.c, to: rocker.c}
  D: {type: pin, from: ground.D, to: rocker.d}
"""
    plain = prepare(build(load("x.yaml", text=text), {})).layout.spanning.cut
    (cut,) = plain
    name = "ABCD"[cut]
    with_stop = text + f"stops: {{s: {{joint: {name}, angle: [-1, 1]}}}}\n"
    assert prepare(build(load("x.yaml", text=with_stop), {})).layout.spanning.cut != plain


# ---- blows
SECTION = """\
sections:
  s: {body: bar, at: [0.7, 0, 0], normal: [1, 0, 0], piece: {mass: 0.2, center: [0.8, 0, 0], inertia: [0, 0.01, 0.01]}}
"""


@pytest.mark.parametrize(("text", "codes"), [
    (PIN + "impulses: {hit: {on: bar.b, vector: [0, 1, 2]}}\n", ["not-planar"]),
    (PIN + "impulses: {hit: {on: bar.b, couple: [1, 0, 2]}}\n", ["not-planar"]),
    (PIN + "impulses: {hit: {on: bar.b, vector: [0, 1, 0], frame: body}}\n", []),
])  # fmt: skip
def test_blows_of_a_planar_scene_lie_in_it(text: str, codes: list[str]) -> None:
    flat = TOP.replace("heun: 1\n", "heun: 1\nspace: planar\n") + text
    assert codes_of(flat) == codes


@pytest.mark.parametrize(("blow", "codes"), [
    ("{body: bar, couple: [0, 0, 1]}", ["couple-point"]), ("{on: bar, couple: [0, 0, 1]}", ["couple-point"]),
    ("{on: bar.b, couple: [0, 0, 1]}", []), ("{on: bar.b, vector: [0, 0, 1]}", []),
])  # fmt: skip
def test_an_impulsive_couple_on_a_body_that_is_cut_has_a_point(blow: str, codes: list[str]) -> None:
    assert codes_of(TOP + PIN + SECTION + f"impulses: {{hit: {blow}}}\n") == codes


def test_a_state_has_no_blows() -> None:
    text = TOP + PIN + "impulses: {hit: {on: bar.b, vector: [0, 1, 0]}}\nanalysis: {type: state}\n"
    assert codes_of(text) == ["analysis-type"]


@pytest.mark.parametrize(("rest", "codes"), [
    ("drives: {hit: {joint: pivot, angle: t}}\n", ["shared-name"]), ("", []),
    ("forces: {hit: {type: torque, joint: pivot, value: 1}}\n", []),  # a force is no part of a blow
])  # fmt: skip
def test_what_strikes_is_told_by_its_name(rest: str, codes: list[str]) -> None:
    assert codes_of(TOP + PIN + rest + "impulses: {hit: {on: bar.b, vector: [0, 1, 0]}}\n") == codes


def codes_of(text: str) -> list[str]:
    try:
        load("x.yaml", text=text)
    except HeunError as error:
        return [p.code for p in error.problems]
    return []
