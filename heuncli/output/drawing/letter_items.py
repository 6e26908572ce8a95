"""Draw the items of a panel in the cells of a terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.text_safety import escape
from heuncli.output.drawing.canvas import DIM_PEN, DOT_ROWS, NO_PEN, Canvas, TerminalStyle
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
    VerticalMark,
    Words,
)
from heuncli.output.drawing.labels import count_columns
from heuncli.output.drawing.style import find_pen
from heuncli.output.drawing.symbols import SYMBOLS, SymbolPart, make_link
from heuncli.results.results import Array

PIXELS_PER_DOT = 4.0  # pixels of a symbol for a dot
FAINT_STRIDE = 4  # dots of a grid line
MIN_STROKE_DISTANCE = 3.0  # columns between ordinates
SHADES = "·░▒▓█"  # unknown cells are blank
PLAIN_SHADES = ".:*#@"


def choose_mark(shape: str, style: TerminalStyle, number: int) -> str:
    """Return the character of a marked place; points of one curve have the letter of their pen if there are no
    colours.
    """
    if shape not in ("", "circle") and number >= 0:
        return "+" if style.has_colours else find_pen(number).letter
    return "•" if style.has_braille else "o"


def _draw_course(canvas: Canvas, x: Array, y: Array, number: int, stride: int = 1) -> None:
    """Draw the dots of a line through points."""
    points = [(canvas.to_dot_x(a), canvas.to_dot_y(b)) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    for x0, y0 in points if len(points) == 1 or not np.isfinite(y).all() else ():  # isolated points
        if math.isfinite(x0 + y0):
            canvas.set_dot(x0, y0, number)
    for (x0, y0), (x1, y1) in pairwise(points):
        if math.isfinite(x0 + y0 + x1 + y1):
            canvas.draw_line(x0, y0, x1, y1, number, stride)


def _draw_trace(item: Trace, canvas: Canvas) -> None:
    _draw_course(canvas, item.x, item.y, item.pen, 2 if item.is_thin and canvas.style.has_braille else 1)


def _draw_band(item: Band, canvas: Canvas) -> None:
    for edge in (item.low, item.high):
        _draw_course(canvas, item.x, edge, item.pen, 3 if canvas.style.has_braille else 2)


def _draw_strokes(item: Strokes, canvas: Canvas) -> None:
    """Draw strokes; of vertical ordinates only so many that what lies between them is visible.

    If curves are letters, strokes are dots, and hatches are left out.
    """
    last = -math.inf
    number = NO_PEN if item.pen is None or not canvas.style.has_braille else item.pen
    if item.is_hatch:  # it hides the curve where it cannot be dim
        if not canvas.style.has_colours:
            return
        number = DIM_PEN
    for (x0, y0), (x1, y1) in item.ends.tolist():
        if x0 == x1:
            column = canvas.to_dot_x(x0) / canvas.per_x
            if abs(column - last) < MIN_STROKE_DISTANCE:
                continue
            last = column
        ends = canvas.to_dot_x(x0), canvas.to_dot_y(y0), canvas.to_dot_x(x1), canvas.to_dot_y(y1)
        canvas.draw_line(*ends, number, FAINT_STRIDE if item.is_faint else 1)


def _draw_polygon(item: Polygon, canvas: Canvas) -> None:
    if not item.has_outline:
        return
    outline = np.concatenate([item.corners, item.corners[:1]])
    _draw_course(canvas, outline[:, 0], outline[:, 1], NO_PEN if item.pen is None else item.pen)


def _draw_arrow(item: Arrow, canvas: Canvas) -> None:
    number = NO_PEN if item.pen is None else item.pen
    x, y = canvas.to_dot_x(item.x + item.by_x), canvas.to_dot_y(item.y + item.by_y)
    canvas.draw_line(canvas.to_dot_x(item.x), canvas.to_dot_y(item.y), x, y, number)
    if item.name:
        canvas.write(escape(item.name), round(x) // canvas.per_x + 1, round(y) // canvas.per_y)


def _draw_spot(item: Spot, canvas: Canvas) -> None:
    number = NO_PEN if item.pen is None else item.pen
    column, row = round(canvas.to_dot_x(item.x)) // canvas.per_x, round(canvas.to_dot_y(item.y)) // canvas.per_y
    canvas.write(choose_mark(item.shape, canvas.style, number), column, row, number)


def _draw_words(item: Words, canvas: Canvas) -> None:
    column, row = round(canvas.to_dot_x(item.x)) // canvas.per_x, round(canvas.to_dot_y(item.y)) // canvas.per_y
    text = escape(item.text)
    canvas.write(text, column - count_columns(text) // 2, row)


def _draw_symbol(item: Symbol, canvas: Canvas) -> None:
    x, y = canvas.to_dot_x(item.x), canvas.to_dot_y(item.y)
    symbol = SYMBOLS[item.symbol]
    letter = symbol.letter if canvas.style.has_braille else symbol.plain
    if letter:
        canvas.write(
            letter, round(x) // canvas.per_x, round(y) // canvas.per_y, NO_PEN if item.pen is None else item.pen
        )
    elif canvas.style.has_braille:
        direction = (
            canvas.to_dot_x(item.direction[0]) - canvas.to_dot_x(0.0),
            canvas.to_dot_y(item.direction[1]) - canvas.to_dot_y(0.0),
        )
        _draw_parts(symbol.parts, x, y, direction, item.pen, canvas)


def _draw_link(item: Link, canvas: Canvas) -> None:
    x, y = canvas.to_dot_x(item.x), canvas.to_dot_y(item.y)
    difference = canvas.to_dot_x(item.to_x) - x, canvas.to_dot_y(item.to_y) - y
    if canvas.style.has_braille:
        _draw_parts(make_link(item.kind, PIXELS_PER_DOT * math.hypot(*difference)), x, y, difference, item.pen, canvas)
    else:
        canvas.draw_line(x, y, x + difference[0], y + difference[1], NO_PEN if item.pen is None else item.pen)


def _draw_parts(
    parts: Sequence[SymbolPart], x: float, y: float, direction: tuple[float, float], number: int | None, canvas: Canvas
) -> None:
    """Draw the parts of a symbol at a dot; direction: of its x axis, in dots."""
    length = math.hypot(*direction)
    a, b = (direction[0] / length, direction[1] / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        points = [(x + (p * a + q * b) / PIXELS_PER_DOT, y + (p * b - q * a) / PIXELS_PER_DOT) for p, q in part.points]
        for (x0, y0), (x1, y1) in pairwise([*points, *points[: part.is_closed]]):
            canvas.draw_line(x0, y0, x1, y1, NO_PEN if number is None else number)


def _skip_label(item: PlaceLabel, canvas: Canvas) -> None:
    """Labels are placed after all other items (letters.py)."""


def _draw_vertical_mark(item: VerticalMark, canvas: Canvas) -> None:
    x = canvas.to_dot_x(item.x)
    canvas.draw_line(x, 0.0, x, canvas.rows * canvas.per_y - 1.0, NO_PEN, DOT_ROWS if canvas.style.has_braille else 1)


def _draw_blank(item: Blank, canvas: Canvas) -> None:
    left, right = (round(canvas.to_dot_x(x)) // canvas.per_x for x in (item.low, item.high))
    text = f" {escape(item.text)} "
    if item.text and len(text) <= right - left + 1:
        canvas.write(text, (left + right + 1 - len(text)) // 2, canvas.rows // 3)
    for row in range(canvas.rows):
        for column in range(max(left, 0), min(right + 1, canvas.columns)):
            canvas.dots[row, column] = 0
            if (row + column) % 3 == 0:
                canvas.write("/", column, row)


def _draw_bars(item: Bars, canvas: Canvas) -> None:
    for x, y in zip(item.x.tolist(), item.y.tolist(), strict=True):
        if math.isfinite(y):
            for k in range(-1, 2):
                canvas.draw_line(
                    canvas.to_dot_x(x) + k, canvas.to_dot_y(0.0), canvas.to_dot_x(x) + k, canvas.to_dot_y(y), item.pen
                )


def _draw_cells(item: Cells, canvas: Canvas) -> None:
    shares, shades = item.find_shares(), SHADES if canvas.style.has_braille else PLAIN_SHADES
    for row in range(canvas.rows):
        for column in range(canvas.columns):
            i, j = (
                _find_cell(item.x_edges, column / canvas.columns, canvas.x_scaling),
                _find_cell(item.y_edges, 1.0 - row / canvas.rows, canvas.y_scaling),
            )
            share = float(shares[j, i])
            if math.isfinite(share):
                canvas.words.setdefault((row, column), (shades[round(share * (len(shades) - 1))], NO_PEN))


def _find_cell(edges: Array, share: float, scaling: Scaling) -> int:
    """Return the index of the cell at a share of an axis."""
    shares: Sequence[float] = [scaling.to_share(edge) for edge in edges.tolist()]
    return min(max(int(np.searchsorted(shares, share, side="right")) - 1, 0), len(edges) - 2)


DRAW_FUNCTIONS: dict[type[Item], Callable[[Any, Canvas], None]] = {
    Trace: _draw_trace,
    Band: _draw_band,
    Strokes: _draw_strokes,
    Polygon: _draw_polygon,
    Arrow: _draw_arrow,
    Spot: _draw_spot,
    Words: _draw_words,
    Symbol: _draw_symbol,
    Link: _draw_link,
    PlaceLabel: _skip_label,
    VerticalMark: _draw_vertical_mark,
    Blank: _draw_blank,
    Bars: _draw_bars,
    Cells: _draw_cells,
}
