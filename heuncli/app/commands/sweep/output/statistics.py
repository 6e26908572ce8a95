"""The measures of a sweep as columns of numbers, and the statistics of a random sweep, for each combination of axes."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.analyses.sweep_rows import SweepHead, SweptRow
from heuncli.analyses.variants.plans import Plan
from heuncli.analyses.variants.sample_statistics import (
    SampleStatistics,
    SobolIndices,
    compute_sobol_indices,
    compute_statistics,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.quantity import ParameterValue


class ColumnBuffer:
    """The columns of the rows so far: numbers of the variants in their order, and their measures; nan if there is
    none.
    """

    def __init__(self, measure_count: int) -> None:
        """measure_count: number of measures of each variant"""
        self._numbers = array("q")
        self._values = [array("d") for _ in range(measure_count)]
        self._errors = [array("d") for _ in range(measure_count)]
        self.failures: Counter[str] = Counter()  # by code

    def record(self, rows: Iterable[SweptRow]) -> Iterator[SweptRow]:
        """Yield the rows, and add each to the columns."""
        for row in rows:
            self.add(row)
            yield row

    def add(self, row: SweptRow) -> None:
        """Add a variant."""
        self._numbers.append(row.number)
        if row.result.code:
            self.failures[row.result.code] += 1
        results = row.result.measures or (None,) * len(self._values)
        for place, one in enumerate(results):
            self._values[place].append(np.nan if one is None or one.value is None else one.value)
            self._errors[place].append(np.nan if one is None or one.error is None else one.error)

    def __len__(self) -> int:
        return len(self._numbers)

    @property
    def numbers(self) -> Array:
        """Numbers of the variants, (n,)."""
        return np.frombuffer(self._numbers, dtype=np.int64) if self._numbers else np.empty(0, dtype=np.int64)

    def values(self, measure: int) -> Array:
        """Return the values of a measure, (n,) in SI."""
        return _to_array(self._values[measure])

    def errors(self, measure: int) -> Array:
        """Return the stated errors of a measure, (n,) in SI; 0 if a run states none."""
        return np.nan_to_num(_to_array(self._errors[measure]))


def _to_array(numbers: array[float]) -> Array:
    return np.frombuffer(numbers) if numbers else np.empty(0)


INDEPENDENT = 2  # of the variants of a sample for Sobol indices: A and B


class MeasureStatistics(NamedTuple):
    """The statistics of one measure for fixed values of the axes that are not random.

    combination: its values
    measure: index of the measure
    drawn_count: number of variants, of which `left_out` have no value
    sample: the sample statistics, or None
    error: the largest error that a run states
    indices: Sobol indices of each random parameter; None if the plan has none, or if the measure varies by no more than
    its error
    samples: number of samples behind the indices
    """

    combination: dict[str, ParameterValue]
    measure: int
    drawn_count: int
    left_out: int
    sample: SampleStatistics | None
    error: float
    indices: tuple[SobolIndices, ...] | None = None
    samples: int = 0

    @property
    def is_constant(self) -> bool:
        """Whether the measure varies by no more than the errors of its runs."""
        return self.sample is not None and not self.sample.deviation.value > self.error


def iter_statistics(head: SweepHead, rows: ColumnBuffer) -> Iterator[MeasureStatistics]:
    """Yield the statistics of every combination and measure; nothing if no parameter is random."""
    plan = head.plan
    if plan.draws is None:
        return
    draw_count = len(plan.draws.values)
    numbers = rows.numbers
    for start in range(0, plan.size, draw_count):
        begin, end = np.searchsorted(numbers, (start, start + draw_count)).tolist()
        if begin == end:
            continue  # of another shard
        combination = find_combination(plan, start)
        for measure in range(len(head.measures)):
            values, errors = rows.values(measure)[begin:end], rows.errors(measure)[begin:end]
            yield _compute_statistics(plan, combination, measure, numbers[begin:end] - start, values, errors)


def find_combination(plan: Plan, number: int) -> dict[str, ParameterValue]:
    """Return the values of the axes that are not random."""
    random_names = {law.name for law in plan.draws.laws} if plan.draws is not None else set()
    return {name: value for name, value in plan.find_values(number).items() if name not in random_names}


def _compute_statistics(
    plan: Plan, combination: dict[str, ParameterValue], measure: int, places: Array, values: Array, errors: Array
) -> MeasureStatistics:
    """Compute the statistics of one measure at one combination.

    places: indices of the values among the random draws
    """
    assert plan.draws is not None
    each = plan.draws.each
    independent = values if each == 1 else values[places % each < INDEPENDENT]
    known = independent[np.isfinite(independent)]
    error = float(errors.max(initial=0.0))
    sample = compute_statistics(known)
    statistics = MeasureStatistics(combination, measure, len(independent), len(independent) - len(known), sample, error)
    if each == 1:
        return statistics
    whole = np.full(len(plan.draws.values), np.nan)
    whole[places] = values
    samples = whole.reshape(-1, each)
    known_ones = np.flatnonzero(np.isfinite(samples).all(axis=1))
    samples = samples[known_ones]
    repetitions = plan.draws.repetitions
    repetition = known_ones % repetitions if repetitions > 1 else None
    indices = None if sample is None or statistics.is_constant else compute_sobol_indices(samples, repetition)
    return statistics._replace(indices=indices, samples=len(samples))
