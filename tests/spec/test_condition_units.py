"""Numbers with units inside conditions: each is read to SI; beside a coordinate of another dimension it is refused."""

from __future__ import annotations

import math
import random

import pytest

from heuncli.base.errors import Finding
from heuncli.base.units import LENGTH, UNITS, parse_unit
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import DimensionedParameter, Scope
from heuncli.scene.file_format.quantity import read_condition

JOINTS = {"shaft": "pin", "guide": "slide"}
GIVEN = {"L": DimensionedParameter(LENGTH, "0.5 m")}
SCOPE = Scope({"L": 0.5, "q": 3.0, "m": 2.0}, JOINTS, in_time=True, given=GIVEN)
COORDINATES = {"shaft.angle": "rad", "shaft.rate": "rad/s", "guide.travel": "m", "guide.speed": "m/s", "t": "s"}


def numbers(text: str) -> list[float]:
    """The margins at which a condition in one coordinate changes: the last constant of its comparison."""
    return [read_condition(text, SCOPE).constants[-1]]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("guide.travel < 20 mm", 0.02), ("guide.travel<20mm", 0.02), ("shaft.angle > 30 deg", math.pi / 6.0),
        ("shaft.angle > 30 °", math.pi / 6.0), ("shaft.rate < -1500 rpm", -50.0 * math.pi),
        ("guide.speed > 36 km/h", 10.0), ("shaft.rate > 3 rad/s", 3.0), ("shaft.rate > 120 1/min", 2.0),
        ("t > 5 ms", 0.005), ("t > 2 min", 120.0), ("guide.travel**2 > 4 cm^2", 4e-4),
        ("guide.travel**2 > 4 cm²", 4e-4), ("guide.travel**2 > 4 cm**2", 4e-4), ("guide.travel > 3 in", 0.0762),
        ("guide.travel > 3*(20 mm)", 0.06), ("guide.travel > 20 mm * 3", 0.06), ("guide.travel > 20", 20.0),
        ("guide.travel > 8 mm/2", 0.004), ("guide.travel > 2 km/q", 2000.0 / 3.0),
    ],
)  # fmt: skip
def test_the_number_is_that_in_si(text: str, number: float) -> None:
    assert numbers(text) == [pytest.approx(number, rel=4e-16)]


def test_every_unit_is_read_as_beside_a_key() -> None:
    rng = random.Random(5)
    for unit in UNITS:
        figure = round(rng.uniform(0.1, 50.0), 3)
        size, dimension = parse_unit(unit)
        found = read_condition(f"guide.travel*q > {figure} {unit}", SCOPE)
        assert found.constants[-1] == figure * size, unit
        same = [name for name, own in COORDINATES.items() if parse_unit(own)[1] == dimension]
        for name in COORDINATES:
            if name in same:
                read_condition(f"{name} > {figure} {unit}", SCOPE)
            else:
                assert refused(f"{name} > {figure} {unit}").code == "wrong-dimension", (name, unit)


def test_it_is_true_where_the_same_in_si_is() -> None:
    units = read_condition("20 mm < guide.travel <= 5 cm and (t > 3 ms or shaft.rate < -30 rpm)", SCOPE)
    plain = read_condition("0.02 < guide.travel <= 0.05 and (t > 0.003 or shaft.rate < -30*rpm)", SCOPE)
    rng = random.Random(6)
    for _ in range(200):
        t, x, w = rng.uniform(0.0, 0.006), rng.uniform(0.0, 0.07), rng.uniform(-6.0, 0.0)
        assert value(units, t, x, w) == value(plain, t, x, w)


def value(found: Expression, t: float, travel: float, rate: float) -> float:
    """Of a condition in these coordinates."""
    at = {("guide", "travel"): travel, ("shaft", "rate"): rate}
    return found.value(t, [at[use] for use in found.uses])


def refused(text: str) -> Finding:
    """What is said of a condition that is none."""
    with pytest.raises(Finding) as caught:
        read_condition(text, SCOPE)
    return caught.value


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("guide.travel > 20 deg", "wrong-dimension", "compares a length and an angle"),
        ("20 deg < guide.travel", "wrong-dimension", "compares an angle or a plain number and a length"),
        ("guide.travel - 20 deg > 0", "wrong-dimension", "subtracts"),
        ("0 < t < 20 mm", "wrong-dimension", "compares a time and a length"),
        ("t > L", "wrong-dimension", "L = 0.5 m is a length"),
        ("5 mm > L*L", "wrong-dimension", "compares a length and an area"),
        ("max(guide.travel, 3 s) > 2", "wrong-dimension", "takes the largest of"),
        ("guide.travel > (20 mm if t > 1 s else 3 N)", "wrong-dimension", "chooses between"),
        ("sin(20 mm) > t", "wrong-dimension", "takes sin of a length"),
        ("guide.travel > 20 mmm", "unknown-unit", "did you mean mm?"),
        ("guide.travel > 3 q", "expression-syntax", "write 3*q"),
        ("guide.travel > 2 t", "expression-syntax", "write 2*t"),
        ("guide.speed*q > 2 km/m", "expression-syntax", "write (2 km)/m"),
        ("guide.travel > mm", "unknown-name", "right after a number: 20 mm"),
        ("20 mm", "condition", "never changes"),
        ("guide.travel > 1e308 km", "not-computable", "too large"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(text: str, code: str, told: str) -> None:
    finding = refused(text)
    assert finding.code == code
    assert told in f"{finding.message} {finding.hint}"


def test_values_have_units_inside() -> None:
    found = compile_expression("guide.travel - 20 mm", SCOPE)
    assert found.constants[-1] == 0.02
