"""Find places for words near a mark: over no other words, and over as little of the curves as possible.

A field is a grid of small cells, each with the cost of writing there: zero if it is empty, CURVE_COST if a curve
passes. No words are placed over other words or marks.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

MAX_LINES = 5  # maximum distance of words, in lines of text
ROUNDING = 1e-6  # of rounding
COST_PER_LINE = 7.0  # cost of a line of distance
CURVE_COST = 3.0  # cost of a cell of a curve


N_SAMPLES = 25  # places along a line that may strike words
Place = tuple[float, float]


class WordBox(NamedTuple):
    """A rectangle, y downwards."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: WordBox) -> bool:
        """Return whether two boxes overlap; boxes that only touch do not."""
        return (
            self.left < other.right - ROUNDING and other.left < self.right - ROUNDING
            and self.top < other.bottom - ROUNDING and other.top < self.bottom - ROUNDING
        )  # fmt: skip

    def contains(self, other: WordBox) -> bool:
        """Return whether another box lies within this one."""
        return (
            self.left <= other.left + ROUNDING and other.right <= self.right + ROUNDING
            and self.top <= other.top + ROUNDING and other.bottom <= self.bottom + ROUNDING
        )  # fmt: skip


class WordField:
    """The cells of a rectangle with their costs; cell_size: width and height of one."""

    def __init__(self, box: WordBox, cell_size: tuple[float, float]) -> None:
        self.box, self.cell_size = box, cell_size
        rows, columns = (max(1, math.ceil(length / f)) for length, f in
                         ((box.bottom - box.top, cell_size[1]), (box.right - box.left, cell_size[0])))  # fmt: skip
        self.cost = np.zeros((rows, columns))
        self.occupied: list[WordBox] = []

    def add_curve(self, points: Array) -> None:
        """Add the cost of a line through points (n, 2)."""
        if len(points) < 2 or not np.isfinite(points).all():
            return
        cell_places = (points - (self.box.left, self.box.top)) / self.cell_size
        length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(cell_places, axis=0)).max(axis=1))])
        samples = np.linspace(0.0, length[-1], min(math.ceil(2.0 * length[-1]) + 1, 100_000))
        column, row = (np.floor(np.interp(samples, length, cell_places[:, k])).astype(np.intp) for k in (0, 1))
        rows, columns = self.cost.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        row, column = row[inside], column[inside]
        self.cost[row, column] = np.maximum(self.cost[row, column], CURVE_COST)

    def add_area(self, corners: Array) -> None:
        """Add the cost of an upright rectangle with corners (n, 2)."""
        (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
        self._select_cells(WordBox(left, top, right, bottom))[:] = CURVE_COST

    def is_struck(self, begin: Place, end: Place, except_boxes: Sequence[WordBox]) -> bool:
        """Return whether a line between two places crosses words or marks other than `except_boxes`."""
        x, y = (np.linspace(a, b, N_SAMPLES) for a, b in zip(begin, end, strict=True))
        others = [box for box in self.occupied if box not in except_boxes and not box.contains(WordBox(*begin, *begin))]
        return any(bool(((x > box.left) & (x < box.right) & (y > box.top) & (y < box.bottom)).any()) for box in others)

    def occupy(self, box: WordBox) -> None:
        """Occupy a box with words or a mark."""
        self.occupied.append(box)

    def occupy_best(self, candidates: Iterable[tuple[float, WordBox]]) -> WordBox | None:
        """Occupy the candidate box with the lowest total cost and return it; None if there is no room.

        candidates: each with its own cost
        """
        best_box, lowest_cost = None, math.inf
        for own_cost, box in candidates:
            if (
                own_cost >= lowest_cost
                or not self.box.contains(box)
                or any(box.overlaps(other) for other in self.occupied)
            ):
                continue
            cost = own_cost + float(self._select_cells(box).sum())
            if cost < lowest_cost:
                best_box, lowest_cost = box, cost
        if best_box is not None:
            self.occupy(best_box)
        return best_box

    def occupy_near(self, mark: WordBox, width: float, height: float, *, is_centred: bool = False) -> WordBox | None:
        """Occupy a box of a size near a mark and return it; None if there is no room.

        is_centred: whether a place in the middle above it is better than one beside it, as for a bar
        """
        return self.occupy_best(self._iter_candidate_boxes(mark, width, height, is_centred))

    def _iter_candidate_boxes(
        self, mark: WordBox, width: float, height: float, is_centred: bool
    ) -> Iterator[tuple[float, WordBox]]:
        """Yield boxes about a mark after their costs: above, below, to its right and left, then farther away."""
        middle = 0.5 * (mark.top + mark.bottom - height)
        centred = 0.5 * (mark.left + mark.right - width)
        centred = max(min(centred, self.box.right - width), self.box.left)
        sides = (centred, mark.right, mark.left - width) if is_centred else (mark.right, mark.left - width, centred)
        for line in range(MAX_LINES):
            cost = COST_PER_LINE * line
            for top in (mark.top - height * (line + 1), mark.bottom + height * line):
                for left in sides:
                    yield cost, WordBox(left, top, left + width, top + height)
            if not line:
                for left in (mark.right, mark.left - width):
                    yield cost, WordBox(left, middle, left + width, middle + height)

    def _select_cells(self, box: WordBox) -> Array:
        (left, right), (top, bottom) = (
            (max(0, math.floor((low - origin) / f + 1e-9)), max(0, math.ceil((high - origin) / f - 1e-9)))
            for low, high, origin, f in (
                (box.left, box.right, self.box.left, self.cell_size[0]),
                (box.top, box.bottom, self.box.top, self.cell_size[1]),
            )
        )
        return self.cost[top:bottom, left:right]


def count_columns(text: str) -> int:
    """Return the number of cells that a text takes in a terminal: two for a wide letter, none for a combining one."""
    if text.isascii():
        return len(text)
    import unicodedata  # rarely needed

    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def make_omitted_note(omitted: Iterable[str], max_texts: int = 12) -> list[str]:
    """Return a note on the words that found no room, if there are any."""
    distinct = list(dict.fromkeys(omitted))
    if not distinct:
        return []
    hidden_text = f"; and {len(distinct) - max_texts} more" if len(distinct) > max_texts else ""
    return [f"labels omitted for lack of space: {'; '.join(distinct[:max_texts])}{hidden_text}"]
