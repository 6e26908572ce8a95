"""Numbers with units against their definitions; what is a unit, what an expression."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from heuncli.base import units as u
from heuncli.base.errors import Finding
from heuncli.base.units import parse_unit
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.quantity import read_function, read_number

SCOPE = Scope(parameters={"L": 2.0, "m": 3.0})


@pytest.mark.parametrize(("text", "value", "dimension"), [
    # the factors of NIST SP 811 (2008), appendix B
    ("1 in", 2.54e-2, u.LENGTH), ("1 ft", 3.048e-1, u.LENGTH), ("1 lb", 4.535924e-1, u.MASS),
    ("1 lbf", 4.448222, u.FORCE), ("1 psi", 6.894757e3, u.PRESSURE), ("1 bar", 1.0e5, u.PRESSURE),
    ("1 rpm", 1.047198e-1, u.RATE), ("1 rev", 6.283185, u.ANGLE), ("1 deg", 1.745329e-2, u.ANGLE),
    ("1 lbf ft", 1.355818, u.MOMENT), ("1 lb/ft^3", 1.601846e1, u.DENSITY), ("1 lbf/in", 1.751268e2, u.STIFFNESS),
    ("1 lb ft^2", 4.214011e-2, u.INERTIA), ("1 km/h", 2.777778e-1, u.VELOCITY), ("1 h", 3.6e3, u.TIME),
    # decimal ones
    ("12 mm", 0.012, u.LENGTH), ("12mm", 0.012, u.LENGTH), ("-12.5e-1 cm", -0.0125, u.LENGTH), ("3 um", 3e-6, u.LENGTH),
    ("3 µm", 3e-6, u.LENGTH), ("7.85 g/cm^3", 7850.0, u.DENSITY), ("7850 kg/m³", 7850.0, u.DENSITY),
    ("7850 kg*m^-3", 7850.0, u.DENSITY), ("9.81 m/s^2", 9.81, u.ACCELERATION), ("9.81 m/s/s", 9.81, u.ACCELERATION),
    ("5 N·m", 5.0, u.MOMENT), ("5 N m", 5.0, u.MOMENT), ("5 Nm", 5.0, u.MOMENT), ("5 kNm", 5000.0, u.MOMENT),
    ("5 N*m/deg", 5.0 * 180.0 / math.pi, u.MOMENT), ("5 N/(m/s)", 5.0, u.DAMPING), ("5 N s/m", 5.0, u.DAMPING),
    ("5 N*m*s/rad", 5.0, u.TURNING_DAMPING), ("3 kg m^2", 3.0, u.INERTIA), ("90°", math.pi / 2, u.ANGLE),
    ("3 1/s", 3.0, u.RATE), ("2 N/mm^2", 2e6, u.PRESSURE), ("2 MPa", 2e6, u.PRESSURE), ("4 mm^4", 4e-12, u.AREA_MOMENT),
    ("2 kN/mm", 2e6, u.STIFFNESS), ("1 l", 1e-3, u.VOLUME), ("2 kW", 2000.0, u.POWER), ("2 J", 2.0, u.MOMENT),
])  # fmt: skip
def test_units(text: str, value: float, dimension: u.Dimension) -> None:
    found = read_function(text, None, SCOPE)
    assert found.constant == pytest.approx(value, rel=1e-6 if text[0] == "1" else 1e-15)
    assert found.dimension == dimension
    assert read_number(text, dimension, SCOPE) == found.constant


@pytest.mark.parametrize(("text", "value"), [
    (3, 3.0), (2.5, 2.5), ("3", 3.0), ("2*L", 4.0), ("-L/2", -1.0), ("2*m", 6.0), ("1e3", 1000.0), ("1.5E-2", 0.015),
    ("9.81/2", 4.905), ("21/2*L", 21.0), ("0.31/2/L", 0.0775), ("11/2", 5.5), ("1/2", 0.5), ("9.81/2*cos(0)", 4.905),
    ("2 if L > 1 else 3", 2.0), ("2 if 0 else 3", 3.0), ("90*deg", math.pi / 2), (" 4 ", 4.0),
    ("2*(1 and 0)", 0.0), ("1 if L > 1 else 0", 1.0),
])  # fmt: skip
def test_plain_numbers_and_expressions(text: object, value: float) -> None:
    assert read_number(text, u.LENGTH, SCOPE) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(("value", "code", "words"), [
    ("2 kg", "dimension", "a mass, expected a length"),
    ("1 > 0", "wrong-kind", "'1 > 0' is a condition, not a number"), ("(0 < L < 3)", "wrong-kind", "a condition"),
    ("1 and 0", "wrong-kind", "a condition"), ("0 or L", "wrong-kind", "a condition"), ("not L", "wrong-kind", "not L"),
    ("2 m^2", "dimension", "an area"),
    ("2 kg*m", "dimension", "kg*m"),
    ("2 L", "dimension", "2*L"),
    ("2 m/s", "dimension", "a velocity"),
    ("2 meters", "unknown-unit", "meter"),
    ("2 Mm", "unknown-unit", "mm"),
    ("2 Hz", "unknown-unit", "3000 rpm"),
    ("2 t", "unknown-unit", "2*t"),
    ("2 t/m", "unknown-unit", "2*t/m"),
    ("2 pi", "unknown-unit", "2*pi"),
    ("2 xyz", "unknown-unit", "known units"),
    ("2 mm + 3 kg", "wrong-dimension", "adds a length and a mass"),
    ("2 m^x", "unknown-unit", "power"),
    ("2 m^", "unknown-unit", "power"),
    ("2 m^1000", "unknown-unit", "power"),
    ("2 m2", "unknown-unit", "m^2"),
    ("21/s", "unknown-name", "'s'"),
    ("2 mm/", "unknown-unit", "early"),
    ("2 mm/(3", "expression-syntax", "close"),
    ("2 m)", "unknown-unit", "')'"),
    ("2 m$", "unknown-unit", "$"),
    ("2 mm/" + "(" * 50 + "s" + ")" * 50, "unknown-unit", "unit"),
    (True, "wrong-kind", "true"),
    (None, "wrong-kind", "nothing"),
    ([1], "wrong-kind", "a list"),
    ({"a": 1}, "wrong-kind", "a mapping"),
    ({"L": None}, "wrong-kind", "without"),
    (float("inf"), "not-finite", "inf"),
    (float("nan"), "not-finite", "nan"),
    (10**400, "not-finite", "number"),
    ("inf", "not-finite", "inf"),
    ("-.inf", "not-finite", "inf"),
    ("1e400 m", "not-finite", "inf"),
    ("1e300 km^9", "not-finite", "inf"),
    (1e-61, "magnitude", "too small"),
    (-1e61, "magnitude", "too large"),
    (10**61, "magnitude", "1e60"),
    (5e-324, "magnitude", "write 0"),
    ("1e-58 mm", "magnitude", "unit"),
    ("1e58 km", "magnitude", "unit"),
    ("L*1e-70", "magnitude", "1e-60"),
    ("1e40*1e40", "magnitude", "1e60"),
    ("1,5 m", "expression-syntax", "point: 1.5"),
    ("2*1,25", "expression-syntax", "point: 1.25"),
    ("sin(1,5)", "function-arguments", "point: 1.5"),
    ("40 kN * 2", "wrong-dimension", "is a force, expected a length"),
    ("L mm", "expression-syntax", "L*mm"),
    ("L*mm", "unknown-name", "right after a number: 20 mm"),
    ("40*s", "unknown-name", "right after a number: 20 s"),
    ("2*40 L", "expression-syntax", "both a unit and a parameter"),
    ("3 deg*2", "wrong-dimension", "an angle"),
    ("m L", "expression-syntax", "m*L"),
])  # fmt: skip
def test_refusals(value: object, code: str, words: str) -> None:
    with pytest.raises(Finding) as caught:
        read_number(value, u.LENGTH, SCOPE)
    assert caught.value.code == code
    assert words in f"{caught.value.message} {caught.value.hint}"


@pytest.mark.parametrize(
    ("text", "number"),
    [("2 m + 3 mm", 2.003), ("40 mm * 2", 0.08), ("2*40mm", 0.08), ("40*mm", 0.04), ("3 mm if 2 > 1 else 5 m", 0.003),
     ("L*3 mm/(1 mm)", 3.0), ("5 N/(2 kN/m)", 0.0025), ("sqrt(16 mm^2)", 0.004), ("2 km/1000 + 50 * cm", 2.5),
     ("-(3 in)", -0.0762), ("3*min(2 mm, 1 m)", 0.006)],
)  # fmt: skip
def test_numbers_have_units_inside_expressions(text: str, number: float) -> None:
    scope = Scope({"L": 1.0})
    assert read_number(text, u.LENGTH, scope) == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize("value", [0, 0.0, -0.0, 1e-60, -1e60, "0 mm", "1e-30*1e-30"])
def test_what_is_just_computed_with(value: object) -> None:
    assert read_number(value, u.LENGTH, SCOPE) == read_function(value, u.LENGTH, SCOPE).constant


def test_in_time_a_multiple_of_time_is_meant() -> None:
    with pytest.raises(Finding) as caught:
        read_function("100 t", u.ANGLE, Scope(in_time=True))
    assert "100*t" in (caught.value.hint or "")


def test_the_list_of_units_is_readable() -> None:
    for symbol, (size, dimension) in u.UNITS.items():
        assert u.parse_unit(symbol) == (size, dimension)
        assert u.describe(dimension).startswith(("a ", "an ")) and size > 0.0
        assert dimension in u.NAMES
    for spelling, symbol in u.SPELLINGS.items():
        assert symbol in u.UNITS, spelling


@pytest.mark.heavy
@given(st.text(max_size=30))
@settings(max_examples=200, deadline=None, derandomize=True)
def test_any_text_is_a_number_or_a_finding(text: str) -> None:
    for words in (text, f"2 {text}"):
        try:
            assert math.isfinite(read_number(words, None, SCOPE))
        except Finding as finding:
            assert finding.message


@pytest.mark.parametrize("unit", ["mm^99*mm^99/m^99/m^98", "km^99*km^99*km^99"])
def test_a_unit_has_a_size(unit: str) -> None:
    with pytest.raises(Finding, match="out of number range"):
        parse_unit(unit)
