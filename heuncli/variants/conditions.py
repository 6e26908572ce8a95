"""A measure held against a number: `max joints.main.force = 10 kN`, `max abs sections.web.M2 < 40`.

A number without a unit is in SI, as everywhere; one with a unit is checked against the measure's own.
"""

from __future__ import annotations

import re
from typing import Literal

from heuncli.errors import Finding
from heuncli.expressions.units import describe, parse_unit
from heuncli.named_tuples import NamedTuple
from heuncli.variants.axes import AxisError, Figure, figure_of

Sign = Literal["=", "<", ">", "<=", ">="]
SPELLINGS: dict[str, Sign] = {
    "=": "=", "==": "=", "<": "<", ">": ">", "<=": "<=", ">=": ">=", "≤": "<=", "≥": ">=", "=<": "<=", "=>": ">=",
}  # fmt: skip
PARTS = re.compile(r"([^<>=≤≥]*)([<>=≤≥]+)([^<>=≤≥]*)\Z", re.DOTALL)
FORM = "expected MEASURE < VALUE"
HINT = "such as 'max abs sections.web.M2 < 40 N*m'"


class MeasureCondition(NamedTuple):
    """The words of a measure, the sign, and what stands behind it as it is written."""

    measure: str
    sign: Sign
    figure: Figure

    @property
    def below(self) -> bool:
        """Whether the measure is to lie below."""
        return self.sign in ("<", "<=")


def condition_of(text: str, form: str = FORM, hint: str = HINT) -> MeasureCondition:
    """What a text such as `max joints.main.force < 10 kN` says. Raises AxisError."""
    found = PARTS.match(text)
    sign = SPELLINGS.get(found[2]) if found is not None else None
    if found is None or sign is None or not found[1].strip():
        raise AxisError(text, form, hint)
    figure = figure_of(found[3])
    if figure is None:
        turned = figure_of(found[1]) is not None
        message = "the measure stands first" if turned else f"'{found[3].strip()}' is not a number with or without unit"
        raise AxisError(text, message, hint)
    return MeasureCondition(found[1].strip(), sign, figure)


def in_si(condition: MeasureCondition, unit: str) -> float:
    """The number of a condition in SI; unit: the measure's own, empty where it is not known. Raises AxisError."""
    value, given = condition.figure
    if not given:
        return value
    word = f"{condition.measure} {condition.sign} {value:g} {given}"
    try:
        size, dimension = parse_unit(given)
        own = parse_unit(unit)[1] if unit else None
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint) from None
    if own is not None and own != dimension:
        raise AxisError(
            word, f"'{given}' is {describe(dimension)}, the measure is {describe(own)}", f"give it in {unit}"
        )
    return value * size
