"""Find the numbers that a spec gives by their names: the values around which its variants lie.

The value that a parameter or a dotted key has in the spec is read as it is written: the number and the unit.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.analyses.variants.parameters import AxisError
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import as_mapping
from heuncli.scene.file_format.parameters import (
    apply_settings,
    get_value,
    list_case_settings,
    parse_path,
    parse_settings,
)
from heuncli.scene.file_format.quantity import NumberWithUnit, Scope, match_quantity, read_number
from heuncli.scene.file_format.source import read_source

EXAMPLES = "for example L, or bodies.crank.mass"


class SpecNumber(NamedTuple):
    """A number by its name, in its unit (empty: SI, or none); size: of the unit in SI."""

    name: str
    value: float
    unit: str
    size: float

    def make_value(self, number: float) -> NumberWithUnit:
        """Return another number as its value."""
        return NumberWithUnit(float(number), self.unit)


class SpecNumbers:
    """The numbers of a spec as a recipe gives them: with its load case, and the values set in all variants."""

    def __init__(self, recipe: Recipe, spec: Spec) -> None:
        source = read_source(recipe.path, recipe.text)
        settings = [] if recipe.case is None else list_case_settings(recipe.case, source)
        settings += parse_settings(recipe.overrides)[0]
        self._data: dict[str, Any] = apply_settings(source.data, settings)[0]
        self._spec = spec

    def find_number(self, name: str) -> SpecNumber:
        """Return the number under a name; an expression counts by its value in SI. Raises AxisError."""
        path = parse_path(name, self._data)
        entry = get_value(self._data, path)
        if entry is None:
            parameter_names = [*as_mapping(self._data.get("parameters"))]
            raise AxisError(
                name, "the spec gives no number there", suggest(name, parameter_names, "parameters") or EXAMPLES
            )
        try:
            return self._parse(name, entry)
        except Finding as finding:
            raise AxisError(name, f"not a number: {finding.message}", EXAMPLES) from None

    def iter_parameters(self) -> Iterator[SpecNumber]:
        """Yield the parameters that are given as numbers, without those that are expressions of others."""
        for name, entry in as_mapping(self._data.get("parameters")).items():
            if type(entry) in (int, float) or (type(entry) is str and match_quantity(entry) is not None):
                yield self._parse(name, entry)

    def _parse(self, name: str, entry: Any) -> SpecNumber:
        value = read_number(entry, None, Scope(self._spec.parameters))
        with_unit = match_quantity(entry) if type(entry) is str else None
        if with_unit is None:
            return SpecNumber(name, value, "", 1.0)
        return SpecNumber(name, with_unit.value, with_unit.unit, parse_unit(with_unit.unit)[0])
