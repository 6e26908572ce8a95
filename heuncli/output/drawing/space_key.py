"""Lay out what stands below a view of a machine: axes, a scale bar, gravity, the arrows of loads, names of numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.text_safety import escape
from heuncli.output.drawing.figure import Figure, KeyArrow, Panel, SpaceKey
from heuncli.output.drawing.labels import estimate_width
from heuncli.output.drawing.shapes import Line, Shape, Text, draw_arrow
from heuncli.output.drawing.style import (
    BLACK,
    GREY,
    INDENT,
    LINE_HEIGHT,
    SMALL_SIZE,
    SYMBOL_WIDTH,
    find_colour,
)

MIN_WIDTH = 420.0  # pixels of a sheet, for its title and key
AXES_LENGTH, GRAVITY_LENGTH = 20.0, 26.0  # pixels of a unit vector
AXES_WIDTH, GRAVITY_WIDTH = 64.0, 42.0  # pixels of their places in the key
KEY_HEIGHT = 56.0  # pixels
GAP = 22.0  # pixels between the entries of the key
MAX_COLUMNS = 4  # of the names of numbers


def choose_sheet_width(figure: Figure, width: float) -> float:
    """Choose the width of the sheet: `width`, or, if a figure shows views of machines alone, what these need of it."""
    if not all(panel.key is not None for panel in figure.panels):
        return width
    needed = max(compute_view_width(panel, width) for panel in figure.panels) + 2.0 * INDENT
    return min(width, max(MIN_WIDTH, needed))


def compute_view_width(panel: Panel, width: float) -> float:
    """Compute the width of a view on a sheet of some width at most."""
    x_span, y_span = panel.x.high - panel.x.low, panel.y.high - panel.y.low
    return x_span * min((width - 2.0 * INDENT) / x_span, panel.height / y_span)


def lay_out_key(key: SpaceKey, pixels_per_unit: float, top: float, width: float) -> tuple[list[Shape], float]:
    """Return the shapes of a key below a height, and the y below them."""
    shapes, x = list(_draw_axes(key, INDENT, top)), INDENT + AXES_WIDTH
    if key.gravity is not None:
        a, b = (GRAVITY_LENGTH * part for part in key.gravity)
        middle_x, middle_y = x + 0.4 * GRAVITY_WIDTH, top + 0.5 * KEY_HEIGHT
        shapes += draw_arrow(middle_x - 0.5 * a, middle_y + 0.5 * b, a, -b, GREY, "gravity")
        shapes.append(Text(middle_x + 7.0, middle_y + 4.5, "g", SMALL_SIZE, colour=GREY))
        x += GRAVITY_WIDTH
    left, y = x, top + LINE_HEIGHT
    length, words = pixels_per_unit * key.bar[0], key.bar[1]
    shapes += _draw_bar(x, y, length, words)
    x += length + 6.0 + estimate_width(words, SMALL_SIZE) + GAP
    for arrow in key.arrows:
        own_length, text = pixels_per_unit * arrow.length, escape(arrow.text)
        own_width = own_length + 6.0 + estimate_width(text, SMALL_SIZE)
        if x > left and x + own_width > width - INDENT:
            x, y = left, y + LINE_HEIGHT
        shapes += _draw_key_arrow(arrow, x, y, own_length, text)
        x += own_width + GAP
    y = max(top + KEY_HEIGHT, y + LINE_HEIGHT)
    names = [f"{number}  {escape(text)}" for number, text in key.names]
    if not names:
        return shapes, y
    column_width = max(estimate_width(name, SMALL_SIZE) for name in names) + 0.5 * GAP
    columns = max(1, min(MAX_COLUMNS, int((width - 2.0 * INDENT + 0.5 * GAP) / column_width)))
    rows = math.ceil(len(names) / columns)
    step = (width - 2.0 * INDENT) / columns
    y += 0.5 * LINE_HEIGHT
    for k, name in enumerate(names):
        shapes.append(Text(INDENT + k // rows * step, y + k % rows * LINE_HEIGHT, name, SMALL_SIZE))
    return shapes, y + rows * LINE_HEIGHT


def _draw_axes(key: SpaceKey, left: float, top: float) -> Iterator[Shape]:
    """Draw the world's axes, those towards the viewer last; one along the line of sight has no arrow."""
    ends = [(AXES_LENGTH * a, -AXES_LENGTH * b, name) for name, a, b in key.axes]
    low_x, high_x = (f(0.0, *(a for a, _, _ in ends)) for f in (min, max))
    low_y, high_y = (f(0.0, *(b for _, b, _ in ends)) for f in (min, max))
    x = left + 0.5 * (AXES_WIDTH - 16.0) - 0.5 * (low_x + high_x)
    y = top + 0.5 * KEY_HEIGHT - 0.5 * (low_y + high_y)
    for a, b, name in ends:
        length = math.hypot(a, b)
        if length < 1.0:
            continue
        yield from draw_arrow(x, y, a, b, BLACK, f"axis: {name}")
        off = 7.0 / length
        yield Text(x + a * (1.0 + off), y + b * (1.0 + off) + 4.5, name, SMALL_SIZE, "middle")


def _draw_bar(x: float, y: float, length: float, words: str) -> Iterator[Shape]:
    """Draw a scale bar between two strokes, with its words."""
    for end in (x, x + length):
        yield Line(((end, y - 4.0), (end, y + 4.0)), BLACK, SYMBOL_WIDTH)
    yield Line(((x, y), (x + length, y)), BLACK, SYMBOL_WIDTH, name=f"scale bar: {words}")
    yield Text(x + length + 6.0, y + 4.5, words, SMALL_SIZE)


def _draw_key_arrow(arrow: KeyArrow, x: float, y: float, length: float, text: str) -> Iterator[Shape]:
    """Draw an arrow of a key with its words."""
    colour = find_colour(arrow.pen)
    yield from draw_arrow(x, y, length, 0.0, colour, text, is_double=arrow.is_double)
    yield Text(x + length + 6.0, y + 4.5, text, SMALL_SIZE, colour=colour)
