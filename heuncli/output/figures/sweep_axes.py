"""The axes of the variables and of the measures of a sweep, and the contours of a field of cells over two of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import choose_ends, choose_ticks, is_zero_near
from heuncli.output.drawing.figure import Cells, Item, Scaling, Strokes, Words
from heuncli.output.figures.sweep_tables import SweepVariable
from heuncli.results.results import Array

MAX_LETTERS, MAX_NAMES = 100, 12  # of names below an axis; more names are numbered
EVEN_TOLERANCE = 1e-6  # relative difference of equal steps
MIN_LEVELS = 4  # values along each axis; a smaller field has no contours
MAX_CONTOURS = 6


class VariableAxis(NamedTuple):
    """A variable along an axis, and a note that lists its names if the axis shows numbers in their place."""

    variable: SweepVariable
    scaling: Scaling
    note: str


def make_axis(variable: SweepVariable, *, cells: bool = False) -> VariableAxis:
    """Make the axis of a variable; cells: each of its values has a cell."""
    levels = variable.levels
    if variable.texts:
        names = [variable.texts[int(k)] for k in levels]
        numbered = len(names) > MAX_NAMES or sum(map(len, names)) > MAX_LETTERS
        tick_texts = [str(k + 1) for k in range(len(names))] if numbered else names
        scaling = Scaling(
            variable.name, float(levels[0]) - 0.5, float(levels[-1]) + 0.5,
            tick_texts=tuple(zip(levels.tolist(), tick_texts, strict=True)),
        )  # fmt: skip
        pairs = ", ".join(f"{k} {name}" for k, name in zip(tick_texts, names, strict=True))
        return VariableAxis(variable, scaling, f"{variable.name}: {pairs}" if numbered else "")
    by_ratio = _is_logarithmic(levels)
    if cells:
        edges = _find_edges(levels, by_ratio)
        return VariableAxis(variable, Scaling(variable.axis_label, float(edges[0]), float(edges[-1]), by_ratio), "")
    if by_ratio:
        return VariableAxis(
            variable, Scaling(variable.axis_label, float(levels[0]), float(levels[-1]), is_logarithmic=True), ""
        )
    return VariableAxis(
        variable, Scaling(variable.axis_label, *choose_ends(float(levels[0]), float(levels[-1]), margin=0.03)), ""
    )


def _is_logarithmic(levels: Array) -> bool:
    """Return whether the logarithms of the values are evenly spaced, but not the values."""
    if len(levels) < 3 or levels[0] <= 0.0:
        return False
    steps, ratios = np.diff(levels), np.diff(np.log(levels))
    return bool(np.ptp(ratios) <= EVEN_TOLERANCE * ratios.max() and np.ptp(steps) > EVEN_TOLERANCE * steps.max())


def _find_edges(levels: Array, by_ratio: bool) -> Array:
    """Return the edges of the cells of values, (n + 1,): half way between neighbours."""
    positions = np.log(levels) if by_ratio else levels
    middle = 0.5 * (positions[1:] + positions[:-1])
    edges = np.concatenate([[2.0 * positions[0] - middle[0]], middle, [2.0 * positions[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if by_ratio else edges)


def find_cell_edges(variable: SweepVariable, scaling: Scaling) -> Array:
    """Return the edges of the cells of a variable along its axis."""
    if variable.texts:
        return np.asarray(np.arange(len(variable.levels) + 1) + scaling.low)
    return _find_edges(variable.levels, scaling.is_logarithmic)


def make_measure_axis(unit: str, values: Array, errors: Array, spare: float = 0.12) -> Scaling:
    """Make the axis of a measure."""
    known = np.isfinite(values)
    low = float((values - errors)[known].min()) if known.any() else 0.0
    high = float((values + errors)[known].max()) if known.any() else 1.0
    return Scaling(f"[{unit or '-'}]", *choose_ends(low, high, zero=is_zero_near(low, high), margin=spare))


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
