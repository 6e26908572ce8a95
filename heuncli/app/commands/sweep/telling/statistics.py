"""The statistics of a random sweep: of each combination of its other axes, and of each measure.

Variants that could not be solved, or whose measure is not known, are left out and counted. Where Sobol indices were
asked for, the statistics are those of A and B, which are independent; a sample of whose d + 2 variants one has no value
is left out of the indices.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.analyses.sweep_store.rows import SweepHead
from heuncli.analyses.variants.indices import SobolIndices, sobol_indices
from heuncli.analyses.variants.plans import Plan
from heuncli.analyses.variants.sampling import Sampled, sampled
from heuncli.app.commands.sweep.telling.gathered import GatheredRows
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

INDEPENDENT = 2  # of the variants of a sample for Sobol indices: A and B


class MeasureStatistics(NamedTuple):
    """Of one measure at one combination of the other axes.

    combination: its values, in the form of `--set`; measure: its place; drawn: how many variants were asked for, of
    which `left_out` have no value; error: the largest that a run states; indices: of each random parameter, None where
    the plan has none or the measure does not vary by more than the error of its runs; samples: those they are from.
    """

    combination: dict[str, str]
    measure: int
    drawn: int
    left_out: int
    found: Sampled | None
    error: float
    indices: tuple[SobolIndices, ...] | None = None
    samples: int = 0

    @property
    def flat(self) -> bool:
        """Whether the measure varies by no more than the errors of its runs."""
        return self.found is not None and not self.found.deviation.value > self.error


def statistics_of(head: SweepHead, rows: GatheredRows) -> Iterator[MeasureStatistics]:
    """Of every combination and measure; none where nothing is drawn."""
    plan = head.plan
    if plan.draws is None:
        return
    of_one = len(plan.draws.values)
    numbers = rows.numbers
    for start in range(0, plan.size, of_one):
        begin, end = np.searchsorted(numbers, (start, start + of_one)).tolist()
        if begin == end:
            continue  # of another shard
        combination = combination_of(plan, start)
        for measure in range(len(head.measures)):
            values, errors = rows.values(measure)[begin:end], rows.errors(measure)[begin:end]
            yield _of_one(plan, combination, measure, numbers[begin:end] - start, values, errors)


def combination_of(plan: Plan, number: int) -> dict[str, str]:
    """The values of the axes alone in a variant, in the form of `--set`."""
    drawn = {law.name for law in plan.draws.laws} if plan.draws is not None else set()
    return {name: text for name, text in plan.values(number).items() if name not in drawn}


def _of_one(
    plan: Plan, combination: dict[str, str], measure: int, places: Array, values: Array, errors: Array
) -> MeasureStatistics:
    """Of one measure at one combination; places: of the values among the variants that are drawn."""
    assert plan.draws is not None
    each = plan.draws.each
    independent = values if each == 1 else values[places % each < INDEPENDENT]
    known = independent[np.isfinite(independent)]
    error = float(errors.max(initial=0.0))
    found = sampled(known)
    made = MeasureStatistics(combination, measure, len(independent), len(independent) - len(known), found, error)
    if each == 1:
        return made
    whole = np.full(len(plan.draws.values), np.nan)
    whole[places] = values
    samples = whole.reshape(-1, each)
    known_ones = np.flatnonzero(np.isfinite(samples).all(axis=1))
    samples = samples[known_ones]
    repetitions = plan.draws.repetitions
    of_plans = known_ones % repetitions if repetitions > 1 else None
    indices = None if found is None or made.flat else sobol_indices(samples, of_plans)
    return made._replace(indices=indices, samples=len(samples))
