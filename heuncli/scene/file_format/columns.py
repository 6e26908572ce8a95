"""Read columns of numbers from a CSV text as programs write it.

A file has one decimal mark: where decimal commas occur, a point may be a thousands separator. The text is read in
pieces of many lines: NumPy reads those with only plain numbers. All others are read cell by cell under the same rules,
and so are those with an error, to report what is wrong and where.
"""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Sequence
from itertools import islice

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results_schema import parse_index
from heuncli.scene.file_format.column_layout import (
    ROWS_HINT,
    WIDTH_HINT,
    ColumnLayout,
    Columns,
    CsvError,
    Heading,
    cell_hint,
    detect_layout,
    find_column,
    is_first_row_a_point,
    is_gap,
    is_row,
    iter_line_pieces,
    iter_rows,
    parse_number,
    quote_cell,
    split_cells,
)

MOST_ROWS = 2_000_000
PLAIN_CHARACTERS = b"0123456789+-.eE \t\r\n"
GROUPED_DIGITS = re.compile(r"[-+]?[1-9][0-9]{0,2}(?:,[0-9]{3})+\Z")  # 1,234: a thousand, or decimals
QUOTED_COMMA = re.compile(r'"\s*[-+]?[0-9]*,[0-9]')
COMMA_AT_DIGIT = re.compile(r"[0-9],|,[0-9]")
# hints
FEWER_ROWS_HINT = "keep only the points needed: the table interpolates between them"
ONE_MARK_HINT = "use one decimal mark in the whole file, and no thousands separators"
NO_GROUPS_HINT = "write thousands without a separator, and decimals with a point"


class ReadColumns(NamedTuple):
    """Columns as read from a text.

    numbers: the columns, of equal length
    headings: of each column; None where the file has none
    layout: of the text
    rows: the index of each point among the rows of the text; None if every row is a point
    gaps: rows with a gap: how many there are, how many of them were filled, and the line of the first
    """

    numbers: Columns
    headings: list[Heading | None]
    layout: ColumnLayout
    rows: array[int] | None = None
    gaps: tuple[int, int, int] = (0, 0, 0)

    def find_line(self, text: str, point: int) -> int:
        """Return the line of a point in the text that was read."""
        row = point if self.rows is None else self.rows[point]
        return next(islice(iter_rows(text, self.layout.header_lines), row, None), (1, ""))[0]

    def list_lines(self, text: str) -> array[int]:
        """Return the lines of all points in the text that was read."""
        lines = array("q", [n for n, _ in iter_rows(text, self.layout.header_lines)])
        return lines if self.rows is None else array("q", [lines[row] for row in self.rows])


def read_column_numbers(text: str, *keys: object) -> Columns:
    """Read columns by name or by number from 1, without their headings. Raises CsvError, MissingColumnError."""
    return read_columns(text, *keys).numbers


def read_columns(text: str, *keys: object, skip: int = 0, gaps: str = "refuse") -> ReadColumns:
    """Read columns and their headings (None where the file has none).

    keys: names in the headings, with or without their unit, or numbers from 1
    skip: number of lines before the headings
    gaps: refuse rows with a gap, skip them, or fill y where x is given and both neighbours are (linear)

    Raises CsvError, MissingColumnError.
    """
    layout = detect_layout(text, skip)
    indices = [find_column(number, key, layout, text) for number, key in enumerate(keys)]
    has_only_numbers = all(parse_index(str(key)) is not None for key in keys)
    if has_only_numbers and is_first_row_a_point(layout, indices, text):
        layout = ColumnLayout(layout.separator, [], layout.width, layout.header_lines - 1)
    if has_only_numbers and layout.separator is None and layout.has_hash_names:
        layout = layout._replace(names=[])  # words behind # that happen to be as many as the numbers
    if has_only_numbers:  # the headings, or a title, do not matter
        n, row = next(iter_rows(text, layout.header_lines), (0, ""))
        layout = layout._replace(width=max(layout.width, len(split_cells(n, row, layout.separator))))
    columns: Columns = [array("d") for _ in keys]
    for line, lines in iter_line_pieces(text, layout.header_lines):
        if not read_plain(lines, layout, indices, columns):
            read_rows(lines, line, layout, indices, columns, gaps != "refuse")
        if len(columns[0]) > MOST_ROWS:
            raise CsvError(
                1, 1, Finding("too-large", f"more than {MOST_ROWS} rows, the maximum that is read", FEWER_ROWS_HINT)
            )
    if may_have_decimal_commas(text, layout.separator):
        check_decimal_marks(text, layout, indices)
    headings = [Heading(layout.names[i], layout.names_line, i + 1) if layout.names else None for i in indices]
    found = ReadColumns(columns, headings, layout)
    return found if gaps == "refuse" else close_gaps(found, text, fills=gaps == "linear")


