"""The measures of a sweep as numbers in a row: what extremes, sparklines and statistics are made from.

Of a million variants it holds the numbers alone, 16 bytes a measure and variant.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.analyses.sweep_store.rows import SweptRow
from heuncli.results.results import Array


class GatheredRows:
    """What has passed by: the numbers of the variants in their order, and their measures; nan where there is none."""

    def __init__(self, measures: int) -> None:
        """measures: how many there are of each variant."""
        self._numbers = array("q")
        self._values = [array("d") for _ in range(measures)]
        self._errors = [array("d") for _ in range(measures)]
        self.failed: Counter[str] = Counter()  # by code

    def passing(self, rows: Iterable[SweptRow]) -> Iterator[SweptRow]:
        """The rows, each taken down as it goes by."""
        for row in rows:
            self.add(row)
            yield row

    def add(self, row: SweptRow) -> None:
        """Take down a variant."""
        self._numbers.append(row.number)
        if row.answer.code:
            self.failed[row.answer.code] += 1
        found = row.answer.measures or (None,) * len(self._values)
        for place, one in enumerate(found):
            self._values[place].append(np.nan if one is None or one.value is None else one.value)
            self._errors[place].append(np.nan if one is None or one.error is None else one.error)

    def __len__(self) -> int:
        return len(self._numbers)

    @property
    def numbers(self) -> Array:
        """Of the variants, (n,)."""
        return np.frombuffer(self._numbers, dtype=np.int64) if self._numbers else np.empty(0, dtype=np.int64)

    def values(self, measure: int) -> Array:
        """Of a measure, (n,) in SI."""
        return _floats(self._values[measure])

    def errors(self, measure: int) -> Array:
        """As the runs state them, (n,) in SI; 0 where they state none."""
        return np.nan_to_num(_floats(self._errors[measure]))


def _floats(numbers: array[float]) -> Array:
    return np.frombuffer(numbers) if numbers else np.empty(0)
