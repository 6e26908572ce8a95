"""Read columns of numbers from a CSV text as programs write it.

Commas, semicolons (which also allow decimal commas), tabs or blanks separate cells; empty lines and lines that begin
with # are skipped. A file has one decimal mark: where decimal commas occur, a point may be a thousands separator. The
text is read in pieces of many lines: NumPy reads those with only plain numbers. All others are read cell by cell under
the same rules, and so are those with an error, to report what is wrong and where.
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
from heuncli.base.spelling import MAX_WORD_LENGTH, find_similar, list_words
from heuncli.results.results_schema import parse_index
from heuncli.scene.file_format.headings import name_in_heading

MOST_ROWS = 2_000_000
PIECE = 1 << 20  # characters: large enough to make NumPy's overhead negligible, small enough to save memory
MAX_EXAMINED_ROWS = 1000  # rows examined before a message may quote a file's headings
MAX_NUMBER_LENGTH = 24  # characters; a double needs 24 at most
PLAIN_CHARACTERS = b"0123456789+-.eE \t\r\n"
NUMERIC_CHARACTERS = frozenset("0123456789+-.,eE_% ")
NOT_FINITE = frozenset({"nan", "inf", "infinity"})
BEGINS_AS_NUMBER = re.compile(r"[-+]?[.,]?[0-9]")
# hints
ROWS_HINT = "separate the numbers of a row by commas: 0.5, 12"
FEWER_ROWS_HINT = "keep only the points needed: the table interpolates between them"
NUMBERS_HINT = "one number per cell, with a decimal point; start lines of text with #"
QUOTES_HINT = "close each quote; plain numbers need none"
ONE_MARK_HINT = "use one decimal mark in the whole file, and no thousands separators"

Columns = list["array[float]"]


class MissingColumnError(Exception):
    """A requested column does not exist: its index among the requested ones, and the finding."""

    def __init__(self, number: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.number, self.finding = number, finding


class CsvError(Exception):
    """An error in a CSV file: line, column and finding."""

    def __init__(self, line: int, column: int, finding: Finding) -> None:
        super().__init__(finding.message)
        self.line, self.column, self.finding = line, column, finding


class Heading(NamedTuple):
    """The heading of a column, the line it is on, and the column's number from 1."""

    text: str
    line: int
    number: int


class ColumnLayout(NamedTuple):
    """Layout of a file.

    separator: the cell separator; None: blanks
    names: the cells of the first row if they are headings, else empty
    width: number of cells in the first row
    header_lines: number of lines before the numbers
    """

    separator: str | None
    names: list[str]
    width: int
    header_lines: int


def read_column_numbers(text: str, *keys: object) -> Columns:
    """Read columns by name or by number from 1, without their headings. Raises CsvError, MissingColumnError."""
    return read_columns(text, *keys)[0]


def read_columns(text: str, *keys: object) -> tuple[Columns, list[Heading | None]]:
    """Read columns and their headings (None where the first row holds numbers).

    keys: names in the first row, with or without their unit, or numbers from 1. Raises CsvError, MissingColumnError.
    """
    layout = detect_layout(text)
    indices = [find_column(number, key, layout, text) for number, key in enumerate(keys)]
    if all(parse_index(str(key)) is not None for key in keys) and is_first_row_a_point(layout, indices, text):
        layout = ColumnLayout(layout.separator, [], layout.width, layout.header_lines - 1)
    columns: Columns = [array("d") for _ in keys]
    for line, lines in iter_line_pieces(text, layout.header_lines):
        if not read_plain(lines, layout.separator, indices, columns):
            read_rows(lines, line, layout.separator, indices, columns)
        if len(columns[0]) > MOST_ROWS:
            raise CsvError(
                1, 1, Finding("too-large", f"more than {MOST_ROWS} rows, the maximum that is read", FEWER_ROWS_HINT)
            )
    if layout.separator == ";" and "," in text and "." in text:
        require_one_decimal_mark(text, layout, indices)
    headings = [Heading(layout.names[i], layout.header_lines, i + 1) if layout.names else None for i in indices]
    return columns, headings


