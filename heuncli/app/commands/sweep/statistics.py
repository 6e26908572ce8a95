"""The columns of a sweep's measures, their statistics, and the rows that its table shows.

Of a long sweep these are the first, the last, and those with an extreme.
"""

from __future__ import annotations

from array import array
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from heuncli.analyses.sweep_rows import JumpFinder, SweepHead, SweptJump, SweptRow
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
        """Append the measures of a variant, or nan, and count its failure."""
        self._numbers.append(row.number)
        if row.result.code:
            self.failures[row.result.code] += 1
        results = row.result.measures or (None,) * len(self._values)
        for place, reading in enumerate(results):
            self._values[place].append(np.nan if reading is None or reading.value is None else reading.value)
            self._errors[place].append(np.nan if reading is None or reading.error is None else reading.error)

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
    """Return the numbers as an array that shares their memory."""
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


MAX_ROWS = 60  # shown without --all
END_ROWS = 10  # rows at the beginning and at the end of more


class ShownRows(NamedTuple):
    """The selected rows by their index in the sweep, and the columns of all rows."""

    rows: Mapping[int, SweptRow]
    columns: ColumnBuffer
    extremes: tuple[MeasureExtremes | None, ...]
    jumps: Sequence[SweptJump]

    @property
    def size(self) -> int:
        """Number of variants."""
        return len(self.columns)


def select_rows(head: SweepHead, rows: Iterable[SweptRow], all_of_them: bool) -> ShownRows:
    """Select the rows to show, reading them once."""
    columns = ColumnBuffer(len(head.measures))
    finder = JumpFinder(head.plan, len(head.measures))
    recorded, limit = columns.record(finder.record(rows)), None if all_of_them else MAX_ROWS
    first = list(islice(recorded, limit))
    best = ExtremeRows(first, len(head.measures))
    last: deque[SweptRow] = deque(maxlen=END_ROWS)
    for row in recorded:
        best.add(row, len(columns) - 1)
        last.append(row)
    extremes_found = tuple(find_extremes(columns.values(k), columns.errors(k)) for k in range(len(head.measures)))
    selected = dict(enumerate(first))
    if last:
        selected = dict(enumerate(first[:END_ROWS])) | dict(enumerate(last, len(columns) - len(last)))
        selected |= {place: row for place, row in best.iter_rows() if place not in selected}
    return ShownRows(dict(sorted(selected.items())), columns, extremes_found, finder.jumps)


class ExtremeRows:
    """The rows with the least and the greatest value of each measure so far; the first of equal ones."""

    def __init__(self, first: Sequence[SweptRow], measures: int) -> None:
        self._least: list[tuple[float, int, SweptRow] | None] = [None] * measures
        self._greatest: list[tuple[float, int, SweptRow] | None] = [None] * measures
        for place, row in enumerate(first):
            self.add(row, place)

    def add(self, row: SweptRow, place: int) -> None:
        """Keep the row if it has an extreme."""
        for k, reading in enumerate(row.result.measures):
            if reading.value is None:
                continue
            for best, sign in ((self._least, 1.0), (self._greatest, -1.0)):
                known = best[k]
                if known is None or sign * reading.value < sign * known[0]:
                    best[k] = reading.value, place, row

    def iter_rows(self) -> Iterator[tuple[int, SweptRow]]:
        """Yield these rows with their indices."""
        return ((known[1], known[2]) for known in (*self._least, *self._greatest) if known is not None)


class MeasureExtremes(NamedTuple):
    """The extremes of a measure.

    least, greatest: indices of the variants
    may_be_least, may_be_greatest: (n,) bool, which variants may be it as well by their errors
    """

    least: int
    greatest: int
    may_be_least: Array
    may_be_greatest: Array

    @property
    def is_constant(self) -> bool:
        """Whether any variant could be either: the measure does not vary, as far as is known."""
        return bool(self.may_be_least[self.greatest])


def find_extremes(values: Array, errors: Array) -> MeasureExtremes | None:
    """Find the extremes of a measure, (n,) values and errors, nan if unknown; None if fewer than two values are
    known.
    """
    if np.count_nonzero(np.isfinite(values)) < 2:
        return None
    least, greatest = int(np.nanargmin(values)), int(np.nanargmax(values))
    with np.errstate(invalid="ignore"):
        low = values - errors <= values[least] + errors[least]
        high = values + errors >= values[greatest] - errors[greatest]
    return MeasureExtremes(least, greatest, low, high)
