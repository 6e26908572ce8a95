"""What a run says of bodies that had to leave their place in the drawing for the joints to close."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.shared.heading import format_heading
from tests.shared.scenes import study


def four_bar(slip: float = 0.0, crank: str = "", pin: str = "") -> str:
    """Drawn in world coordinates: crank 1, coupler 3, rocker 2; the coupler drawn too far to the right by a slip."""
    return f"""
heun: 1
ground: {{points: {{A: [0, 0, 0], D: [3, -1, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0, 0.5, 0], inertia: [1, 1, 1], points: {{A: [0, 0, 0], B: [0, 1, 0]}}{crank}}}
  coupler: {{mass: 1, center: [1.5, 1, 0], inertia: [1, 1, 1],
            points: {{B: [{slip}, 1, 0], C: [{3 + slip}, 1, 0]}}}}
  rocker: {{mass: 1, center: [3, 0, 0], inertia: [1, 1, 1], points: {{C: [3, 1, 0], D: [3, -1, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.A, axis: [0, 0, 1]{pin}}}
  B: {{type: pin, from: crank.B, to: coupler.B, axis: [0, 0, 1]}}
  C: {{type: pin, from: coupler.C, to: rocker.C, axis: [0, 0, 1]}}
  D: {{type: pin, from: ground.D, to: rocker.D, axis: [0, 0, 1]}}
"""


SIZE = 3.3  # of the four-bar [m], nearly


@pytest.mark.parametrize(("slip", "said"), [(0.0, False), (0.005, False), (0.006, True), (0.1, True)])
def test_a_slip_of_the_drawing_is_said_in_one_line(slip: float, said: bool) -> None:
    done = study(four_bar(slip))
    lines = [line for line in format_heading(done.results).splitlines() if line.startswith("moved")]
    assert len(lines) == int(said)
    assert not done.results.warnings
    if said:
        assert lines[0].endswith("; see heun model")
        assert f"to assemble the joints: coupler by {slip:.1g}" in lines[0]


def test_what_the_spec_asks_for_is_not_a_slip() -> None:
    """A held angle turns the loop away from its drawing."""
    assert "moved" not in study(four_bar(pin=", initial: {angle: 20 deg}")).results.model


def test_joints_between_origins_say_nothing_of_how_a_scene_is_drawn() -> None:
    """A robot, many parts of which are fixed where their bodies have their origins, drawn about these."""
    parts = "".join(f"  part{k}: {{mass: 1, center: [0.1, 0, 0], inertia: [1, 1, 1]}}\n" for k in range(3))
    origins = [f"{{body: {body}, at: [0, 0, 0]}}" for body in ("arm", "part0", "part1", "part2")]
    welds = "".join(f"  fixed{k}: {{type: weld, from: {origins[0]}, to: {to}}}\n" for k, to in enumerate(origins[1:]))
    text = f"""
heun: 1
ground: {{points: {{O: [0, 0, 1]}}}}
bodies:
  arm: {{mass: 1, center: [0.5, 0, 0], inertia: [1, 1, 1], points: {{e: [1, 0, 0]}}}}
  hand: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
{parts}joints:
  turn: {{type: pin, from: ground.O, to: {origins[0]}, axis: [0, 0, 1]}}
  wrist: {{type: pin, from: arm.e, to: hand.o, axis: [0, 0, 1]}}
{welds}"""
    assert "moved" not in study(text).results.model


def test_bodies_drawn_about_their_own_origins_are_placed() -> None:
    text = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0.5, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0], b: [1, 0, 0]}}
  rod: {mass: 1, center: [1.5, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0], b: [3, 0, 0]}}
  piston: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0]}}
joints:
  main: {type: pin, from: ground.O, to: crank.a, axis: [0, 0, 1]}
  big: {type: pin, from: crank.b, to: rod.a, axis: [0, 0, 1]}
  wrist: {type: pin, from: rod.b, to: piston.a, axis: [0, 0, 1]}
  guide: {type: slide, from: ground.O, to: piston.a, axis: [1, 0, 0]}
"""
    assert "moved" not in study(text).results.model


def test_near_is_a_place() -> None:
    """The crank's own pin lies 0.2 m beside where near puts it."""
    (said,) = study(four_bar(crank=", near: {position: [0.2, 0, 0]}")).results.model["moved"]
    assert said == "crank by 0.2 m"


def test_three_are_named() -> None:
    """Of many bodies those that moved most; all of them stand in the note on the model."""
    results = replace(study(four_bar(0.1)).results, model={"moved": [f"b{i} by 1 m" for i in range(8)]})
    told = " ".join(format_heading(results).split())
    assert "moved to assemble the joints: b0 by 1 m, b1 by 1 m, b2 by 1 m and 5 more; see heun model" in told
