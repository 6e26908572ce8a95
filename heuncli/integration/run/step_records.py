"""What a run puts down of its steps, in arrays that grow: a step of a long run takes bytes, not objects."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.records import record
from heuncli.results import Array, Indices

FIRST_ROOM = 64  # rows


class Growing:
    """Rows of so many numbers, one behind the other; the room is doubled where it ends, so that adding stays cheap."""

    def __init__(self, width: int) -> None:
        self.room, self.count = np.empty((FIRST_ROOM, width)), 0

    def add(self, rows: Array) -> None:
        """Rows (n, width) behind the others; a copy."""
        count = self.count + len(rows)
        if count > len(self.room):
            room = np.empty((max(count, 2 * len(self.room)), self.room.shape[1]))
            room[: self.count] = self.rows
            self.room = room
        self.room[self.count : count] = rows
        self.count = count

    def thin(self) -> None:
        """Leave every second row, the first among them."""
        kept = self.rows[::2].copy()
        self.room[: len(kept)], self.count = kept, len(kept)

    @property
    def rows(self) -> Array:
        """All rows, (n, width); a view, until more are added."""
        return self.room[: self.count]


@record
class Kept:
    """The steps whose starts were kept, by their numbers (n,), ascending, and the records that they start from."""

    steps: Indices
    records: Array

    def __len__(self) -> int:
        return len(self.steps)

    def with_others(self, others: Mapping[int, Array]) -> Kept:
        """With other steps' records, which go before those of the same number."""
        if not others:
            return self
        own = ~np.isin(self.steps, list(others))
        steps = np.concatenate([self.steps[own], list(others)])
        order = np.argsort(steps)
        return Kept(steps[order], np.concatenate([self.records[own], list(others.values())])[order])


NOTHING_KEPT = Kept(np.zeros(0, dtype=int), np.zeros((0, 0)))
