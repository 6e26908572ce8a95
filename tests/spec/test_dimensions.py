"""Dimensions of expressions: what is certain is what a change of units shows, and nothing right is refused."""

from __future__ import annotations

import math
import random
import re

import pytest

from heuncli.base.errors import Finding, SpecError
from heuncli.base.records import replace
from heuncli.base.units import NUMBER, Dimension, parse_unit
from heuncli.scene.expressions import dimensions
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import DimensionedParameter, Scope
from heuncli.scene.file_format.load import load
from tests.shared.folders import ROOT
from tests.shared.manual import TEXTS, file_of

WRITTEN = {
    "L": "1200 mm", "b": "0.3 m", "m": "3 kg", "F": "100 N", "n": "1500 rpm", "phi": "30 deg", "v": "2 m/s",
    "T": "0.5 s", "k": "200 N/m", "c": "5 N*s/m", "A": "1 m^2", "p": "5 bar", "g": "9.81 m/s^2", "M": "7 N*m",
    "J": "2 kg*m^2",
}  # fmt: skip
DIMENSIONS = {name: parse_unit(text.partition(" ")[2])[1] for name, text in WRITTEN.items()}
GIVEN = {name: DimensionedParameter(DIMENSIONS[name], text) for name, text in WRITTEN.items()}
VALUES = {name: 0.7 + 0.13 * i for i, name in enumerate(WRITTEN)}
GAS = replace(
    interpolate_points("gas", [0.0, 1.0], [2.0, 3.0], "linear", "hold", None), dimensions=(NUMBER, parse_unit("bar")[1])
)
SCOPE = Scope({**VALUES, "q": 3.0}, {"pin": "pin", "guide": "slide"}, {"gas": GAS}, in_time=True, given=GIVEN)


def dimension(text: str) -> Dimension | None:
    return compile_expression(text, SCOPE).dimension


