"""Falling chimney: manual/theory.md, "Closed cases" 4, and manual/references.md, "Chimney": a rod hinged at its foot.

    S = 3/4 m g sin ϑ (x² − 4x/3 + 1/3),   P = −1/2 m g (1 − x) [(5 + 3x) cos ϑ − 3 (1 + x)]
    M = −1/4 m g H sin ϑ x (1 − x)²
with x = r/H, ϑ from the vertical, released upright at rest: ω² = 3 g (1 − cos ϑ)/H.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.bars import HEAD
from tests.shared.scenes import near, solved

G = 9.81


def chimney(degrees: float, mass: float, height: float, sections: str, analysis: str = "{type: state}") -> Results:
    """The rod along body z, falling towards world x; at a tilt, with the rate it has there."""
    tilt = math.radians(degrees)
    rate = math.sqrt(3 * G * (1 - math.cos(tilt)) / height)
    return solved(
        HEAD
        + f"""
bodies:
  chimney:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0, {height}], mass: {mass}}}]
    points: {{foot: [0, 0, 0], tip: [0, 0, {height}]}}
joints:
  foot: {{type: pin, from: ground.O, to: chimney.foot, axis: [0, 1, 0], initial: {{angle: {tilt}, rate: {rate}}}}}
sections: {sections}
analysis: {analysis}
"""
    )


def cuts(places: dict[str, float], height: float) -> str:
    """Single cuts; the one at the foot just beyond the hinge."""
    rows = []
    for name, x in places.items():
        side = ", side: beyond" if x == 0 else ""
        rows.append(f"{name}: {{body: chimney, at: [0, 0, {x * height}], normal: [0, 0, 1]{side}}}")
    return "{" + ", ".join(rows) + "}"


def test_case_4() -> None:
    """m = 1000, L = 30, 30°: M2, Q1 and N at three heights; e1 is the direction it falls in."""
    wanted = {
        0.5: (-4598.4375, -306.5625, -2769.277468078683), 0.1: (-2979.7875, 772.5375, -5694.416468533943),
        0.8: (-1177.2, -343.35, -989.4248162327539),
    }  # fmt: skip
    places = {f"x{int(10 * x)}": x for x in wanted}
    found = chimney(30, 1000, 30, cuts(places, 30)).sections
    for name, x in places.items():
        values = [found[name][part][0] for part in ("M2", "Q1", "N")]
        near(values, wanted[x], 5000.0, 1e-14)
        near([found[name][part][0] for part in ("M1", "Q2", "T")], 0.0, 5000.0, 1e-14)


def test_largest_moment_at_one_third() -> None:
    """m g L sin ϑ/27 = 5450 N m, where the shear is zero."""
    found = chimney(30, 1000, 30, cuts({"third": 1 / 3}, 30)).sections["third"]
    near(found["M2"][0], -5450.0, 5450.0, 1e-14)
    near(found["Q1"][0], 0.0, 5450.0, 1e-14)
    run = chimney(30, 1000, 30, "{run: {body: chimney, from: foot, to: tip, count: 301}}").sections["run"]
    assert run["s"][int(np.argmax(np.abs(run["M2"][0])))] == pytest.approx(10.0, abs=1e-12)


def test_along_the_fall() -> None:
    """A series of cuts over the motion from 20° on, against the formulas at the angle reached."""
    found = chimney(20, 2, 5, "{run: {body: chimney, from: foot, to: tip, count: 11}}",
                    "{duration: 1.2, samples: 13, tolerance: 1e-12}")  # fmt: skip
    tilt = found.coordinates["foot"]["angle"][:, None]
    run = found.sections["run"]
    x, mg = run["s"] / 5, 2 * G
    near(run["Q1"], 0.75 * mg * np.sin(tilt) * (x * x - 4 * x / 3 + 1 / 3), mg, 1e-11)
    near(run["N"], -0.5 * mg * (1 - x) * ((5 + 3 * x) * np.cos(tilt) - 3 * (1 + x)), mg, 1e-11)
    near(run["M2"], -0.25 * mg * 5 * np.sin(tilt) * x * (1 - x) ** 2, mg, 1e-11)
    assert tilt[-1, 0] > 1.5  # nearly level at the end
    near(found.coordinates["foot"]["acceleration"], 1.5 * G * np.sin(tilt[:, 0]) / 5, 1.0, 1e-11)
