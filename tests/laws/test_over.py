"""What is told over a range is what each instant tells by itself, with loads of all kinds, driven or let go."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.analyses.lagrange.inertia_curve import find_inertia_curve
from heuncli.app.commands.lagrange import forms, page
from heuncli.app.commands.lagrange.command import parse_range
from heuncli.scene.file_format.load import load
from heuncli.study.quantities.table_units import Units
from tests.shared.folders import ROOT
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


@pytest.mark.heavy
@pytest.mark.parametrize("way", WAYS)
def test_a_range_is_its_instants(way: str) -> None:
    """Below and above the start, over more than a turn; turns are counted, which the turn spring feels."""
    text = FOUR_BAR.format(**WAYS[way])
    spec = load("scene.yaml", text)
    found = find_inertia_curve(spec, parse_range("A.angle=-200deg:400deg/7", spec))
    assert found.rate == pytest.approx(7.0, rel=1e-12) and found.is_driven == (way == "driven")
    for i, phi in enumerate(found.values.tolist()):
        one = told(text.replace("phi: 50 deg", f"phi: {phi!r}"), coordinates=("A.angle",))
        assert found.epsilon[i] == pytest.approx(one.epsilon[0, 0], abs=DIGITS)
        assert found.half[i] * 49.0 == pytest.approx(one.coriolis[0], abs=DIGITS)
        assert found.forces.keys() == one.forces.keys()
        for name, k in found.forces.items():
            assert k[i] == pytest.approx(one.forces[name][0], abs=DIGITS)


SLIDER_CRANK = load(str(ROOT / "specs" / "slider_crank.yaml"))
TURN = 0.01642669572178526  # kg m^2, of its crank over a whole turn


@pytest.mark.parametrize("words", ["0:360deg/73", "0:360deg/2", "720deg:0/5", "0:180deg/7", "-360deg:0/18"])
def test_the_mean_is_of_the_range_not_of_its_values(words: str) -> None:
    assert find_inertia_curve(SLIDER_CRANK, parse_range(f"main.angle={words}", SLIDER_CRANK)).mean == pytest.approx(
        TURN, rel=1e-7
    )


@pytest.mark.heavy
def test_a_mean_that_does_not_settle_is_not_told() -> None:
    """Beside dead centres, at 0.2 and 0.4 m, the inertia of the slider is without bound."""
    found = find_inertia_curve(SLIDER_CRANK, parse_range("guide.travel=0.2001:0.39999/4", SLIDER_CRANK))
    assert np.isnan(found.mean) and forms.to_course_block(found)["mean"] is None
    assert "mean does not converge" in page.make_course_document(found, Units()).facts[0][1]


TIPPER = """
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {hinge: [0, 0], foot: [1.2, -0.5]}}
bodies: {bed: {mass: 900, center: [1.5, 0.4], inertia: 700, points: {hinge: [0, 0], lift: [1.6, 0]}}}
joints:
  hinge: {type: pin, from: ground.hinge, to: bed.hinge}
  ram: {type: rod, from: ground.foot, to: bed.lift}
drives: {oil: {joint: ram, speed: 0.1}}
"""


def test_over_the_length_of_a_rod() -> None:
    """What a tipper's cylinder moves: J (dphi/dl)^2 by the triangle of hinge, foot and lift; its weight m g dy/dl."""
    spec = load("tipper.yaml", TIPPER)
    found = find_inertia_curve(spec, parse_range("ram.length=0.7 m:1.2/6", spec))
    a, b, J = 1.3, 1.6, 700 + 900 * (1.5**2 + 0.4**2)
    l = found.values
    at_hinge = np.arccos((a**2 + b**2 - l**2) / (2 * a * b))  # between hinge-foot and hinge-lift
    turned = at_hinge - np.arctan2(0.5, 1.2)
    by_length = l / (a * b * np.sin(at_hinge))
    assert found.epsilon == pytest.approx(J * by_length**2, rel=1e-11)
    lever = 1.5 * np.cos(turned) - 0.4 * np.sin(turned)
    assert found.total_force == pytest.approx(-900 * 9.81 * lever * by_length, rel=1e-11)
