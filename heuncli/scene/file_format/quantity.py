"""Read every number of a spec: 12, "12 mm", "2*L + 0.1", and in time "5*sin(2*pi*t)". Raises Finding."""

from __future__ import annotations

import math
import re
from typing import Any

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.spelling import find_similar
from heuncli.base.units import (
    UNITS,
    Dimension,
    canonical_symbol,
    correct_unit,
    describe,
    is_in_range,
    parse_unit,
    range_error,
    si_unit,
)
from heuncli.scene.expressions.grammar import compile_expression, require_length
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import (
    ARITY,
    RESERVED,
    WORDS,
    DependentError,
    Scope,
    describe_dimensions,
    unknown_name_finding,
)

# A number followed by something that begins like a unit; "2 if t < 1 else 3" is excluded separately.
# The 1 of 1/s needs a blank before it: 21/s is not 2 1/s, and 9.81/2 is not 9.8 1/2.
# Possessive quantifiers (++, *+, ?+) prevent backtracking, so that a text is scanned only once.
FIGURE = r"\s*+([+-]?\s*+(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?+)\s*+"
WITH_UNIT = re.compile(rf"{FIGURE}((?:[^\W\d_]|°|(?<=\s)1/)[^,]*+)\Z")
WHOLE_NUMBER = re.compile(r"(?<![\w.*])\d(?![\w.])|(?<=[^*]\*)\d(?![\w.])")
PLAIN_OR_WITH_UNIT = re.compile(rf"(?!\s*0[xo]){FIGURE}((?:[^\W\d_]|°|1/).*)?\Z")  # the x of 0x32 is no unit
CALL = re.compile(r"([^\W\d]\w*+)\s*+\(")  # a name before a parenthesis
UNIT_NAME = re.compile(r"[^\W\d]\w*|°")
EXPRESSION_MARK = re.compile(r"\+|(?<![*^])-|(?<!\*)[*/][\s(]*[0-9.]")  # a sum, or a product with a number
OVER_UNIT = re.compile(rf"{FIGURE}/\s*+([^\W\d]++)\s*\Z")
USES_TIME = re.compile(r"(?<![\w.])t(?![\w.])")
CONDITIONS_HINT = "for example guide.travel > 0.2, shaft.rate < 0 and t > 1, or {of: joints.wall.force.x, below: 0}"
NOT_A_NUMBER = re.compile(r"[+-]?\.?(?:inf|nan)(?:inity)?\Z", re.IGNORECASE)


class WrittenQuantity(NamedTuple):
    """A number with a unit as it is written."""

    figure: str
    unit: str

    @property
    def value(self) -> float:
        """The number, in its unit."""
        return float(self.figure.replace(" ", ""))


class NumberWithUnit(NamedTuple):
    """A number and its unit (empty: SI, or none)."""

    value: float
    unit: str = ""

    def format(self) -> str:
        """Format the number with all its digits, as a spec and `--set` take it."""
        return f"{self.value!r} {self.unit}" if self.unit else repr(self.value)

    def to_entry(self) -> float | str:
        """Return the number as the data of a spec hold it: with a unit as text."""
        return self.format() if self.unit else self.value


ParameterValue = NumberWithUnit | str  # what is set in a spec: a number, or a text in the form of `--set`


def read_number(value: Any, dimension: Dimension | None, scope: Scope) -> float:
    """Read a value of a spec as a number in SI; dimension None accepts any. Raises Finding."""
    if type(value) is float or type(value) is int:
        return require_in_range(require_finite(value))
    expression = read_function(value, dimension, scope)
    assert expression.constant is not None  # a scope without time has no variables
    return expression.constant


def read_function(value: Any, dimension: Dimension | None, scope: Scope) -> Expression:
    """Read a value of a spec as an expression in time, in SI; its dimension is known if it has a unit. Raises
    Finding, also for a condition.
    """
    expression = read_unbounded_function(value, dimension, scope)
    if expression.is_condition:
        text = expression.source.strip()
        raise Finding("wrong-kind", f"'{text}' is a condition, not a number", f"write 1 if {text} else 0")
    if expression.constant is not None:
        require_in_range(expression.constant)
    return expression


