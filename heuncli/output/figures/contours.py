"""Contour lines of a field of a sweep, through the values of its cells (marching squares)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.output.drawing.figure import Cells, Item, Scaling, Strokes, Words
from heuncli.output.drawing.ticks import choose_ticks
from heuncli.results.results import Array

MIN_LEVELS = 4  # values along each axis; a smaller field has no contours
MAX_CONTOURS = 6


def draw_contours(cells: Cells, x: Array, y: Array) -> Iterator[Item]:
    """Draw contours at round values, each with its value at its middle.

    x, y: the places of the values, the middles of the cells
    """
    values = cells.values
    known = values[np.isfinite(values)]
    if min(values.shape) < MIN_LEVELS or not known.size or not known.max() > known.min():
        return
    for level, text in choose_ticks(Scaling("", float(known.min()), float(known.max())), MAX_CONTOURS):
        squares = [(i, j) for j in range(len(y) - 1) for i in range(len(x) - 1)]
        ends = [stroke for i, j in squares for stroke in _cross(values, x, y, i, j, level)]
        if ends:
            strokes = np.array(ends)
            yield Strokes(strokes, width=1.0)
            middle = strokes[np.argsort(strokes[:, 0, 0], kind="stable")[len(strokes) // 2]].mean(axis=0)
            yield Words(float(middle[0]), float(middle[1]), text)


def _cross(values: Array, x: Array, y: Array, i: int, j: int, level: float) -> list[list[tuple[float, float]]]:
    """Return the strokes of a contour in the square between four values; of a saddle the two that part its corners."""
    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    heights = [float(values[b, a]) - level for a, b in corners]
    if not np.isfinite(heights).all():
        return []
    points = []
    for k in range(4):
        (a, b), (c, d), p, q = corners[k], corners[(k + 1) % 4], heights[k], heights[(k + 1) % 4]
        if (p >= 0.0) != (q >= 0.0):
            share = p / (p - q)
            points.append((float(x[a] + share * (x[c] - x[a])), float(y[b] + share * (y[d] - y[b]))))
    return [points[k : k + 2] for k in range(0, len(points), 2)]
