"""`properties: auto`: stresses with properties taken from the shapes that are cut, as with those written down."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved, study

BAR = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{shapes}]
    points: {{a: [0, 0, 0], b: [2, 0, 0]}}
joints: {{wall: {{type: weld, from: ground.O, to: bar.a}}}}
forces:
  pull: {{type: force, on: bar.b, vector: [300, -200, 150]}}
  twist: {{type: couple, on: bar.b, vector: [40, 0, 0]}}
sections: {{cut: {{body: bar, {where}, properties: {properties}, strength: 200 MPa{more}}}}}
"""
AT = "at: [0.5, 0, 0], normal: [1, 0, 0]"
ROUND = "{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.03, density: 1}"
TUBE = "{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.03, inner_radius: 0.02, density: 1}"
CONE = "{type: cone, from: [0, 0, 0], to: [2, 0, 0], radius: 0.04, to_radius: 0.02, density: 1}"
BOX = "{type: box, center: [1, 0, 0], size: [2, 0.03, 0.05], density: 1}"
BALL = "{type: sphere, center: [1, 0, 0], radius: 1, density: 1}"
CORE = "{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.02, density: 1}"
THIN = "{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 1}"
I_BEAM = ", ".join(
    f"{{type: box, center: [1, {y}, 0], size: [2, {h}, {b}], density: 1}}"
    for y, h, b in ((0, 0.08, 0.01), (0.045, 0.01, 0.06), (-0.045, 0.01, 0.06))
)


def bar(shapes: str, properties: str, where: str = AT, more: str = "") -> Results:
    return solved(BAR.format(shapes=shapes, properties=properties, where=where, more=more))


@pytest.mark.parametrize(("shapes", "properties"), [
    (ROUND, "{circle: {radius: 0.03}}"), (f"{ROUND}, {THIN}", "{circle: {radius: 0.03}}"),
    (TUBE, "{tube: {radius: 0.03, inner_radius: 0.02}}"), (CONE, "{circle: {radius: 0.035}}"),
    (BOX, "{rectangle: {width: 0.03, height: 0.05}}"), (BALL, f"{{circle: {{radius: {0.75**0.5!r}}}}}"),
    (f"{TUBE}, {CORE}", "{circle: {radius: 0.03}}"),
])  # fmt: skip
def test_one_section(shapes: str, properties: str) -> None:
    found, wanted = (bar(shapes, p).sections["cut"]["stress"] for p in ("auto", properties))
    assert found.keys() == wanted.keys() and len(found) == 7
    for name, value in wanted.items():
        near(found[name], value, float(np.abs(value).max()) or 1.0, 1e-12)


def test_flanges_and_a_web() -> None:
    """By Steiner: 2 (60·10³/12 + 600·45²) + 10·80³/12 mm⁴; J at least the sum of the rectangles'."""
    I2 = 2 * (60 * 10**3 / 12 + 600 * 45**2) + 10 * 80**3 / 12
    I1 = 2 * 10 * 60**3 / 12 + 80 * 10**3 / 12
    stress = bar(I_BEAM, "auto").sections["cut"]["stress"]
    bending = 1.5 * 200 * 0.05 / (I2 * 1e-12) + 1.5 * 150 * 0.03 / (I1 * 1e-12)
    near(stress["normal_max"], 300 / 2e-3 + bending, bending, 1e-12)
    thin = 40 * 0.06 / ((2 * 60 + 80) * 10**3 / 3 * 1e-12)  # as of thin walls, with twice the smaller half extent for t
    assert thin < stress["shear_torsion"][0] < 1.15 * thin


def test_along_a_stepped_bar() -> None:
    """At each cut those of the shape there; a shoulder has the smaller ones, a stretch its largest stress exactly."""
    step = "{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.04, density: 1}"
    cone = "{type: cone, from: [1, 0, 0], to: [2, 0, 0], radius: 0.03, to_radius: 0.015, density: 1}"
    run = bar(f"{step}, {cone}", "auto", "from: a, to: b, count: 5").sections["cut"]
    for k, radius in enumerate((0.04, 0.04, 0.03, 0.0225, 0.015)):
        s = 0.5 * k
        W = np.pi * radius**3 / 4
        end = 250 * 2 * tolerances.IN_PLANE / W  # the section's centroid at the end is found so far before it
        near(run["stress"]["normal_max"][0, k], 300 / (np.pi * radius**2) + 250 * (2 - s) / W, 1e8, 1e-12 + end / 1e8)


@pytest.mark.parametrize(("shapes", "where", "more", "why"), [
    (ROUND, "at: [0.5, 0, 0], normal: [1, 0.1, 0]", "", "obliquely"),
    (BOX, "at: [0.5, 0, 0], normal: [1, 0.1, 0]", "", "obliquely"),
    (BOX, AT, ", first_axis: [0, 1, 1]", "e1 is not parallel to a side"),
    (THIN, AT, "", "no shape with a thickness"),
    (f"{ROUND}, {CORE}", AT, "", "overlap"),
    (f"{ROUND}, {BOX}", AT, "", "round and rectangular"),
    (f"{BOX}, {{type: box, center: [1, 0.04, 0], size: [2, 0.05, 0.05], density: 1}}", AT, "", "180-degree"),
    (f"{BOX}, {{type: box, center: [1, 0.2, 0], size: [2, 0.05, 0.05], density: 1}}", AT, "", "do not touch"),
    (f"{BOX}, {{type: box, center: [1, 0.01, 0], size: [2, 0.05, 0.05], density: 1}}", AT, "", "overlap"),
    ("{type: cone, from: [0, 0, 0], to: [2, 0, 0], radius: 0.04, to_radius: 0, density: 1}",
     "from: a, to: b, count: 3", "", "s = 2 m: the cut has no area"),
])  # fmt: skip
def test_what_is_not_known_is_refused(shapes: str, where: str, more: str, why: str) -> None:
    with pytest.raises(SpecError) as raised:
        bar(shapes, "auto", where, more)
    (problem,) = raised.value.problems
    assert problem.code == "no-properties" and why in problem.message


def test_without_shapes_there_is_nothing_to_take() -> None:
    text: Any = BAR.format(shapes=ROUND, properties="auto", where=AT, more="")
    text = text.replace(
        f"shapes: [{ROUND}]",
        "mass: 1\n    center: [1, 0, 0]\n    inertia: [1, 1, 1]\n"
        "    piece: {mass: 1, center: [1, 0, 0], inertia: [1, 1, 1]}",
    )
    with pytest.raises(SpecError, match="no shapes to take them from"):
        study(text)
