"""Entries of `tables:` -> functions: columns of a CSV file or lists in the spec, in SI. Impure: reads files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from heuncli import tolerances
from heuncli.errors import Finding, SourceLocation
from heuncli.expressions.curves import fit
from heuncli.expressions.programs import Table
from heuncli.expressions.units import Dimension, parse_unit
from heuncli.nearest import nearest
from heuncli.number_range import is_in_range, out_of_range
from heuncli.records import record, replace
from heuncli.spec.format import Table as Entry
from heuncli.spec.quantity import Scope, number
from heuncli.spec.reading import read_bytes

MOST_ROWS = 2_000_000
LARGEST = 200_000_000  # bytes: that many rows of a hundred characters
RELATIVE = "a path is relative to the spec's folder"
# what to do about it
SLOPES = "keep x and y within some ten powers of ten, in units of their own: x_unit, y_unit"
CONSTANT = "a value that does not change is a parameter"
ROWS = "each row has its numbers between commas, as 0.5, 12"
FEWER = "keep the points that matter: between them the table interpolates"
NUMBERS = "one number a cell, with a point; lines of words begin with #"
QUOTES = "quotes come in pairs; plain numbers need none"


@record
class Wrong:
    """A finding at a key of the entry, or at a location in its file."""

    keys: tuple[str | int, ...]
    finding: Finding
    location: SourceLocation | None = None


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


def build_table(name: str, entry: Entry, scope: Scope, folder: Path) -> tuple[Table | None, list[Wrong]]:
    """The table of an entry, or what is wrong with it."""
    wrong: list[Wrong] = []
    sizes = [unit_size(key, getattr(entry, key), wrong) for key in ("x_unit", "y_unit")]
    if entry.file is not None:
        if isinstance(entry.x, list) or isinstance(entry.y, list):
            hint = "with a file, x and y name its columns"
            return None, [*wrong, Wrong((), Finding("table-form", "both a file and lists of numbers", hint))]
        columns = from_file(entry, entry.file, folder, wrong)
        if columns is not None:
            columns = [[v * size for v in column] for column, size in zip(columns, sizes, strict=True)]
    elif isinstance(entry.x, list) and isinstance(entry.y, list):
        columns = [
            [v for i, item in enumerate(items) if (v := read(item, size, scope, (key, i), wrong)) is not None]
            for key, items, size in (("x", entry.x, sizes[0]), ("y", entry.y, sizes[1]))
        ]
    else:
        hint = "give {file, x, y} with columns by name or number, or the lists {x: [...], y: [...]}"
        return None, [*wrong, Wrong((), Finding("table-form", "neither a file nor lists of numbers x and y", hint))]
    if columns is None or wrong:
        return None, wrong
    x, y = columns
    wrong += too_small_or_large(columns, entry)
    wrong += shape_of(x, y, entry) if not wrong else ()
    if wrong:
        return None, wrong
    if entry.period is not None:
        x[-1], y[-1] = x[0] + entry.period, y[0]
    table = fit(name, x, y, entry.interpolation, entry.outside, entry.period)
    table = replace(table, dimensions=(dimension_of(entry.x_unit), dimension_of(entry.y_unit)))
    if not all(map(math.isfinite, table.numbers)):
        return None, [
            Wrong((), Finding("table-shape", "its points lie too close together or too far apart for a slope", SLOPES))
        ]
    return table, []


def dimension_of(unit: str | None) -> Dimension | None:
    """The dimension of a column with a unit that was read."""
    return parse_unit(unit)[1] if unit is not None else None


def unit_size(key: str, unit: str | None, wrong: list[Wrong]) -> float:
    """Size of a column's unit in SI."""
    try:
        return parse_unit(unit)[0] if unit is not None else 1.0
    except Finding as finding:
        wrong.append(Wrong((key,), finding))
        return 1.0


def read(item: object, size: float, scope: Scope, keys: tuple[str | int, ...], wrong: list[Wrong]) -> float | None:
    """One number of a list: plain ones in the column's unit, texts as anywhere else in a spec."""
    try:
        value = number(item, None, scope)
    except Finding as finding:
        wrong.append(Wrong(keys, finding))
        return None
    return value if isinstance(item, str) else value * size


def too_small_or_large(columns: list[list[float]], entry: Entry) -> Iterator[Wrong]:
    """The first number of each column that is not computed with."""
    for key, column in zip(("x", "y"), columns, strict=True):
        sizes = [*map(abs, column)]
        if not is_in_range(max(sizes, default=0.0)) or not is_in_range(min(filter(None, sizes), default=0.0)):
            i = next(i for i, value in enumerate(column) if not is_in_range(value))
            in_file = entry.file is not None
            yield Wrong(("file",) if in_file else (key, i), out_of_range(column[i], f"number {i + 1} of {key} (SI)"))


