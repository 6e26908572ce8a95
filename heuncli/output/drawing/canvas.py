"""The cells of a terminal: dots, eight a cell in braille, and words over them, each where it finds room."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import (
    Scaling,
)
from heuncli.output.drawing.pens import pen
from heuncli.output.drawing.room import WordBox, WordField, columns_of

BRAILLE = 0x2800
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # by row and column of a cell
ACROSS, DOWN = 2, 4  # dots of a cell
RESET = "\x1b[0m"
NOBODY, SEVERAL = -1, -2  # in place of a pen: what is of no curve, and of more than one
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
