"""A figure laid out in pixels: what becomes of its panels, axes and items as shapes of a picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.base.foreign_text import shown
from heuncli.base.wrapping import wrapped
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
    Upright,
    Words,
)
from heuncli.output.drawing.labels import labelled
from heuncli.output.drawing.pens import BLACK, DIM, FAINT, GREY, GRID, WHITE, ink, mixed, pen
from heuncli.output.drawing.picture import Area, Line, Mark, Picture, Shape, Text
from heuncli.output.drawing.room import WordBox, left_out
from heuncli.output.drawing.scales import PanelBox
from heuncli.output.drawing.shades import shade
from heuncli.output.drawing.symbols import SYMBOLS, SymbolPart, link
from heuncli.output.drawing.ticks import ticks
from heuncli.output.drawing.words import SMALL, SPOT, apart, field_of, wide, words
from heuncli.results.results import Array

WIDTH = 820.0  # pixels
LEFT, RIGHT, TOP = 86.0, 26.0, 26.0
UNDER, BETWEEN = 44.0, 20.0  # below a panel with the name of its axis, and between panels
TITLE, NAME = 17.0, 12.0  # sizes of letters
LINE = 16.0  # from one line of text to the next
LETTER = 0.56  # of the size of letters: their mean width in a sentence
PER_TICK_X, PER_TICK_Y = 78.0, 34.0  # pixels at least
HEAD = 8.0  # the head of an arrow
HATCH = 9.0  # between the lines of a hatch
SEAM = 0.5  # pixels by which a cell goes under the next, else the ground is seen between them
MARGIN = 8.0  # of the picture, where words may stand beside a panel without axes
CLOSE = 2.0  # pixels: vertical marks that are closer are one
POINT = 1.6  # half the size of a point of a curve that stands alone
TINT, SOLID = 0.14, 0.65  # of a colour in what is filled with it; how much of what is solid hides what is behind
ORDER = {Area: 0, Line: 1, Mark: 2, Text: 3}  # what lies on what
LAYERED = {Area: 0, Line: 0, Mark: 0, Text: 1}
MANY = 8  # corners of an outline, of which those are left out that do not show
FINE = 0.1  # pixels: what a point of a curve may lie off the line that is drawn


def laid_out(figure: Figure, width: float = WIDTH) -> Picture:
    """The picture of a figure."""
    shapes, y = _heading(figure, width)
    shapes += (legend := _legend(figure, y, width))[0]
    y = legend[1]
    told: list[str] = []
    for panel in figure.panels:
        y += LINE + 4.0 if panel.title else 6.0
        head = y - 6.0
        y += LINE * any(isinstance(item, Upright) and item.above for item in panel.items)
        box = _box(panel, y, width)
        if panel.title:
            shapes.append(Text(box.left, head, shown(panel.title), NAME, bold=True))
        drawn, without_words = _panel(panel, box, width)
        shapes += drawn
        told += without_words
        y = box.bottom + (UNDER if panel.x.shown_label else BETWEEN)
    notes = [*figure.notes, *left_out(told)]
    y += 6.0 if notes else 0.0
    for note in notes:
        for text in _wrapped(note, SMALL, width):
            shapes.append(Text(20.0, y + 4.0, text, SMALL, colour=GREY))
            y += LINE
    return Picture(width, y + 8.0, shown(figure.title), "; ".join(map(shown, figure.words)), shapes)


def _heading(figure: Figure, width: float) -> tuple[list[Shape], float]:
    """The title and what the figure is of, and the height below."""
    shapes: list[Shape] = []
    y = TOP
    for text in _wrapped(figure.title, TITLE, width):
        shapes.append(Text(20.0, y, text, TITLE, bold=True))
        y += 21.0
    for sentence in figure.words:
        for text in _wrapped(sentence, SMALL, width):
            shapes.append(Text(20.0, y, text, SMALL, colour=GREY))
            y += LINE
    return shapes, y


def _wrapped(text: str, size: float, width: float) -> list[str]:
    """A text in lines that fit."""
    return wrapped(shown(text), int((width - 40.0) / (LETTER * size)), 0)


def _legend(figure: Figure, y: float, width: float) -> tuple[list[Shape], float]:
    """A stroke or mark of each pen with its name, as many in a line as fit, and the height below."""
    shapes: list[Shape] = []
    entries = [*((name, number, "") for name, number in figure.legend), *figure.marks]
    if not entries:
        return shapes, y
    x, y = 20.0, y + 4.0
    for name, number, mark in entries:
        text = shown(name)
        room = 34.0 + wide(text, NAME) + 14.0
        if x > 20.0 and x + room > width - 20.0:
            x, y = 20.0, y + LINE
        own = pen(number)
        if mark:
            shapes.append(Mark(x + 14.0, y - 4.0, mark, own.colour, False, SPOT))
        else:
            shapes.append(Line(((x, y - 4.0), (x + 28.0, y - 4.0)), own.colour, 2.0, own.dash))
        shapes.append(Text(x + 34.0, y, text, NAME))
        x += room
    return shapes, y + 8.0


def _box(panel: Panel, top: float, width: float) -> PanelBox:
    """The field of a panel below a height; of equal axes as wide as its unit is high, in the middle."""
    left, right, height = LEFT, width - RIGHT, panel.height
    if panel.equal:
        across, up = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        scale = min((right - left) / across, height / up)
        middle = (left + right) / 2.0
        left, right, height = middle - scale * across / 2.0, middle + scale * across / 2.0, scale * up
    return PanelBox(left, top, right, top + height, panel.x, panel.y)


def _panel(panel: Panel, box: PanelBox, width: float) -> tuple[list[Shape], list[str]]:
    """The axes and items of a panel, what is filled first, words last; and what is told of words without room."""
    items = apart(panel.items, box, CLOSE)
    drawn = [shape for item in items for shape in _shapes(item, box)]
    order = LAYERED if panel.layered else ORDER
    drawn.sort(key=lambda shape: order[type(shape)])
    filled = 0 if panel.layered else sum(isinstance(shape, Area) for shape in drawn)
    room = WordBox(box.left, box.top, box.right, box.bottom)
    if panel.bare:
        room = WordBox(MARGIN, box.top, width - MARGIN, box.bottom)
    field = field_of(drawn, room)
    texts, told = words(items, box, field)
    named, without_names = labelled([item for item in items if isinstance(item, PlaceLabel)], box, field)
    grid, axes = ([], []) if panel.bare else _axes(box)
    return [*grid, *drawn[:filled], *axes, *drawn[filled:], *texts, *named], told + without_names


def _axes(box: PanelBox) -> tuple[list[Shape], list[Shape]]:
    """The grid, on which all stands; and the zero lines, the frame with its numbers, and what the axes tell."""
    most = max(2, int((box.right - box.left) / PER_TICK_X)), max(2, int((box.bottom - box.top) / PER_TICK_Y))
    grid: list[Shape] = []
    axes: list[Shape] = []
    for value, text in ticks(box.across, most[0]):
        x = box.x(value)
        is_zero = _is_zero(value, box.across)
        (axes if is_zero else grid).append(Line(((x, box.top), (x, box.bottom)), GREY if is_zero else FAINT, 0.8))
        axes.append(Line(((x, box.bottom), (x, box.bottom + 4.0)), GREY, 0.8))
        if box.across.shown_label:
            axes.append(Text(x, box.bottom + 16.0, shown(text), SMALL, "middle"))
    for value, text in ticks(box.up, most[1]):
        y = box.y(value)
        is_zero = _is_zero(value, box.up)
        (axes if is_zero else grid).append(Line(((box.left, y), (box.right, y)), GREY if is_zero else FAINT, 0.8))
        axes.append(Text(box.left - 7.0, y + 4.0, shown(text), SMALL, "end"))
    corners = ((box.left, box.top), (box.right, box.top), (box.right, box.bottom), (box.left, box.bottom))
    axes.append(Line((*corners, corners[0]), BLACK, 0.8))
    if box.across.shown_label:
        middle = (box.left + box.right) / 2.0
        axes.append(Text(middle, box.bottom + 34.0, shown(box.across.shown_label), NAME, "middle"))
    if box.up.label:
        at = max(box.left - 64.0, 16.0), (box.top + box.bottom) / 2.0
        axes.append(Text(*at, shown(box.up.label), NAME, "middle", turned=True))
    return grid, axes


def _is_zero(value: float, scaling: Scaling) -> bool:
    return value == 0.0 and not scaling.logarithmic and not scaling.named


def _shapes(item: Item, box: PanelBox) -> Iterator[Shape]:
    """What an item is drawn with."""
    draw: Callable[[Any, PanelBox], Iterator[Shape]] = DRAWN[type(item)]
    return draw(item, box)


def _trace(item: Trace, box: PanelBox) -> Iterator[Shape]:
    own = pen(item.pen)
    for part in pieces(box.points(item.x, item.y)):
        if len(part) == 1:
            yield Mark(float(part[0, 0]), float(part[0, 1]), "circle", own.colour, True, POINT)
            continue
        line = tuple(map(tuple, thinned(part).tolist()))
        yield Line(line, own.colour, 0.9 if item.thin else 1.5, own.dash, shown(item.name))


def _band(item: Band, box: PanelBox) -> Iterator[Shape]:
    low, high = box.points(item.x, item.low), box.points(item.x, item.high)
    for part in pieces(np.hstack([low, high])):
        if len(part) == 1:
            continue
        around = np.concatenate([thinned(part[:, :2]), thinned(part[:, 2:])[::-1]])
        yield Area(tuple(map(tuple, around.tolist())), pen(item.pen).colour, 0.2, shown(item.name))


def _strokes(item: Strokes, box: PanelBox) -> Iterator[Shape]:
    colour = GREY if item.pen is None else pen(item.pen).colour
    first, last = (box.points(*item.ends[:, k].T) for k in (0, 1))
    follows = (first[1:] == last[:-1]).all(axis=1)  # where the one before ends
    for run in np.split(np.arange(len(first)), np.flatnonzero(~follows) + 1):
        if len(run):
            points = np.concatenate([first[run], last[run[-1:]]])
            points = thinned(points) if len(points) > MANY else points
            yield Line(tuple(map(tuple, points.tolist())), colour, item.width)


def _polygon(item: Polygon, box: PanelBox) -> Iterator[Shape]:
    colour = ink(item.pen)
    around = box.points(*item.corners.T)
    corners = tuple(map(tuple, thinned(around).tolist())) if len(around) > MANY else tuple(map(tuple, around.tolist()))
    if item.solid:
        yield Area(corners, mixed(colour, TINT), SOLID, shown(item.name))
    elif item.filled:
        yield Area(corners, colour, TINT, shown(item.name))
    if item.outlined:
        yield Line((*corners, corners[0]), colour, item.width, name=shown(item.name))


def _symbol(item: Symbol, box: PanelBox) -> Iterator[Shape]:
    a, b = box.x(item.along[0]) - box.x(0.0), box.y(item.along[1]) - box.y(0.0)
    yield from _parts(SYMBOLS[item.symbol].parts, box.x(item.x), box.y(item.y), a, b, ink(item.pen), item.name)


def _link(item: Link, box: PanelBox) -> Iterator[Shape]:
    x, y = box.x(item.x), box.y(item.y)
    a, b = box.x(item.to_x) - x, box.y(item.to_y) - y
    yield from _parts(link(item.kind, math.hypot(a, b)), x, y, a, b, ink(item.pen), item.name)


def _parts(
    parts: Sequence[SymbolPart], x: float, y: float, a: float, b: float, colour: str, name: str = ""
) -> Iterator[Shape]:
    """The parts of a symbol about a place, its x along (a, b)."""
    length, name = math.hypot(a, b), shown(name)
    a, b = (a / length, b / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        # y to the left of x: on paper y goes down
        points = tuple((x + p * a + q * b, y + p * b - q * a) for p, q in part.points)
        if part.fill == "ink":
            yield Area(points, colour, name=name)
        else:
            if part.fill:
                yield Area(points, WHITE)
            yield Line((*points, points[0]) if part.closed else points, colour, 1.2, name=name)
        name = ""  # told once


def _label(item: PlaceLabel, box: PanelBox) -> Iterator[Shape]:
    """Placed when all else is (`_panel`)."""
    yield from ()


def _arrow(item: Arrow, box: PanelBox) -> Iterator[Shape]:
    colour = ink(item.pen)
    x0, y0 = box.x(item.x), box.y(item.y)
    x1, y1 = box.x(item.x + item.by_x), box.y(item.y + item.by_y)
    length = math.hypot(x1 - x0, y1 - y0)
    if not length > 0.0:
        return
    a, b = (x1 - x0) / length, (y1 - y0) / length
    head = min(HEAD, 0.6 * length)
    back = x1 - head * a, y1 - head * b
    name = shown(item.told or item.name)
    yield Line(((x0, y0), back), colour, 1.6, name=name)
    side = 0.4 * head
    left, right = (back[0] - side * b, back[1] + side * a), (back[0] + side * b, back[1] - side * a)
    yield Area(((x1, y1), left, right), colour, 1.0, name)
    if item.name:
        yield Text(x1 + 5.0 * a, y1 + 5.0 * b + 4.0, shown(item.name), SMALL, "end" if a < 0.0 else "start", colour)


def _spot(item: Spot, box: PanelBox) -> Iterator[Shape]:
    colour = ink(item.pen)
    yield Mark(box.x(item.x), box.y(item.y), item.shape, colour, item.filled, SPOT)


def _words(item: Words, box: PanelBox) -> Iterator[Shape]:
    colour = ink(item.pen)
    yield Text(box.x(item.x), box.y(item.y) + 4.0, shown(item.text), NAME, "middle", colour)


def _upright(item: Upright, box: PanelBox) -> Iterator[Shape]:
    x = box.x(item.x)
    yield Line(((x, box.top), (x, box.bottom)), DIM, 0.8, (3.0, 3.0), shown(item.note or item.text))
    if item.above:  # within the picture
        half = min(0.5 * wide(shown(item.text), SMALL) + 4.0, 0.5 * (box.right + RIGHT))
        middle = max(half, min(x, box.right + RIGHT - half))
        yield Text(middle, box.top - 5.0, shown(item.text), SMALL, "middle", GREY)


def _blank(item: Blank, box: PanelBox) -> Iterator[Shape]:
    left, right = box.x(item.low), box.x(item.high)
    yield Area(
        ((left, box.top), (right, box.top), (right, box.bottom), (left, box.bottom)), "#ffffff", 1.0, shown(item.text)
    )
    height = box.bottom - box.top
    first = math.ceil((left - height) / HATCH)
    for k in range(first, math.floor(right / HATCH) + 1):
        x = k * HATCH  # a line that rises to the right from the bottom at x
        low, high = max(left, x), min(right, x + height)
        if low < high:
            yield Line(((low, box.bottom - (low - x)), (high, box.bottom - (high - x))), GRID, 0.7)
    yield Text((left + right) / 2.0, box.top + 0.3 * height, shown(item.text), SMALL, "middle", GREY, halo=True)


def _bars(item: Bars, box: PanelBox) -> Iterator[Shape]:
    own, zero = pen(item.pen), box.y(0.0)
    step = float(np.diff(item.x).min()) if len(item.x) > 1 else 1.0
    half = min(0.3 * abs(box.x(step) - box.x(0.0)), 15.0)
    for x, y in box.points(item.x, item.y).tolist():
        if math.isfinite(y):
            corners = ((x - half, zero), (x - half, y), (x + half, y), (x + half, zero))
            yield Area(corners, own.colour, 0.85, shown(item.name))


def _cells(item: Cells, box: PanelBox) -> Iterator[Shape]:
    xs, ys = (
        box.points(item.x_edges, np.full(len(item.x_edges), box.up.low))[:, 0],
        box.points(np.full(len(item.y_edges), box.across.low), item.y_edges)[:, 1],
    )
    known = item.values[np.isfinite(item.values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    there = np.pad(np.isfinite(item.values), ((0, 1), (0, 1)))
    for j, row in enumerate(item.values.tolist()):
        for i, value in enumerate(row):
            if there[j, i]:
                share = (value - low) / (high - low) if high > low else 0.5
                right = xs[i + 1] + (SEAM if there[j, i + 1] else 0.0)
                upper = ys[j + 1] - (SEAM if there[j + 1, i] else 0.0)
                corners = ((xs[i], ys[j]), (right, ys[j]), (right, upper), (xs[i], upper))
                yield Area(tuple((float(a), float(b)) for a, b in corners), shade(share), 1.0)


DRAWN: dict[type, Callable[[Any, PanelBox], Iterator[Shape]]] = {
    Trace: _trace, Band: _band, Strokes: _strokes, Polygon: _polygon, Arrow: _arrow, Spot: _spot, Words: _words,
    Symbol: _symbol, Link: _link, PlaceLabel: _label, Upright: _upright, Blank: _blank, Bars: _bars, Cells: _cells,
}  # fmt: skip


def pieces(points: Array) -> list[Array]:
    """The stretches of a course (n, m) between what is not known; of one point, too."""
    known = np.isfinite(points).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(np.int8)))
    return [points[a:b] for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)]


def thinned(points: Array) -> Array:
    """Without the points (n, 2) that lie on the line between their neighbours (Douglas and Peucker, 1973)."""
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    stack = [(0, len(points) - 1)]
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        first, along = points[a], points[b] - points[a]
        length = math.hypot(*along)
        inner = points[a + 1 : b] - first
        off = np.abs(inner[:, 0] * along[1] - inner[:, 1] * along[0]) / length if length else np.hypot(*inner.T)
        k = int(np.argmax(off))
        if off[k] > FINE:
            keep[a + 1 + k] = True
            stack += [(a, a + 1 + k), (a + 1 + k, b)]
    return points[keep]
