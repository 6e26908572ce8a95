"""A number that was read from an expression once, calculated again with other parameters, and not read again.

What an expression of parameters alone means is a row of numbers, each as written, a parameter's, or what an operation
makes of earlier ones. With other values it is the same row, as long as no choice hangs on a value: where one does
(`a if c else b`, tables, an exponent that is no number written out) nothing is kept of it.
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
    """An operation on earlier numbers of the row; reads: how long its program is."""

    program: expressions.Expressions
    length: int
    operands: tuple[int, ...]


MOST = 7  # calculations of one text, beside the last
Source = float | str | Operation  # of a number: as it is written, a parameter's name, or made of others


class Calculation(NamedTuple):
    """An expression, where its numbers come from, and the dimensions of its parameters, None where they have none."""

    expression: Expression
    sources: tuple[Source, ...]
    dimensions: dict[str, Dimension | None]

    def again(self, parameters: Mapping[str, float | None]) -> Expression | None:
        """The expression with these values; None: it has to be read, for there is something to be told of it."""
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
        again: Expression = replace(self.expression, constant=constant, constants=tuple(numbers))
        return again


class Calculations:
    """Numbers that were read, by their texts. Impure: what is read is kept, which changes no number.

    Of a text there are several where its parameters were given with units, and without.
    """

    def __init__(self) -> None:
        self.known: dict[str, tuple[Calculation, ...]] = {}

    def again(
        self, text: str, parameters: Mapping[str, float | None], dimension_of: Callable[[str], Dimension | None]
    ) -> Expression | None:
        """What a text means with these values; None: it has to be read."""
        for one in self.known.get(text, ()):
            if all(dimension_of(name) == dimension for name, dimension in one.dimensions.items()):
                return one.again(parameters)
        return None

    def keep(
        self,
        text: str,
        expression: Expression,
        sources: Sequence[Source] | None,
        dimension_of: Callable[[str], Dimension | None],
    ) -> None:
        """Keep how a number was calculated; sources: None where a choice hangs on a value."""
        if sources is not None:
            dimensions = {name: dimension_of(name) for name in sources if isinstance(name, str)}
            others = self.known.get(text, ())[-MOST:]
            self.known[text] = (*others, Calculation(expression, tuple(sources), dimensions))
