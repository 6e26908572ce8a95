"""Parse the option `--spread L=0.1mm,e=0.02mm`."""

from __future__ import annotations

from heuncli.analyses.sensitivity.tolerance_analysis import NumberSpread
from heuncli.analyses.variants.axes import AxisError, split_at_commas, split_name
from heuncli.analyses.variants.spec_numbers import SpecNumber, SpecNumbers
from heuncli.base.errors import Finding
from heuncli.base.units import describe, parse_unit
from heuncli.scene.file_format.quantity import parse_number_with_unit

FORM = "expected NAME=VALUE,..., the tolerance of each parameter"
HINT = "for example --spread L=0.1mm,e=0.02mm"


def parse_spreads(text: str, spec_numbers: SpecNumbers) -> list[NumberSpread]:
    """Return the tolerances of numbers, each in its number's unit. Raises AxisError."""
    spreads: dict[str, NumberSpread] = {}
    for word in split_at_commas(text):
        name, value = split_name(word.strip(), FORM, HINT)
        if name in spreads:
            raise AxisError(name, "has two spreads", HINT)
        number = spec_numbers.find_number(name)
        spreads[name] = NumberSpread(number, _parse_size(word.strip(), value, number))
    return [*spreads.values()]


def _parse_size(word: str, value: str, number: SpecNumber) -> float:
    """Return the tolerance of a number, in its unit. Raises AxisError."""
    quantity = parse_number_with_unit(value)
    if quantity is None or quantity.value <= 0.0:
        raise AxisError(word, "a spread is a positive number, with its unit", HINT)
    if not quantity.unit:
        if number.size != 1.0:
            raise AxisError(word, f"{number.name} is given in {number.unit}: its spread needs a unit", HINT)
        return quantity.value
    try:
        size, dimension = parse_unit(quantity.unit)
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint) from None
    if number.unit and dimension != parse_unit(number.unit)[1]:
        raise AxisError(word, f"{describe(dimension)}, but {number.name} is given in {number.unit}", HINT)
    return quantity.value * size / number.size
