"""Build functions in SI from entries of `tables:`, which name columns of a CSV file or hold lists. Impure: reads
files.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.base.units import Dimension, are_in_range, parse_unit, range_error
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.column_layout import (
    MAX_NUMBER_LENGTH,
    Columns,
    CsvError,
    Heading,
    MissingColumnError,
)
from heuncli.scene.file_format.columns import ReadColumns, read_columns
from heuncli.scene.file_format.format import TableEntry
from heuncli.scene.file_format.headings import find_heading_unit
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.quantity import Scope, read_number
from heuncli.scene.file_format.table_signals import (
    SignalKeyError,
    check_signal_keys,
    has_signal_keys,
    prepare_signal,
    resample_table,
)

# hints
SLOPES_HINT = "keep x and y within about ten powers of ten; x_unit and y_unit set their units"
CONSTANT_HINT = "use a parameter for a constant value"
UNIT_CONFLICT_HINT = "give the unit of the heading, or correct the heading"
NO_FILE_HINT = "leave it out: it is for a file; lists hold their numbers as they are"
UNIT_KEYS = ("x_unit", "y_unit")
UNIT_CODE = "column-unit"
GAPS_CODE = "table-gaps"
EXAMPLE_UNITS = {  # one meaning of each ambiguous unit
    "g": "m/s^2", "G": "m/s^2", "t": "tonne", "lb": "lbf",
    **dict.fromkeys(("1/min", "min-1", "min^-1", "1/s", "s-1", "s^-1", "Hz"), "rpm"),
}  # fmt: skip

Locate = Callable[[int], SourceLocation]


@record
class TableProblem:
    """A problem of a table, at a key of its entry or a place in its file; a warning does not prevent its use."""

    keys: tuple[str | int, ...]
    finding: Finding
    location: SourceLocation | None = None
    is_warning: bool = False


class ColumnUnit(NamedTuple):
    """The unit of a column: its size in SI, its dimension if that is certain, and the heading that states it."""

    size: float
    dimension: Dimension | None
    heading: Heading | None = None


class FileColumns(NamedTuple):
    """The columns of a CSV file in SI, with their units.

    locate: returns the place of a point in the file
    list_lines: returns the lines of all points
    """

    numbers: Columns
    units: list[ColumnUnit]
    locate: Locate
    list_lines: Callable[[], array[int]]


def has_error(problems: list[TableProblem]) -> bool:
    """Whether an entry cannot be used."""
    return any(not one.is_warning for one in problems)


def build_table(
    name: str, entry: TableEntry, scope: Scope, files: NamedFiles
) -> tuple[TableFunction | None, list[TableProblem]]:
    """Build the table of an entry (None if it cannot be used) and list its problems."""
    problems = [TableProblem(("ends",), finding) for finding in check_ends(entry)]
    problems += [TableProblem((key,), finding) for key, finding in check_signal_keys(entry)]
    columns, units, locate = read_columns_in_si(entry, scope, files, problems)
    if columns is None or has_error(problems):
        return None, problems
    x, y = columns
    problems += check_magnitudes(columns, locate)
    problems += check_points(x, y, entry, locate) if not has_error(problems) else ()
    if has_error(problems):
        return None, problems
    if entry.period is not None:
        x[-1], y[-1] = x[0] + entry.period, y[0]
    curve = entry.ends if entry.ends == "natural" else entry.interpolation
    table = interpolate_points(name, x, y, curve, entry.outside, entry.period)
    table = replace(table, dimensions=(units[0].dimension, units[1].dimension))
    if has_signal_keys(entry) or entry.resample is not None:
        try:
            table, warnings = prepare_signal(table, entry)
            table = table if entry.resample is None else resample_table(table, entry)
        except SignalKeyError as error:
            return None, [*problems, TableProblem((error.key,), error.finding)]
        problems += [TableProblem((key,), finding, is_warning=True) for key, finding in warnings]
        problems += check_magnitudes([table.x, table.y], None)
        if has_error(problems):
            return None, problems
    if not np.isfinite(np.frombuffer(table.numbers)).all():
        message = "its points are too close together or too far apart to compute a slope"
        return None, [*problems, TableProblem((), Finding("table-shape", message, SLOPES_HINT))]
    return table, problems


def check_ends(entry: TableEntry) -> Iterator[Finding]:
    """Yield what is wrong with the end conditions of a table."""
    if entry.ends is None:
        return
    if entry.interpolation != "cubic":
        hint = "write interpolation: cubic, or leave ends out"
        yield Finding("table-form", f"a {entry.interpolation} table takes no condition at its ends", hint)
    elif entry.period is not None:
        yield Finding(
            "table-form", "a periodic table takes no ends: it continues smoothly there", "leave ends or period out"
        )


def read_columns_in_si(
    entry: TableEntry, scope: Scope, files: NamedFiles, problems: list[TableProblem]
) -> tuple[Columns | None, list[ColumnUnit], Locate | None]:
    """Read the columns x and y of an entry in SI, from its file or lists, with their units and, of a file, what finds
    the place of a point; append what is wrong.
    """
    if entry.file is not None:
        if isinstance(entry.x, list) or isinstance(entry.y, list):
            hint = "with a file, x and y name its columns"
            problems.append(TableProblem((), Finding("table-form", "both a file and lists of numbers are given", hint)))
            return None, [], None
        if entry.skip is not None and entry.skip < 0:
            problems.append(TableProblem(("skip",), Finding("table-form", f"skip is {entry.skip}", "give 0 or more")))
            return None, [], None
        column_keys = (entry.x if entry.x is not None else 1, entry.y if entry.y is not None else 2)
        units_given = entry.x_unit, entry.y_unit
        found = read_file_columns(
            column_keys, units_given, entry.file, files, problems, entry.skip or 0, entry.gaps, entry.sheet
        )
        return (None, [], None) if found is None else (found.numbers, found.units, found.locate)
    keys = {"skip": entry.skip is not None, "gaps": entry.gaps != "refuse", "sheet": entry.sheet is not None}
    for key in (key for key, is_given in keys.items() if is_given):
        problems.append(TableProblem((key,), Finding("table-form", f"{key} is given without a file", NO_FILE_HINT)))
    units = [parse_given_unit(key, getattr(entry, key), problems) or ColumnUnit(1.0, None) for key in UNIT_KEYS]
    if isinstance(entry.x, list) and isinstance(entry.y, list):
        lists = (("x", entry.x, units[0].size), ("y", entry.y, units[1].size))
        read_items = ([read_list_item(item, size, scope, (key, i), problems) for i, item in enumerate(items)]
                      for key, items, size in lists)  # fmt: skip
        return [array("d", [value for value in values if value is not None]) for values in read_items], units, None
    hint = "give {file, x, y} with columns by name or number, or the lists {x: [...], y: [...]}"
    problems.append(
        TableProblem((), Finding("table-form", "neither a file nor lists of numbers x and y are given", hint))
    )
    return None, units, None


def parse_given_unit(key: str, unit: str | None, problems: list[TableProblem]) -> ColumnUnit | None:
    """Parse the unit that an entry gives for a column; None if it gives none."""
    if unit is None:
        return None
    try:
        return ColumnUnit(*parse_unit(unit))
    except Finding as finding:
        problems.append(TableProblem((key,), finding))
        return ColumnUnit(1.0, None)


def choose_column_unit(
    key: str, given_text: str | None, heading: Heading | None, file: str, problems: list[TableProblem]
) -> ColumnUnit:
    """Choose the unit of a file's column: that of the entry, else that of its heading, else SI.

    Warns if both differ or if the heading states an unknown unit; refuses an ambiguous one.
    """
    unit = parse_given_unit(key, given_text, problems)
    heading_unit = find_heading_unit(heading.text) if heading is not None else None
    if heading is None or heading_unit is None:
        return unit or ColumnUnit(1.0, None)
    column = f"the heading of column {heading.number}"
    unit_text = f"'{heading_unit.text}'" if len(heading_unit.text) <= MAX_NUMBER_LENGTH else "a unit"
    location = SourceLocation(file, heading.line, 1)
    if unit is not None:
        if heading_unit.size is not None and heading_unit.dimension is not None:
            has_same_size = math.isclose(heading_unit.size, unit.size)
            if heading_unit.dimension != unit.dimension or not has_same_size:
                finding = Finding(
                    UNIT_CODE,
                    f"{column} says {unit_text}, {key} says '{given_text}', which is used",
                    UNIT_CONFLICT_HINT,
                )
                problems.append(TableProblem((key,), finding, location, is_warning=True))
        return unit
    if heading_unit.size is not None:
        return ColumnUnit(heading_unit.size, heading_unit.dimension, heading)
    if heading_unit.meanings:
        message = f"{column} says {unit_text}, which may be {heading_unit.meanings}"
        consequence = "" if heading_unit.is_certain else "; the numbers are read as SI"
        finding = Finding(
            UNIT_CODE,
            message + consequence,
            f"give the unit: {key}: {EXAMPLE_UNITS.get(heading_unit.text, heading_unit.text)}",
        )
        problems.append(TableProblem((key,), finding, location, is_warning=not heading_unit.is_certain))
    else:
        message = f"{column} says {unit_text}, which is not a unit known to heun; the numbers are read as SI"
        hint = f"give their unit, for example {key}: N; '1' uses them as they are"
        problems.append(TableProblem((key,), Finding(UNIT_CODE, message, hint), location, is_warning=True))
    return ColumnUnit(1.0, None)


def read_list_item(
    item: object, size: float, scope: Scope, path: tuple[str | int, ...], problems: list[TableProblem]
) -> float | None:
    """Read one number of a list: a plain number in the column's unit, a text like anywhere else in a spec."""
    try:
        value = read_number(item, None, scope)
    except Finding as finding:
        problems.append(TableProblem(path, finding))
        return None
    return value if isinstance(item, str) else value * size


