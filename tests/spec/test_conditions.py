"""A measure held against a number: how it is written, and its unit."""

from __future__ import annotations

import math

import pytest

from heuncli.variants.axes import AxisError, Figure
from heuncli.variants.conditions import MeasureCondition, condition_of, in_si


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("max joints.main.force = 10 kN", MeasureCondition("max joints.main.force", "=", Figure(10.0, "kN"))),
        ("max abs sections.web.M2<40", MeasureCondition("max abs sections.web.M2", "<", Figure(40.0, ""))),
        ("at 0.5 joints.a.angle >= -3e-2deg", MeasureCondition("at 0.5 joints.a.angle", ">=", Figure(-0.03, "deg"))),
        (" x.y ≤ 2 N·m ", MeasureCondition("x.y", "<=", Figure(2.0, "N·m"))),
        ("x.y == 2 1/s", MeasureCondition("x.y", "=", Figure(2.0, "1/s"))),
        ("x.y => 2", MeasureCondition("x.y", ">=", Figure(2.0, ""))),
    ],
)
def test_read(text: str, condition: MeasureCondition) -> None:
    assert condition_of(text) == condition
    assert condition.below is (condition.sign in ("<", "<="))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("max joints.main.force", "expected MEASURE"),
        ("< 3", "expected MEASURE"),
        ("1 < x.y < 3", "expected MEASURE"),
        ("x.y <> 3", "expected MEASURE"),
        ("x.y < three", "'three' is not a number"),
        ("x.y < ", "'' is not a number"),
        ("3 kN > x.y", "the measure stands first"),
    ],
)
def test_refused(text: str, said: str) -> None:
    with pytest.raises(AxisError, match=said) as caught:
        condition_of(text)
    assert caught.value.exit_code == 2 and caught.value.problems[0].hint


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("x < 10 kN", "N", 1e4),
        ("x < 10", "N", 10.0),
        ("x < 1500 rpm", "rad/s", 50.0 * math.pi),
        ("x < 90 deg", "1", 0.5 * math.pi),
        ("x < 3 N mm", "N·m", 3e-3),
        ("x < 3 N mm", "", 3e-3),
        ("x < 3 m/s^2", "m/s²", 3.0),
    ],
)
def test_in_si(text: str, unit: str, value: float) -> None:
    assert in_si(condition_of(text), unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "said"), [("x < 3 kN", "N·m", "'kN' is a force"), ("x < 3 kX", "N", "not a unit")]
)
def test_a_unit_that_does_not_fit(text: str, unit: str, said: str) -> None:
    with pytest.raises(AxisError, match=said):
        in_si(condition_of(text), unit)
