"""Springs about the axes of joints: closed forms, energy, the same chain with its joints cut elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from tests.shared.scenes import near, solved

PENDULUM = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{disc: {{mass: 2, center: [0.1, 0, 0], inertia: [0.1, 0.2, 0.3], points: {{o: [0, 0, 0]}}}}}}
joints: {{axle: {{type: {kind}, from: {ends}, axis: [0, 0, 1]{more}}}}}
forces: {{spring: {{type: turn_spring, joint: axle, stiffness: 5 N*m/rad, angle: {angle}, damping: {damping}}}}}
analysis: {{duration: 2, samples: 21, tolerance: 1e-12}}
"""
FORWARD, BACKWARD = "ground.O, to: disc.o", "disc.o, to: ground.O"


def pendulum(kind: str = "pin", ends: str = FORWARD, more: str = "", angle: float = 0.3, damping: float = 0.0) -> str:
    return PENDULUM.format(kind=kind, ends=ends, more=more, angle=angle, damping=damping)


@pytest.mark.parametrize("ends", [FORWARD, BACKWARD])
def test_a_torsional_pendulum(ends: str) -> None:
    """φ = φ0 + a cos ωt + b/ω sin ωt, ω² = k/J, over several turns; told as a torque is, with its angle."""
    found = solved(pendulum(ends=ends, more=", initial: {angle: 0.5, rate: 60}"))
    J = 0.3 + 2 * 0.01
    w, t = np.sqrt(5 / J), found.time
    turn = 0.2 * np.cos(w * t) + 60 / w * np.sin(w * t)
    block = found.forces["spring"]
    assert float(np.abs(turn).max()) > 4 * np.pi
    near(block["angle"], 0.3 + turn, 15.0, 1e-10)
    near(block["value"], -5 * turn, 75.0, 1e-10)
    near(block["power"], block["value"] * block["rate"], 4000.0, 1e-12)
    near(found.coordinates["axle"]["angle"], block["angle"], 15.0, 1e-14)
    near(found.energy["potential"], 2.5 * turn**2, 600.0, 1e-10)
    near(found.energy["work"], 0.0, 600.0, 1e-12)


def test_it_dies_out() -> None:
    """With damping c at the aperiodic limit, c² = 4 k J: (φ − φ0) e^(ωt) is a straight line."""
    J = 0.32
    w = np.sqrt(5 / J)
    found = solved(pendulum(more=", initial: {angle: 1.3, rate: 0}", damping=2 * np.sqrt(5 * J)))
    t = found.time
    near(found.forces["spring"]["angle"], 0.3 + (1 + w * t) * np.exp(-w * t), 1.0, 1e-10)
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], 2.5, 1e-10)
    assert float(found.energy["work"][-1]) < -2.4


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.9])
def test_a_universal_about_its_axis(turn: float) -> None:
    """The outer ring of a gimbal: the angle is that of its second axis, as drawn 0."""
    c, s = np.cos(turn), np.sin(turn)
    more = ", to_axis: [1, 0, 0]"
    text = (
        pendulum("universal", more=more)
        .replace("center: [0.1, 0, 0]", "center: [0, 0, 0]")
        .replace("points: {o", f"orientation: {{matrix: [[{c}, {-s}, 0], [{s}, {c}, 0], [0, 0, 1]]}}, points: {{o")
    )
    found = solved(text)
    near(found.forces["spring"]["angle"], 0.3 + (turn - 0.3) * np.cos(np.sqrt(5 / 0.3) * found.time), 3.2, 1e-9)


LOOP = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], D: [2, 0, 0]}}}}
bodies:
  crank:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0.5, 0], mass: 1}}]
    points: {{a: [0, 0, 0], b: [0, 0.5, 0]}}
  rod:
    shapes: [{{type: rod, from: [0, 0.5, 0], to: [2, 1.5, 0], mass: 2}}]
    points: {{b: [0, 0.5, 0], c: [2, 1.5, 0]}}
  rocker:
    shapes: [{{type: rod, from: [2, 0, 0], to: [2, 1.5, 0], mass: 3}}]
    points: {{c: [2, 1.5, 0], d: [2, 0, 0]}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a, axis: [0, 0, 1], initial: {{rate: 30}}}}
  {middle}
  D: {{type: pin, from: ground.D, to: rocker.d, axis: [0, 0, 1]}}
forces:
  {springs}
  motor: {{type: torque, joint: A, value: 60}}
space: {space}
analysis: {{duration: 1, samples: 11, tolerance: 1e-11}}
"""
SPRINGS = "\n  ".join(
    f"s{joint}: {{type: turn_spring, joint: {joint}, stiffness: {k}, angle: {angle}}}"
    for joint, k, angle in (("A", 3, 0.2), ("B", 4, -0.3), ("C", 5, 0.4), ("D", 6, 0.1))
)


MIDDLE = (
    "B: {type: pin, from: crank.b, to: rod.b, axis: [0, 0, 1]}",
    "C: {type: pin, from: rod.c, to: rocker.c, axis: [0, 0, 1]}",
)


@pytest.mark.parametrize("space", ["planar", "auto"])
@pytest.mark.parametrize("middle", [MIDDLE, MIDDLE[::-1]])
def test_a_compliant_four_bar(middle: tuple[str, str], space: str) -> None:
    """Springs in all four joints, of which one is cut: energy stays, angles add up, turns count in the cut one, too."""
    found = solved(LOOP.format(springs=SPRINGS, space=space, middle="\n  ".join(middle)))
    angle = {joint: found.forces[f"s{joint}"]["angle"] for joint in "ABCD"}
    near(angle["A"] + angle["B"] + angle["C"], angle["D"], 1.0, 1e-9)
    assert min(abs(float(angle[joint][-1] - angle[joint][0])) for joint in "AB") > 4 * np.pi
    for joint, values in angle.items():
        near(values, found.coordinates[joint]["angle"], 1.0, 1e-9)
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], float(np.abs(total).max()), 1e-9)
    torque = {joint: found.forces[f"s{joint}"]["value"] for joint in "ABCD"}
    near(torque["C"], -5 * (angle["C"] - 0.4), 50.0, 1e-12)


@pytest.mark.parametrize(("spec", "code"), [
    ("{type: turn_spring, joint: axle, stiffness: -1}", "negative"),
    ("{type: turn_spring, joint: axle, stiffness: 1 N/m}", "dimension"),
    ("{type: turn_spring, joint: shaft, stiffness: 1}", "unknown-joint"),
    ("{type: torsional_spring, joint: axle, stiffness: 1}", "unknown-force-type"),
])  # fmt: skip
def test_errors(spec: str, code: str) -> None:
    text = pendulum()
    first = text.index("{type: turn_spring")
    with pytest.raises(SpecError) as raised:
        solved(text[:first] + spec + text[text.index("}}", first) + 1 :])
    assert [problem.code for problem in raised.value.problems] == [code]


def test_other_joints_have_no_axis_for_it() -> None:
    with pytest.raises(SpecError, match="a turn_spring acts in a pin, cylinder or universal, not in a ball"):
        solved(pendulum("ball").replace(", axis: [0, 0, 1]", ""))
