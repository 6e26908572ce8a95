"""Recalculate a number from its expression with other parameter values, without parsing the text again.

An expression of parameters alone becomes a row of numbers: each is a literal, a parameter, or the result of an
operation on earlier ones. With other values the row stays the same, unless a choice depends on a value (`a if c else
b`, tables, an exponent that is no literal): then nothing is cached.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.programs import Expression

Dimension = tuple[int, int, int]


class Operation(NamedTuple):
    """An operation on earlier numbers of the row; length: that of its program."""

    program: expressions.Expressions
    length: int
    operands: tuple[int, ...]


MAX_OLDER_ENTRIES = 7  # older calculations stored for one text, besides the latest
NumberSource = float | str | Operation  # of a number: a literal, a parameter's name, or an operation


class Calculation(NamedTuple):
    """An expression, the sources of its numbers, and the dimensions of its parameters (None without one)."""

    expression: Expression
    sources: tuple[NumberSource, ...]
    dimensions: dict[str, Dimension | None]

    def recalculate(self, parameters: Mapping[str, float | None]) -> Expression | None:
        """Return the expression with these values; None if it has to be parsed, because of an error to report."""
        numbers: list[float] = []
        for source in self.sources:
            if isinstance(source, Operation):
                operands = [numbers[k] for k in source.operands]
                numbers.append(source.program.evaluate(0, source.length, operands))
            elif isinstance(source, str):
                value = parameters[source]
                if value is None:
                    return None
                numbers.append(value)
            else:
                numbers.append(source)
        constant = numbers[self.expression.code[1]]
        if not math.isfinite(constant):
            return None
        recalculated: Expression = replace(self.expression, constant=constant, constants=tuple(numbers))
        return recalculated


class CalculationCache:
    """Cache of parsed numbers by their texts. Impure: entries are added, which changes no number.

    A text has several entries if its parameters were given with and without units.
    """

    def __init__(self) -> None:
        self.entries: dict[str, tuple[Calculation, ...]] = {}

    def recalculate(
        self, text: str, parameters: Mapping[str, float | None], dimension_of: Callable[[str], Dimension | None]
    ) -> Expression | None:
        """Return the expression of a text with these values; None if it has to be parsed."""
        for entry in self.entries.get(text, ()):
            if all(dimension_of(name) == dimension for name, dimension in entry.dimensions.items()):
                return entry.recalculate(parameters)
        return None

    def store(
        self,
        text: str,
        expression: Expression,
        sources: Sequence[NumberSource] | None,
        dimension_of: Callable[[str], Dimension | None],
    ) -> None:
        """Store how a number was calculated. sources: None if a choice depends on a value; then nothing is stored."""
        if sources is not None:
            dimensions = {name: dimension_of(name) for name in sources if isinstance(name, str)}
            others = self.entries.get(text, ())[-MAX_OLDER_ENTRIES:]
            self.entries[text] = (*others, Calculation(expression, tuple(sources), dimensions))
