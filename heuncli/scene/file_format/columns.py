"""Columns of numbers out of a CSV text, as programs write it.

Commas, semicolons (then with decimal commas, too), tabs or spaces separate; empty lines and lines that begin with #
do not count. A file has one decimal mark: where commas are, a point may as well mark thousands. The text is taken in
pieces of some lines: NumPy reads those that hold nothing but plain numbers, all others are read cell by cell, by the
same rules, and so are those in which something is wrong, to say what and where.
"""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import LONGEST, listed, nearest
from heuncli.results.results_schema import counted
from heuncli.scene.file_format.headings import name_in_heading

MOST_ROWS = 2_000_000
PIECE = 1 << 20  # characters: NumPy's start is nothing beside reading them, and what they take in between is little
LOOKED_THROUGH = 1000  # rows by which a file is taken for a table of numbers, where something is wrong
LONGEST_NUMBER = 24  # characters; a double has 24 at most
PLAIN = b"0123456789+-.eE \t\r\n"
NUMERIC = frozenset("0123456789+-.,eE_% ")
NOT_FINITE = frozenset({"nan", "inf", "infinity"})
BEGINS_AS_NUMBER = re.compile(r"[-+]?[.,]?[0-9]")
# what to do about it
ROWS = "each row has its numbers between commas, as 0.5, 12"
FEWER = "keep the points that matter: between them the table interpolates"
NUMBERS = "one number a cell, with a point; lines of words begin with #"
QUOTES = "quotes come in pairs; plain numbers need none"
ONE_MARK = "write all numbers of the file with one decimal mark, and thousands without any"

Columns = list["array[float]"]


