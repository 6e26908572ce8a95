"""Make a plan: the values of the parameters in each variant, made when they are needed.

A plan of many variants holds its axes and its random numbers, not its rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.analyses.variants.axes import HINT, AxisError
from heuncli.analyses.variants.parameters import ParameterAxis, RandomVariable
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue

MAX_VARIANTS = 10_000_000


class Draws(NamedTuple):
    """Random parameters together: their laws, and their draws in their units, (variants, parameters).

    seed: with which the same draws are repeated
    each: number of consecutive variants of one sample
    repetitions: the k-th sample belongs to the k-th of so many plans, taken in turn, each drawn by itself (draws.py)
    """

    laws: tuple[RandomVariable, ...]
    values: Array
    seed: int
    each: int = 1
    repetitions: int = 1


class Plan(NamedTuple):
    """The variants of a sweep, by number from 0. The first axis changes slowest.

    axes: every combination of their values is a variant
    together: whether the k-th values of all axes make the k-th variant instead
    draws: random samples, which change fastest
    columns: of a table; each of its rows is combined with all of the above, and they change slowest
    """

    axes: tuple[ParameterAxis, ...]
    together: bool = False
    draws: Draws | None = None
    columns: tuple[ParameterAxis, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of what is varied, in the given order."""
        return (
            *(axis.name for axis in (*self.columns, *self.axes)),
            *(law.name for law in (self.draws.laws if self.draws else ())),
        )

    @property
    def size(self) -> int:
        """The number of variants."""
        return self._combinations * (len(self.draws.values) if self.draws is not None else 1)

    @property
    def _combinations(self) -> int:
        rows = len(self.columns[0].values) if self.columns else 1
        if self.together:
            return rows * (len(self.axes[0].values) if self.axes else 1)
        return rows * math.prod(len(axis.values) for axis in self.axes)

    def find_values(self, number: int) -> dict[str, ParameterValue]:
        """Return the values of a variant."""
        drawn_values: dict[str, ParameterValue] = {}
        if self.draws is not None:
            number, row = divmod(number, len(self.draws.values))
            drawn = zip(self.draws.laws, self.draws.values[row].tolist(), strict=True)
            drawn_values = {law.name: NumberWithUnit(value, law.unit) for law, value in drawn}
        axis_values: dict[str, ParameterValue] = {}
        if self.together and self.axes:
            number, place = divmod(number, len(self.axes[0].values))
            axis_values = {axis.name: axis.find_value(place) for axis in self.axes}
        for axis in reversed(self.axes) if not self.together else ():
            number, place = divmod(number, len(axis.values))
            axis_values[axis.name] = axis.find_value(place)
        row_values = {axis.name: axis.find_value(number) for axis in self.columns}
        return row_values | {axis.name: axis_values[axis.name] for axis in self.axes} | drawn_values

    def iter_numbers(self, shard: tuple[int, int] = (1, 1)) -> Iterator[int]:
        """Iterate over the numbers of the variants; of a shard k of n: every n-th one, from the k-th on."""
        k, n = shard
        return iter(range(k - 1, self.size, n))


def make_axes_plan(
    axes: Sequence[ParameterAxis],
    *,
    together: bool = False,
    draws: Draws | None = None,
    columns: Sequence[ParameterAxis] = (),
) -> Plan:
    """Make the plan of some axes, and of the columns of a table, which have equal lengths. Raises AxisError."""
    if together or not axes:
        axes, columns, together = [*columns, *axes], (), together or bool(columns)
    names = [axis.name for axis in (*columns, *axes)] + [law.name for law in (draws.laws if draws else ())]
    for name in names:
        if names.count(name) > 1:
            raise AxisError(name, "is varied twice", "give one axis per parameter")
    if together and len({len(axis.values) for axis in axes}) > 1:
        counts = ", ".join(f"{axis.name} {len(axis.values)}" for axis in axes)
        raise AxisError(
            "--zip", f"the axes have different numbers of values: {counts}", "leave --zip out for all combinations"
        )
    plan = Plan(tuple(axes), together, draws, tuple(columns))
    if plan.size > MAX_VARIANTS:
        raise AxisError(" ".join(names), f"{plan.size:,} variants; at most {MAX_VARIANTS:,}", HINT)
    return plan