def read_unbounded_function(value: Any, dimension: Dimension | None, scope: Scope) -> Expression:
    """Read a value like `read_function`, but without refusing numbers outside the range of computation."""
    if type(value) is float or type(value) is int:
        return Expression.from_number(require_finite(value))
    if type(value) is not str:
        raise Finding("wrong-kind", f"expected a number, found {describe_kind(value)}", number_hint(value))
    require_length(value)
    if NOT_A_NUMBER.match(value.strip()):
        raise Finding("not-finite", f"'{value.strip()}' is not a finite number", FINITE_HINT)
    with_unit = match_quantity(value)
    if with_unit is None:
        return require_dimension(compile_text(value, scope), dimension, scope)
    if is_expression_after_unit(with_unit, scope):
        return require_dimension(compile_text(value, scope), dimension, scope)
    size, unit_dimension = evaluate_quantity(with_unit, scope)
    if dimension is not None and unit_dimension != dimension:
        hint = product_hint(with_unit, scope) or f"a number without a unit is taken to be in {si_unit(dimension)}"
        raise Finding(
            "dimension", f"'{value.strip()}' is {describe(unit_dimension)}, expected {describe(dimension)}", hint
        )
    return replace(Expression.from_number(size), source=value, dimension=unit_dimension)


def is_expression_after_unit(number: WrittenQuantity, scope: Scope) -> bool:
    """Return whether the text goes on after the unit, as in '2 kN*sin(3*t)' and '40 mm + 3 mm'."""
    names = UNIT_NAME.findall(number.unit)
    if not UNIT_NAME.match(number.unit) or canonical_symbol(names[0]) not in UNITS:
        return False
    try:
        parse_unit(number.unit)
    except Finding:
        known = (scope.parameters, scope.joints, scope.own, RESERVED)
        has_name = any(name in block and canonical_symbol(name) not in UNITS for name in names for block in known)
        return has_name or EXPRESSION_MARK.search(number.unit) is not None
    return False


def compile_text(text: str, scope: Scope) -> Expression:
    """Compile the expression in a text; for 21/s the hint of the Finding shows how the unit is written."""
    try:
        return compile_expression(text, scope)
    except Finding as finding:
        division = OVER_UNIT.match(text)
        if division is None or finding.code not in ("unknown-name", "function-arguments"):
            raise
        unit = f"1/{division[2]}"
        try:
            parse_unit(unit)
        except Finding:
            raise finding from None
        raise Finding(finding.code, finding.message, f"give it with a unit: {division[1].strip()} {unit}") from None


def match_quantity(text: str) -> WrittenQuantity | None:
    """Return figure and unit of a value of a spec that is a number with a unit; None for any other."""
    found = WITH_UNIT.match(text)
    if found is None or re.split(r"\W", found[2], maxsplit=1)[0] in WORDS:
        return None
    return WrittenQuantity(found[1], found[2].strip())


def parse_number_with_unit(text: str) -> NumberWithUnit | None:
    """Parse a number with or without a unit, such as `20 mm`, of a command line or a table; None for any other text."""
    found = PLAIN_OR_WITH_UNIT.match(text)
    if found is None:
        return None
    value = WrittenQuantity(found[1], "").value
    return NumberWithUnit(value, (found[2] or "").strip()) if math.isfinite(value) else None


def require_dimension(expression: Expression, dimension: Dimension | None, scope: Scope) -> Expression:
    """Return the expression unless it certainly has another dimension. Raises Finding."""
    own_dimension = expression.dimension
    if dimension is None or own_dimension is None or own_dimension == dimension:
        return expression
    text, hint = expression.source.strip(), "a parameter without a unit fits any dimension"
    description = f"'{text}' is {describe(own_dimension)}"
    if text in scope.given:
        description = f"{text} is {describe(own_dimension)} ({scope.given[text].text})"
    else:
        hint = "; ".join(filter(None, [describe_dimensions(text, scope), hint]))
        if WHOLE_NUMBER.search(text):
            hint += "; whole numbers are plain factors: write 3.0 for one with a unit"
        if USES_TIME.search(text):
            hint += "; t is a time: for a ramp divide by a time, as in F*t/T"
    raise Finding("wrong-dimension", f"{description}, expected {describe(dimension)}", hint)


