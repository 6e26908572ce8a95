"""Where words find room beside a marked place: over no other words, and over as little of the curves as may be.

A field is a grid of small cells, each with what it costs to write there: nothing where it is empty, one where a curve
passes. Where words or marks stand there is no room at any price.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

LINES = 4  # how many lines of text away from its place words are looked for room
TOUCH = 1e-6  # of rounding
PER_LINE = 7.0  # what each of them costs, in cells of a curve


class WordBox(NamedTuple):
    """A rectangle, y downwards."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: WordBox) -> bool:
        """Whether two of them overlap; boxes that touch do not."""
        return (
            self.left < other.right - TOUCH and other.left < self.right - TOUCH
            and self.top < other.bottom - TOUCH and other.top < self.bottom - TOUCH
        )  # fmt: skip

    def holds(self, other: WordBox) -> bool:
        """Whether another one lies in it."""
        return (
            self.left <= other.left + TOUCH and other.right <= self.right + TOUCH
            and self.top <= other.top + TOUCH and other.bottom <= self.bottom + TOUCH
        )  # fmt: skip


class WordField:
    """The cells of a rectangle; fine: the size of one, (across, down)."""

    def __init__(self, box: WordBox, fine: tuple[float, float]) -> None:
        self.box, self.fine = box, fine
        rows, columns = (max(1, math.ceil(length / f)) for length, f in
                         ((box.bottom - box.top, fine[1]), (box.right - box.left, fine[0])))  # fmt: skip
        self.price = np.zeros((rows, columns))
        self.taken: list[WordBox] = []

    def curve(self, points: Array) -> None:
        """A line passes through points (n, 2)."""
        if len(points) < 2 or not np.isfinite(points).all():
            return
        at = (points - (self.box.left, self.box.top)) / self.fine
        length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(at, axis=0)).max(axis=1))])
        along = np.linspace(0.0, length[-1], min(math.ceil(2.0 * length[-1]) + 1, 100_000))
        column, row = (np.floor(np.interp(along, length, at[:, k])).astype(np.intp) for k in (0, 1))
        rows, columns = self.price.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        row, column = row[inside], column[inside]
        self.price[row, column] = np.maximum(self.price[row, column], 1.0)

    def take(self, box: WordBox) -> None:
        """Words or a mark stand there."""
        self.taken.append(box)

    def best(self, candidates: Iterable[tuple[float, WordBox]]) -> WordBox | None:
        """The box that costs least beside its own price, which is taken then; None where there is none."""
        found, least = None, math.inf
        for own, box in candidates:
            if own >= least or not self.box.holds(box) or any(box.meets(other) for other in self.taken):
                continue
            cost = own + float(self._cells(box).sum())
            if cost < least:
                found, least = box, cost
        if found is not None:
            self.take(found)
        return found

    def beside(self, mark: WordBox, width: float, height: float) -> WordBox | None:
        """Room for words of a size beside a mark."""
        return self.best(self._around(mark, width, height))

    def _around(self, mark: WordBox, width: float, height: float) -> Iterator[tuple[float, WordBox]]:
        """Boxes about a mark with what each costs: above, below, at its right and left, then farther and farther."""
        middle = 0.5 * (mark.top + mark.bottom - height)
        centred = 0.5 * (mark.left + mark.right - width)
        centred = max(min(centred, self.box.right - width), self.box.left)
        for line in range(LINES):
            own = PER_LINE * line
            for top in (mark.top - height * (line + 1), mark.bottom + height * line):
                for left in (mark.right, mark.left - width, centred):
                    yield own, WordBox(left, top, left + width, top + height)
            if not line:
                for left in (mark.right, mark.left - width):
                    yield own, WordBox(left, middle, left + width, middle + height)

    def _cells(self, box: WordBox) -> Array:
        (left, right), (top, bottom) = (
            (max(0, math.floor((low - own) / f + 1e-9)), max(0, math.ceil((high - own) / f - 1e-9)))
            for low, high, own, f in (
                (box.left, box.right, self.box.left, self.fine[0]), (box.top, box.bottom, self.box.top, self.fine[1])
            )
        )  # fmt: skip
        return self.price[top:bottom, left:right]


def columns_of(text: str) -> int:
    """How many cells a text takes in a terminal: two for a wide letter, none for one that stands over another."""
    if text.isascii():
        return len(text)
    import unicodedata  # few words have other letters

    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def left_out(told: Iterable[str], most: int = 12) -> list[str]:
    """A note of the words that found no room, if there are any."""
    several = list(dict.fromkeys(told))
    if not several:
        return []
    more = f"; and {len(several) - most} more" if len(several) > most else ""
    return [f"without words for want of room: {'; '.join(several[:most])}{more}"]
