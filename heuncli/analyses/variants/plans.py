"""A plan: which values the parameters have in each variant, made as they are asked for.

A plan of many variants holds its axes and its random numbers, not its rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from heuncli.analyses.variants.axes import HINT, AxisError, Drawn, ParameterAxis, figure_of, text_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

MOST_VARIANTS = 10_000_000


class Draws(NamedTuple):
    """Random parameters together: their laws, and what is drawn of them in their units, (variants, parameters).

    seed: by which the same are drawn again; each: so many variants in a row are of one sample; repetitions: the
    k-th sample is of the k-th of so many plans, taken in turn, each drawn by itself (draws.py).
    """

    laws: tuple[Drawn, ...]
    values: Array
    seed: int
    each: int = 1
    repetitions: int = 1


class Plan(NamedTuple):
    """Variants by their numbers, from 0 on: every combination of the axes, or of all the values of one place together.

    The first axis changes slowest; draws, where there are any, come behind all axes and change fastest. columns: of a
    table of which every row is combined with all that the axes make; these change slowest of all.
    """

    axes: tuple[ParameterAxis, ...]
    together: bool = False
    draws: Draws | None = None
    columns: tuple[ParameterAxis, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """What is varied, in the order in which it was named."""
        return (
            *(axis.name for axis in (*self.columns, *self.axes)),
            *(law.name for law in (self.draws.laws if self.draws else ())),
        )

    @property
    def size(self) -> int:
        """How many variants there are."""
        return self._combinations * (len(self.draws.values) if self.draws is not None else 1)

    @property
    def _combinations(self) -> int:
        rows = len(self.columns[0].texts) if self.columns else 1
        if self.together:
            return rows * (len(self.axes[0].texts) if self.axes else 1)
        return rows * math.prod(len(axis.texts) for axis in self.axes)

    def values(self, number: int) -> dict[str, str]:
        """The values of a variant, in the form of `--set`."""
        found: dict[str, str] = {}
        if self.draws is not None:
            number, row = divmod(number, len(self.draws.values))
            drawn = zip(self.draws.laws, self.draws.values[row].tolist(), strict=True)
            found = {law.name: text_of(value, law.unit) for law, value in drawn}
        own: dict[str, str] = {}
        if self.together and self.axes:
            number, place = divmod(number, len(self.axes[0].texts))
            own = {axis.name: axis.texts[place] for axis in self.axes}
        for axis in reversed(self.axes) if not self.together else ():
            number, place = divmod(number, len(axis.texts))
            own[axis.name] = axis.texts[place]
        of_row = {axis.name: axis.texts[number] for axis in self.columns}
        return of_row | {axis.name: own[axis.name] for axis in self.axes} | found

    def numbers(self, shard: tuple[int, int] = (1, 1)) -> Iterator[int]:
        """The numbers of the variants, of a shard k of n: every n-th one, from the k-th on."""
        k, n = shard
        return iter(range(k - 1, self.size, n))


def plan_of(
    axes: Sequence[ParameterAxis],
    *,
    together: bool = False,
    draws: Draws | None = None,
    columns: Sequence[ParameterAxis] = (),
) -> Plan:
    """The plan of some axes, and of the columns of a table, which are of one length. Raises AxisError."""
    if together or not axes:
        axes, columns, together = [*columns, *axes], (), together or bool(columns)
    names = [axis.name for axis in (*columns, *axes)] + [law.name for law in (draws.laws if draws else ())]
    for name in names:
        if names.count(name) > 1:
            raise AxisError(name, "is varied twice", "one axis a parameter")
    if together and len({len(axis.texts) for axis in axes}) > 1:
        counts = ", ".join(f"{axis.name} {len(axis.texts)}" for axis in axes)
        raise AxisError(
            "--zip", f"the axes have not the same count of values: {counts}", "leave --zip out for all combinations"
        )
    plan = Plan(tuple(axes), together, draws, tuple(columns))
    if plan.size > MOST_VARIANTS:
        raise AxisError(" ".join(names), f"{plan.size:,} variants; at most {MOST_VARIANTS:,}", HINT)
    return plan


def numbers_of(texts: Sequence[str]) -> Mapping[str, float]:
    """The figures of values by their texts, where all are numbers of one unit; empty where they are not."""
    figures = {text: figure_of(text) for text in texts}
    if any(figure is None for figure in figures.values()):
        return {}
    known = {text: figure for text, figure in figures.items() if figure is not None}
    return {text: figure.value for text, figure in known.items()} if len({f.unit for f in known.values()}) == 1 else {}