class NoColumn(Exception):
    """A column that the file does not have: which of those wanted, and the finding."""

    def __init__(self, number: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.number, self.finding = number, finding


class CsvError(Exception):
    """Line and column in a CSV file, and what is wrong there."""

    def __init__(self, line: int, column: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.line, self.column, self.finding = line, column, finding


class Heading(NamedTuple):
    """What stands above a column, and on which line; the column's number counts from 1."""

    text: str
    line: int
    number: int


class ColumnLayout(NamedTuple):
    """How a file is written: what separates cells, the names in its first row, how many cells that has, and how many
    lines stand before the numbers."""

    mark: str | None
    names: list[str]
    width: int
    before: int


def columns_of(text: str, *wanted: object) -> Columns:
    """Columns of a text, by their names in the first row or their numbers from 1. Raises CsvError, NoColumn."""
    return read_columns(text, *wanted)[0]


def read_columns(text: str, *wanted: object) -> tuple[Columns, list[Heading | None]]:
    """Columns of a text, and what stands above each of them (None where the first row is a point).

    wanted: names in the first row, with their unit or without, or numbers from 1. Raises CsvError, NoColumn.
    """
    layout = layout_of(text)
    indices = [column(number, key, layout, text) for number, key in enumerate(wanted)]
    if all(counted(str(key)) is not None for key in wanted) and begins_at_once(layout, indices, text):
        layout = ColumnLayout(layout.mark, [], layout.width, layout.before - 1)
    columns: Columns = [array("d") for _ in wanted]
    for line, lines in numbered(text, layout.before):
        if not read_plain(lines, layout.mark, indices, columns):
            read_rows(lines, line, layout.mark, indices, columns)
        if len(columns[0]) > MOST_ROWS:
            raise CsvError(1, 1, Finding("too-large", f"more than {MOST_ROWS} rows; at most so many are read", FEWER))
    if layout.mark == ";" and "," in text and "." in text:
        require_one_decimal_mark(text, layout, indices)
    headings = [Heading(layout.names[i], layout.before, i + 1) if layout.names else None for i in indices]
    return columns, headings


def require_one_decimal_mark(text: str, layout: ColumnLayout, indices: Sequence[int]) -> None:
    """Refuse columns with decimal commas in some cells and points in others. Raises CsvError."""
    first: tuple[str, str, int] | None = None  # a mark, the first cell with it, its line
    for begin, lines in numbered(text, layout.before):
        for n, line in enumerate(lines, begin):
            if not is_row(line):
                continue
            row = cells(n, line, layout.mark)
            for index in indices:
                cell = row[index].strip()
                mark = next((one for one in ",." if one in cell), None)
                if mark is None:
                    continue
                first = first or (mark, cell, n)
                if mark != first[0]:
                    message = (
                        f"'{cell}' in column {index + 1} beside '{first[1]}' on line {first[2]}: two decimal marks"
                    )
                    raise CsvError(n, 1, Finding("table-file", message, ONE_MARK))


def numbered(text: str, before: int = 0) -> Iterator[tuple[int, list[str]]]:
    """The lines of a text behind the first `before`, many at a time, and the number of the first of them, from 1."""
    begin, line = 0, 1
    while begin < len(text):
        end = text.find("\n", begin + PIECE) + 1 or len(text)
        lines = text[begin:end].splitlines()
        left_out = max(before + 1 - line, 0)
        yield line + left_out, lines[left_out:]
        begin, line = end, line + len(lines)


def rows_of(text: str) -> Iterator[tuple[int, str]]:
    """The lines that count, with their numbers."""
    for first, lines in numbered(text):
        yield from ((n, line) for n, line in enumerate(lines, first) if is_row(line))


def is_row(line: str) -> bool:
    """Whether a line counts."""
    shown = line.lstrip()
    return shown != "" and not shown.startswith("#")


def layout_of(text: str) -> ColumnLayout:
    """How a text is written, by its first row. Raises CsvError."""
    n, line = next(rows_of(text), (0, ""))
    if not n:
        raise CsvError(1, 1, Finding("table-file", "the file holds no rows", ROWS))
    mark = next((m for m in (";", "\t", ",") if m in line), None)
    first = [cell.strip() for cell in cells(n, line, mark)]
    if all(as_number(cell, mark) is not None for cell in first):
        return ColumnLayout(mark, [], len(first), n - 1)
    return ColumnLayout(mark, first, len(first), n)


def begins_at_once(layout: ColumnLayout, indices: Sequence[int], text: str) -> bool:
    """Whether what was taken for names is the first point of columns named by number: "0,1,start", "0,1,", "0,NaN".

    Its x is a number then, or all that is wanted begins as one: "0 s,1 N", which is no point, and no names either.
    Numbers do serve as names, beside a name or an empty cell where the rows have numbers, too.
    """
    first = layout.names
    if not first or not first[0]:
        return False
    if not is_like_number(first[indices[0]], layout.mark):
        return all(BEGINS_AS_NUMBER.match(first[i]) for i in indices)
    words = {i for i, cell in enumerate(first) if cell and not is_like_number(cell, layout.mark)} - set(indices)
    n, line = next(islice(rows_of(text), 1, 2), (0, ""))
    second = cells(n, line, layout.mark) if n else []
    return not any(as_number(cell, layout.mark) is not None for i, cell in enumerate(second) if i in words)


def read_plain(lines: list[str], mark: str | None, indices: Sequence[int], columns: Columns) -> bool:
    """Add lines of nothing but plain numbers to the columns; False: they are something else, and nothing is added."""
    text = "\n".join(lines)
    if not text.isascii():
        return False
    others = set(text.encode().translate(None, PLAIN).decode()) - {mark}
    if others == {","} and mark == ";" and "." not in text:  # decimal commas
        lines = text.replace(",", ".").split("\n")
    elif others:
        return False
    if not text.strip():
        return True
    try:
        values = np.loadtxt(lines, delimiter=mark, comments=None, usecols=indices, ndmin=2, encoding=None)
    except ValueError:
        return False
    if not np.isfinite(values).all():
        return False
    for found, numbers in zip(values.T, columns, strict=True):
        numbers.frombytes(found.tobytes())
    return True


def read_rows(lines: list[str], first: int, mark: str | None, indices: Sequence[int], columns: Columns) -> None:
    """Add lines to the columns, cell by cell. Raises CsvError."""
    for n, line in enumerate(lines, first):
        if not is_row(line):
            continue
        row = cells(n, line, mark)
        for index, numbers in zip(indices, columns, strict=True):
            if index >= len(row):
                message = f"the row has {len(row)} cells, column {index + 1} is missing"
                raise CsvError(n, 1, Finding("table-file", message, ROWS))
            value = as_number(row[index], mark)
            if value is None:
                shown = quoted(row[index].strip(), among_numbers=bool(numbers))
                message = f"{shown} in column {index + 1} is not a number"
                raise CsvError(n, 1, Finding("table-file", message, hint_for(row[index], mark)))
            numbers.append(value)


def cells(n: int, line: str, mark: str | None) -> list[str]:
    """The cells of a row. Raises CsvError."""
    if mark is None or '"' not in line:
        return line.split(mark)
    try:
        return next(csv.reader([line], delimiter=mark, strict=True))
    except csv.Error as error:
        raise CsvError(n, 1, Finding("table-file", f"the row cannot be read: {error}", QUOTES)) from None


def as_number(cell: str, mark: str | None) -> float | None:
    """The finite number in a cell, if there is one."""
    cell = cell.strip()
    if mark == ";" and "." not in cell:
        cell = cell.replace(",", ".")
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in cell else None


def is_like_number(cell: str, mark: str | None) -> bool:
    """Whether a cell was written as a number, be it one that is not read: nan, 1e400."""
    try:
        float(cell.replace(",", ".") if mark == ";" else cell)
    except ValueError:
        return False
    return True


def quoted(cell: str, among_numbers: bool) -> str:
    """A cell as it may be told: not where the file may be no table at all, and hold what is nobody's business."""
    if not cell:
        return "an empty cell"
    is_numeric = set(cell) <= NUMERIC or cell.lower().lstrip("+-") in NOT_FINITE
    if (is_numeric or among_numbers) and len(cell) <= LONGEST_NUMBER:
        return f"'{cell}'"
    return "what stands"


def hint_for(cell: str, mark: str | None) -> str:
    """What a cell should hold."""
    if mark != ";" and "," in cell:
        return "a decimal is written with a point, as 1.5; with commas where semicolons separate"
    return NUMBERS


def column(number: int, key: object, layout: ColumnLayout, text: str) -> int:
    """Index of a column, from 0; number: which of those wanted. Raises NoColumn."""
    place = counted(str(key)) if isinstance(key, int | str) else None
    if isinstance(key, str) and place is None:
        found = [i for i, name in enumerate(layout.names) if name == key.strip()]
        found = found or [i for i, name in enumerate(layout.names) if name_in_heading(name) == key.strip()]
        if len(found) == 1:
            return found[0]
        if found:
            places = " or ".join(str(i + 1) for i in found)
            message = f"there are {len(found)} columns '{key}'"
            raise NoColumn(number, Finding("table-file", message, f"name it by its number: {places}"))
        raise NoColumn(number, Finding("table-file", f"there is no column '{key}'", known_columns(key, layout, text)))
    if place is None or not 1 <= place <= layout.width:
        finding = Finding("table-file", f"there is no column {key}", f"columns are counted from 1 to {layout.width}")
        raise NoColumn(number, finding)
    return place - 1


def known_columns(key: str, layout: ColumnLayout, text: str) -> str:
    """A hint for a column that is not there."""
    by_number = "columns may be named by 1, 2, ..., too"
    if not layout.names:
        return f"the first row holds numbers; {by_number}"
    names = names_of_numbers(layout, text)
    if not names:
        return f"its rows are no numbers under names; {by_number}"
    near = nearest(key, names)
    hint = f"columns are: {listed(names)}"
    return f"did you mean {near}? {hint}" if near else f"{hint}; {by_number}"


def names_of_numbers(layout: ColumnLayout, text: str) -> list[str]:
    """The names in the first row, if the others are numbers. Of a file that is no table of numbers nothing is told: it
    may be any file, and its first row anything."""
    rows = [cells(n, line, layout.mark) for n, line in islice(rows_of(text), 1, LOOKED_THROUGH + 1)]
    if not rows or not all(len(row) == layout.width and is_of_numbers(row, layout.mark) for row in rows):
        return []
    return [name for name in layout.names if name and len(name) <= LONGEST]


def is_of_numbers(row: list[str], mark: str | None) -> bool:
    """Whether a row holds numbers alone, in some of its cells."""
    filled = [cell for cell in row if cell.strip()]
    return bool(filled) and all(as_number(cell, mark) is not None for cell in filled)
