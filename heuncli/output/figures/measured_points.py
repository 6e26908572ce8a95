"""Draw measured points in a history: squares, or if there are many a line through all their peaks."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Item, Spot, Trace
from heuncli.output.figures.thinning import find_visible_points
from heuncli.results.results import Array

MAX_SPOTS = 150  # more points are drawn as a line


class MeasuredPoints(NamedTuple):
    """Measured points (n,), in SI units of the axes of a panel.

    unit: SI unit of y
    """

    name: str
    unit: str
    x: Array
    y: Array


def draw_points(points: MeasuredPoints, pen: int, size_x: float, size_y: float) -> Iterator[Item]:
    """Draw squares, or if there are many a thin line through them.

    size_x, size_y: factors from SI to the display units
    """
    x, y = size_x * points.x, size_y * points.y
    if len(x) <= MAX_SPOTS:
        for a, b in zip(x.tolist(), y.tolist(), strict=True):
            yield Spot(a, b, "", pen, "square")
        return
    visible = find_visible_points(y)
    yield Trace(points.name, x[visible], y[visible], pen, is_thin=True)
