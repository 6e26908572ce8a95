"""One reader of numbers: 12, "12 mm", "2*L + 0.1", and in time "5*sin(2*pi*t)". Raises Finding."""

from __future__ import annotations

import math
import re
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.number_range import is_in_range, out_of_range
from heuncli.base.records import replace
from heuncli.base.units import Dimension, describe, in_si, parse_unit, si_unit, spelled
from heuncli.scene.expressions.grammar import (
    RESERVED,
    WORDS,
    Follows,
    Scope,
    compile_expression,
    require_length,
    told_of,
)
from heuncli.scene.expressions.programs import Expression

# A number and then something that begins like a unit; "2 if t < 1 else 3" is an expression all the same.
# The 1 of 1/s stands apart from it: 21/s is no 2 of 1/s, nor 9.81/2 a 9.8 of 1/2.
# Possessive (++, *+, ?+): what is taken is not given back, so that a text is read once whatever does not follow.
FIGURE = r"\s*+([+-]?\s*+(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?+)\s*+"
WITH_UNIT = re.compile(rf"{FIGURE}((?:[^\W\d_]|°|(?<=\s)1/)[^,]*+)\Z")
WHOLE_NUMBER = re.compile(r"(?<![\w.*])\d(?![\w.])|(?<=[^*]\*)\d(?![\w.])")
OVER_UNIT = re.compile(rf"{FIGURE}/\s*+([^\W\d]++)\s*\Z")
TIME_IN_IT = re.compile(r"(?<![\w.])t(?![\w.])")
CONDITIONS = "such as guide.travel > 0.2, shaft.rate < 0 and t > 1, or {of: joints.wall.force.x, below: 0}"
NOT_A_NUMBER = re.compile(r"[+-]?\.?(?:inf|nan)(?:inity)?\Z", re.IGNORECASE)


def number(value: Any, dimension: Dimension | None, scope: Scope) -> float:
    """The SI value of what stands in a spec; dimension None takes any."""
    if type(value) is float or type(value) is int:
        return in_range(finite(value))
    expression = in_time(value, dimension, scope)
    assert expression.constant is not None  # a scope out of time knows no variables
    return expression.constant


def in_time(value: Any, dimension: Dimension | None, scope: Scope) -> Expression:
    """The expression that stands in a spec, in SI; its dimension is known where it has a unit."""
    expression = as_written(value, dimension, scope)
    if expression.constant is not None:
        in_range(expression.constant)
    return expression


def as_written(value: Any, dimension: Dimension | None, scope: Scope) -> Expression:
    """A value in time as `in_time` reads it, also where it is too large or too small to be computed with."""
    if type(value) is float or type(value) is int:
        return Expression.of(finite(value))
    if type(value) is not str:
        raise Finding("wrong-kind", f"expected a number, found {kind_of(value)}", hint_for(value))
    require_length(value)
    if NOT_A_NUMBER.match(value.strip()):
        raise Finding("not-finite", f"'{value.strip()}' is not a finite number", FINITE)
    with_unit = unit_in(value)
    if with_unit is None:
        return fitting(compiled(value, scope), dimension, scope)
    size, measured = measure(with_unit[1], with_unit[2].strip(), scope)
    if dimension is not None and measured != dimension:
        hint = (
            product_hint(with_unit[1], with_unit[2].strip(), scope)
            or f"a number without a unit is taken in {si_unit(dimension)}"
        )
        raise Finding("dimension", f"'{value.strip()}' is {describe(measured)}, expected {describe(dimension)}", hint)
    return replace(Expression.of(size), source=value, dimension=measured)


def compiled(text: str, scope: Scope) -> Expression:
    """The expression a text means; of 21/s the hint is the unit as it is written."""
    try:
        return compile_expression(text, scope)
    except Finding as finding:
        found = OVER_UNIT.match(text)
        if found is None or finding.code not in ("unknown-name", "function-arguments"):
            raise
        unit = f"1/{found[2]}"
        try:
            parse_unit(unit)
        except Finding:
            raise finding from None
        raise Finding(finding.code, finding.message, f"with a unit: {found[1].strip()} {unit}") from None


def unit_in(text: str) -> re.Match[str] | None:
    """The figure and the unit of a text that is a number with a unit."""
    found = WITH_UNIT.match(text)
    return found if found is not None and re.split(r"\W", found[2], maxsplit=1)[0] not in WORDS else None