def close_gaps(columns: ReadColumns, text: str, fills: bool) -> ReadColumns:
    """Leave out the rows with a gap (NaN) in a column, or fill the last column on a straight line where it can be."""
    values = np.array([np.frombuffer(column) if column else np.empty(0) for column in columns.numbers])
    has_gap = np.isnan(values).any(axis=0)
    if not has_gap.any():
        return columns
    y, is_point = values[-1], ~has_gap
    known = np.flatnonzero(is_point)
    if fills and len(known) > 1:
        between = np.arange(len(y))
        fillable = has_gap & ~np.isnan(values[:-1]).any(axis=0) & (between > known[0]) & (between < known[-1])
        y[fillable] = np.interp(values[0][fillable], values[0][known], y[known])
        is_point |= fillable
    rows = np.flatnonzero(is_point)
    gap_count, filled_count = int(has_gap.sum()), int((is_point & has_gap).sum())
    first_line = columns.find_line(text, int(has_gap.argmax()))
    numbers = [array("d", column[rows].tobytes()) for column in values]
    return columns._replace(
        numbers=numbers, rows=array("q", rows.astype(np.int64).tobytes()), gaps=(gap_count, filled_count, first_line)
    )


def may_have_decimal_commas(text: str, separator: str | None) -> bool:
    """Whether cells may have commas whose meaning is to be checked; quick, as the check itself is not."""
    if separator == ";":
        return "," in text and "." in text
    return (QUOTED_COMMA if separator == "," else COMMA_AT_DIGIT).search(text) is not None


def check_decimal_marks(text: str, layout: ColumnLayout, indices: Sequence[int]) -> None:
    """Refuse columns with decimal commas in some cells and points in others, and commas that may group thousands.

    Semicolons as separators say that commas are decimal marks. Raises CsvError.
    """
    has_points, is_decimal = "." in text, layout.separator == ";"
    first: tuple[str, str, int, int] | None = None  # decimal mark, first cell with it, its line and column
    for begin, lines in iter_line_pieces(text, layout.header_lines):
        for n, line in enumerate(lines, begin):
            if not is_row(line):
                continue
            row = split_cells(n, line, layout.separator)
            for index in indices:
                cell = row[index].strip() if index < len(row) else ""
                mark = next((one for one in ",." if one in cell), None)
                if mark is None:
                    continue
                first = first or (mark, cell, n, index + 1)
                is_decimal = is_decimal or (mark == "," and not GROUPED_DIGITS.match(cell))
                if mark != first[0]:
                    message = f"'{cell}' in column {index + 1}, but '{first[1]}' on line {first[2]}: two decimal marks"
                    raise CsvError(n, 1, Finding("table-file", message, ONE_MARK_HINT))
            if is_decimal and not has_points:
                return
    if first is not None and first[0] == "," and not is_decimal:
        message = f"'{first[1]}' in column {first[3]} may have a decimal comma, or one between thousands"
        raise CsvError(first[2], 1, Finding("table-file", message, NO_GROUPS_HINT))


def read_plain(lines: list[str], layout: ColumnLayout, indices: Sequence[int], columns: Columns) -> bool:
    """Append lines of plain numbers to the columns. Returns False, and appends nothing, if a line is not plain."""
    text, separator = "\n".join(lines), layout.separator
    if not text.isascii():
        return False
    others = set(text.encode().translate(None, PLAIN_CHARACTERS).decode()) - {separator}
    if others == {","} and separator in (";", "\t") and "." not in text:  # decimal commas
        lines = text.replace(",", ".").split("\n")
    elif others:
        return False
    if not text.strip():
        return True
    if any((len(line.split()) if separator is None else line.count(separator) + 1) > layout.width for line in lines):
        return False
    try:
        values = np.loadtxt(lines, delimiter=separator, comments=None, usecols=indices, ndmin=2, encoding=None)
    except ValueError:
        return False
    if not np.isfinite(values).all():
        return False
    for column_values, numbers in zip(values.T, columns, strict=True):
        numbers.frombytes(column_values.tobytes())
    return True


def read_rows(
    lines: list[str], first: int, layout: ColumnLayout, indices: Sequence[int], columns: Columns, allows_gaps: bool
) -> None:
    """Append lines to the columns, cell by cell; a gap is NaN if gaps are allowed. Raises CsvError."""
    for n, line in enumerate(lines, first):
        if not is_row(line):
            continue
        row = split_cells(n, line, layout.separator)
        if any(parse_number(cell) is not None for cell in row[layout.width :]):
            message = f"the row has {len(row)} cells, rows before it {layout.width}"
            raise CsvError(n, layout.width + 1, Finding("table-file", message, WIDTH_HINT))
        for index, numbers in zip(indices, columns, strict=True):
            cell = row[index] if index < len(row) else ""
            if allows_gaps and is_gap(cell):
                numbers.append(math.nan)
                continue
            if index >= len(row):
                message = f"the row has {len(row)} cells, column {index + 1} is missing"
                raise CsvError(n, 1, Finding("table-file", message, ROWS_HINT))
            value = parse_number(cell)
            if value is None:
                cell_text = quote_cell(cell.strip(), among_numbers=bool(numbers))
                message = f"{cell_text} in column {index + 1} is not a number"
                raise CsvError(n, 1, Finding("table-file", message, cell_hint(cell)))
            numbers.append(value)
