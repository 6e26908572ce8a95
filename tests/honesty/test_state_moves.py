"""A state that is not at rest says so, with what its loads set going; what moves or is driven to change does not."""

from __future__ import annotations

import pytest

from heuncli.results.results import Results
from tests.shared.heading import format_heading
from tests.shared.scenes import solved

G = 9.81
# a deck on a pin, held by a jack from the ground; the jack's length, 1.25, is that of its points as drawn
LIFT = f"""
heun: 1
gravity: [0, 0, -{G}]
ground: {{points: {{O: [0, 0, 0], J: [1, 0, -0.75]}}}}
bodies:
  deck: {{mass: 100, center: [1, 0, 0], inertia: [10, 20, 20], points: {{O: [0, 0, 0], J: [2, 0, 0]}}}}
joints:
  hinge: {{type: pin, from: ground.O, to: deck.O, axis: [0, 1, 0]INITIAL}}
"""
JACK = "  jack: {type: rod, from: ground.J, to: deck.J}\n"
SPRING = "forces: {jack: {type: spring, from: ground.J, to: deck.J, stiffness: 1e4, length: LENGTH}}\n"
BALANCED = 1.25 + 100 * G / 2 / 0.6 / 1e4  # its upward part, 0.6 of it, carries half of the deck


def found(text: str, initial: str = "") -> Results:
    return solved(text.replace("INITIAL", initial))


def line(results: Results) -> str:
    return next((line for line in format_heading(results).splitlines() if line.startswith("moves")), "")


def test_a_forgotten_jack() -> None:
    """Without its jack the deck falls: by g m c²/(I + m c²) at its centre, at once and in the heading; with it, not."""
    forgotten = found(LIFT)
    hint = "not at rest; analysis: {type: rest} finds the rest position"
    assert forgotten.model["moves"] == [f"deck {G * 100 / 120:.3g} m/s²: {hint}"]
    assert "deck 8.18 m/s²: not at rest" in line(forgotten)
    assert line(found(LIFT + JACK)) == ""


@pytest.mark.parametrize(("off", "moves"), [(0.0, False), (1e-12, False), (1e-8, True)])
def test_a_balance_of_digits(off: float, moves: bool) -> None:
    """A spring that carries its load to rounding leaves it at rest; one that does not, does not."""
    assert bool(line(found(LIFT + SPRING.replace("LENGTH", repr(BALANCED * (1.0 + off)))))) == moves


def test_what_is_meant_to_move() -> None:
    """A start with a speed, a drive that begins to turn, and a motion say nothing."""
    assert line(found(LIFT, ", initial: {rate: 1}")) == ""
    assert line(found(LIFT + "drives: {motor: {joint: hinge, angle: t**2}}\n")) == ""
    assert line(found(LIFT + "analysis: {duration: 0.1, samples: 2}\n")) == ""


def test_turning_about_its_centre() -> None:
    """A wheel whose centre stays is told by its angular acceleration."""
    text = LIFT.replace("center: [1, 0, 0]", "center: [0, 0, 0]")
    text += "forces: {t: {type: torque, joint: hinge, value: 5}}\n"
    assert line(found(text)).startswith("moves     deck 0.25 rad/s²")


def test_carried_round_by_a_drive() -> None:
    """What swings on a turning arm: told by its angle where it swings, and silent where the spin holds it out."""
    text = """
heun: 1
gravity: [0, 0, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {O: [0, 0, 0], E: [1, 0, 0]}}
  bob: {mass: 1, center: [0, 0, -0.5], inertia: [0, 0, 0], points: {E: [0, 0, 0]}}
joints:
  shaft: {type: pin, from: ground.O, to: arm.O, axis: [0, 0, 1]}
  swing: {type: pin, from: arm.E, to: bob.E, axis: [0, 1, 0], initial: {angle: ANGLE deg}}
drives: {motor: {joint: shaft, rate: 2}}
"""
    assert line(solved(text.replace("ANGLE", "0"))).startswith("moves     swing.angle 8 rad/s²")
    assert line(solved(text.replace("ANGLE", "-90"))) == ""
