"""Draw the items of a panel as shapes in pixels: curves, bands, arrows, marks, symbols, bars, fields."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.axes import PanelBox
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
    Spot,
    Strokes,
    Symbol,
    Trace,
    VerticalMark,
    Words,
)
from heuncli.output.drawing.labels import estimate_width
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text, draw_arrow
from heuncli.output.drawing.style import find_colour, find_pen, find_shade, mix_with_white
from heuncli.output.drawing.symbols import SYMBOLS, SymbolPart, make_link
from heuncli.results.results import Array

CELL_OVERLAP = 0.5  # pixels by which cells overlap, else the background shows between them
MAX_EXACT_CORNERS = 8  # an outline with more corners is simplified
SIMPLIFY_TOLERANCE = 0.1  # pixels


def draw_item(item: Item, box: PanelBox) -> Iterator[Shape]:
    """Yield the shapes of an item in the field of its panel."""
    draw: Callable[[Any, PanelBox], Iterator[Shape]] = DRAW_FUNCTIONS[type(item)]
    return draw(item, box)


def _draw_trace(item: Trace, box: PanelBox) -> Iterator[Shape]:
    trace_pen = find_pen(item.pen)
    for part in split_at_gaps(box.to_pixels(item.x, item.y)):
        if len(part) == 1:
            yield Mark(float(part[0, 0]), float(part[0, 1]), "circle", trace_pen.colour, True, style.POINT_SIZE)
            continue
        line = tuple(map(tuple, simplify(part).tolist()))
        width = style.THIN_WIDTH if item.is_thin else style.CURVE_WIDTH
        yield Line(line, trace_pen.colour, width, trace_pen.dash, escape(item.name))


def _draw_band(item: Band, box: PanelBox) -> Iterator[Shape]:
    low, high = box.to_pixels(item.x, item.low), box.to_pixels(item.x, item.high)
    for part in split_at_gaps(np.hstack([low, high])):
        if len(part) == 1:
            continue
        outline = np.concatenate([simplify(part[:, :2]), simplify(part[:, 2:])[::-1]])
        colour, name = find_pen(item.pen).colour, escape(item.name)
        yield Area(tuple(map(tuple, outline.tolist())), colour, style.BAND_OPACITY, name)
        for edge in (part[:, :2], part[:, 2:]) if item.has_edges else ():
            yield Line(tuple(map(tuple, simplify(edge).tolist())), colour, style.ENVELOPE_WIDTH)


def _draw_strokes(item: Strokes, box: PanelBox) -> Iterator[Shape]:
    colour = style.GREY if item.pen is None else find_pen(item.pen).colour
    colour = style.FAINT if item.is_faint else mix_with_white(colour, style.HATCH_SHARE) if item.is_hatch else colour
    colour = mix_with_white(colour, style.GHOST_SHARE) if item.is_ghost else colour
    first, last = (box.to_pixels(*item.ends[:, k].T) for k in (0, 1))
    is_connected = (first[1:] == last[:-1]).all(axis=1)  # begins where the one before ends
    for run in np.split(np.arange(len(first)), np.flatnonzero(~is_connected) + 1):
        if len(run):
            points = np.concatenate([first[run], last[run[-1:]]])
            points = simplify(points) if len(points) > MAX_EXACT_CORNERS else points
            yield Line(tuple(map(tuple, points.tolist())), colour, item.width, item.dash, escape(item.name))


def _draw_polygon(item: Polygon, box: PanelBox) -> Iterator[Shape]:
    colour = style.FAINT if item.is_faint else find_colour(item.pen)
    colour = mix_with_white(colour, style.GHOST_SHARE) if item.is_ghost else colour
    outline = box.to_pixels(*item.corners.T)
    corners = (
        tuple(map(tuple, simplify(outline).tolist()))
        if len(outline) > MAX_EXACT_CORNERS
        else tuple(map(tuple, outline.tolist()))
    )
    if item.is_opaque:
        share = style.LIGHT_SHARE if item.is_light else style.TINT_SHARE
        yield Area(corners, mix_with_white(colour, share), 1.0, escape(item.name))
    elif item.is_filled:
        yield Area(corners, colour, style.FILL_OPACITY, escape(item.name))
    if item.has_outline:
        yield Line((*corners, corners[0]), colour, item.width, name=escape(item.name))


def _draw_symbol(item: Symbol, box: PanelBox) -> Iterator[Shape]:
    a, b = (
        box.to_pixel_x(item.direction[0]) - box.to_pixel_x(0.0),
        box.to_pixel_y(item.direction[1]) - box.to_pixel_y(0.0),
    )
    yield from _draw_parts(
        SYMBOLS[item.symbol].parts,
        box.to_pixel_x(item.x),
        box.to_pixel_y(item.y),
        a,
        b,
        find_colour(item.pen),
        item.name,
    )


def _draw_link(item: Link, box: PanelBox) -> Iterator[Shape]:
    x, y = box.to_pixel_x(item.x), box.to_pixel_y(item.y)
    a, b = box.to_pixel_x(item.to_x) - x, box.to_pixel_y(item.to_y) - y
    yield from _draw_parts(make_link(item.kind, math.hypot(a, b)), x, y, a, b, find_colour(item.pen), item.name)


def _draw_parts(
    parts: Sequence[SymbolPart], x: float, y: float, a: float, b: float, colour: str, name: str = ""
) -> Iterator[Shape]:
    """Draw the parts of a symbol at a place, with its x axis along (a, b)."""
    length, name = math.hypot(a, b), escape(name)
    a, b = (a / length, b / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        # y of the symbol is to the left of x; y of the drawing is downwards
        points = tuple((x + p * a + q * b, y + p * b - q * a) for p, q in part.points)
        if part.fill == "ink":
            yield Area(points, colour, name=name)
        else:
            if part.fill:
                fill = mix_with_white(colour, style.TINT_SHARE) if part.fill == "tint" else style.WHITE
                yield Area(points, fill)
            yield Line((*points, points[0]) if part.is_closed else points, colour, style.SYMBOL_WIDTH, name=name)
        name = ""  # only once


def _skip_label(item: PlaceLabel, box: PanelBox) -> Iterator[Shape]:
    """Labels are placed after all other items (`_lay_out_panel`)."""
    yield from ()


def _draw_arrow(item: Arrow, box: PanelBox) -> Iterator[Shape]:
    colour, name = find_colour(item.pen), escape(item.description or item.name)
    x0, y0 = box.to_pixel_x(item.x), box.to_pixel_y(item.y)
    x1, y1 = box.to_pixel_x(item.x + item.by_x), box.to_pixel_y(item.y + item.by_y)
    width = style.THIN_WIDTH if item.is_thin else style.ARROW_WIDTH
    yield from draw_arrow(x0, y0, x1 - x0, y1 - y0, colour, name, is_double=item.is_double, width=width)
    length = math.hypot(x1 - x0, y1 - y0)
    if item.name and length > 0.0:
        a, b = (x1 - x0) / length, (y1 - y0) / length
        yield Text(
            x1 + 5.0 * a, y1 + 5.0 * b + 4.0, escape(item.name), style.SMALL_SIZE, "end" if a < 0.0 else "start", colour
        )


def _draw_spot(item: Spot, box: PanelBox) -> Iterator[Shape]:
    if not item.shape:
        return
    colour = find_colour(item.pen)
    yield Mark(box.to_pixel_x(item.x), box.to_pixel_y(item.y), item.shape, colour, item.is_filled, style.MARK_SIZE)


def _draw_words(item: Words, box: PanelBox) -> Iterator[Shape]:
    colour, x, y = find_colour(item.pen), box.to_pixel_x(item.x), box.to_pixel_y(item.y)
    if item.is_sign:  # in a white disc
        yield Mark(x, y, "circle", colour, False, style.SIGN_SIZE)
    size = style.NAME_SIZE if item.is_sign else style.SMALL_SIZE
    yield Text(x, y + 0.36 * size, escape(item.text), size, "middle", colour, has_halo=not item.is_sign)


def _draw_vertical_mark(item: VerticalMark, box: PanelBox) -> Iterator[Shape]:
    x = box.to_pixel_x(item.x)
    name = escape(item.note or item.text)
    if item.is_tick:
        yield Line(((x, box.bottom - style.EVENT_LENGTH), (x, box.bottom)), style.DIM, style.AXIS_WIDTH, (), name)
        return
    yield Line(((x, box.top), (x, box.bottom)), style.DIM, style.AXIS_WIDTH, (3.0, 3.0), name)
    if item.is_above:  # keep the words within the drawing
        half = min(0.5 * estimate_width(escape(item.text), style.SMALL_SIZE) + 4.0, 0.5 * (box.right + style.RIGHT))
        middle = max(half, min(x, box.right + style.RIGHT - half))
        yield Text(middle, box.top - 5.0, escape(item.text), style.SMALL_SIZE, "middle", style.GREY)


def _hatch_box(left: float, top: float, right: float, bottom: float) -> Iterator[Shape]:
    """Draw slanted lines in a rectangle."""
    height = bottom - top
    for k in range(math.ceil((left - height) / style.HATCH_STEP), math.floor(right / style.HATCH_STEP) + 1):
        x = k * style.HATCH_STEP  # a line that rises to the right from the bottom at x
        low, high = max(left, x), min(right, x + height)
        if low < high:
            yield Line(((low, bottom - (low - x)), (high, bottom - (high - x))), style.GRID, style.HATCH_WIDTH)


def _draw_blank(item: Blank, box: PanelBox) -> Iterator[Shape]:
    left, right = box.to_pixel_x(item.low), box.to_pixel_x(item.high)
    yield Area(
        ((left, box.top), (right, box.top), (right, box.bottom), (left, box.bottom)), "#ffffff", 1.0, escape(item.text)
    )
    height = box.bottom - box.top
    yield from _hatch_box(left, box.top, right, box.bottom)
    x, y = 0.5 * (left + right), box.top + 0.3 * height
    yield Text(x, y, escape(item.text), style.SMALL_SIZE, "middle", style.GREY, has_halo=True)


def _draw_bars(item: Bars, box: PanelBox) -> Iterator[Shape]:
    bar_pen, zero = find_pen(item.pen), box.to_pixel_y(0.0)
    step = float(np.diff(item.x).min()) if len(item.x) > 1 else 1.0
    pixels = abs(box.to_pixel_x(1.0) - box.to_pixel_x(0.0))
    half = min(0.3 * step * pixels, 15.0) if item.width is None else min(0.5 * item.width * pixels, 22.0)
    for x, y in box.to_pixels(item.x, item.y).tolist():
        if math.isfinite(y):
            corners = ((x - half, zero), (x - half, y), (x + half, y), (x + half, zero))
            yield Area(corners, bar_pen.colour, style.BAR_OPACITY, escape(item.name))


def _draw_cells(item: Cells, box: PanelBox) -> Iterator[Shape]:
    xs, ys = (
        box.to_pixels(item.x_edges, np.full(len(item.x_edges), box.y_scaling.low))[:, 0],
        box.to_pixels(np.full(len(item.y_edges), box.x_scaling.low), item.y_edges)[:, 1],
    )
    is_known = np.pad(np.isfinite(item.values), ((0, 1), (0, 1)))
    for j, row in enumerate(item.find_shares().tolist()):
        for i, share in enumerate(row):
            if not is_known[j, i]:
                yield from _hatch_box(xs[i], ys[j + 1], xs[i + 1], ys[j])
            else:
                right = xs[i + 1] + (CELL_OVERLAP if is_known[j, i + 1] else 0.0)
                upper = ys[j + 1] - (CELL_OVERLAP if is_known[j + 1, i] else 0.0)
                corners = ((xs[i], ys[j]), (right, ys[j]), (right, upper), (xs[i], upper))
                yield Area(tuple((float(a), float(b)) for a, b in corners), find_shade(share), 1.0)


DRAW_FUNCTIONS: dict[type, Callable[[Any, PanelBox], Iterator[Shape]]] = {
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


def split_at_gaps(points: Array) -> list[Array]:
    """Return the parts of a course (n, m) between its unknown points; a part may have one point."""
    known = np.isfinite(points).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(np.int8)))
    return [points[a:b] for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)]


def simplify(points: Array) -> Array:
    """Drop the points (n, 2) that lie on the line between their neighbours (Douglas and Peucker, 1973)."""
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    stack = [(0, len(points) - 1)]
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        first, direction = points[a], points[b] - points[a]
        length = math.hypot(*direction)
        inner = points[a + 1 : b] - first
        distances = (
            np.abs(inner[:, 0] * direction[1] - inner[:, 1] * direction[0]) / length if length else np.hypot(*inner.T)
        )
        k = int(np.argmax(distances))
        if distances[k] > SIMPLIFY_TOLERANCE:
            keep[a + 1 + k] = True
            stack += [(a, a + 1 + k), (a + 1 + k, b)]
    return points[keep]
