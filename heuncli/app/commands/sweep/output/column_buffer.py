"""Buffer the measures of a sweep as columns of numbers, for extremes, sparklines and statistics.

It holds only the numbers, 16 bytes per measure and variant, so that a million variants fit.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.analyses.sweep_rows import SweptRow
from heuncli.results.results import Array


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