def wrong(text: str) -> str:
    with pytest.raises(Finding) as caught:
        compile_expression(text, SCOPE)
    assert caught.value.code == "wrong-dimension"
    return caught.value.message


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("L", "m"), ("-L/2", "m"), ("3*L/4", "m"), ("2*L - b", "m"), ("L + 0.1", "m"), ("L*cos(phi)", "m"),
        ("v*t", "m"), ("pi*b**2", "m^2"), ("b**3", "m^3"), ("b**-1", "1/m"), ("L**0.5*L**1.5", None),
        ("sqrt(k/m)", "1/s"), ("sqrt(2*g*L)", "m/s"), ("m*g", "N"), ("m*L**2/3", "kg*m^2"), ("2*pi/T", "rad/s"),
        ("v/L", "rad/s"), ("F*sin(n*t)", "N"), ("F*(1 - exp(-t/T))", "N"), ("F*sin(phi)**2", "N"),
        ("F if t < T else 0", "N"), ("max(0, F)", "N"), ("min(L, b, 0.5)", "m"), ("abs(-L)", "m"),
        ("hypot(L, b)", "m"), ("sqrt(2)*L", "m"), ("k*guide.travel", "N"), ("-c*guide.speed", "N"),
        ("k*L*pin.angle", "N"), ("M*pin.rate", "W"), ("p*A", "N"), ("table(gas, pin.angle)*A", "N"),
        ("F*(t < T)", "N"), ("F*step(t - T)", "N"), ("n*T*L", "m"), ("1/T", "1/s"), ("phi + pi/2", "rad"),
        ("F*L**phi", None), ("M/F", "m"), ("(L + b)/T", "m/s"), ("F*(L > b)", "N"),
        # free: a number may carry any unit of its own
        ("m*9.81", None), ("m*10", None), ("k*0.1", None), ("5*sin(2*pi*t)", None), ("100*t", None), ("3*t", None),
        ("t", None), ("L*q", None), ("F*t/2", None), ("2*v*t", None), ("0.5*g*t**2", None), ("F*min(t, 1)", None),
        ("L/b", None), ("n*t", None), ("1500*rpm*t", None), ("60*deg", None), ("2*phi*q", None), ("sin(phi)", None),
        ("atan2(L, b)", None), ("guide.travel", None), ("3*guide.travel", None), ("table(gas, t)*5", None),
        ("12.0*L", None), ("48*J", None), ("pi", None), ("2", None), ("L**(0.5*q)", None), ("L**65", None),
        ("exp(-t)", None), ("sin(3*t)", None), ("log(L) - log(b)", None), ("sign(F)", None), ("L > b", None),
        ("q if L > b else t", None), ("t - T", "s"), ("q + t", None), ("L + 2*t", "m"), ("L + t", "m"),
        ("t > 0.5 and L > b", None), ("not F", None),
    ],
)  # fmt: skip
def test_what_is_certain(text: str, unit: str | None) -> None:
    assert dimension(text) == (parse_unit(unit)[1] if unit is not None else None)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("L + m", "adds a length and a mass"),
        ("2*(L - m)*t", "subtracts a length and a mass"),
        ("L + phi", "adds a length and an angle"),
        ("v*t + m*g", "adds a length and a force"),
        ("L < m", "compares a length and a mass"),
        ("0 < L < m", "compares a length and a mass"),
        ("min(L, 1, m)", "takes the smallest of a length and a mass"),
        ("atan2(L, m)", "takes atan2 of a length and a mass"),
        ("L if t < 1 else m", "chooses between a length and a mass"),
        ("F if 1 < 2 else m", "chooses between a force and a mass"),
        ("sin(L)", "takes sin of a length"),
        ("exp(-c*t)", "takes exp of a mass"),
        ("tanh(pin.rate*L)", "takes tanh of a velocity"),
        ("2**L", "has an exponent that is a length"),
        ("table(gas, L)", "looks up a length in the table gas, whose x is an angle"),
        ("table(gas, pin.angle) + F", "adds a pressure and a force"),
    ],
)
def test_what_is_certainly_wrong(text: str, said: str) -> None:
    assert f"'{text}' {said}" in wrong(text)


# Seeds of random expressions, chosen from the first 400 of either test below: between them they show every operation on
# every two kinds of parts that those show, and of 372 changes of a word or a number of the code of dimensions they find
# all 169 that those find, each by three seeds where there are three.
ANY = (
    0, 9, 12, 16, 17, 21, 23, 26, 32, 33, 34, 38, 41, 54, 55, 64, 68, 76, 94, 107, 108, 111, 114, 115, 117, 132,
    135, 145, 146, 150, 161, 171, 174, 192, 208, 217, 243, 253, 254, 259, 262, 297, 299, 300, 328, 339, 340, 350,
    386, 395,
)  # fmt: skip
RIGHT = (
    1, 4, 6, 16, 21, 28, 30, 34, 38, 40, 57, 62, 68, 85, 91, 92, 98, 113, 115, 131, 148, 160, 171, 178, 194, 196,
    199, 212, 233, 235, 240, 251, 252, 332, 377,
)  # fmt: skip
OPERATIONS = ("+", "-", "*", "*", "/", "/", "**", "sqrt", "abs", "neg", "min", "sin", "if", "hypot", "half")


def drawn(draw: random.Random, depth: int) -> str:
    """Any expression of parameters with units and plain factors, right or wrong."""
    if depth == 0 or draw.random() < 0.1:
        return draw.choice([*WRITTEN, *WRITTEN, "2", "pi"])
    operation, a, b = draw.choice(OPERATIONS), drawn(draw, depth - 1), drawn(draw, depth - 1)
    match operation:
        case "**":
            return f"({a})**{draw.choice([2, 3, -1, -2])}"
        case "sqrt" | "abs":
            return f"{operation}(({a})**2)"
        case "neg":
            return f"(-({a}))"
        case "min" | "hypot":
            return f"{operation}({a}, {b})"
        case "sin":
            return f"sin({a})"
        case "if":
            return f"({a} if {b} > 0 else {a})"
        case "half":
            return f"({a})/2"
    return f"({a}){operation}({b})"


