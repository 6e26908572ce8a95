"""What is told over a range is what each instant tells by itself, with loads of all kinds, driven or let go."""

from __future__ import annotations

import pytest

from heuncli.commands.lagrange.options import range_of
from heuncli.commands.lagrange.over import over
from heuncli.spec.load import load
from tests.shared.lagrange import told

FOUR_BAR = """\
heun: 1
gravity: [0, -9.81, 0]
parameters: {{phi: 50 deg, w: 7}}
ground: {{points: {{O: [0, 0, 0], B: [0.9, 0.1, 0], W: [0.2, 0.8, 0]}}}}
bodies:
  a:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0.2, 0, 0], mass: 1}}, {{type: point, at: [0.05, 0.1, 0], mass: 0.5}}]
    points: {{o: [0, 0, 0], e: [0.2, 0, 0]}}
  b:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0.8, 0, 0], mass: 0.7}}]
    points: {{o: [0, 0, 0], e: [0.8, 0, 0], m: [0.4, 0.1, 0]}}
    near: {{position: [0.13, 0.15, 0]}}
  c:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0.5, 0, 0], mass: 0.9}}]
    points: {{o: [0, 0, 0], e: [0.5, 0, 0]}}
    near: {{position: [0.9, 0.1, 0], orientation: {{axis: [0, 0, 1], angle: 90 deg}}}}
joints:
  A: {{type: pin, axis: [0, 0, 1], from: ground.O, to: a.o{initial}}}
  B: {{type: line, axis: [0, 0, 1], from: a.e, to: b.o}}
  C: {{type: pin, axis: [0, 0, 1], from: b.e, to: c.e}}
  D: {{type: pin, axis: [0, 0, 1], from: ground.B, to: c.o}}
forces:
  spring: {{type: spring, from: ground.W, to: b.m, stiffness: 300, length: 0.3, damping: 2}}
  rub: {{type: damper, joint: D, coefficient: 0.4}}
  turn: {{type: turn_spring, joint: A, stiffness: 3, angle: 0.2}}
  law: {{type: force, on: b.m, vector: ["20*sin(A.angle)", 3, 0]}}
  time: {{type: torque, joint: A, value: "2 + t"}}
{drives}
analysis: {{type: state}}
"""
WAYS = {
    "driven": {"initial": "", "drives": "drives: {motor: {joint: A, angle: phi + w*t}}"},
    "let go": {"initial": ", initial: {angle: phi, rate: w}", "drives": ""},
}
DIGITS = 1e-12  # of N m and kg m^2 of some ten


@pytest.mark.parametrize("way", WAYS)
def test_a_range_is_its_instants(way: str) -> None:
    """Below and above the start, over more than a turn; turns are counted, which the turn spring feels."""
    text = FOUR_BAR.format(**WAYS[way])
    spec = load("scene.yaml", text)
    found = over(spec, range_of("A.angle=-200deg:400deg/7", spec))
    assert found.rate == pytest.approx(7.0, rel=1e-12) and found.driven == (way == "driven")
    for i, phi in enumerate(found.values.tolist()):
        one = told(text.replace("phi: 50 deg", f"phi: {phi!r}"), coordinates=("A.angle",))
        assert found.epsilon[i] == pytest.approx(one.epsilon[0, 0], abs=DIGITS)
        assert found.half[i] * 49.0 == pytest.approx(one.coriolis[0], abs=DIGITS)
        assert found.forces.keys() == one.forces.keys()
        for name, k in found.forces.items():
            assert k[i] == pytest.approx(one.forces[name][0], abs=DIGITS)
