"""What variants change: parameters and dotted keys of a spec, and the values that they take.

A value is a number with its unit, or a text in the form of `--set`. Numbers stay numbers until they are printed or put
into the data of the spec, which hold a number with a unit as text (`NumberWithUnit.to_entry`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue, parse_number_with_unit
from heuncli.scene.file_format.source import parse_plain_scalar

Law = Literal["normal", "uniform", "lhs", "sobol"]
CASE = "case"  # the name by which an axis varies the load case
RESOLUTION_DIGITS = 9  # of a design variable, relative to the width of its interval


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
    """Make an axis of values in the form of `--set`: of numbers, if all are numbers of one unit."""
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