def check_magnitudes(columns: Columns, locate: Locate | None) -> Iterator[TableProblem]:
    """Yield a problem for the first number of each column that is outside the range of computation."""
    for key, column in zip(("x", "y"), columns, strict=True):
        is_outside = ~are_in_range(np.frombuffer(column))
        if is_outside.any():
            i = int(is_outside.argmax())
            finding = range_error(column[i], f"number {i + 1} of {key} (SI)")
            yield make_point_problem(key, i, finding, locate)


def make_point_problem(key: str, i: int, finding: Finding, locate: Locate | None) -> TableProblem:
    """Make the problem of one point: at its place in the list, or in the file."""
    return TableProblem((key, i), finding) if locate is None else TableProblem(("file",), finding, locate(i))


def check_points(x: array[float], y: array[float], entry: TableEntry, locate: Locate | None) -> Iterator[TableProblem]:
    """Yield what prevents the points from forming a function."""
    file_path = () if entry.file is None else ("file",)
    if len(x) != len(y):
        yield TableProblem(
            file_path, Finding("table-shape", f"{len(x)} values of x and {len(y)} of y", "each x needs one y")
        )
        return
    if len(x) < 2:
        yield TableProblem(file_path, Finding("table-shape", "a table needs at least two points", CONSTANT_HINT))
        return
    points = np.frombuffer(x)
    is_falling = points[1:] <= points[:-1]
    if is_falling.any():
        i = int(is_falling.argmax()) + 1
        message = f"x must increase, but {x[i]:.9g} follows {x[i - 1]:.9g} (SI)"
        hint = "for a jump increase x slightly" if x[i] == x[i - 1] else "sort the points by x"
        yield make_point_problem("x", i, Finding("table-shape", message, hint), locate)
        return
    if entry.period is None:
        return
    if entry.outside is not None:
        yield TableProblem(
            ("outside",),
            Finding("table-form", "both period and outside are given", "a periodic table takes no outside"),
        )
    span = x[-1] - x[0]
    if abs(entry.period - span) > tolerances.TABLE_ENDS * span:
        message = f"the period is {entry.period:.9g}, but x spans {span:.9g} (SI)"
        unit = f"give the period its own unit: '{entry.period:g} {entry.x_unit}'" if entry.x_unit else None
        yield TableProblem(
            ("period",),
            Finding("table-period", message, unit or "the last point must repeat the first, one period later"),
        )
    elif abs(y[-1] - y[0]) > tolerances.TABLE_ENDS * (max(y) - min(y)):
        message = f"with a period, the first and last y must be equal, but are {y[0]:.9g} and {y[-1]:.9g} (SI)"
        yield TableProblem(
            ("period",), Finding("table-period", message, "the last point must repeat the first, one period later")
        )


