"""The words in which variants are asked for: which parameter takes which values.

    n=1000:6000/51rpm       51 values from 1000 to 6000 rpm, both ends among them
    c=1:1000/31log          31 values whose logarithms are evenly spaced
    L=0.1,0.12,0.15         these; each in the form of --set
    r=20:60mm               an interval, for what looks for a value between its ends
    d=normal(100,0.1)mm     random: mean and standard deviation; uniform, lhs and sobol: least and greatest

A unit stands behind the last figure and counts for all of them, or behind each.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.quantity import FIGURE

Law = Literal["normal", "uniform", "lhs", "sobol"]
MOST_VALUES = 10_000_000  # of one axis, which are kept as numbers

QUANTITY = re.compile(rf"(?!\s*0[xo]){FIGURE}((?:[^\W\d_]|°|1/).*)?\Z")  # the x of 0x32 is no unit
EVENLY = re.compile(r"([^/].*:.*?)/\s*(\d+)\s*(log\b)?(.*)\Z", re.DOTALL)  # the first /count: units have a / too
DRAWN = re.compile(rf"\s*({'|'.join(get_args(Law))})\s*\((.*)\)([^(),]*)\Z", re.DOTALL)
FORMS = "NAME=a:b/count, NAME=a:b/count log, NAME=v1,v2,..., or NAME=normal(mean,deviation), uniform(a,b), lhs, sobol"
HINT = "such as n=1000:6000/51rpm, L=0.1,0.12,0.15 or d=normal(100,0.1)mm"
INTERVAL_HINT = "such as r=20:60mm"


class AxisError(HeunError):
    """What is to be varied is not said in a form that is read, or does not fit its parameter."""

    exit_code = 2

    def __init__(self, word: str, message: str, hint: str = HINT, code: str = "bad-option") -> None:
        super().__init__(Problem(code, f"{word}: {message}", hint=hint))


class NumberWithUnit(NamedTuple):
    """A number as it is written, and its unit (empty: none)."""

    value: float
    unit: str


class ParameterAxis(NamedTuple):
    """The values that a parameter takes one after the other, in the form of `--set`."""

    name: str
    texts: Sequence[str]


class Interval(NamedTuple):
    """A parameter and the ends between which it may lie, in its unit."""

    name: str
    low: float
    high: float
    unit: str

    def text(self, value: float) -> str:
        """A value of it in the form of `--set`: all its digits."""
        return text_of(value, self.unit)

    def at(self, place: float) -> str:
        """The value at a place from 0 to 1, in the form of `--set`."""
        return self.text(self.low + place * (self.high - self.low))


class Drawn(NamedTuple):
    """A parameter whose values are drawn: normal by mean and deviation, else between two ends; in its unit."""

    name: str
    law: Law
    a: float
    b: float
    unit: str


def text_of(value: float, unit: str) -> str:
    """A number with its unit as a spec takes it: all its digits."""
    return f"{float(value)!r} {unit}" if unit else repr(float(value))


def axis_of(word: str) -> ParameterAxis | Drawn:
    """What one word of a command line asks for. Raises AxisError."""
    name, values = name_and_values(word)
    drawn = DRAWN.match(values)
    if drawn is not None:
        return _drawn(word, name, drawn[1], drawn[2], drawn[3].strip())
    evenly = EVENLY.match(values)
    if evenly is not None:
        return ParameterAxis(name, _evenly(word, evenly[1], int(evenly[2]), evenly[3] is not None, evenly[4].strip()))
    if ":" in values and not values.lstrip().startswith(("{", "[")):
        raise AxisError(word, "an interval needs a count of its values", f"such as {name}={values.strip()}/11")
    return ParameterAxis(name, _listed(word, values))


def interval_of(word: str) -> Interval:
    """The interval that one word asks for, its lower end first. Raises AxisError."""
    name, values = name_and_values(word, "expected NAME=a:b, an interval", INTERVAL_HINT)
    low, high, unit = _ends(word, values, "expected NAME=a:b, an interval", INTERVAL_HINT)
    if low == high:
        raise AxisError(word, "both ends are the same", INTERVAL_HINT)
    return Interval(name, min(low, high), max(low, high), unit)


def name_and_values(word: str, message: str = f"expected {FORMS}", hint: str = HINT) -> tuple[str, str]:
    """The name of what is varied, and what stands behind its equals sign. Raises AxisError."""
    name, equals, values = word.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise AxisError(word, message, hint)
    return name.strip(), values


def at_top_level(text: str) -> list[str]:
    """The parts between commas that stand in no brackets and no quotes."""
    parts, depth, quote, start = [], 0, "", 0
    for place, sign in enumerate(text):
        if quote or sign in "\"'":
            quote = "" if sign == quote else quote or sign
        elif sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
        elif sign == "," and depth == 0:
            parts.append(text[start:place])
            start = place + 1
    return [*parts, text[start:]]


def figure_of(text: str) -> NumberWithUnit | None:
    """The number and the unit of a text such as `20 mm`; None where it is no such text."""
    found = QUANTITY.match(text)
    if found is None:
        return None
    value = float(found[1].replace(" ", ""))
    return NumberWithUnit(value, (found[2] or "").strip()) if math.isfinite(value) else None


def _listed(word: str, values: str) -> tuple[str, ...]:
    """The values of a list; the unit of the last is that of all, where these are plain numbers."""
    texts = [text.strip() for text in at_top_level(values)]
    if not all(texts):
        raise AxisError(word, "a value is missing between two commas" if len(texts) > 1 else "a value is missing")
    figures = [figure_of(text) for text in texts]
    last = figures[-1]
    if last is None or not last.unit or any(figure is None or figure.unit for figure in figures[:-1]):
        return tuple(texts)
    return tuple(text_of(figure.value, last.unit) for figure in figures if figure is not None)


def _evenly(word: str, ends: str, count: int, by_ratio: bool, unit_behind: str) -> tuple[str, ...]:
    """The values between two ends, both among them; by_ratio: their logarithms evenly spaced."""
    low, high, unit = _ends(word, f"{ends} {unit_behind}".strip(), f"expected {FORMS}", HINT)
    if not 1 <= count <= MOST_VALUES:
        raise AxisError(word, f"{count} values: accepted: 1 to {MOST_VALUES:,}")
    if count == 1 and low != high:
        raise AxisError(word, "1 value cannot be at both ends", "give it alone, or 2 values or more")
    if by_ratio and low * high <= 0.0:
        raise AxisError(word, "log: both ends need the same sign, and neither is 0")
    values = np.geomspace(low, high, count) if by_ratio else np.linspace(low, high, count)
    return tuple(text_of(value, unit) for value in values.tolist())


def _drawn(word: str, name: str, law: str, inner: str, unit_behind: str) -> Drawn:
    """A random parameter."""
    parts = at_top_level(inner)
    if len(parts) != 2:
        raise AxisError(word, f"{law} takes two numbers", f"such as {name}={law}(99,101)mm")
    a, b, unit = _two(word, (parts[0], f"{parts[1]} {unit_behind}"), "", HINT)
    if law == "normal":
        if b <= 0.0:
            raise AxisError(word, "the deviation of normal(mean,deviation) is positive")
    elif a >= b:
        raise AxisError(word, f"{law}(a,b) runs from the lesser to the greater")
    return Drawn(name, law, a, b, unit)  # type: ignore[arg-type]


def _ends(word: str, values: str, message: str, hint: str) -> tuple[float, float, str]:
    """Both ends of an interval in one unit."""
    parts = values.split(":")
    if len(parts) != 2:
        raise AxisError(word, message, hint)
    return _two(word, (parts[0], parts[1]), message, hint)


def _two(word: str, texts: tuple[str, str], message: str, hint: str) -> tuple[float, float, str]:
    """Two numbers in the unit of the second; a first one without a unit is in it, too."""
    first, second = (_figure(word, text, hint) for text in texts)
    if first.unit in ("", second.unit):
        return first.value, second.value, second.unit
    (size, dimension), (own, other) = _unit(word, first.unit), _unit(word, second.unit)
    if not second.unit or dimension != other:
        raise AxisError(word, f"'{first.unit}' and '{second.unit or 'no unit'}' are not of one kind", hint)
    return first.value * size / own, second.value, second.unit


def _figure(word: str, text: str, hint: str) -> NumberWithUnit:
    found = figure_of(text)
    if found is None:
        raise AxisError(word, f"'{text.strip()}' is not a number with or without a unit", hint)
    if found.unit:
        _unit(word, found.unit)
    return found


def _unit(word: str, unit: str) -> tuple[float, tuple[int, int, int]]:
    try:
        return parse_unit(unit) if unit else (1.0, (0, 0, 0))
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint or HINT) from None
