"""Conditions on measures, such as `max joints.main.force < 10 kN`: their parsing, and their comparison in SI.

A value is written as in a spec: with a unit of the measure's kind, in SI without one, or by parameters.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from heuncli.analyses.variants.parameters import AxisError
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import Scope, parse_number_with_unit, read_number

Relation = Literal["=", "<", ">", "<=", ">="]
SPELLINGS: dict[str, Relation] = {
    "=": "=", "==": "=", "<": "<", ">": ">", "<=": "<=", ">=": ">=", "≤": "<=", "≥": ">=", "=<": "<=", "=>": ">=",
}  # fmt: skip
PARTS = re.compile(r"([^<>=≤≥]*)([<>=≤≥]+)([^<>=≤≥]*)\Z", re.DOTALL)  # measure, relation, value
SIDES: dict[Relation, int] = {"=": 0, "<": -1, "<=": -1, ">": 1, ">=": 1}  # the side of the value where it is met


class WrittenCondition(NamedTuple):
    """A condition as it is written: the words of a measure, the relation, and the value."""

    measure: str
    relation: Relation
    value: str

    @property
    def text(self) -> str:
        """The whole condition."""
        return f"{self.measure} {self.relation} {self.value}"


class Comparison(NamedTuple):
    """A condition on a measure, in SI.

    measure: its words
    unit: its SI unit; empty if it has none
    given_unit: the unit in which the value was given; empty if it has none, or is an expression
    """

    measure: str
    relation: Relation
    value: float
    unit: str
    given_unit: str = ""

    @property
    def side(self) -> int:
        """The side of the value where an inequality is met: 1 above, -1 below; 0 of an equation."""
        return SIDES[self.relation]

    @property
    def includes_value(self) -> bool:
        """Whether the value itself meets the condition."""
        return "=" in self.relation

    def compute_excess(self, number: float) -> float:
        """Return by how much an inequality is violated; negative: the margin."""
        return number - self.value if self.side < 0 else self.value - number

    def is_met(self, number: float) -> bool:
        """Return whether a number meets an inequality."""
        excess = self.compute_excess(number)
        return excess < 0.0 or (excess == 0.0 and self.includes_value)


def parse_condition(text: str, form: str, hint: str) -> WrittenCondition:
    """Parse a text such as `max joints.main.force < 10 kN`; form, hint: the message where it is not understood.

    Raises AxisError.
    """
    found = PARTS.match(text)
    relation = SPELLINGS.get(found[2]) if found is not None else None
    if found is None or relation is None:
        raise AxisError(text, form, hint)
    if not found[1].strip() or not found[3].strip():
        what = "no measure before" if not found[1].strip() else "no value after"
        raise AxisError(text, f"{form}; there is {what} the '{found[2]}'", hint)
    if parse_number_with_unit(found[1]) is not None:
        raise AxisError(text, "put the measure first", hint)
    return WrittenCondition(found[1].strip(), relation, found[3].strip())


def resolve_condition(condition: WrittenCondition, unit: str, specs: Sequence[Spec], hint: str) -> Comparison:
    """Return a condition in SI, whose value must be the same in all specs.

    unit: the measure's own, empty where it is unknown

    Raises AxisError.
    """
    number = parse_number_with_unit(condition.value)
    value = find_si_value(condition, unit, specs, hint)
    return Comparison(condition.measure, condition.relation, value, unit, number.unit if number is not None else "")


def find_si_value(condition: WrittenCondition, unit: str, specs: Sequence[Spec], hint: str) -> float:
    """Return the value of a condition in SI, the same in all specs; unit: the measure's own, empty where it is unknown.

    Raises AxisError.
    """
    dimension = parse_unit(unit)[1] if unit else None
    values: set[float] = set()
    for spec in specs:
        try:
            values.add(read_number(_parse_plain(condition.value), dimension, Scope(spec.parameters)))
        except Finding as finding:
            raise AxisError(condition.text, finding.message, finding.hint or hint, finding.code) from None
    if len(values) > 1:
        raise AxisError(
            condition.text, f"the value '{condition.value}' depends on what is varied", "give it as a number"
        )
    return values.pop()


def _parse_plain(text: str) -> float | str:
    """Return a number if the text is one, because in a spec a plain number is no text."""
    try:
        return float(text)
    except ValueError:
        return text