def read_file_columns(
    column_keys: tuple[object, object],
    given_units: tuple[str | None, str | None],
    file: str,
    files: NamedFiles,
    problems: list[TableProblem],
    skip: int = 0,
    gaps: str = "refuse",
    sheet: str | None = None,
) -> FileColumns | None:
    """Read the columns x and y of a CSV file in SI, with their units.

    column_keys: names or numbers of the columns
    given_units: the units that the entry gives
    skip, gaps: as `read_columns` takes them
    sheet: of an Excel file

    What is wrong is appended to `problems`; None if that prevents reading.
    """
    try:
        text = files.read_text(file, sheet)
    except Finding as finding:
        problems.append(TableProblem(("file",), finding))
        return None
    path = str(files.path(file))
    try:
        found = read_columns(text, *column_keys, skip=skip, gaps=gaps)
    except MissingColumnError as error:
        key = ("x", "y")[error.number]
        missing = error.finding
        problems.append(TableProblem((key,), Finding(missing.code, f"{missing.message} in '{path}'", missing.hint)))
        return None
    except CsvError as error:
        problems.append(TableProblem(("file",), error.finding, SourceLocation(path, error.line, error.column)))
        return None
    report_gaps(found, path, problems)
    units = [
        choose_column_unit(*one, path, problems) for one in zip(UNIT_KEYS, given_units, found.headings, strict=True)
    ]
    for column, unit in zip(found.numbers, units, strict=True):
        values = np.frombuffer(column)  # the same memory
        with np.errstate(over="ignore"):  # the caller checks the range and knows the location
            values *= unit.size
    return FileColumns(
        found.numbers,
        units,
        lambda i: SourceLocation(path, found.find_line(text, i), 1),
        lambda: found.list_lines(text),
    )


def report_gaps(columns: ReadColumns, path: str, problems: list[TableProblem]) -> None:
    """Say how many rows of a file have a gap, and what became of them."""
    count, filled, line = columns.gaps
    if not count:
        return
    whole = count - filled + len(columns.numbers[0])
    parts = [f"{count - filled} left out"] if count > filled else []
    parts += [f"{filled} filled on a straight line"] if filled else []
    message = f"{count} of {whole} rows {'has' if count == 1 else 'have'} a gap: {', '.join(parts)}"
    finding = Finding(GAPS_CODE, message, "fill them in the file")
    problems.append(TableProblem(("gaps",), finding, SourceLocation(path, line, 1), is_warning=True))