def read_condition(value: Any, scope: Scope) -> Expression:
    """Read a condition in time and coordinates, which is true or false. Raises Finding."""
    if type(value) is not str:
        raise Finding("condition", f"expected a condition, found {describe_kind(value)}", CONDITIONS_HINT)
    require_length(value)
    expression = compile_expression(value, replace(scope, with_units=True))
    text = value.strip()
    if not expression.is_truth and expression.constant is None:
        hint = f"compare it, for example {text.removesuffix(' == 0')} > 0"
        raise Finding("condition", f"'{text}' is a number, not a condition", hint)
    if expression.constant is not None:
        raise Finding(
            "condition", f"'{text}' never changes: it uses neither the time nor a coordinate", CONDITIONS_HINT
        )
    if equality := re.search("[=!]=", text):
        message = f"'{text}': a motion meets an equality ({equality[0]}) for an instant only"
        raise Finding("condition", message, "compare with > or <: an event reports the instants of both directions")
    return expression


def evaluate_quantity(number: WrittenQuantity, scope: Scope) -> tuple[float, Dimension]:
    """Return SI value and dimension of a number with a unit. Raises Finding."""
    try:
        size, dimension = parse_unit(number.unit)
    except Finding as finding:
        require_known_functions(number, scope)
        usual_spelling = correct_unit(number.unit)
        hint = f"write {number.figure.strip()} {usual_spelling}" if usual_spelling else product_hint(number, scope)
        hint = hint or finding.hint
        raise Finding(finding.code, finding.message, hint) from None
    return require_finite(number.value * size), dimension


def require_known_functions(number: WrittenQuantity, scope: Scope) -> None:
    """Raise Finding [unknown-name] for '2 cycloide(t)': a misspelt function where a unit is expected."""
    for name in CALL.findall(number.unit):
        if name in ARITY or name in scope.parameters or name in RESERVED or canonical_symbol(name) in UNITS:
            continue
        finding = unknown_name_finding(scope, name, "function")
        if find_similar(name, UNITS) is not None and not finding.hint.startswith("did you mean"):
            continue
        hint = finding.hint
        for verb, mark in (("did you mean ", "?"), ("write ", "")):
            if number.unit.startswith(name) and hint.startswith(verb):
                function = hint.removeprefix(verb).removesuffix(mark)
                hint = f"{verb}{number.figure.strip()}*{function}{number.unit.removeprefix(name)}{mark}"
        raise Finding(finding.code, finding.message, hint)


def product_hint(number: WrittenQuantity, scope: Scope) -> str | None:
    """Return a hint for '2 L' with a parameter L, or '2 t': a product was meant."""
    figure, unit = number.figure.strip(), number.unit
    name = re.split(r"\W", unit, maxsplit=1)[0]
    if name == "t" and re.fullmatch(r"t\s*/\s*m(\^|\*\*)?[3³]", unit):
        unit_text = f"tonne{unit[1:]}"
        return f"t is the time; for 1000 kg write tonne: {figure} {correct_unit(unit_text) or unit_text}"
    if name in scope.parameters or name in RESERVED:
        return f"for a product write {figure}*{unit}"
    return None


def require_finite(value: float) -> float:
    """Return a number as a float. Raises Finding [not-finite] for inf, nan and overflow."""
    try:
        result = float(value)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        description = value if isinstance(value, float) else "the number"
        raise Finding("not-finite", f"{description} is not a finite number", FINITE_HINT)
    return result


def require_in_range(value: float) -> float:
    """Return the number. Raises Finding if it is outside the range of computation."""
    if not is_in_range(value):
        raise range_error(value)
    return value


def describe_kind(value: Any) -> str:
    """Describe the kind of a value in words."""
    if value is None:
        return "nothing"
    if type(value) is bool:
        return "true" if value else "false"
    if type(value) is str:
        return f"the text '{value}'" if len(value) <= 40 else "a text"
    return "a list" if type(value) is list else "a mapping" if type(value) is dict else "a number"


def number_hint(value: Any) -> str:
    """Return a hint on how to write a number instead of this value."""
    if type(value) is dict and len(value) == 1 and next(iter(value.values())) is None:
        return "write the expression without { }"
    if value is None:
        return "write a number after the colon, or leave the key out"
    if type(value) is list and len(value) == 1:
        return "write a single number without [ ]"
    return 'as 0.5, "12 mm" or "2*L"'


FINITE_HINT = "for no limit leave the key out; in [low, high] write null"

__all__ = ["DependentError", "Scope", "describe_kind", "read_function", "read_number"]
