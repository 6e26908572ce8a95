"""The condition that a measure is to meet: `max joints.main.force = 10 kN`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import get_args

from heuncli.cli import measure
from heuncli.cli.entry import UsageError
from heuncli.commands.find.study import Relation
from heuncli.errors import Finding, Problem
from heuncli.expressions.units import Dimension, parse_unit
from heuncli.named_tuples import NamedTuple
from heuncli.spec.models import Spec
from heuncli.spec.quantity import Scope, number
from heuncli.study.ask.measure import MeasureRequest
from heuncli.variants.axes import figure_of
from heuncli.variants.stated import unit_of

PARTS = re.compile(r"(.*?)(<=|>=|==|=|<|>)(.*)\Z", re.DOTALL)
HINT = "such as 'max joints.main.force = 10 kN'"


class ConditionWords(NamedTuple):
    """A condition as it is written: the measure, how it stands to the value, and the value."""

    text: str
    asked: MeasureRequest
    relation: Relation
    value: str


class FindCondition(NamedTuple):
    """A condition in SI, with the SI unit of its measure (empty: none); own: the unit in which the value was given."""

    text: str
    relation: Relation
    value: float
    unit: str
    own: str


def parsed(text: str) -> ConditionWords:
    """What the words mean. Raises UsageError."""
    parts = PARTS.match(text)
    if parts is None:
        relations = ", ".join(get_args(Relation))
        raise UsageError(Problem("bad-option", f"'{text}': no {relations} between a measure and a value", hint=HINT))
    words, sign, value = (part.strip() for part in parts.groups())
    if not words or not value:
        what = "a measure before" if not words else "a value behind"
        raise UsageError(Problem("bad-option", f"'{text}': expected {what} the '{sign}'", hint=HINT))
    relation: Relation = "=" if sign == "==" else sign  # type: ignore[assignment]
    return ConditionWords(words, measure.parse(words), relation, value)


def condition_of(words: ConditionWords, specs: Sequence[Spec]) -> FindCondition:
    """The condition in SI, the same in all specs (those of the interval's ends). Raises UsageError."""
    unit = unit_of(words.asked.path, specs[0])
    dimension: Dimension | None = parse_unit(unit)[1] if unit and unit != "1" else (0, 0, 0)
    values: set[float] = set()
    for spec in specs:
        try:
            values.add(number(_plain(words.value), dimension, Scope(spec.parameters)))
        except Finding as finding:
            message = f"{words.text} {words.relation} {words.value}: {finding.message}"
            raise UsageError(Problem(finding.code, message, hint=finding.hint)) from None
    if len(values) > 1:
        message = f"the value '{words.value}' hangs on what is looked for"
        raise UsageError(Problem("bad-option", message, hint="give it as a number"))
    figure = figure_of(words.value)
    return FindCondition(words.text, words.relation, values.pop(), unit, figure.unit if figure is not None else "")


def _plain(text: str) -> float | str:
    """A number where the text is one, for what a spec holds is no text then."""
    try:
        return float(text)
    except ValueError:
        return text