def shape_of(x: list[float], y: list[float], entry: Entry) -> Iterator[Wrong]:
    """What keeps points from being a function."""
    at = () if entry.file is None else ("file",)
    if len(x) != len(y):
        yield Wrong(at, Finding("table-shape", f"{len(x)} values of x and {len(y)} of y", "each x has its y"))
        return
    if len(x) < 2:
        yield Wrong(at, Finding("table-shape", "a table needs two points at least", CONSTANT))
        return
    for i in range(1, len(x)):
        if x[i] <= x[i - 1]:
            message = f"x must ascend, but {x[i]:.9g} follows {x[i - 1]:.9g} (SI)"
            keys = ("x", i) if entry.file is None else at
            hint = "for a jump let x grow by a little" if x[i] == x[i - 1] else "sort the points by x"
            yield Wrong(keys, Finding("table-shape", message, hint))
            return
    if entry.period is None:
        return
    if entry.outside is not None:
        yield Wrong(("outside",), Finding("table-form", "both period and outside", "a periodic table has no outside"))
    span = x[-1] - x[0]
    if abs(entry.period - span) > tolerances.TABLE_ENDS * span:
        message = f"the period is {entry.period:.9g}, but x spans {span:.9g} (SI)"
        unit = f"a period has its own unit: '{entry.period:g} {entry.x_unit}'" if entry.x_unit else None
        yield Wrong(
            ("period",), Finding("table-period", message, unit or "the last point repeats the first, one period on")
        )
    elif abs(y[-1] - y[0]) > tolerances.TABLE_ENDS * (max(y) - min(y)):
        message = f"the ends of a periodic table must agree, but y is {y[0]:.9g} and {y[-1]:.9g} (SI)"
        yield Wrong(("period",), Finding("table-period", message, "the last point repeats the first, one period on"))


def from_file(entry: Entry, file: str, folder: Path, wrong: list[Wrong]) -> list[list[float]] | None:
    """The two columns of a CSV file, as they stand there."""
    path = folder / file
    try:
        text = text_of(path)
    except Finding as finding:
        wrong.append(Wrong(("file",), finding))
        return None
    try:
        return columns_of(text, entry.x if entry.x is not None else 1, entry.y if entry.y is not None else 2)
    except NoColumn as error:
        key = ("x", "y")[error.number]
        absent = error.finding
        message = f"{absent.message} in '{path}'"
        wrong.append(Wrong((key,), Finding(absent.code, message, absent.hint)))
        return None
    except CsvError as error:
        wrong.append(Wrong(("file",), error.finding, SourceLocation(str(path), error.line, error.column)))
        return None


def text_of(path: Path) -> str:
    """The text of a file of a table. Raises Finding."""
    try:
        return read_bytes(str(path), LARGEST).decode("utf-8-sig")
    except UnicodeDecodeError:
        reason, code, hint = "it is not UTF-8", "table-file", "save it as CSV in UTF-8"
    except Finding as refused:
        is_large = refused.code == "too-large"
        reason, code = refused.message, refused.code if is_large else "table-file"
        hint = "a table of fewer points, or of these two columns alone" if is_large else RELATIVE
    raise Finding(code, f"the file '{path}' cannot be read: {reason}", hint)


def columns_of(text: str, *wanted: object) -> list[list[float]]:
    """Columns of CSV text, by their names in the first row or their numbers from 1. Raises CsvError, NoColumn.

    Commas, semicolons (then with decimal commas, too), tabs or spaces separate; empty lines and lines that begin with #
    do not count.
    """
    lines = [
        (n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise CsvError(1, 1, Finding("table-file", "the file holds no rows", ROWS))
    if len(lines) > MOST_ROWS:
        raise CsvError(1, 1, Finding("table-file", f"{len(lines)} rows; at most {MOST_ROWS} are read", FEWER))
    mark = next((m for m in (";", "\t", ",") if m in lines[0][1]), None)
    rows = [(n, cells(n, line, mark)) for n, line in lines]
    header = [cell.strip() for cell in rows[0][1]]
    is_header = not all(as_number(cell, mark) is not None for cell in header)
    body = rows[1:] if is_header else rows
    indices = [column(i, key, header if is_header else [], len(header)) for i, key in enumerate(wanted)]
    columns: list[list[float]] = [[] for _ in wanted]
    for n, row in body:
        for index, values in zip(indices, columns, strict=True):
            if index >= len(row):
                message = f"the row has {len(row)} cells, column {index + 1} is missing"
                raise CsvError(n, 1, Finding("table-file", message, ROWS))
            value = as_number(row[index], mark)
            if value is None:
                message = f"'{row[index].strip()}' in column {index + 1} is not a number"
                raise CsvError(n, 1, Finding("table-file", message, NUMBERS))
            values.append(value)
    return columns


def cells(n: int, line: str, mark: str | None) -> list[str]:
    """The cells of a row."""
    if mark is None:
        return line.split()
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


def column(number: int, key: object, header: list[str], count: int) -> int:
    """Index of a column, from 0; number: which of those wanted."""
    if isinstance(key, str) and not key.isdigit():
        if key in header:
            return header.index(key)
        hint = f"the first row is: {', '.join(header)}" if header else "the first row holds numbers"
        near = nearest(key, header)
        hint = f"did you mean {near}? {hint}" if near else f"{hint}; columns may be named by 1, 2, ..., too"
        raise NoColumn(number, Finding("table-file", f"there is no column '{key}'", hint))
    index = int(str(key)) if str(key).isdigit() else 0
    if not 1 <= index <= count:
        finding = Finding("table-file", f"there is no column {key}", f"columns are counted from 1 to {count}")
        raise NoColumn(number, finding)
    return index - 1