def fitting(expression: Expression, dimension: Dimension | None, scope: Scope) -> Expression:
    """The expression, unless it is certainly of another dimension. Raises Finding."""
    found = expression.dimension
    if dimension is None or found is None or found == dimension:
        return expression
    text, hint = expression.source.strip(), "without a unit a parameter fits anywhere"
    what = f"'{text}' is {describe(found)}"
    if text in scope.given:
        what = f"{text} is {describe(found)} ({scope.given[text].text})"
    else:
        hint = f"{told_of(text, scope)}; {hint}"
        if WHOLE_NUMBER.search(text):
            hint += "; a whole number is a plain factor: write 3.0 for one that has a unit"
        if TIME_IN_IT.search(text):
            hint += "; t beside it is a time: for a ramp divide by one, as in F*t/T"
    raise Finding("wrong-dimension", f"{what}, {describe(dimension)} is wanted here", hint)


def condition(value: Any, scope: Scope) -> Expression:
    """The condition that stands in a spec: what is true or not, in time and coordinates."""
    if type(value) is not str:
        raise Finding("condition", f"expected a condition, found {kind_of(value)}", CONDITIONS)
    require_length(value)
    found = compile_expression(value, replace(scope, with_units=True))
    text = value.strip()
    if not found.is_truth and found.constant is None:
        hint = f"compare it: {text.removesuffix(' == 0')} > 0, say"
        raise Finding("condition", f"'{text}' is a number, not a condition", hint)
    if found.constant is not None:
        raise Finding("condition", f"'{text}' never changes: it uses neither the time nor a coordinate", CONDITIONS)
    if equality := re.search("[=!]=", text):
        message = f"'{text}': a motion passes through an equality ({equality[0]}) in no time"
        raise Finding("condition", message, "compare by > or <: an event tells the instants of both directions")
    return found


def measure(figure: str, unit: str, scope: Scope) -> tuple[float, Dimension]:
    """SI value and dimension of a figure with a unit."""
    try:
        size, dimension = parse_unit(unit)
    except Finding as finding:
        written = spelled(unit)
        hint = f"write {figure.strip()} {written}" if written else product_hint(figure, unit, scope)
        hint = hint or inside_hint(figure, unit) or finding.hint
        raise Finding(finding.code, finding.message, hint) from None
    return finite(float(figure.replace(" ", "")) * size), dimension


def product_hint(figure: str, unit: str, scope: Scope) -> str | None:
    """For '2 L' with a parameter L, or '2 t': a product was meant."""
    name = re.split(r"\W", unit, maxsplit=1)[0]
    if name == "t" and re.fullmatch(r"t\s*/\s*m(\^|\*\*)?[3³]", unit):
        whole = f"tonne{unit[1:]}"
        return f"t is the time; a thousand kilograms are a tonne: {figure.strip()} {spelled(whole) or whole}"
    if re.search(r"[+-]\s*+(?:\d++\s*+)?[^\W\d]", unit):
        return "units do not stand inside expressions: give the quantity a name under parameters, or write it in SI"
    if name in scope.parameters or name in RESERVED:
        return f"for a product write {figure.strip()}*{unit}"
    return None


def inside_hint(figure: str, unit: str) -> str | None:
    """For '40 mm * 2': what goes on after the unit makes it an expression, in which there are no units."""
    parts = re.match(r"([^\W\d]+)(\s*[-+*/].*)", unit)
    return in_si(figure.replace(" ", ""), parts[1], parts[2]) if parts is not None else None


def finite(value: float) -> float:
    """A number as a float, unless it is inf, nan or too large."""
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        what = value if isinstance(value, float) else "the number"
        raise Finding("not-finite", f"{what} is not a finite number", FINITE)
    return result


def in_range(value: float) -> float:
    """The number, unless it is too small or too large to be computed with."""
    if not is_in_range(value):
        raise out_of_range(value)
    return value


def kind_of(value: Any) -> str:
    """What stands there, in words."""
    if value is None:
        return "nothing"
    if type(value) is bool:
        return "true" if value else "false"
    if type(value) is str:
        return f"the text '{value}'" if len(value) <= 40 else "a text"
    return "a list" if type(value) is list else "a mapping" if type(value) is dict else "a number"


def hint_for(value: Any) -> str:
    """What to do about it."""
    if type(value) is dict and len(value) == 1 and next(iter(value.values())) is None:
        return "an expression with { } is written without them"
    if value is None:
        return "write a number behind the colon, or leave the key out"
    if type(value) is list and len(value) == 1:
        return "one number stands without [ ]"
    return 'as 0.5, "12 mm" or "2*L"'


FINITE = "where there is no limit leave the key out; in [low, high] write null"

__all__ = ["Follows", "Scope", "in_time", "kind_of", "number"]
