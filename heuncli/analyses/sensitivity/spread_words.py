"""What `--spread L=0.1mm,e=0.02mm` asks for."""

from __future__ import annotations

from heuncli.analyses.sensitivity.spread import NumberSpread
from heuncli.analyses.variants.axes import AxisError, at_top_level, figure_of, name_and_values
from heuncli.analyses.variants.written import WrittenNumber, WrittenNumbers
from heuncli.base.errors import Finding
from heuncli.base.units import describe, parse_unit

FORM = "expected NAME=VALUE,..., how far each may lie from its value"
HINT = "such as --spread L=0.1mm,e=0.02mm"


def spreads_of(words: str, written: WrittenNumbers) -> list[NumberSpread]:
    """The spreads of numbers, each in its number's unit. Raises AxisError."""
    found: dict[str, NumberSpread] = {}
    for word in at_top_level(words):
        name, value = name_and_values(word.strip(), FORM, HINT)
        if name in found:
            raise AxisError(name, "has two spreads", HINT)
        number = written.named(name)
        found[name] = NumberSpread(number, _size(word.strip(), value, number))
    return [*found.values()]


def _size(word: str, value: str, number: WrittenNumber) -> float:
    """How far a number may lie from its value, in its unit. Raises AxisError."""
    figure = figure_of(value)
    if figure is None or figure.value <= 0.0:
        raise AxisError(word, "a spread is a positive number, with its unit", HINT)
    if not figure.unit:
        if number.size != 1.0:
            raise AxisError(word, f"{number.name} is given in {number.unit}: a spread needs its unit", HINT)
        return figure.value
    try:
        size, dimension = parse_unit(figure.unit)
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint) from None
    if number.unit and dimension != parse_unit(number.unit)[1]:
        raise AxisError(word, f"{describe(dimension)}, but {number.name} is given in {number.unit}", HINT)
    return figure.value * size / number.size