def require_one_decimal_mark(text: str, layout: ColumnLayout, indices: Sequence[int]) -> None:
    """Refuse columns with decimal commas in some cells and points in others. Raises CsvError."""
    first: tuple[str, str, int] | None = None  # decimal mark, first cell with it, its line
    for begin, lines in iter_line_pieces(text, layout.header_lines):
        for n, line in enumerate(lines, begin):
            if not is_row(line):
                continue
            row = split_cells(n, line, layout.separator)
            for index in indices:
                cell = row[index].strip()
                mark = next((one for one in ",." if one in cell), None)
                if mark is None:
                    continue
                first = first or (mark, cell, n)
                if mark != first[0]:
                    message = f"'{cell}' in column {index + 1}, but '{first[1]}' on line {first[2]}: two decimal marks"
                    raise CsvError(n, 1, Finding("table-file", message, ONE_MARK_HINT))


def iter_line_pieces(text: str, header_lines: int = 0) -> Iterator[tuple[int, list[str]]]:
    """Yield the lines after the header in pieces of many lines, each with the number, from 1, of its first line."""
    begin, line = 0, 1
    while begin < len(text):
        end = text.find("\n", begin + PIECE) + 1 or len(text)
        lines = text[begin:end].splitlines()
        skipped = max(header_lines + 1 - line, 0)
        yield line + skipped, lines[skipped:]
        begin, line = end, line + len(lines)


def iter_rows(text: str) -> Iterator[tuple[int, str]]:
    """Yield the lines that hold a row, with their line numbers."""
    for first, lines in iter_line_pieces(text):
        yield from ((n, line) for n, line in enumerate(lines, first) if is_row(line))


def is_row(line: str) -> bool:
    """Whether a line holds a row: neither empty nor a comment."""
    stripped = line.lstrip()
    return stripped != "" and not stripped.startswith("#")


def detect_layout(text: str) -> ColumnLayout:
    """Detect the layout of a text from its first row. Raises CsvError."""
    n, line = next(iter_rows(text), (0, ""))
    if not n:
        raise CsvError(1, 1, Finding("table-file", "the file has no rows", ROWS_HINT))
    separator = next((m for m in (";", "\t", ",") if m in line), None)
    first = [cell.strip() for cell in split_cells(n, line, separator)]
    if all(parse_number(cell, separator) is not None for cell in first):
        return ColumnLayout(separator, [], len(first), n - 1)
    return ColumnLayout(separator, first, len(first), n)


def is_first_row_a_point(layout: ColumnLayout, indices: Sequence[int], text: str) -> bool:
    """Whether the row taken for headings is the first point of columns requested by number: "0,1,start", "0,1,",
    "0,NaN".

    It is if its x is a number, or if all requested cells begin like one ("0 s,1 N": not a point, but no headings
    either). Numbers still count as headings if they stand next to a word or an empty cell whose column holds numbers.
    """
    first = layout.names
    if not first or not first[0]:
        return False
    if not is_like_number(first[indices[0]], layout.separator):
        return all(BEGINS_AS_NUMBER.match(first[i]) for i in indices)
    words = {i for i, cell in enumerate(first) if cell and not is_like_number(cell, layout.separator)} - set(indices)
    n, line = next(islice(iter_rows(text), 1, 2), (0, ""))
    second = split_cells(n, line, layout.separator) if n else []
    return not any(parse_number(cell, layout.separator) is not None for i, cell in enumerate(second) if i in words)


def read_plain(lines: list[str], separator: str | None, indices: Sequence[int], columns: Columns) -> bool:
    """Append lines of plain numbers to the columns. Returns False, and appends nothing, if a line is not plain."""
    text = "\n".join(lines)
    if not text.isascii():
        return False
    others = set(text.encode().translate(None, PLAIN_CHARACTERS).decode()) - {separator}
    if others == {","} and separator == ";" and "." not in text:  # decimal commas
        lines = text.replace(",", ".").split("\n")
    elif others:
        return False
    if not text.strip():
        return True
    try:
        values = np.loadtxt(lines, delimiter=separator, comments=None, usecols=indices, ndmin=2, encoding=None)
    except ValueError:
        return False
    if not np.isfinite(values).all():
        return False
    for column_values, numbers in zip(values.T, columns, strict=True):
        numbers.frombytes(column_values.tobytes())
    return True


def read_rows(lines: list[str], first: int, separator: str | None, indices: Sequence[int], columns: Columns) -> None:
    """Append lines to the columns, cell by cell. Raises CsvError."""
    for n, line in enumerate(lines, first):
        if not is_row(line):
            continue
        row = split_cells(n, line, separator)
        for index, numbers in zip(indices, columns, strict=True):
            if index >= len(row):
                message = f"the row has {len(row)} cells, column {index + 1} is missing"
                raise CsvError(n, 1, Finding("table-file", message, ROWS_HINT))
            value = parse_number(row[index], separator)
            if value is None:
                cell_text = quote_cell(row[index].strip(), among_numbers=bool(numbers))
                message = f"{cell_text} in column {index + 1} is not a number"
                raise CsvError(n, 1, Finding("table-file", message, cell_hint(row[index], separator)))
            numbers.append(value)


