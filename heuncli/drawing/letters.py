"""A figure in the cells of a terminal: curves in braille, eight dots a cell, or in letters where it shows no braille.

The items are those of drawing/figure.py. Curves keep the colour of their pen where colours are shown; else, and where
there is no braille, the pen's letter stands on the curve.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.drawing.figure import (
    Arrow,
    Band,
    Bars,
    Blank,
    Cells,
    Figure,
    Item,
    Label,
    Link,
    Panel,
    Polygon,
    Scaling,
    Spot,
    Strokes,
    Symbol,
    Trace,
    Upright,
)
from heuncli.drawing.labels import NOT_NAMED
from heuncli.drawing.pens import pen
from heuncli.drawing.symbols import SYMBOLS, Part, link
from heuncli.drawing.ticks import ticks
from heuncli.foreign_text import shown
from heuncli.named_tuples import NamedTuple
from heuncli.results import Array
from heuncli.wrapping import wrapped

BRAILLE = 0x2800
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # by row and column of a cell
ACROSS, DOWN = 2, 4  # dots of a cell
ROWS, LEAST_ROWS = 12, 5  # of a panel of 170 pixels
PIXELS = 170.0
DOT = 4.0  # pixels that a dot stands for where symbols are drawn in dots
ASPECT = 2.0  # how much higher than wide a cell is
LABEL = 10  # columns left of a panel
SHADES = " ░▒▓█"
PLAIN_SHADES = " .:*#"
RESET = "\x1b[0m"


class Look(NamedTuple):
    """What a terminal shows: its columns, whether it has braille, and whether colours."""

    width: int
    braille: bool
    colours: bool


def look_of(width: int, encoding: str | None, *, colours: bool) -> Look:
    """The look of a terminal of an encoding; None: what is read as UTF-8."""
    try:
        chr(BRAILLE).encode(encoding or "utf-8")
    except (UnicodeError, LookupError):
        return Look(width, False, colours)
    return Look(width, True, colours)


class Canvas:
    """The cells of a panel: dots, and words over them."""

    def __init__(self, columns: int, rows: int, across: Scaling, up: Scaling, look: Look) -> None:
        self.columns, self.rows, self.across, self.up, self.look = columns, rows, across, up, look
        self.per_x, self.per_y = (ACROSS, DOWN) if look.braille else (1, 1)
        self.dots = np.zeros((rows, columns), dtype=np.int64)
        self.pens = np.full((rows, columns), -1)
        self.words: dict[tuple[int, int], str] = {}
        self.unwritten: list[str] = []

    def x(self, value: float) -> float:
        """The dot of a place along the axis across, from the left."""
        return self.across.at(value) * (self.columns * self.per_x - 1)

    def y(self, value: float) -> float:
        """The dot of a place along the axis upwards, from the top."""
        return (1.0 - self.up.at(value)) * (self.rows * self.per_y - 1)

    def dot(self, x: float, y: float, number: int) -> None:
        """Set a dot with a pen; what lies outside is left."""
        i, j = round(x), round(y)
        column, row = i // self.per_x, j // self.per_y
        if not (0 <= i and 0 <= j and column < self.columns and row < self.rows):
            return
        self.dots[row, column] |= DOTS[j % DOWN][i % ACROSS] if self.look.braille else 1
        self.pens[row, column] = number

    def line(self, x0: float, y0: float, x1: float, y1: float, number: int, every: int = 1) -> None:
        """The dots between two places; every: the how manieth of them is set."""
        limit = 2.0 * (self.columns * self.per_x + self.rows * self.per_y)
        if max(abs(x0), abs(y0), abs(x1), abs(y1)) > 4.0 * limit:
            return
        steps = max(1, math.ceil(max(abs(x1 - x0), abs(y1 - y0))))
        for k in range(0, steps + 1, every):
            self.dot(x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, number)

    def write(self, text: str, column: int, row: int) -> bool:
        """Words over the dots, moved to the left where they would leave the panel; not over other words.

        Returns whether they stand there.
        """
        begin = max(0, min(column, self.columns - len(text)))
        cells = [(row, begin + k) for k in range(len(text))]
        if not (0 <= row < self.rows and begin + len(text) <= self.columns) or any(c in self.words for c in cells):
            return False
        self.words |= dict(zip(cells, text, strict=True))
        return True

    def lines(self) -> list[str]:
        """The rows as text."""
        return ["".join(self._row(row)).rstrip() for row in range(self.rows)]

    def _row(self, row: int) -> Iterable[str]:
        code = ""
        for column in range(self.columns):
            word = self.words.get((row, column))
            number = int(self.pens[row, column])
            wanted = pen(number).code if word is None and number >= 0 and self.look.colours else ""
            if wanted != code:
                yield RESET if not wanted else f"\x1b[{wanted}m"
                code = wanted
            yield word if word is not None else self._cell(row, column, number)
        if code:
            yield RESET

    def _cell(self, row: int, column: int, number: int) -> str:
        dots = int(self.dots[row, column])
        if not dots:
            return " "
        if self.look.braille:
            return chr(BRAILLE + dots)
        return pen(number).letter if number >= 0 else "."


def drawn(figure: Figure, look: Look) -> str:
    """The figure as lines of text; ends with a newline."""
    lines = [line for text in (figure.title, *figure.words) if text for line in wrapped(shown(text), look.width, 0)]
    legend = "   ".join(f"{_sample(number, look)} {shown(name)}" for name, number in figure.legend)
    if legend:
        lines += [legend] if look.colours else wrapped(legend, look.width, 0)
    for panel in figure.panels:
        lines += ["", *_panel(panel, look)]
    lines += [line for note in figure.notes for line in wrapped(shown(note), look.width, 2)]
    return "\n".join(lines) + "\n"


def _sample(number: int, look: Look) -> str:
    """How a curve of a pen is told in the legend."""
    if look.colours:
        return f"\x1b[{pen(number).code}m{'⠤⠤' if look.braille else pen(number).letter}{RESET}"
    return pen(number).letter


def _panel(panel: Panel, look: Look) -> list[str]:
    """A panel with its axes."""
    room = max(look.width - LABEL - 2, 10)
    rows = max(LEAST_ROWS, round(ROWS * panel.height / PIXELS))
    columns = room
    if panel.equal:
        across, up = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        unit = min(room / across, ASPECT * rows / up)  # columns a unit
        columns, rows = max(2, round(unit * across)), max(2, round(unit * up / ASPECT))
    canvas = Canvas(columns, rows, panel.x, panel.y, look)
    for item in panel.items:
        draw: Callable[[Any, Canvas], None] = DRAWN[type(item)]
        draw(item, canvas)
    heads = wrapped(shown(" ".join(part for part in (panel.title, _upward(panel)) if part)), look.width, 0)
    lines = [*(head for head in heads if head)]
    if panel.bare:
        return lines + canvas.lines() + _key(panel, canvas)
    marks = {round(canvas.y(v)) // canvas.per_y: text for v, text in ticks(panel.y, max(2, rows // 3))}
    for row, text in enumerate(canvas.lines()):
        lines.append(
            f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} │{text}"
            if look.braille
            else f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} |{text}"
        )
    return lines + _below(panel, canvas) + _key(panel, canvas)


def _key(panel: Panel, canvas: Canvas) -> list[str]:
    """What the letters of labels stand for."""
    labels = [item for item in panel.items if isinstance(item, Label) and item.letter]
    known = [f"{item.letter} {item.text}" for item in labels if item.letter not in (item.text, *canvas.unwritten)]
    hidden = [item.text for item in labels if item.letter in canvas.unwritten]
    told = [", ".join(dict.fromkeys(known)), *([NOT_NAMED.format(", ".join(hidden))] if hidden else [])]
    return [line for text in told if text for line in wrapped(shown(text), canvas.look.width, 2)]


def _upward(panel: Panel) -> str:
    """What the axis upwards tells, above the panel."""
    return "" if panel.bare else panel.y.label


def _below(panel: Panel, canvas: Canvas) -> list[str]:
    """The axis across with its numbers and what it tells."""
    places = {round(canvas.x(v)) // canvas.per_x: text for v, text in ticks(panel.x, max(2, canvas.columns // 12))}
    rule, cross = ("─", "┴") if canvas.look.braille else ("-", "+")
    axis = "".join(cross if k in places else rule for k in range(canvas.columns))
    corner = "└" if canvas.look.braille else "+"
    lines = [f"{'':{LABEL}} {corner}{axis}"]
    if not panel.x.label:
        return lines
    under = [" "] * (canvas.columns + LABEL + 12)
    for place, text in sorted(places.items()):
        begin = max(place - len(text) // 2, 0) + LABEL + 2
        if all(c == " " for c in under[max(begin - 1, 0) : begin + len(text) + 1]):
            under[begin : begin + len(text)] = shown(text)
    middle = max(0, (canvas.columns - len(panel.x.label)) // 2)
    return [*lines, "".join(under).rstrip(), f"{'':{LABEL}}  {'':{middle}}{shown(panel.x.label)}"]


def _course(canvas: Canvas, x: Array, y: Array, number: int, every: int = 1) -> None:
    """The dots of a line through points."""
    points = [(canvas.x(a), canvas.y(b)) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    for (x0, y0), (x1, y1) in pairwise(points):
        if math.isfinite(x0 + y0 + x1 + y1):
            canvas.line(x0, y0, x1, y1, number, every)


def _trace(item: Trace, canvas: Canvas) -> None:
    _course(canvas, item.x, item.y, item.pen, 2 if item.thin and canvas.look.braille else 1)


def _band(item: Band, canvas: Canvas) -> None:
    for edge in (item.low, item.high):
        _course(canvas, item.x, edge, item.pen, 3 if canvas.look.braille else 2)


def _strokes(item: Strokes, canvas: Canvas) -> None:
    for (x0, y0), (x1, y1) in item.ends.tolist():
        canvas.line(canvas.x(x0), canvas.y(y0), canvas.x(x1), canvas.y(y1), -1 if item.pen is None else item.pen)


def _polygon(item: Polygon, canvas: Canvas) -> None:
    around = np.concatenate([item.corners, item.corners[:1]])
    _course(canvas, around[:, 0], around[:, 1], -1 if item.pen is None else item.pen)


def _arrow(item: Arrow, canvas: Canvas) -> None:
    number = -1 if item.pen is None else item.pen
    x, y = canvas.x(item.x + item.by_x), canvas.y(item.y + item.by_y)
    canvas.line(canvas.x(item.x), canvas.y(item.y), x, y, number)
    if item.name:
        canvas.write(shown(item.name), round(x) // canvas.per_x + 1, round(y) // canvas.per_y)


def _spot(item: Spot, canvas: Canvas) -> None:
    column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
    canvas.write("o" if not canvas.look.braille else "•", column, row)
    if item.text:
        text = shown(item.text)
        right = column + 1 + len(text) <= canvas.columns
        canvas.write(text, column + 1 if right else column - len(text), row)


def _symbol(item: Symbol, canvas: Canvas) -> None:
    x, y = canvas.x(item.x), canvas.y(item.y)
    shown_as = SYMBOLS[item.symbol]
    letter = shown_as.letter if canvas.look.braille else shown_as.plain
    if letter:
        canvas.write(letter, round(x) // canvas.per_x, round(y) // canvas.per_y)
    elif canvas.look.braille:
        along = canvas.x(item.along[0]) - canvas.x(0.0), canvas.y(item.along[1]) - canvas.y(0.0)
        _parts(shown_as.parts, x, y, along, item.pen, canvas)


def _link(item: Link, canvas: Canvas) -> None:
    x, y = canvas.x(item.x), canvas.y(item.y)
    along = canvas.x(item.to_x) - x, canvas.y(item.to_y) - y
    if canvas.look.braille:
        _parts(link(item.kind, DOT * math.hypot(*along)), x, y, along, item.pen, canvas)
    else:
        canvas.line(x, y, x + along[0], y + along[1], -1 if item.pen is None else item.pen)


def _parts(
    parts: Sequence[Part], x: float, y: float, along: tuple[float, float], number: int | None, canvas: Canvas
) -> None:
    """The parts of a symbol about a dot, its x along a way in dots."""
    length = math.hypot(*along)
    a, b = (along[0] / length, along[1] / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        points = [(x + (p * a + q * b) / DOT, y + (p * b - q * a) / DOT) for p, q in part.points]
        for (x0, y0), (x1, y1) in pairwise([*points, *points[: part.closed]]):
            canvas.line(x0, y0, x1, y1, -1 if number is None else number)


def _label(item: Label, canvas: Canvas) -> None:
    text = shown(item.letter)
    column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
    width = len(text)
    beside = ((1, 0), (-width, 0), (0, -1), (0, 1), (1, -1), (1, 1), (-width, -1), (-width, 1), (2, 0), (-width - 1, 0))
    for right, down in beside if text else ():
        if canvas.write(text, column + right, row + down):
            return
    canvas.unwritten += [item.letter] if text and not item.spare else []


def _upright(item: Upright, canvas: Canvas) -> None:
    x = canvas.x(item.x)
    canvas.line(x, 0.0, x, canvas.rows * canvas.per_y - 1.0, -1, 2)
    if item.text:
        canvas.write(shown(item.text), round(x) // canvas.per_x + 1, 0)


def _blank(item: Blank, canvas: Canvas) -> None:
    left, right = (round(canvas.x(x)) // canvas.per_x for x in (item.low, item.high))
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
                canvas.words.setdefault((row, column), shades[round(share * (len(shades) - 1))])


def _cell_at(edges: Array, share: float, scaling: Scaling) -> int:
    """The cell at a share of an axis."""
    shares: Sequence[float] = [scaling.at(edge) for edge in edges.tolist()]
    return min(max(int(np.searchsorted(shares, share, side="right")) - 1, 0), len(edges) - 2)


DRAWN: dict[type[Item], Callable[[Any, Canvas], None]] = {
    Trace: _trace, Band: _band, Strokes: _strokes, Polygon: _polygon, Arrow: _arrow, Spot: _spot, Symbol: _symbol,
    Link: _link, Label: _label, Upright: _upright, Blank: _blank, Bars: _bars, Cells: _cells,
}  # fmt: skip
