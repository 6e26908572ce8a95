"""Select the rows of a sweep for the table: of a long sweep the first, the last, and those with an extreme."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from heuncli.analyses.sweep_jumps import JumpFinder, SweptJump
from heuncli.analyses.sweep_rows import SweepHead, SweptRow
from heuncli.app.commands.sweep.output.statistics import ColumnBuffer
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

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
        for k, one in enumerate(row.result.measures):
            if one.value is None:
                continue
            for best, sign in ((self._least, 1.0), (self._greatest, -1.0)):
                known = best[k]
                if known is None or sign * one.value < sign * known[0]:
                    best[k] = one.value, place, row

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
