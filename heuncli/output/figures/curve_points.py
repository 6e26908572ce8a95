"""The points of curves: those of a long course that can be seen, measured ones, and whether a band of errors shows.

Of a long course each short interval shows its minimum, its maximum, and its gaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Item, Scaling, Spot, Trace
from heuncli.output.drawing.style import PANEL_HEIGHT
from heuncli.results.results import Array

N_INTERVALS = 1500  # nearly two a pixel of a panel
MIN_HALF_WIDTH = 0.5  # pixels: half width of a band
MAX_SPOTS = 150  # more points are drawn as a line


def find_visible_points(values: Array, n_intervals: int = N_INTERVALS) -> NDArray[np.intp]:
    """Return the indices (m,) of values (n,), ascending, that a figure shows; all of them if they are few."""
    count = len(values)
    if count <= 4 * n_intervals:
        return np.arange(count)
    n_per_interval = -(-count // n_intervals)
    places = np.minimum(np.arange(n_intervals * n_per_interval), count - 1).reshape(n_intervals, n_per_interval)
    parts = values[places]
    unknown = np.isnan(parts)
    rows = np.arange(n_intervals)
    chosen = [
        places[rows, np.where(unknown, np.inf, parts).argmin(axis=1)],
        places[rows, np.where(unknown, -np.inf, parts).argmax(axis=1)],
        places[rows, unknown.argmax(axis=1)],  # a gap, else the first
        places[-1:, -1],
    ]
    return np.unique(np.concatenate(chosen))


def is_visible(error: float, y: Scaling, height: float = PANEL_HEIGHT) -> bool:
    """Return whether an error is visible on a vertical axis of a height [pixels]; error and axis have the same unit."""
    return math.isfinite(error) and error * height > MIN_HALF_WIDTH * (y.high - y.low)


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