def split_cells(n: int, line: str, separator: str | None) -> list[str]:
    """Split a row into its cells. Raises CsvError."""
    if separator is None or '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, strict=True))
    except csv.Error as error:
        raise CsvError(n, 1, Finding("table-file", f"the row cannot be read: {error}", QUOTES_HINT)) from None


def parse_number(cell: str, separator: str | None) -> float | None:
    """Return the finite number in a cell, or None."""
    cell = cell.strip()
    if separator == ";" and "." not in cell:
        cell = cell.replace(",", ".")
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in cell else None


def is_like_number(cell: str, separator: str | None) -> bool:
    """Whether a cell is written as a number, even one that is refused: nan, 1e400."""
    try:
        float(cell.replace(",", ".") if separator == ";" else cell)
    except ValueError:
        return False
    return True


def quote_cell(cell: str, among_numbers: bool) -> str:
    """Quote a cell for a message, but only if it looks like a number: the file may be private and not a table at
    all.
    """
    if not cell:
        return "an empty cell"
    is_numeric = set(cell) <= NUMERIC_CHARACTERS or cell.lower().lstrip("+-") in NOT_FINITE
    if (is_numeric or among_numbers) and len(cell) <= MAX_NUMBER_LENGTH:
        return f"'{cell}'"
    return "the cell"


def cell_hint(cell: str, separator: str | None) -> str:
    """Return a hint on what a cell should hold."""
    if separator != ";" and "," in cell:
        return "write decimals with a point: 1.5; decimal commas need semicolons as separators"
    return NUMBERS_HINT


def find_column(number: int, key: object, layout: ColumnLayout, text: str) -> int:
    """Return the index, from 0, of a requested column.

    number: index of the request, for the error. Raises MissingColumnError.
    """
    column_number = parse_index(str(key)) if isinstance(key, int | str) else None
    if isinstance(key, str) and column_number is None:
        matches = [i for i, name in enumerate(layout.names) if name == key.strip()]
        matches = matches or [i for i, name in enumerate(layout.names) if name_in_heading(name) == key.strip()]
        if len(matches) == 1:
            return matches[0]
        if matches:
            number_list = " or ".join(str(i + 1) for i in matches)
            message = f"there are {len(matches)} columns '{key}'"
            raise MissingColumnError(number, Finding("table-file", message, f"give its number: {number_list}"))
        raise MissingColumnError(
            number, Finding("table-file", f"there is no column '{key}'", known_columns_hint(key, layout, text))
        )
    if column_number is None or not 1 <= column_number <= layout.width:
        finding = Finding("table-file", f"there is no column {key}", f"give a number from 1 to {layout.width}")
        raise MissingColumnError(number, finding)
    return column_number - 1


def known_columns_hint(key: str, layout: ColumnLayout, text: str) -> str:
    """Return a hint for a missing column."""
    by_number = "columns may also be given by number: 1, 2, ..."
    if not layout.names:
        return f"the first row contains numbers, not names; {by_number}"
    names = find_numeric_columns(layout, text)
    if not names:
        return f"it has no names above rows of numbers; {by_number}"
    near = find_similar(key, names)
    hint = f"columns: {list_words(names)}"
    return f"did you mean {near}? {hint}" if near else f"{hint}; {by_number}"


def find_numeric_columns(layout: ColumnLayout, text: str) -> list[str]:
    """Return the headings if all examined rows below hold numbers.

    Otherwise the result is empty: the file may be any file, and messages must not reveal its content.
    """
    rows = [split_cells(n, line, layout.separator) for n, line in islice(iter_rows(text), 1, MAX_EXAMINED_ROWS + 1)]
    if not rows or not all(len(row) == layout.width and holds_only_numbers(row, layout.separator) for row in rows):
        return []
    return [name for name in layout.names if name and len(name) <= MAX_WORD_LENGTH]


def holds_only_numbers(row: list[str], mark: str | None) -> bool:
    """Whether a row holds at least one cell and only numbers."""
    filled = [cell for cell in row if cell.strip()]
    return bool(filled) and all(parse_number(cell, mark) is not None for cell in filled)
