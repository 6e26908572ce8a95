"""Measured points over a history: squares, or where there are many a line through all their peaks."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Item, Spot, Trace
from heuncli.output.figures.thinning import seen_places
from heuncli.results.results import Array

MOST_SPOTS = 150  # points that are told apart; more are drawn as a line


class MeasuredPoints(NamedTuple):
    """Points that were measured, (n,): over what a panel shows, in SI, and of which unit."""

    name: str
    unit: str
    x: Array
    y: Array


def seen(points: MeasuredPoints, pen: int, size_x: float, size_y: float) -> Iterator[Item]:
    """Squares, or where there are many a thin line through them; sizes: from SI to the units that are shown."""
    x, y = size_x * points.x, size_y * points.y
    if len(x) <= MOST_SPOTS:
        for a, b in zip(x.tolist(), y.tolist(), strict=True):
            yield Spot(a, b, "", pen, "square")
        return
    kept = seen_places(y)
    yield Trace(points.name, x[kept], y[kept], pen, thin=True)
