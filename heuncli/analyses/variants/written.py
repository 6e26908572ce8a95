"""What a parameter or a dotted key of a spec has as its value: the number and the unit, as they are written."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.analyses.variants.asking import Recipe
from heuncli.analyses.variants.axes import AxisError, text_of
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.cases import settings_of
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import mapping
from heuncli.scene.file_format.overrides import at, of_words, override, path_of
from heuncli.scene.file_format.quantity import Scope, number, unit_in
from heuncli.scene.file_format.source import read

NUMBERS = "such as L, or bodies.crank.mass"


class WrittenNumber(NamedTuple):
    """A number by its name, in its unit (empty: SI, or none); size: of the unit in SI."""

    name: str
    value: float
    unit: str
    size: float

    def text(self, value: float) -> str:
        """Another value of it in the form of `--set`."""
        return text_of(value, self.unit)


class WrittenNumbers:
    """The numbers of a spec as it stands in a recipe: with its load case, and what is set in all variants."""

    def __init__(self, recipe: Recipe, spec: Spec) -> None:
        source = read(recipe.path, recipe.text)
        settings = [] if recipe.case is None else settings_of(recipe.case, source)
        settings += of_words(recipe.overrides)[0]
        self._data: dict[str, Any] = override(source.data, settings)[0]
        self._spec = spec

    def named(self, name: str) -> WrittenNumber:
        """The number under a name; of an expression its value in SI. Raises AxisError."""
        path = path_of(name, self._data)
        found = at(self._data, path)
        if found is None:
            known = [*mapping(self._data.get("parameters"))]
            raise AxisError(name, "the spec gives no number there", did_you_mean(name, known, "parameters") or NUMBERS)
        try:
            return self._read(name, found)
        except Finding as finding:
            raise AxisError(name, f"this is no number: {finding.message}", NUMBERS) from None

    def all(self) -> Iterator[WrittenNumber]:
        """The parameters that are given as numbers; those that follow from others are none."""
        for name, given in mapping(self._data.get("parameters")).items():
            if type(given) in (int, float) or (type(given) is str and unit_in(given) is not None):
                yield self._read(name, given)

    def _read(self, name: str, given: Any) -> WrittenNumber:
        value = number(given, None, Scope(self._spec.parameters))
        found = unit_in(given) if type(given) is str else None
        if found is None:
            return WrittenNumber(name, value, "", 1.0)
        unit = found[2].strip()
        return WrittenNumber(name, float(found[1].replace(" ", "")), unit, parse_unit(unit)[0])
