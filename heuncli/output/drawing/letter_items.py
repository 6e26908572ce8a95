"""What the items of a panel become in the cells of a terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.foreign_text import shown
from heuncli.output.drawing.canvas import DOWN, NOBODY, Canvas, Look
from heuncli.output.drawing.figure import (
    Arrow,
    Band,
    Bars,
    Blank,
    Cells,
    Item,
    Link,
    PlaceLabel,
    Polygon,
    Scaling,
    Spot,
    Strokes,
    Symbol,
    Trace,
    Upright,
    Words,
)
from heuncli.output.drawing.pens import pen
from heuncli.output.drawing.room import columns_of
from heuncli.output.drawing.symbols import SYMBOLS, SymbolPart, link
from heuncli.results.results import Array

DOT = 4.0  # pixels that a dot stands for where symbols are drawn in dots
APART = 3.0  # columns between upright strokes that belong together
SHADES = "·░▒▓█"  # what is not known is blank
PLAIN_SHADES = ".:*#@"


def mark_of(shape: str, look: Look, number: int) -> str:
    """How a marked place is told; points that belong together by the letter of their pen, where no colour tells."""
    if shape != "circle" and number >= 0:
        return "+" if look.colours else pen(number).letter
    return "•" if look.braille else "o"


def _course(canvas: Canvas, x: Array, y: Array, number: int, every: int = 1) -> None:
    """The dots of a line through points."""
    points = [(canvas.x(a), canvas.y(b)) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    for x0, y0 in points if len(points) == 1 or not np.isfinite(y).all() else ():  # some may stand alone
        if math.isfinite(x0 + y0):
            canvas.dot(x0, y0, number)
    for (x0, y0), (x1, y1) in pairwise(points):
        if math.isfinite(x0 + y0 + x1 + y1):
            canvas.line(x0, y0, x1, y1, number, every)


def _trace(item: Trace, canvas: Canvas) -> None:
    _course(canvas, item.x, item.y, item.pen, 2 if item.thin and canvas.look.braille else 1)


def _band(item: Band, canvas: Canvas) -> None:
    for edge in (item.low, item.high):
        _course(canvas, item.x, edge, item.pen, 3 if canvas.look.braille else 2)


def _strokes(item: Strokes, canvas: Canvas) -> None:
    """Of ordinates, which stand upright, only so many that what lies between them can be seen.

    Where curves are letters strokes are dots.
    """
    last = -math.inf
    number = NOBODY if item.pen is None or not canvas.look.braille else item.pen
    for (x0, y0), (x1, y1) in item.ends.tolist():
        if x0 == x1:
            column = canvas.x(x0) / canvas.per_x
            if abs(column - last) < APART:
                continue
            last = column
        canvas.line(canvas.x(x0), canvas.y(y0), canvas.x(x1), canvas.y(y1), number)


def _polygon(item: Polygon, canvas: Canvas) -> None:
    if not item.outlined:
        return
    around = np.concatenate([item.corners, item.corners[:1]])
    _course(canvas, around[:, 0], around[:, 1], NOBODY if item.pen is None else item.pen)


def _arrow(item: Arrow, canvas: Canvas) -> None:
    number = NOBODY if item.pen is None else item.pen
    x, y = canvas.x(item.x + item.by_x), canvas.y(item.y + item.by_y)
    canvas.line(canvas.x(item.x), canvas.y(item.y), x, y, number)
    if item.name:
        canvas.write(shown(item.name), round(x) // canvas.per_x + 1, round(y) // canvas.per_y)


def _spot(item: Spot, canvas: Canvas) -> None:
    number = NOBODY if item.pen is None else item.pen
    column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
    canvas.write(mark_of(item.shape, canvas.look, number), column, row, number)


def _word(item: Words, canvas: Canvas) -> None:
    column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
    text = shown(item.text if canvas.look.braille else item.text.replace("\N{MINUS SIGN}", "-"))
    canvas.write(text, column - columns_of(text) // 2, row)


def _symbol(item: Symbol, canvas: Canvas) -> None:
    x, y = canvas.x(item.x), canvas.y(item.y)
    shown_as = SYMBOLS[item.symbol]
    letter = shown_as.letter if canvas.look.braille else shown_as.plain
    if letter:
        canvas.write(
            letter, round(x) // canvas.per_x, round(y) // canvas.per_y, NOBODY if item.pen is None else item.pen
        )
    elif canvas.look.braille:
        along = canvas.x(item.along[0]) - canvas.x(0.0), canvas.y(item.along[1]) - canvas.y(0.0)
        _parts(shown_as.parts, x, y, along, item.pen, canvas)


def _link(item: Link, canvas: Canvas) -> None:
    x, y = canvas.x(item.x), canvas.y(item.y)
    along = canvas.x(item.to_x) - x, canvas.y(item.to_y) - y
    if canvas.look.braille:
        _parts(link(item.kind, DOT * math.hypot(*along)), x, y, along, item.pen, canvas)
    else:
        canvas.line(x, y, x + along[0], y + along[1], NOBODY if item.pen is None else item.pen)


def _parts(
    parts: Sequence[SymbolPart], x: float, y: float, along: tuple[float, float], number: int | None, canvas: Canvas
) -> None:
    """The parts of a symbol about a dot, its x along a way in dots."""
    length = math.hypot(*along)
    a, b = (along[0] / length, along[1] / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        points = [(x + (p * a + q * b) / DOT, y + (p * b - q * a) / DOT) for p, q in part.points]
        for (x0, y0), (x1, y1) in pairwise([*points, *points[: part.closed]]):
            canvas.line(x0, y0, x1, y1, NOBODY if number is None else number)


def _label(item: PlaceLabel, canvas: Canvas) -> None:
    """Placed when all else is (letters.py)."""


def _upright(item: Upright, canvas: Canvas) -> None:
    x = canvas.x(item.x)
    canvas.line(x, 0.0, x, canvas.rows * canvas.per_y - 1.0, NOBODY, DOWN if canvas.look.braille else 1)


def _blank(item: Blank, canvas: Canvas) -> None:
    left, right = (round(canvas.x(x)) // canvas.per_x for x in (item.low, item.high))
    text = f" {shown(item.text)} "
    if item.text and len(text) <= right - left + 1:
        canvas.write(text, (left + right + 1 - len(text)) // 2, canvas.rows // 3)
    for row in range(canvas.rows):
        for column in range(max(left, 0), min(right + 1, canvas.columns)):
            canvas.dots[row, column] = 0
            if (row + column) % 3 == 0:
                canvas.write("/", column, row)


def _bars(item: Bars, canvas: Canvas) -> None:
    for x, y in zip(item.x.tolist(), item.y.tolist(), strict=True):
        if math.isfinite(y):
            for k in range(-1, 2):
                canvas.line(canvas.x(x) + k, canvas.y(0.0), canvas.x(x) + k, canvas.y(y), item.pen)


def _cells(item: Cells, canvas: Canvas) -> None:
    known = item.values[np.isfinite(item.values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    shades = SHADES if canvas.look.braille else PLAIN_SHADES
    for row in range(canvas.rows):
        for column in range(canvas.columns):
            i, j = (
                _cell_at(item.x_edges, column / canvas.columns, canvas.across),
                _cell_at(item.y_edges, 1.0 - row / canvas.rows, canvas.up),
            )
            value = float(item.values[j, i])
            if math.isfinite(value):
                share = (value - low) / (high - low) if high > low else 0.5
                canvas.words.setdefault((row, column), (shades[round(share * (len(shades) - 1))], NOBODY))


def _cell_at(edges: Array, share: float, scaling: Scaling) -> int:
    """The cell at a share of an axis."""
    shares: Sequence[float] = [scaling.at(edge) for edge in edges.tolist()]
    return min(max(int(np.searchsorted(shares, share, side="right")) - 1, 0), len(edges) - 2)


DRAWN: dict[type[Item], Callable[[Any, Canvas], None]] = {
    Trace: _trace, Band: _band, Strokes: _strokes, Polygon: _polygon, Arrow: _arrow, Spot: _spot, Words: _word,
    Symbol: _symbol, Link: _link, PlaceLabel: _label, Upright: _upright, Blank: _blank, Bars: _bars, Cells: _cells,
}  # fmt: skip
