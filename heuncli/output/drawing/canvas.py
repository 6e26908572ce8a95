"""The cells of a terminal: dots, eight in each cell with braille, and words over them where there is room."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import (
    Scaling,
)
from heuncli.output.drawing.labels import WordBox, WordField, count_columns
from heuncli.output.drawing.style import find_pen

BRAILLE = 0x2800
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # by row and column of a cell
DOT_COLUMNS, DOT_ROWS = 2, 4  # dots of a cell
RESET = "\x1b[0m"
NO_PEN, SEVERAL_PENS, DIM_PEN = -1, -2, -3  # instead of a pen: no curve, several curves, a hatch
BOLD, DIM_CODE = "1;", "2"  # codes of terminals: before the colour of a curve, of a hatch
LABEL_ROWS = 3  # upper rows for the words of vertical marks


class TerminalStyle(NamedTuple):
    """What a terminal shows: its number of columns, and whether it has braille and colours."""

    width: int
    has_braille: bool
    has_colours: bool

    @property
    def uses_letters(self) -> bool:
        """Whether curves are distinguished by letters."""
        return not self.has_colours


def make_terminal_style(width: int, encoding: str | None, *, has_colours: bool) -> TerminalStyle:
    """Return the style of a terminal with this encoding; None stands for UTF-8."""
    try:
        chr(BRAILLE).encode(encoding or "utf-8")
    except (UnicodeError, LookupError):
        return TerminalStyle(width, False, has_colours)
    return TerminalStyle(width, True, has_colours)


class Canvas:
    """The cells of a panel: dots, and words over them."""

    def __init__(self, columns: int, rows: int, x_scaling: Scaling, y_scaling: Scaling, style: TerminalStyle) -> None:
        self.columns, self.rows, self.x_scaling, self.y_scaling, self.style = columns, rows, x_scaling, y_scaling, style
        self.per_x, self.per_y = (DOT_COLUMNS, DOT_ROWS) if style.has_braille else (1, 1)
        self.dots = np.zeros((rows, columns), dtype=np.int64)
        self.pens = np.full((rows, columns), NO_PEN)
        self.words: dict[tuple[int, int], tuple[str, int]] = {}
        self.field = WordField(WordBox(0.0, 0.0, columns, rows), (1.0, 1.0))

    def to_dot_x(self, value: float) -> float:
        """Return the dot of a value on the horizontal axis, counted from the left."""
        return self.x_scaling.to_share(value) * (self.columns * self.per_x - 1)

    def to_dot_y(self, value: float) -> float:
        """Return the dot of a value on the vertical axis, counted from the top."""
        return (1.0 - self.y_scaling.to_share(value)) * (self.rows * self.per_y - 1)

    def set_dot(self, x: float, y: float, number: int) -> None:
        """Set a dot with a pen; dots outside are ignored."""
        i, j = round(x), round(y)
        column, row = i // self.per_x, j // self.per_y
        if not (0 <= i and 0 <= j and column < self.columns and row < self.rows):
            return
        self.dots[row, column] |= DOTS[j % DOT_ROWS][i % DOT_COLUMNS] if self.style.has_braille else 1
        old_pen = self.pens[row, column]
        self.pens[row, column] = (
            number if old_pen < 0 or old_pen == number or not self.style.uses_letters else SEVERAL_PENS
        )
        if number >= 0:
            self.field.cost[row, column] = 1.0

    def draw_line(self, x0: float, y0: float, x1: float, y1: float, number: int, stride: int = 1) -> None:
        """Set the dots between two places; stride: only each stride-th of them."""
        limit = 2.0 * (self.columns * self.per_x + self.rows * self.per_y)
        if max(abs(x0), abs(y0), abs(x1), abs(y1)) > 4.0 * limit:
            return
        steps = max(1, math.ceil(max(abs(x1 - x0), abs(y1 - y0))))
        for k in range(0, steps + 1, stride):
            self.set_dot(x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, number)

    def write(self, text: str, column: int, row: int, number: int = NO_PEN) -> None:
        """Write words over the dots, moved to the left if they would leave the panel, but not over other words."""
        first_column = max(0, min(column, self.columns - count_columns(text)))
        cells = list(iter_cells(text, first_column, row))
        if 0 <= row < self.rows and first_column >= 0 and not any(cell in self.words for cell, _ in cells):
            self.words |= {cell: (letter, number) for cell, letter in cells}
            self.field.occupy(WordBox(first_column, row, first_column + count_columns(text), row + 1))

    def write_near(self, text: str, column: int, row: int, number: int) -> bool:
        """Write words near a cell if there is room; return whether there is."""
        mark = WordBox(column, row, column + 1, row + 1)
        box = self.field.occupy_near(mark, count_columns(text) + 2, 1.0)  # with a blank at both sides
        if box is not None:
            self._set_words(text, int(box.left) + 1, int(box.top), number)
        return box is not None

    def write_touching(self, text: str, column: int, row: int, number: int) -> bool:
        """Write words at a cell, or next to it if other words are there; return whether there is room."""
        width = count_columns(text)
        box = self.field.occupy_best(
            (abs(down) + 0.1 * k, WordBox(column + right, row + down, column + right + width, row + down + 1))
            for k, (right, down) in enumerate((a, b) for b in (0, -1, 1) for a in (1, -width, 0, 2, -width - 1))
            if down or not -width < right < 1
        )
        if box is not None:
            self._set_words(text, int(box.left), int(box.top), number)
        return box is not None

    def write_at_top(self, text: str, column: int) -> bool:
        """Write words in one of the upper rows, to the right or left of a column; return whether there is room."""
        width = count_columns(text)
        box = self.field.occupy_best(
            (2.0 * row, WordBox(left, row, left + width + 2, row + 1))
            for row in range(min(LABEL_ROWS, self.rows))
            for left in (column, column - width - 2)
        )
        if box is not None:
            self._set_words(text, int(box.left) + 1, int(box.top), NO_PEN)
        return box is not None

    def _set_words(self, text: str, column: int, row: int, number: int) -> None:
        self.words |= {cell: (letter, number) for cell, letter in iter_cells(text, column, row)}

    def format_lines(self) -> list[str]:
        """Return the rows as text."""
        return ["".join(self._format_row(row)).rstrip() for row in range(self.rows)]

    def _format_row(self, row: int) -> Iterable[str]:
        code = ""
        for column in range(self.columns):
            pen_number = int(self.pens[row, column])
            word, number = self.words.get((row, column), (None, pen_number))
            new_code = self._find_code(number, is_curve=word is None)
            if new_code != code:
                yield RESET if not new_code else f"\x1b[{new_code}m"
                code = new_code
            yield word if word is not None else self._format_cell(row, column, number)
        if code:
            yield RESET

    def _find_code(self, number: int, *, is_curve: bool) -> str:
        """Return the code of a pen: curves are bold, hatches dim; empty without colours."""
        if not self.style.has_colours or (number < 0 and number != DIM_PEN):
            return ""
        return DIM_CODE if number == DIM_PEN else BOLD * is_curve + find_pen(number).code

    def _format_cell(self, row: int, column: int, number: int) -> str:
        dots = int(self.dots[row, column])
        if not dots:
            return " "
        if self.style.has_braille:
            return chr(BRAILLE + dots)
        return find_pen(number).letter if number >= 0 else "." if number == NO_PEN else "+"


def iter_cells(text: str, column: int, row: int) -> Iterator[tuple[tuple[int, int], str]]:
    """Yield the characters of a text, each with its cell: a wide one takes two cells, a combining one is left out."""
    cell: tuple[int, int] | None = None
    for letter in text:
        width = count_columns(letter)
        if not width and cell is not None:
            continue
        cell = row, column
        yield cell, letter
        if width == 2:
            yield (row, column + 1), ""
        column += width
