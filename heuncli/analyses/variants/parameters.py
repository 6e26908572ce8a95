"""What variants change: parameters and dotted keys of a spec, the values they take, and the words that say so.

A value is a number with its unit, or a text in the form of `--set`. Numbers stay numbers until they are printed or put
into the data of the spec, which hold a number with a unit as text (`NumberWithUnit.to_entry`).

    n=1000:6000/51rpm       51 values from 1000 to 6000 rpm, both ends among them
    c=1:1000/31log          31 values whose logarithms are evenly spaced
    L=0.1,0.12,0.15         these; each in the form of --set
    r=20:60mm               an interval, for commands that search a value between its ends
    d=normal(100,0.1)mm     random: mean and standard deviation; uniform, lhs and sobol: least and greatest

A unit after the last figure applies to all of them; or each has its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Literal, get_args

import numpy as np

from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue, parse_number_with_unit
from heuncli.scene.file_format.source import parse_plain_scalar

Law = Literal["normal", "uniform", "lhs", "sobol"]
CASE = "case"  # the name by which an axis varies the load case
RESOLUTION_DIGITS = 9  # digits of a design variable, relative to the width of its interval
Values = Mapping[str, ParameterValue]  # what is set in a variant, by name


class ParameterAxis(NamedTuple):
    """The values that a parameter takes one after the other.

    values: numbers in the unit; texts in the form of `--set` if the unit is None
    unit: empty: SI, or none
    """

    name: str
    values: Sequence[float] | Sequence[str]
    unit: str | None = None

    def find_value(self, index: int) -> ParameterValue:
        """Return one of the values."""
        value = self.values[index]
        return value if isinstance(value, str) else NumberWithUnit(value, self.unit or "")


class DesignVariable(NamedTuple):
    """A parameter between two bounds, in its unit; spec_value: its value in the spec, None if it has none."""

    name: str
    low: float
    high: float
    unit: str
    spec_value: float | None = None

    def to_number(self, place: float) -> float:
        """Return the number at a place of [0, 1], rounded to significant digits, so that the number shown is the one
        solved.
        """
        if place <= 0.0:
            return self.low
        if place >= 1.0:
            return self.high
        width = self.high - self.low
        decimals = RESOLUTION_DIGITS - math.floor(math.log10(width))
        return min(max(round(self.low + place * width, decimals), self.low), self.high)

    def to_value(self, place: float) -> NumberWithUnit:
        """Return the value at a place of [0, 1]."""
        return self.make_value(self.to_number(place))

    def make_value(self, number: float) -> NumberWithUnit:
        """Return a number as a value of the variable."""
        return NumberWithUnit(float(number), self.unit)

    def format_value(self, number: float) -> str:
        """Format a number as a value of the variable, in the form of `--set`."""
        return self.make_value(number).format()

    @property
    def spec_place(self) -> float | None:
        """The place of the spec's value; None if it is out of bounds."""
        if self.spec_value is None or not self.low <= self.spec_value <= self.high:
            return None
        return (self.spec_value - self.low) / (self.high - self.low)


class RandomVariable(NamedTuple):
    """A parameter whose values are drawn: normal by mean and deviation, otherwise between two ends; in its unit."""

    name: str
    law: Law
    a: float
    b: float
    unit: str


def make_axis(name: str, texts: Sequence[str]) -> ParameterAxis:
    """Make an axis of values in the form of `--set`: of numbers if all have one unit, or else of the texts."""
    numbers: list[float] = []
    unit: str | None = None
    for text in texts:
        number = parse_number_with_unit(text)
        if number is None or (unit is not None and number.unit != unit) or not is_unit(number.unit):
            return ParameterAxis(name, tuple(texts))
        unit = number.unit
        numbers.append(number.value if unit else _parse_plain_number(text, number.value))
    return ParameterAxis(name, tuple(numbers), unit)


