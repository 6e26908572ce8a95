"""Place the names of lines: next to one of their points, preferably at an end, without covering other names.

A name that finds no such place stands to the right of the field, with a thin line to its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from heuncli.base.named_tuples import NamedTuple

# relative to the letter size: mean width in a bold sans-serif font, line height
WIDTH_FACTOR, HEIGHT_FACTOR = (0.7, 1.15)
GAP = 8.0  # between a point and its name
ON_MARK, ON_LINE = 10.0, 3.0  # costs of covering a marker, or a line
FROM_END = 1.0  # cost of each point away from the end of its line
MAX_COST = 12.0  # a more expensive place is not used
CROWDING_COST, CROWDING_DISTANCE = 4.0, 16.0  # cost of each point of another line within this distance
BORDER_GAP = 12.0  # between the field and the names beside it


class LabelBox(NamedTuple):
    """A rectangle in pixels: left, top, right, bottom."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: LabelBox) -> bool:
        """Return whether two rectangles overlap."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )

    def expand(self, margin: float) -> LabelBox:
        """Return the rectangle with a margin [pixels] at each side."""
        return LabelBox(self.left - margin, self.top - margin, self.right + margin, self.bottom + margin)

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point lies inside."""
        return self.left < x < self.right and self.top < y < self.bottom


class PlacedLabel(NamedTuple):
    """A name in its box.

    anchor: the point of its line that it is joined with, if it stands outside the field
    """

    text: str
    box: LabelBox
    anchor: tuple[float, float] | None = None


Points = Sequence[tuple[float, float]]


def estimate_width(text: str, size: float) -> float:
    """Estimate the width of a text [pixels]."""
    return WIDTH_FACTOR * size * len(text)


def place_labels(
    lines: Sequence[tuple[str, Points]], field: LabelBox, size: float, occupied: Sequence[LabelBox] = ()
) -> list[PlacedLabel]:
    """Place a name for each line of points, within the field or to its right.

    occupied: boxes that are already in use
    """
    labels: list[PlacedLabel] = []
    unplaced: list[tuple[str, tuple[float, float]]] = []
    for text, points in lines:
        blocked = [*occupied, *(label.box for label in labels)]
        # the name must clearly belong to its line; it does best at an end
        point_costs = [
            crowding_cost(p, text, lines) + FROM_END * min(len(points) - 1 - k, k) for k, p in enumerate(points)
        ]
        free_boxes = [
            (k, box) for k, box in iter_candidates(text, points, size)
            if is_inside(box, field) and not any(box.overlaps(other) for other in blocked)
        ]  # fmt: skip
        best = min(
            ((point_costs[k] + placement_cost(box, lines), n, box) for n, (k, box) in enumerate(free_boxes)),
            default=None,
        )
        if best is None or best[0] > MAX_COST:
            unplaced.append((text, points[-1]))
        else:
            labels.append(PlacedLabel(text, best[2]))
    return [*labels, *place_at_border(unplaced, field, size)]


def iter_candidates(text: str, points: Points, size: float) -> Iterable[tuple[int, LabelBox]]:
    """Yield boxes for a name, and the index of the point that each is next to; ends first."""
    w, h = estimate_width(text, size), HEIGHT_FACTOR * size
    for k in sorted(range(len(points)), key=lambda i: min(2 * (len(points) - 1 - i), 2 * i + 1)):
        x, y = points[k]
        for left, top in (
            (x + GAP, y - h / 2), (x - GAP - w, y - h / 2), (x - w / 2, y - GAP - h), (x - w / 2, y + GAP),
            (x + GAP, y - h - 2), (x + GAP, y + 2), (x - GAP - w, y - h - 2), (x - GAP - w, y + 2),
        ):  # fmt: skip
            yield k, LabelBox(left, top, left + w, top + h)


def is_inside(box: LabelBox, field: LabelBox) -> bool:
    """Return whether a box lies in the field."""
    return field.left <= box.left and box.right <= field.right and field.top <= box.top and box.bottom <= field.bottom


def crowding_cost(point: tuple[float, float], line_name: str, lines: Sequence[tuple[str, Points]]) -> float:
    """Return the cost of a point with points of other lines nearby."""
    x, y = point
    close = LabelBox(x - CROWDING_DISTANCE, y - CROWDING_DISTANCE, x + CROWDING_DISTANCE, y + CROWDING_DISTANCE)
    return CROWDING_COST * sum(
        close.contains(*other) for text, points in lines if text != line_name for other in points
    )


def placement_cost(box: LabelBox, lines: Sequence[tuple[str, Points]]) -> float:
    """Return the cost of a box: markers and lines beneath it."""
    total = 0.0
    wider = box.expand(GAP - 3.0)
    for _, points in lines:
        total += ON_MARK * sum(wider.contains(x, y) for x, y in points)
        total += ON_LINE * sum(crosses(box, a, b) for a, b in pairwise(points) if may_cross(box, a, b))
    return total


def may_cross(box: LabelBox, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Return whether the line between two points may pass through a box: it does not lie entirely on one side of it."""
    return (
        min(a[0], b[0]) < box.right and max(a[0], b[0]) > box.left
        and min(a[1], b[1]) < box.bottom and max(a[1], b[1]) > box.top
    )  # fmt: skip


def crosses(box: LabelBox, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Return whether a line between two points passes through a box: whether a part remains after clipping at its four
    sides.
    """
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


def place_at_border(
    unplaced: Sequence[tuple[str, tuple[float, float]]], field: LabelBox, size: float
) -> list[PlacedLabel]:
    """Place names to the right of the field, in the order of their points from above, each near its own."""
    h, labels = HEIGHT_FACTOR * size, []
    order = sorted(unplaced, key=lambda one: one[1][1])
    bottom = field.bottom - h * len(order)
    top = field.top
    for text, point in order:
        top = min(max(top, point[1] - h / 2), bottom)
        x = field.right + BORDER_GAP
        labels.append(PlacedLabel(text, LabelBox(x, top, x + estimate_width(text, size), top + h), point))
        top, bottom = top + h, bottom + h
    return labels
