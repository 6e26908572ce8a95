"""Which rows of a sweep a table shows: of a long one the first, the last, and those with an extreme."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.app.commands.sweep.telling.extremes import BestAndWorst, extremes
from heuncli.app.commands.sweep.telling.gathered import GatheredRows
from heuncli.base.named_tuples import NamedTuple

MOST_ROWS = 60  # that are shown without --all
ENDS = 10  # rows at the beginning and at the end of more


class KeptRows(NamedTuple):
    """The rows that are shown by their places in the sweep, and the measures of all."""

    rows: Mapping[int, SweptRow]
    gathered: GatheredRows
    extremes: tuple[BestAndWorst | None, ...]

    @property
    def size(self) -> int:
        """How many variants there are."""
        return len(self.gathered)


def kept(head: SweepHead, rows: Iterable[SweptRow], all_of_them: bool) -> KeptRows:
    """What is to be shown of the rows, read once."""
    gathered = GatheredRows(len(head.measures))
    passing, most = gathered.passing(rows), None if all_of_them else MOST_ROWS
    first = list(islice(passing, most))
    best = BestRows(first, len(head.measures))
    last: deque[SweptRow] = deque(maxlen=ENDS)
    for row in passing:
        best.look_at(row, len(gathered) - 1)
        last.append(row)
    found = tuple(extremes(gathered.values(k), gathered.errors(k)) for k in range(len(head.measures)))
    shown = dict(enumerate(first))
    if last:
        shown = dict(enumerate(first[:ENDS])) | dict(enumerate(last, len(gathered) - len(last)))
        shown |= {place: row for place, row in best.rows() if place not in shown}
    return KeptRows(dict(sorted(shown.items())), gathered, found)


class BestRows:
    """The rows with the least and the greatest value of each measure so far; the first of equals."""

    def __init__(self, first: Sequence[SweptRow], measures: int) -> None:
        self._least: list[tuple[float, int, SweptRow] | None] = [None] * measures
        self._greatest: list[tuple[float, int, SweptRow] | None] = [None] * measures
        for place, row in enumerate(first):
            self.look_at(row, place)

    def look_at(self, row: SweptRow, place: int) -> None:
        """Keep it where it is one of them."""
        for k, one in enumerate(row.answer.measures):
            if one.value is None:
                continue
            for best, sign in ((self._least, 1.0), (self._greatest, -1.0)):
                known = best[k]
                if known is None or sign * one.value < sign * known[0]:
                    best[k] = one.value, place, row

    def rows(self) -> Iterator[tuple[int, SweptRow]]:
        """These rows and their places."""
        return ((known[1], known[2]) for known in (*self._least, *self._greatest) if known is not None)
