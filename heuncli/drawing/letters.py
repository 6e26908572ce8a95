"""A figure in the cells of a terminal: curves in braille, eight dots a cell, or in letters where it shows no braille.

The items are those of drawing/figure.py. Curves keep the colour of their pen where colours are shown; else the pen's
letter stands at some places of a curve, and where there is no braille it is drawn with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
    Words,
)
from heuncli.drawing.pens import pen
from heuncli.drawing.room import WordBox, WordField, columns_of, left_out
from heuncli.drawing.symbols import SYMBOLS, Part, link
from heuncli.drawing.ticks import ticks
from heuncli.drawing.words import in_turn
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
APART = 3.0  # columns between upright strokes that belong together
LABEL = 10  # columns left of a panel
SHADES = "·░▒▓█"  # what is not known is blank
PLAIN_SHADES = ".:*#@"
RESET = "\x1b[0m"
NOBODY, SEVERAL = -1, -2  # in place of a pen: what is of no curve, and of more than one
LETTERS = 3  # of its pen along a curve
ZERO = 4  # columns from dot to dot of the line at zero
UPPER = 3  # rows in which the words of vertical marks stand


class Look(NamedTuple):
    """What a terminal shows: its columns, whether it has braille, and whether colours."""

    width: int
    braille: bool
    colours: bool

    @property
    def letters(self) -> bool:
        """Whether curves are told apart by letters."""
        return not self.colours


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
        self.pens = np.full((rows, columns), NOBODY)
        self.words: dict[tuple[int, int], tuple[str, int]] = {}
        self.room = WordField(WordBox(0.0, 0.0, columns, rows), (1.0, 1.0))

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
        there = self.pens[row, column]
        self.pens[row, column] = number if there < 0 or there == number or not self.look.letters else SEVERAL
        if number >= 0:
            self.room.price[row, column] = 1.0

    def line(self, x0: float, y0: float, x1: float, y1: float, number: int, every: int = 1) -> None:
        """The dots between two places; every: the how manieth of them is set."""
        limit = 2.0 * (self.columns * self.per_x + self.rows * self.per_y)
        if max(abs(x0), abs(y0), abs(x1), abs(y1)) > 4.0 * limit:
            return
        steps = max(1, math.ceil(max(abs(x1 - x0), abs(y1 - y0))))
        for k in range(0, steps + 1, every):
            self.dot(x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, number)

    def write(self, text: str, column: int, row: int, number: int = NOBODY) -> None:
        """Words over the dots, moved to the left where they would leave the panel; not over other words."""
        begin = max(0, min(column, self.columns - columns_of(text)))
        cells = list(in_cells(text, begin, row))
        if 0 <= row < self.rows and begin >= 0 and not any(cell in self.words for cell, _ in cells):
            self.words |= {cell: (letter, number) for cell, letter in cells}
            self.room.take(WordBox(begin, row, begin + columns_of(text), row + 1))

    def beside(self, text: str, column: int, row: int, number: int) -> bool:
        """Words beside a cell, where there is room for them; whether there is."""
        mark = WordBox(column, row, column + 1, row + 1)
        found = self.room.beside(mark, columns_of(text) + 2, 1.0)  # with a blank at both sides
        if found is not None:
            self._put(text, int(found.left) + 1, int(found.top), number)
        return found is not None

    def at(self, text: str, column: int, row: int, number: int) -> bool:
        """Words at a cell or touching it, where there are no others; whether there is room."""
        wide = columns_of(text)
        found = self.room.best(
            (abs(down) + 0.1 * k, WordBox(column + right, row + down, column + right + wide, row + down + 1))
            for k, (right, down) in enumerate((a, b) for b in (0, -1, 1) for a in (1, -wide, 0, 2, -wide - 1))
            if down or not -wide < right < 1
        )
        if found is not None:
            self._put(text, int(found.left), int(found.top), number)
        return found is not None

    def along(self, text: str, column: int) -> bool:
        """Words in one of the upper rows, at the right or left of a column; whether there is room."""
        wide = columns_of(text)
        found = self.room.best(
            (2.0 * row, WordBox(left, row, left + wide + 2, row + 1))
            for row in range(min(UPPER, self.rows))
            for left in (column, column - wide - 2)
        )
        if found is not None:
            self._put(text, int(found.left) + 1, int(found.top), NOBODY)
        return found is not None

    def _put(self, text: str, column: int, row: int, number: int) -> None:
        self.words |= {cell: (letter, number) for cell, letter in in_cells(text, column, row)}

    def lines(self) -> list[str]:
        """The rows as text."""
        return ["".join(self._row(row)).rstrip() for row in range(self.rows)]

    def _row(self, row: int) -> Iterable[str]:
        code = ""
        for column in range(self.columns):
            own = int(self.pens[row, column])
            word, number = self.words.get((row, column), (None, own))
            wanted = pen(number).code if number >= 0 and self.look.colours else ""
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
        return pen(number).letter if number >= 0 else "." if number == NOBODY else "+"


def in_cells(text: str, column: int, row: int) -> Iterator[tuple[tuple[int, int], str]]:
    """The letters of a text, each with its cell: a wide one takes two, and one that stands over another none."""
    at: tuple[int, int] | None = None
    for letter in text:
        wide = columns_of(letter)
        if not wide and at is not None:
            continue
        at = row, column
        yield at, letter
        if wide == 2:
            yield (row, column + 1), ""
        column += wide


def drawn(figure: Figure, look: Look) -> str:
    """The figure as lines of text; ends with a newline."""
    lines = [line for text in (figure.title, *figure.words) if text for line in wrapped(shown(text), look.width, 0)]
    lines += _legend(figure, look)
    told: list[str] = []
    for panel in figure.panels:
        rows, without_words = _panel(panel, look)
        lines += ["", *rows]
        told += without_words
    lines += [line for note in (*figure.notes, *left_out(told)) for line in wrapped(shown(note), look.width, 2)]
    return "\n".join(lines) + "\n"


def _legend(figure: Figure, look: Look) -> list[str]:
    """How each curve and mark is told, as many in a line as fit."""
    lines, room = [""], look.width
    entries = [*((name, number, "") for name, number in figure.legend), *figure.marks]
    for name, number, mark in entries:
        sample = _mark(mark, look, number) if mark else "⠤⠤" if look.colours and look.braille else pen(number).letter
        wide = columns_of(sample) + 1 + columns_of(shown(name))
        if lines[-1] and wide + 3 > room:
            lines.append("")
            room = look.width
        text = f"\x1b[{pen(number).code}m{sample}{RESET}" if look.colours else sample
        lines[-1] += f"{'   ' if lines[-1] else ''}{text} {shown(name)}"
        room -= wide + 3
    return lines if entries else []


def _mark(shape: str, look: Look, number: int) -> str:
    """How a marked place is told; points that belong together by the letter of their pen, where no colour tells."""
    if shape != "circle" and number >= 0:
        return "+" if look.colours else pen(number).letter
    return "•" if look.braille else "o"


def _panel(panel: Panel, look: Look) -> tuple[list[str], list[str]]:
    """A panel with its axes, and what is told of words that found no room."""
    room = max(look.width - LABEL - 2, 10)
    rows = max(LEAST_ROWS, round(ROWS * panel.height / PIXELS))
    columns = room
    if panel.equal:
        across, up = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        unit = min(room / across, ASPECT * rows / up)  # columns a unit
        columns, rows = max(2, round(unit * across)), max(2, round(unit * up / ASPECT))
    canvas = Canvas(columns, rows, panel.x, panel.y, look)
    if not panel.bare and panel.y.low < 0.0 < panel.y.high and not panel.y.named:
        canvas.line(0.0, canvas.y(0.0), columns * canvas.per_x - 1.0, canvas.y(0.0), NOBODY, ZERO * canvas.per_x)
    for item in panel.items:
        draw: Callable[[Any, Canvas], None] = DRAWN[type(item)]
        draw(item, canvas)
    told = _spoken(panel.items, canvas)
    key, unnamed = _labels([item for item in panel.items if isinstance(item, Label) and item.letter], canvas)
    told += unnamed
    if look.letters and look.braille:
        _named(panel.items, canvas)
    heads = wrapped(shown(" ".join(part for part in (panel.title, _upward(panel)) if part)), look.width, 0)
    lines = [*(head for head in heads if head)]
    if panel.bare:
        return lines + canvas.lines() + key, told
    above = {round(canvas.x(i.x)) // canvas.per_x: i.text for i in panel.items if isinstance(i, Upright) and i.above}
    lines += [_placed(above, canvas)] if above else []
    marks = {round(canvas.y(v)) // canvas.per_y: text for v, text in ticks(panel.y, max(2, rows // 3))}
    for row, text in enumerate(canvas.lines()):
        lines.append(
            f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} │{text}"
            if look.braille
            else f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} |{text}"
        )
    return lines + _below(panel, canvas) + key, told


def _spoken(items: Sequence[Item], canvas: Canvas) -> list[str]:
    """The words of spots and vertical marks where they find room; what is told of the others."""
    told: list[str] = []
    for item in in_turn(items):
        column = round(canvas.x(item.x)) // canvas.per_x
        if isinstance(item, Upright):
            has_room = canvas.along(shown(item.text), column)
        else:
            row = round(canvas.y(item.y)) // canvas.per_y
            number = NOBODY if item.pen is None else item.pen
            has_room = canvas.beside(shown(item.text), column, row, number)
        if not has_room:
            told.append(item.note or item.text)
    return told


def _labels(items: Sequence[Label], canvas: Canvas) -> tuple[list[str], list[str]]:
    """The letters of labels, and what they stand for; what is told of those that found no room."""
    known: dict[str, None] = {}
    told: list[str] = []
    for item in items:
        column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
        if canvas.at(shown(item.letter), column, row, NOBODY if item.pen is None else item.pen):
            known |= {_meant(item): None} if item.letter != item.text else {}
        elif not item.spare:
            told.append(item.text)
    return wrapped(shown(", ".join(known)), canvas.look.width, 2) if known else [], told


def _meant(label: Label) -> str:
    """What a letter stands for, with it; a name is not told twice."""
    return label.text if label.text.startswith(f"{label.letter} ") else f"{label.letter} {label.text}"


def _named(items: Sequence[Item], canvas: Canvas) -> None:
    """The letter of its pen at some places of each curve, where no other one passes."""
    several = len({item.pen for item in items if isinstance(item, Trace)}) > 1
    for item in items if several else ():
        if not isinstance(item, Trace):
            continue
        known = np.isfinite(item.x) & np.isfinite(item.y)
        cells = [
            (round(canvas.y(y)) // canvas.per_y, round(canvas.x(x)) // canvas.per_x)
            for x, y in zip(item.x[known].tolist(), item.y[known].tolist(), strict=True)
        ]
        own = [cell for cell in dict.fromkeys(cells) if _is_own(canvas, cell, item.pen)]
        for k in range(LETTERS):
            if own:
                row, column = own[min(round((k + 0.5) / LETTERS * len(own)), len(own) - 1)]
                canvas.write(pen(item.pen).letter, column, row)


def _is_own(canvas: Canvas, cell: tuple[int, int], number: int) -> bool:
    """Whether one curve alone passes a cell."""
    row, column = cell
    inside = 0 <= row < canvas.rows and 0 <= column < canvas.columns
    return inside and cell not in canvas.words and canvas.pens[row, column] == number


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
    middle = max(0, (canvas.columns - len(panel.x.label)) // 2)
    return [*lines, _placed(places, canvas), f"{'':{LABEL}}  {'':{middle}}{shown(panel.x.label)}"]


def _placed(places: Mapping[int, str], canvas: Canvas) -> str:
    """A line with words about columns of a panel, as many as do not touch; none goes farther than the panel's edge."""
    most = canvas.columns + LABEL + 2
    line = [" "] * most
    for place, words in sorted(places.items()):
        text = shown(words)
        begin = min(max(place - len(text) // 2, 0) + LABEL + 2, most - len(text))
        if begin >= 0 and all(c == " " for c in line[max(begin - 1, 0) : begin + len(text) + 1]):
            line[begin : begin + len(text)] = text
    return "".join(line).rstrip()


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
    """Of ordinates, which stand upright, only so many that what lies between them can be seen."""
    last = -math.inf
    for (x0, y0), (x1, y1) in item.ends.tolist():
        if x0 == x1:
            column = canvas.x(x0) / canvas.per_x
            if abs(column - last) < APART:
                continue
            last = column
        canvas.line(canvas.x(x0), canvas.y(y0), canvas.x(x1), canvas.y(y1), NOBODY if item.pen is None else item.pen)


def _polygon(item: Polygon, canvas: Canvas) -> None:
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
    canvas.write(_mark(item.shape, canvas.look, number), column, row, number)


def _word(item: Words, canvas: Canvas) -> None:
    column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
    canvas.write(shown(item.text), column - columns_of(shown(item.text)) // 2, row)


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
    parts: Sequence[Part], x: float, y: float, along: tuple[float, float], number: int | None, canvas: Canvas
) -> None:
    """The parts of a symbol about a dot, its x along a way in dots."""
    length = math.hypot(*along)
    a, b = (along[0] / length, along[1] / length) if length > 0.0 else (1.0, 0.0)
    for part in parts:
        points = [(x + (p * a + q * b) / DOT, y + (p * b - q * a) / DOT) for p, q in part.points]
        for (x0, y0), (x1, y1) in pairwise([*points, *points[: part.closed]]):
            canvas.line(x0, y0, x1, y1, NOBODY if number is None else number)


def _label(item: Label, canvas: Canvas) -> None:
    """Placed when all else is (`_labels`)."""


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
    Symbol: _symbol, Link: _link, Label: _label, Upright: _upright, Blank: _blank, Bars: _bars, Cells: _cells,
}  # fmt: skip