def value(text: str, units: tuple[float, float, float]) -> float:
    """In units of so many kilograms, metres and seconds; of what is constant its number, not finite: nan."""
    kg, m, s = units
    sizes = {name: kg ** d[0] * m ** d[1] * s ** d[2] for name, d in DIMENSIONS.items()}
    values = {name: number / sizes[name] for name, number in VALUES.items()}
    try:
        found: Expression = compile_expression(text, Scope(values))  # without dimensions: the kernel's number alone
    except Finding:
        return math.nan
    assert found.constant is not None
    return found.constant


@pytest.mark.parametrize("seed", ANY)
def test_a_certain_dimension_is_what_a_change_of_units_shows(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing without a unit is added to what has one: that is taken to have the same."""
    kinds: list[set[str]] = []
    alike = dimensions.common_dimension

    def kept(
        name: str, a: dimensions.MeasuredDimension, b: dimensions.MeasuredDimension, strict: bool
    ) -> dimensions.MeasuredDimension:
        kinds.append({a.kind, b.kind})
        return alike(name, a, b, strict)

    monkeypatch.setattr(dimensions, "common_dimension", kept)
    draw = random.Random(seed)
    text = drawn(draw, draw.randint(1, 4))
    units = (1.7, 0.6, 2.3)
    before, after = value(text, (1.0, 1.0, 1.0)), value(text, units)
    if not (math.isfinite(before) and math.isfinite(after) and 1e-6 < abs(before) < 1e6):
        return
    try:
        found = dimension(text)
    except Finding as finding:
        assert finding.code == "wrong-dimension"
        return
    if found is not None and {"known", "factor"} not in kinds:
        scale = units[0] ** found[0] * units[1] ** found[1] * units[2] ** found[2]
        assert after * scale == pytest.approx(before, rel=1e-9), text


FACTORS = ("2", "pi", "0.5", "sin(phi)", "exp(-t/T)", "(1 - t/T)")


def right(draw: random.Random, wanted: Dimension, depth: int) -> str:
    """A right expression of a dimension, with literals where they are no more than factors."""
    fitting = [name for name, d in DIMENSIONS.items() if d == wanted]
    if depth == 0 and fitting:
        return draw.choice(fitting)
    name = draw.choice(list(WRITTEN))
    own = DIMENSIONS[name]
    rest: Dimension = (wanted[0] - own[0], wanted[1] - own[1], wanted[2] - own[2])
    forms = ["sum", "half", "if", "factor", "least", "sine"] if depth > 0 else []
    if depth > -3:
        forms.append("product")
    if not forms:
        powers = zip(("m/g/T*v", "L", "T"), (0, wanted[1], wanted[2]), strict=True)
        return "*".join(["m**" + str(wanted[0]), *(f"{base}**{power}" for base, power in list(powers)[1:])])
    match draw.choice(forms):
        case "sum":
            return f"({right(draw, wanted, depth - 1)} {draw.choice('+-')} {right(draw, wanted, depth - 1)})"
        case "half":
            return f"{right(draw, wanted, depth - 1)}/{draw.choice(['2', '3', '7.5', '48'])}"
        case "if":
            return f"({right(draw, wanted, depth - 1)} if t < {draw.choice(['T', '0.3'])} else 0)"
        case "factor":
            return f"{draw.choice(FACTORS)}*{right(draw, wanted, depth - 1)}"
        case "least":
            return f"max({right(draw, wanted, depth - 1)}, {right(draw, wanted, depth - 1)})"
        case "sine":
            return f"cos({right(draw, NUMBER, depth - 1)})*{right(draw, wanted, depth - 1)}"
    return f"{name}*{right(draw, rest, depth - 1)}"


@pytest.mark.parametrize("seed", RIGHT)
def test_nothing_right_is_refused(seed: int) -> None:
    draw = random.Random(seed)
    wanted = draw.choice([*DIMENSIONS.values()])
    text = right(draw, wanted, draw.randint(1, 3))
    assert dimension(text) in (None, wanted), text


SCENE = """\
heun: 1
parameters: {c: 0.45 kg, L: 2 m, free: 0.45, phi: 30 deg, r: 12 mm, A: "pi*r**2", rho: 7850 kg/m^3}
bodies:
  bar: {mass: c, center: [0, 0, 0], inertia: [1, 1, 1], points: {top: [0, 0, 0], end: [%s, 0, 0]}}
%s
"""


def codes(place: str, more: str = "", **overrides: str) -> list[str]:
    try:
        load("x.yaml", SCENE % (place, more), overrides)
    except SpecError as error:
        return [f"{p.code}: {p.message}" for p in error.problems]
    return []


@pytest.mark.parametrize(
    "place", ["L", "2*L", "free", "free*c", "0.1", "c*0.5", "L*sin(phi)", "A/r", "sqrt(A)", "A/L*3.0"]
)
def test_what_fits_a_key(place: str) -> None:
    assert codes(place) == []


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("c", "c is a mass (0.45 kg), expected a length"),
        ("2*c", "'2*c' is a mass, expected a length"),
        ("c*2 + 0.1", "'c*2 + 0.1' is a mass, expected a length"),
        ("phi", "phi is an angle or a plain number (30 deg), expected a length"),
        ("A", "A is an area (pi*r**2), expected a length"),
        ("rho*A", "'rho*A' is a mass per length, expected a length"),
    ],
)
def test_what_does_not_fit_a_key(place: str, said: str) -> None:
    assert codes(place) == [f"wrong-dimension: {said}"]


def test_a_direction_may_be_given_by_lengths() -> None:
    ends = "from: {body: ground, at: [0, 0, 0]}, to: bar.top"
    assert codes("0", f"joints: {{p: {{type: pin, {ends}, axis: [L, 0, r]}}}}") == []


def test_a_number_set_without_a_unit_is_free_and_one_with_a_unit_is_not() -> None:
    assert codes("c", c="0.5") == []
    assert codes("L", L="3 kg") == ["wrong-dimension: L is a mass (3 kg), expected a length"]


@pytest.mark.parametrize(
    ("key", "text", "warned"),
    [
        ("r", "5", True), ("r", "5 mm", False), ("r", "0", False), ("L", "3", False), ("free", "3", False),
        ("r", "L/100.0", False), ("phi", "0.5", True), ("bodies.bar.mass", "2", False),
    ],
)  # fmt: skip
def test_a_number_set_in_place_of_another_unit_is_warned_of(key: str, text: str, warned: bool) -> None:
    spec = load("x.yaml", SCENE % ("L", ""), {key: text})
    assert [p.code for p in spec.warnings] == (["set-in-si"] if warned else [])


def test_a_wrong_parameter_is_told_once() -> None:
    assert codes("free", free="L + c") == ["wrong-dimension: 'L + c' adds a length and a mass"]


YAML = re.compile(r"(heun: 1\n(?:.|\n)*?)(?:\"\"\"|```)")


@pytest.mark.heavy
def test_no_scene_of_ours_is_refused() -> None:
    texts = [path.read_text() for path in (ROOT / "specs").glob("*.yaml")]
    for path in [*map(file_of, TEXTS.keys() - {"codes"}), *(ROOT / "tests").rglob("*.py")]:
        texts += [found for found in YAML.findall(path.read_text()) if "{{" not in found]
    assert len(texts) > 60
    for text in texts:
        if text.startswith(SCENE[:40]):
            continue
        try:
            load(str(ROOT / "specs" / "x.yaml"), text)
        except SpecError as error:
            assert "wrong-dimension" not in {p.code for p in error.problems}, error
