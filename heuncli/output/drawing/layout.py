"""Lay out a figure in pixels: convert its panels, axes and items to the shapes of a drawing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.base.sentences import wrap_text
from heuncli.base.text_safety import escape
from heuncli.output.drawing.figure import (
    Arrow,
    Band,
    Bars,
    Blank,
    Cells,
    Figure,
    Item,
    Link,
    Panel,
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
from heuncli.output.drawing.label_placement import WordBox, make_omitted_note
from heuncli.output.drawing.labels import place_labels
from heuncli.output.drawing.pens import BLACK, DIM, FAINT, GREY, GRID, WHITE, find_colour, find_pen, mix_with_white
from heuncli.output.drawing.scales import PanelBox
from heuncli.output.drawing.shades import find_shade
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text, VectorDrawing
from heuncli.output.drawing.symbols import SYMBOLS, SymbolPart, make_link
from heuncli.output.drawing.ticks import choose_ticks
from heuncli.output.drawing.words import (
    MARK_SIZE,
    SMALL_SIZE,
    drop_close_marks,
    estimate_width,
    make_field,
    place_words,
)
from heuncli.results.results import Array

WIDTH = 820.0  # pixels
LEFT, RIGHT, TOP = 86.0, 26.0, 26.0
AXIS_SPACE, PANEL_SPACE = 44.0, 20.0  # pixels below a panel with the label of its axis, and without
TITLE_SIZE, NAME_SIZE = 17.0, 12.0  # font sizes
LINE_HEIGHT = 16.0  # pixels
LETTER_WIDTH = 0.56  # mean width of a letter in a sentence, in font sizes
PER_TICK_X, PER_TICK_Y = 78.0, 34.0  # minimum distance of ticks, pixels
ARROW_HEAD = 8.0  # pixels
HATCH_STEP = 9.0  # pixels between lines
CELL_OVERLAP = 0.5  # pixels by which cells overlap, else the background shows between them
MARGIN = 8.0  # pixels at the edge, for words beside a panel without axes
MIN_MARK_DISTANCE = 2.0  # pixels between vertical marks
POINT_SIZE = 1.6  # pixels, half the size of a single point of a curve
FILL_OPACITY, OPAQUE_OPACITY = 0.14, 0.65  # of a light fill, and of a fill that hides what is behind it
DRAWING_ORDER = {Area: 0, Line: 1, Mark: 2, Text: 3}  # later ones cover earlier ones
LAYERED_ORDER = {Area: 0, Line: 0, Mark: 0, Text: 1}
MAX_EXACT_CORNERS = 8  # an outline with more corners is simplified
SIMPLIFY_TOLERANCE = 0.1  # pixels


def lay_out(figure: Figure, width: float = WIDTH) -> VectorDrawing:
    """Lay out a figure."""
    shapes, y = _lay_out_heading(figure, width)
    shapes += (legend := _lay_out_legend(figure, y, width))[0]
    y = legend[1]
    omitted: list[str] = []
    for panel in figure.panels:
        y += LINE_HEIGHT + 4.0 if panel.title else 6.0
        title_y = y - 6.0
        y += LINE_HEIGHT * any(isinstance(item, VerticalMark) and item.is_above for item in panel.items)
        box = _make_box(panel, y, width)
        if panel.title:
            shapes.append(Text(box.left, title_y, escape(panel.title), NAME_SIZE, is_bold=True))
        panel_shapes, without_words = _lay_out_panel(panel, box, width)
        shapes += panel_shapes
        omitted += without_words
        y = box.bottom + (AXIS_SPACE if panel.x.shown_label else PANEL_SPACE)
    notes = [*figure.notes, *make_omitted_note(omitted)]
    y += 6.0 if notes else 0.0
    for note in notes:
        for text in _wrap(note, SMALL_SIZE, width):
            shapes.append(Text(20.0, y + 4.0, text, SMALL_SIZE, colour=GREY))
            y += LINE_HEIGHT
    return VectorDrawing(width, y + 8.0, escape(figure.title), "; ".join(map(escape, figure.words)), shapes)


def _lay_out_heading(figure: Figure, width: float) -> tuple[list[Shape], float]:
    """Return the title and the description of the figure, and the y below them."""
    shapes: list[Shape] = []
    y = TOP
    for text in _wrap(figure.title, TITLE_SIZE, width):
        shapes.append(Text(20.0, y, text, TITLE_SIZE, is_bold=True))
        y += 21.0
    for sentence in figure.words:
        for text in _wrap(sentence, SMALL_SIZE, width):
            shapes.append(Text(20.0, y, text, SMALL_SIZE, colour=GREY))
            y += LINE_HEIGHT
    return shapes, y


def _wrap(text: str, size: float, width: float) -> list[str]:
    """Wrap a text to lines that fit."""
    return wrap_text(escape(text), int((width - 40.0) / (LETTER_WIDTH * size)), 0)


def _lay_out_legend(figure: Figure, y: float, width: float) -> tuple[list[Shape], float]:
    """Return a stroke or mark of each pen with its name, as many in a line as fit, and the y below them."""
    shapes: list[Shape] = []
    entries = [*((name, number, "") for name, number in figure.legend), *figure.marks]
    if not entries:
        return shapes, y
    x, y = 20.0, y + 4.0
    for name, number, mark in entries:
        text = escape(name)
        entry_width = 34.0 + estimate_width(text, NAME_SIZE) + 14.0
        if x > 20.0 and x + entry_width > width - 20.0:
            x, y = 20.0, y + LINE_HEIGHT
        entry_pen = find_pen(number)
        if mark:
            shapes.append(Mark(x + 14.0, y - 4.0, mark, entry_pen.colour, False, MARK_SIZE))
        else:
            shapes.append(Line(((x, y - 4.0), (x + 28.0, y - 4.0)), entry_pen.colour, 2.0, entry_pen.dash))
        shapes.append(Text(x + 34.0, y, text, NAME_SIZE))
        x += entry_width
    return shapes, y + 8.0


def _make_box(panel: Panel, top: float, width: float) -> PanelBox:
    """Return the field of a panel below a height; with equal scales it is as wide as needed, in the middle."""
    left, right, height = LEFT, width - RIGHT, panel.height
    if panel.has_equal_scales:
        x_span, y_span = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        scale = min((right - left) / x_span, height / y_span)
        middle = (left + right) / 2.0
        left, right, height = middle - scale * x_span / 2.0, middle + scale * x_span / 2.0, scale * y_span
    return PanelBox(left, top, right, top + height, panel.x, panel.y)


def _lay_out_panel(panel: Panel, box: PanelBox, width: float) -> tuple[list[Shape], list[str]]:
    """Return the axes and items of a panel, filled areas first and words last, and the words without room."""
    items = drop_close_marks(panel.items, box, MIN_MARK_DISTANCE)
    drawn_shapes = [shape for item in items for shape in _draw_item(item, box)]
    order = LAYERED_ORDER if panel.is_layered else DRAWING_ORDER
    drawn_shapes.sort(key=lambda shape: order[type(shape)])
    n_filled = 0 if panel.is_layered else sum(isinstance(shape, Area) for shape in drawn_shapes)
    label_area = WordBox(box.left, box.top, box.right, box.bottom)
    if panel.is_bare:
        label_area = WordBox(MARGIN, box.top, width - MARGIN, box.bottom)
    field = make_field(drawn_shapes, label_area)
    texts, omitted = place_words(items, box, field)
    labels, without_names = place_labels([item for item in items if isinstance(item, PlaceLabel)], box, field)
    grid, axes = ([], []) if panel.is_bare else _lay_out_axes(box)
    return [*grid, *drawn_shapes[:n_filled], *axes, *drawn_shapes[n_filled:], *texts, *labels], omitted + without_names


def _lay_out_axes(box: PanelBox) -> tuple[list[Shape], list[Shape]]:
    """Return the grid, which is below all else, and the zero lines, the frame with its numbers, and the labels."""
    max_ticks = max(2, int((box.right - box.left) / PER_TICK_X)), max(2, int((box.bottom - box.top) / PER_TICK_Y))
    grid: list[Shape] = []
    axes: list[Shape] = []
    for value, text in choose_ticks(box.x_scaling, max_ticks[0]):
        x = box.to_pixel_x(value)
        is_zero = _is_zero(value, box.x_scaling)
        (axes if is_zero else grid).append(Line(((x, box.top), (x, box.bottom)), GREY if is_zero else FAINT, 0.8))
        axes.append(Line(((x, box.bottom), (x, box.bottom + 4.0)), GREY, 0.8))
        if box.x_scaling.shown_label:
            axes.append(Text(x, box.bottom + 16.0, escape(text), SMALL_SIZE, "middle"))
    for value, text in choose_ticks(box.y_scaling, max_ticks[1]):
        y = box.to_pixel_y(value)
        is_zero = _is_zero(value, box.y_scaling)
        (axes if is_zero else grid).append(Line(((box.left, y), (box.right, y)), GREY if is_zero else FAINT, 0.8))
        axes.append(Text(box.left - 7.0, y + 4.0, escape(text), SMALL_SIZE, "end"))
    corners = ((box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom))
    axes.append(Line((*corners, corners[0]), BLACK, 0.8))
    if box.x_scaling.shown_label:
        middle = (box.left + box.right) / 2.0
        axes.append(Text(middle, box.bottom + 34.0, escape(box.x_scaling.shown_label), NAME_SIZE, "middle"))
    if box.y_scaling.label:
        label_place = max(box.left - 64.0, 16.0), (box.top + box.bottom) / 2.0
        axes.append(Text(*label_place, escape(box.y_scaling.label), NAME_SIZE, "middle", is_vertical=True))
    return grid, axes


def _is_zero(value: float, scaling: Scaling) -> bool:
    return value == 0.0 and not scaling.is_logarithmic and not scaling.tick_texts


def _draw_item(item: Item, box: PanelBox) -> Iterator[Shape]:
    """Yield the shapes of an item."""
    draw: Callable[[Any, PanelBox], Iterator[Shape]] = DRAW_FUNCTIONS[type(item)]
    return draw(item, box)


def _draw_trace(item: Trace, box: PanelBox) -> Iterator[Shape]:
    trace_pen = find_pen(item.pen)
    for part in split_at_gaps(box.to_pixels(item.x, item.y)):
        if len(part) == 1:
            yield Mark(float(part[0, 0]), float(part[0, 1]), "circle", trace_pen.colour, True, POINT_SIZE)
            continue
        line = tuple(map(tuple, simplify(part).tolist()))
        yield Line(line, trace_pen.colour, 0.9 if item.is_thin else 1.5, trace_pen.dash, escape(item.name))


def _draw_band(item: Band, box: PanelBox) -> Iterator[Shape]:
    low, high = box.to_pixels(item.x, item.low), box.to_pixels(item.x, item.high)
    for part in split_at_gaps(np.hstack([low, high])):
        if len(part) == 1:
            continue
        outline = np.concatenate([simplify(part[:, :2]), simplify(part[:, 2:])[::-1]])
        yield Area(tuple(map(tuple, outline.tolist())), find_pen(item.pen).colour, 0.2, escape(item.name))


def _draw_strokes(item: Strokes, box: PanelBox) -> Iterator[Shape]:
    colour = GREY if item.pen is None else find_pen(item.pen).colour
    first, last = (box.to_pixels(*item.ends[:, k].T) for k in (0, 1))
    is_connected = (first[1:] == last[:-1]).all(axis=1)  # begins where the one before ends
    for run in np.split(np.arange(len(first)), np.flatnonzero(~is_connected) + 1):
        if len(run):
            points = np.concatenate([first[run], last[run[-1:]]])
            points = simplify(points) if len(points) > MAX_EXACT_CORNERS else points
            yield Line(tuple(map(tuple, points.tolist())), colour, item.width)


def _draw_polygon(item: Polygon, box: PanelBox) -> Iterator[Shape]:
    colour = find_colour(item.pen)
    outline = box.to_pixels(*item.corners.T)
    corners = (
        tuple(map(tuple, simplify(outline).tolist()))
        if len(outline) > MAX_EXACT_CORNERS
        else tuple(map(tuple, outline.tolist()))
    )
    if item.is_opaque:
        yield Area(corners, mix_with_white(colour, FILL_OPACITY), OPAQUE_OPACITY, escape(item.name))
    elif item.is_filled:
        yield Area(corners, colour, FILL_OPACITY, escape(item.name))
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
                yield Area(points, WHITE)
            yield Line((*points, points[0]) if part.is_closed else points, colour, 1.2, name=name)
        name = ""  # only once


def _skip_label(item: PlaceLabel, box: PanelBox) -> Iterator[Shape]:
    """Labels are placed after all other items (`_lay_out_panel`)."""
    yield from ()


def _draw_arrow(item: Arrow, box: PanelBox) -> Iterator[Shape]:
    colour = find_colour(item.pen)
    x0, y0 = box.to_pixel_x(item.x), box.to_pixel_y(item.y)
    x1, y1 = box.to_pixel_x(item.x + item.by_x), box.to_pixel_y(item.y + item.by_y)
    length = math.hypot(x1 - x0, y1 - y0)
    if not length > 0.0:
        return
    a, b = (x1 - x0) / length, (y1 - y0) / length
    head = min(ARROW_HEAD, 0.6 * length)
    back = x1 - head * a, y1 - head * b
    name = escape(item.description or item.name)
    yield Line(((x0, y0), back), colour, 1.6, name=name)
    side = 0.4 * head
    left, right = (back[0] - side * b, back[1] + side * a), (back[0] + side * b, back[1] - side * a)
    yield Area(((x1, y1), left, right), colour, 1.0, name)
    if item.name:
        yield Text(
            x1 + 5.0 * a, y1 + 5.0 * b + 4.0, escape(item.name), SMALL_SIZE, "end" if a < 0.0 else "start", colour
        )


def _draw_spot(item: Spot, box: PanelBox) -> Iterator[Shape]:
    colour = find_colour(item.pen)
    yield Mark(box.to_pixel_x(item.x), box.to_pixel_y(item.y), item.shape, colour, item.is_filled, MARK_SIZE)


def _draw_words(item: Words, box: PanelBox) -> Iterator[Shape]:
    colour = find_colour(item.pen)
    yield Text(box.to_pixel_x(item.x), box.to_pixel_y(item.y) + 4.0, escape(item.text), NAME_SIZE, "middle", colour)


def _draw_vertical_mark(item: VerticalMark, box: PanelBox) -> Iterator[Shape]:
    x = box.to_pixel_x(item.x)
    yield Line(((x, box.top), (x, box.bottom)), DIM, 0.8, (3.0, 3.0), escape(item.note or item.text))
    if item.is_above:  # keep the words within the drawing
        half = min(0.5 * estimate_width(escape(item.text), SMALL_SIZE) + 4.0, 0.5 * (box.right + RIGHT))
        middle = max(half, min(x, box.right + RIGHT - half))
        yield Text(middle, box.top - 5.0, escape(item.text), SMALL_SIZE, "middle", GREY)


def _draw_blank(item: Blank, box: PanelBox) -> Iterator[Shape]:
    left, right = box.to_pixel_x(item.low), box.to_pixel_x(item.high)
    yield Area(
        ((left, box.top), (right, box.top), (right, box.bottom), (left, box.bottom)), "#ffffff", 1.0, escape(item.text)
    )
    height = box.bottom - box.top
    first = math.ceil((left - height) / HATCH_STEP)
    for k in range(first, math.floor(right / HATCH_STEP) + 1):
        x = k * HATCH_STEP  # a line that rises to the right from the bottom at x
        low, high = max(left, x), min(right, x + height)
        if low < high:
            yield Line(((low, box.bottom - (low - x)), (high, box.bottom - (high - x))), GRID, 0.7)
    yield Text(
        (left + right) / 2.0, box.top + 0.3 * height, escape(item.text), SMALL_SIZE, "middle", GREY, has_halo=True
    )


def _draw_bars(item: Bars, box: PanelBox) -> Iterator[Shape]:
    bar_pen, zero = find_pen(item.pen), box.to_pixel_y(0.0)
    step = float(np.diff(item.x).min()) if len(item.x) > 1 else 1.0
    half = min(0.3 * abs(box.to_pixel_x(step) - box.to_pixel_x(0.0)), 15.0)
    for x, y in box.to_pixels(item.x, item.y).tolist():
        if math.isfinite(y):
            corners = ((x - half, zero), (x - half, y), (x + half, y), (x + half, zero))
            yield Area(corners, bar_pen.colour, 0.85, escape(item.name))


def _draw_cells(item: Cells, box: PanelBox) -> Iterator[Shape]:
    xs, ys = (
        box.to_pixels(item.x_edges, np.full(len(item.x_edges), box.y_scaling.low))[:, 0],
        box.to_pixels(np.full(len(item.y_edges), box.x_scaling.low), item.y_edges)[:, 1],
    )
    known = item.values[np.isfinite(item.values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    is_known = np.pad(np.isfinite(item.values), ((0, 1), (0, 1)))
    for j, row in enumerate(item.values.tolist()):
        for i, value in enumerate(row):
            if is_known[j, i]:
                share = (value - low) / (high - low) if high > low else 0.5
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
