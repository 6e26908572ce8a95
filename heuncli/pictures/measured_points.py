"""Measured points over a history: squares, or where there are many a line through all their peaks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.drawing.figure import Item, Spot, Trace
from heuncli.named_tuples import NamedTuple
from heuncli.results import Array

MOST_SPOTS = 150  # points that are told apart; more are drawn as a line
SEEN = 1000  # stretches of a long line, in each of which its least and its greatest are drawn


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
    if len(x) > 2 * SEEN:
        parts = np.array_split(np.arange(len(y)), SEEN)
        ends = [(part[np.argmin(y[part])], part[np.argmax(y[part])]) for part in parts]
        kept = np.unique(np.array(ends))
        x, y = x[kept], y[kept]
    yield Trace(points.name, x, y, pen, thin=True)
