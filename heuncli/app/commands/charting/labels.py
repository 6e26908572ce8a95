"""Where the names of lines stand: beside one of their points, first at an end, over no other name.

A name that finds no such room stands beside the field, with a thin line to its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from heuncli.base.named_tuples import NamedTuple

WIDE, HIGH = 0.7, 1.15  # of the size of letters: the mean width of one of a sans-serif font, bold; and a line's height
GAP = 8.0  # between a point and its name
ON_MARK, ON_LINE = 10.0, 3.0  # what it costs to stand over a marker, or over a line
FROM_END = 1.0  # a point farther from the end of its line
MOST_COST = 12.0  # a place that costs more is none
CROWDED, CLOSE = 4.0, 16.0  # each other line's point so close to that which is named: whose name it is would be unclear
ASIDE = 12.0  # between the field and the names beside it


class LabelBox(NamedTuple):
    """A rectangle: left, top, right, bottom."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: LabelBox) -> bool:
        """Whether two of them overlap."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )

    def wider(self, by: float) -> LabelBox:
        """The rectangle with a margin [pixels] at each side."""
        return LabelBox(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def holds(self, x: float, y: float) -> bool:
        """Whether a point lies in it."""
        return self.left < x < self.right and self.top < y < self.bottom


class Label(NamedTuple):
    """A name in its box; to: the point of its line that it is joined with, if it stands apart."""

    text: str
    box: LabelBox
    to: tuple[float, float] | None = None


Points = Sequence[tuple[float, float]]


def wide(text: str, size: float) -> float:
    """About how wide a text is."""
    return WIDE * size * len(text)


def placed(
    lines: Sequence[tuple[str, Points]], field: LabelBox, size: float, taken: Sequence[LabelBox] = ()
) -> list[Label]:
    """A name for each line of points, within the field or at its right; taken: where something stands already."""
    found: list[Label] = []
    aside: list[tuple[str, tuple[float, float]]] = []
    for text, points in lines:
        full = [*taken, *(label.box for label in found)]
        # whose name it is must be clear, and the ends of a line name it best
        own = [crowded(p, text, lines) + FROM_END * min(len(points) - 1 - k, k) for k, p in enumerate(points)]
        free = [
            (k, box) for k, box in candidates(text, points, size)
            if inside(box, field) and not any(box.meets(other) for other in full)
        ]  # fmt: skip
        best = min(((own[k] + cost(box, lines), n, box) for n, (k, box) in enumerate(free)), default=None)
        if best is None or best[0] > MOST_COST:
            aside.append((text, points[-1]))
        else:
            found.append(Label(text, best[2]))
    return [*found, *beside(aside, field, size)]


def candidates(text: str, points: Points, size: float) -> Iterable[tuple[int, LabelBox]]:
    """Boxes for a name, and which of the points each is at; ends first."""
    w, h = wide(text, size), HIGH * size
    for k in sorted(range(len(points)), key=lambda i: min(2 * (len(points) - 1 - i), 2 * i + 1)):
        x, y = points[k]
        for left, top in (
            (x + GAP, y - h / 2), (x - GAP - w, y - h / 2), (x - w / 2, y - GAP - h), (x - w / 2, y + GAP),
            (x + GAP, y - h - 2), (x + GAP, y + 2), (x - GAP - w, y - h - 2), (x - GAP - w, y + 2),
        ):  # fmt: skip
            yield k, LabelBox(left, top, left + w, top + h)


def inside(box: LabelBox, field: LabelBox) -> bool:
    """Whether a box lies in the field."""
    return field.left <= box.left and box.right <= field.right and field.top <= box.top and box.bottom <= field.bottom


def crowded(point: tuple[float, float], own: str, lines: Sequence[tuple[str, Points]]) -> float:
    """What speaks against a point to stand at: points of other lines beside it."""
    x, y = point
    close = LabelBox(x - CLOSE, y - CLOSE, x + CLOSE, y + CLOSE)
    return CROWDED * sum(close.holds(*other) for text, points in lines if text != own for other in points)


def cost(box: LabelBox, lines: Sequence[tuple[str, Points]]) -> float:
    """What speaks against a place: markers and lines under it."""
    total = 0.0
    wider = box.wider(GAP - 3.0)
    for _, points in lines:
        total += ON_MARK * sum(wider.holds(x, y) for x, y in points)
        total += ON_LINE * sum(crosses(box, a, b) for a, b in pairwise(points) if may_cross(box, a, b))
    return total


def may_cross(box: LabelBox, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether the line between two points may pass through a box: it does not lie all on one side of it."""
    return (
        min(a[0], b[0]) < box.right and max(a[0], b[0]) > box.left
        and min(a[1], b[1]) < box.bottom and max(a[1], b[1]) > box.top
    )  # fmt: skip


def crosses(box: LabelBox, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether a line between two points passes through a box: what of it is left after cutting at its four sides."""
    first, last = 0.0, 1.0
    for start, change, low, high in (
        (a[0], b[0] - a[0], box.left, box.right), (a[1], b[1] - a[1], box.top, box.bottom),
    ):  # fmt: skip
        if change == 0.0:
            if not low < start < high:
                return False
            continue
        ends = sorted(((low - start) / change, (high - start) / change))
        first, last = max(first, ends[0]), min(last, ends[1])
    return first < last


def beside(left: Sequence[tuple[str, tuple[float, float]]], field: LabelBox, size: float) -> list[Label]:
    """Names at the right of the field, in the order of their points from above, each near its own."""
    h, found = HIGH * size, []
    order = sorted(left, key=lambda one: one[1][1])
    bottom = field.bottom - h * len(order)
    top = field.top
    for text, point in order:
        top = min(max(top, point[1] - h / 2), bottom)
        x = field.right + ASIDE
        found.append(Label(text, LabelBox(x, top, x + wide(text, size), top + h), point))
        top, bottom = top + h, bottom + h
    return found