def format_value(value: ParameterValue) -> str:
    """Format a value in the form of `--set`."""
    return value if isinstance(value, str) else value.format()


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, or empty: the csv of 1.csv is none."""
    try:
        parse_unit(text or "1")
    except Finding:
        return False
    return True


def _parse_plain_number(text: str, value: float) -> float:
    """Return a number without a unit as YAML reads it: where a key wants a whole number, 5 is not 5.0."""
    scalar = parse_plain_scalar(text.strip())
    return scalar if type(scalar) is int else value


MAX_VALUES = 10_000_000  # values of one axis: it holds them all in memory

EVEN_AXIS = re.compile(r"([^/].*:.*?)/\s*(\d+)\s*(log\b)?(.*)\Z", re.DOTALL)  # the first /count: units have a / too
RANDOM_AXIS = re.compile(rf"\s*({'|'.join(get_args(Law))})\s*\((.*)\)([^(),]*)\Z", re.DOTALL)
FORMS = "NAME=a:b/count, NAME=a:b/count log, NAME=v1,v2,..., or NAME=normal(mean,deviation), uniform(a,b), lhs, sobol"
HINT = "for example n=1000:6000/51rpm, L=0.1,0.12,0.15 or d=normal(100,0.1)mm"
INTERVAL_HINT = "for example r=20:60mm"


class AxisError(HeunError):
    """The words that vary a spec are not understood, or do not fit their parameter."""

    exit_code = 2

    def __init__(self, word: str, message: str, hint: str = HINT, code: str = "bad-option") -> None:
        super().__init__(Problem(code, f"{word}: {message}", hint=hint))


def parse_axis_values(word: str) -> ParameterAxis | RandomVariable:
    """Parse one word of a command line. Raises AxisError."""
    name, values = split_name(word)
    random_match = RANDOM_AXIS.match(values)
    if random_match is not None:
        return _parse_random_variable(word, name, random_match[1], random_match[2], random_match[3].strip())
    even_match = EVEN_AXIS.match(values)
    if even_match is not None:
        ends, count, logarithmic, unit = even_match.groups()
        return _make_even_axis(word, name, f"{ends} {unit.strip()}".strip(), int(count), logarithmic is not None)
    if ":" in values and not values.lstrip().startswith(("{", "[")):
        raise AxisError(word, "an interval needs its number of values", f"for example {name}={values.strip()}/11")
    return _parse_list_axis(word, name, values)


def parse_interval(word: str) -> DesignVariable:
    """Parse the interval that one word gives, its lower end first. Raises AxisError."""
    name, values = split_name(word, "expected NAME=a:b, an interval", INTERVAL_HINT)
    low, high, unit = _parse_ends(word, values, "expected NAME=a:b, an interval", INTERVAL_HINT)
    if low == high:
        raise AxisError(word, "both ends are the same", INTERVAL_HINT)
    return DesignVariable(name, min(low, high), max(low, high), unit)


def split_name(word: str, message: str = f"expected {FORMS}", hint: str = HINT) -> tuple[str, str]:
    """Split a word at its equals sign into the name and the values. Raises AxisError."""
    name, equals, values = word.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise AxisError(word, message, hint)
    return name.strip(), values


def split_at_commas(text: str) -> list[str]:
    """Split a text at the commas that are outside of brackets and quotes."""
    parts, depth, quote, start = [], 0, "", 0
    for place, character in enumerate(text):
        if quote or character in "\"'":
            quote = "" if character == quote else quote or character
        elif character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        elif character == "," and depth == 0:
            parts.append(text[start:place])
            start = place + 1
    return [*parts, text[start:]]


def _parse_list_axis(word: str, name: str, values: str) -> ParameterAxis:
    """Parse the values of a list; the unit of the last applies to all, where these are plain numbers."""
    texts = [text.strip() for text in split_at_commas(values)]
    if not all(texts):
        raise AxisError(word, "a value is missing between two commas" if len(texts) > 1 else "a value is missing")
    numbers = [number for text in texts if (number := parse_number_with_unit(text)) is not None]
    unit = numbers[-1].unit if len(numbers) == len(texts) else ""
    if not unit or any(number.unit for number in numbers[:-1]) or not is_unit(unit):
        return make_axis(name, texts)
    return ParameterAxis(name, tuple(number.value for number in numbers), unit)


def _make_even_axis(word: str, name: str, ends: str, count: int, by_ratio: bool) -> ParameterAxis:
    """Make the axis between two ends, including both; by_ratio: its logarithms evenly spaced."""
    low, high, unit = _parse_ends(word, ends, f"expected {FORMS}", HINT)
    if not 1 <= count <= MAX_VALUES:
        raise AxisError(word, f"{count} values: accepted: 1 to {MAX_VALUES:,}")
    if count == 1 and low != high:
        raise AxisError(word, "1 value cannot be at both ends", "give it alone, or 2 values or more")
    if by_ratio and low * high <= 0.0:
        raise AxisError(word, "log: both ends must have the same sign and not be 0")
    values = np.geomspace(low, high, count) if by_ratio else np.linspace(low, high, count)
    return ParameterAxis(name, tuple(values.tolist()), unit)


def _parse_random_variable(word: str, name: str, law: str, inner: str, last_unit: str) -> RandomVariable:
    """Parse a random parameter."""
    parts = split_at_commas(inner)
    if len(parts) != 2:
        raise AxisError(word, f"{law} takes two numbers", f"for example {name}={law}(99,101)mm")
    a, b, unit = _parse_two_numbers(word, (parts[0], f"{parts[1]} {last_unit}"), "", HINT)
    if law == "normal":
        if b <= 0.0:
            raise AxisError(word, "the deviation of normal(mean,deviation) must be positive")
    elif a >= b:
        raise AxisError(word, f"{law}(a,b) needs a < b")
    return RandomVariable(name, law, a, b, unit)  # type: ignore[arg-type]


def _parse_ends(word: str, values: str, message: str, hint: str) -> tuple[float, float, str]:
    """Parse both ends of an interval in one unit."""
    parts = values.split(":")
    if len(parts) != 2:
        raise AxisError(word, message, hint)
    return _parse_two_numbers(word, (parts[0], parts[1]), message, hint)


def _parse_two_numbers(word: str, texts: tuple[str, str], message: str, hint: str) -> tuple[float, float, str]:
    """Parse two numbers and convert both to the unit of the second; a first number without a unit is already in it."""
    first, second = (_require_number_with_unit(word, text, hint) for text in texts)
    if first.unit in ("", second.unit):
        return first.value, second.value, second.unit
    (size, dimension), (second_size, second_dimension) = (
        _require_unit(word, first.unit),
        _require_unit(word, second.unit),
    )
    if not second.unit or dimension != second_dimension:
        raise AxisError(word, f"'{first.unit}' and '{second.unit or 'no unit'}' are different quantities", hint)
    return first.value * size / second_size, second.value, second.unit


def _require_number_with_unit(word: str, text: str, hint: str) -> NumberWithUnit:
    found = parse_number_with_unit(text)
    if found is None:
        raise AxisError(word, f"'{text.strip()}' is not a number with or without a unit", hint)
    if found.unit:
        _require_unit(word, found.unit)
    return found


def _require_unit(word: str, unit: str) -> tuple[float, tuple[int, int, int]]:
    try:
        return parse_unit(unit or "1")
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint or HINT) from None
