"""A measure held against a number: how it is written, and its unit."""

from __future__ import annotations

import math

import pytest

from heuncli.analyses.variants.conditions import WrittenCondition, find_si_value, parse_condition
from heuncli.analyses.variants.parameters import AxisError
from heuncli.scene.file_format.load import load
from tests.shared.folders import SPECS

HINT = "for example 'x < 3'"
SCENE = load(str(SPECS / "double.yaml"))._replace(parameters={"F": 7.0})


def read(text: str) -> WrittenCondition:
    """What the words mean."""
    return parse_condition(text, "expected MEASURE < VALUE", HINT)


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("max joints.main.force = 10 kN", WrittenCondition("max joints.main.force", "=", "10 kN")),
        ("max abs sections.web.M2<40", WrittenCondition("max abs sections.web.M2", "<", "40")),
        ("at 0.5 joints.a.angle >= -3e-2deg", WrittenCondition("at 0.5 joints.a.angle", ">=", "-3e-2deg")),
        (" x.y ≤ 2 N·m ", WrittenCondition("x.y", "<=", "2 N·m")),
        ("x.y == 2 1/s", WrittenCondition("x.y", "=", "2 1/s")),
        ("x.y => 2", WrittenCondition("x.y", ">=", "2")),
    ],
)
def test_read(text: str, condition: WrittenCondition) -> None:
    assert read(text) == condition


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("max joints.main.force", "expected MEASURE"),
        ("< 3", "expected MEASURE"),
        ("1 < x.y < 3", "expected MEASURE"),
        ("x.y <> 3", "expected MEASURE"),
        ("x.y < ", "expected MEASURE"),
        ("3 kN > x.y", "put the measure first"),
    ],
)
def test_refused(text: str, said: str) -> None:
    with pytest.raises(AxisError, match=said) as caught:
        read(text)
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
        ("x < 2*F", "N", 14.0),
    ],
)
def test_in_si(text: str, unit: str, value: float) -> None:
    assert find_si_value(read(text), unit, [SCENE], HINT) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "said"),
    [("x < 3 kN", "N·m", "'3 kN' is a force"), ("x < 3 kX", "N", "not a unit"), ("x < three", "N", "three")],
)
def test_a_unit_that_does_not_fit(text: str, unit: str, said: str) -> None:
    with pytest.raises(AxisError, match=said):
        find_si_value(read(text), unit, [SCENE], HINT)


def test_a_value_that_hangs_on_what_is_varied() -> None:
    other = SCENE._replace(parameters={"F": 8.0})
    assert find_si_value(read("x < 2"), "N", [SCENE, other], HINT) == 2.0
    with pytest.raises(AxisError, match="depends on what is varied"):
        find_si_value(read("x < 2*F"), "N", [SCENE, other], HINT)
