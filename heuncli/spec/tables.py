"""Entries of `tables:` -> functions: columns of a CSV file or lists in the spec, in SI. Impure: reads files."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from heuncli import tolerances
from heuncli.errors import Finding, SourceLocation
from heuncli.expressions.curves import fit
from heuncli.expressions.programs import TableFunction
from heuncli.expressions.units import Dimension, parse_unit
from heuncli.number_range import are_in_range, out_of_range
from heuncli.records import record, replace
from heuncli.spec.columns import Columns, CsvError, NoColumn, columns_of
from heuncli.spec.format import TableEntry
from heuncli.spec.named_files import NamedFiles
from heuncli.spec.quantity import Scope, number

# what to do about it
SLOPES = "keep x and y within some ten powers of ten, in units of their own: x_unit, y_unit"
CONSTANT = "a value that does not change is a parameter"


@record
class Wrong:
    """A finding at a key of the entry, or at a location in its file."""

    keys: tuple[str | int, ...]
    finding: Finding
    location: SourceLocation | None = None


def build_table(
    name: str, entry: TableEntry, scope: Scope, files: NamedFiles
) -> tuple[TableFunction | None, list[Wrong]]:
    """The table of an entry, or what is wrong with it."""
    wrong = [Wrong(("ends",), told) for told in ends_of(entry)]
    columns = in_si(entry, scope, files, wrong)
    if columns is None or wrong:
        return None, wrong
    x, y = columns
    wrong += too_small_or_large(columns, entry)
    wrong += shape_of(x, y, entry) if not wrong else ()
    if wrong:
        return None, wrong
    if entry.period is not None:
        x[-1], y[-1] = x[0] + entry.period, y[0]
    curve = entry.ends if entry.ends == "natural" else entry.interpolation
    table = fit(name, x, y, curve, entry.outside, entry.period)
    table = replace(table, dimensions=(dimension_of(entry.x_unit), dimension_of(entry.y_unit)))
    if not np.isfinite(np.frombuffer(table.numbers)).all():
        return None, [
            Wrong((), Finding("table-shape", "its points lie too close together or too far apart for a slope", SLOPES))
        ]
    return table, []


def ends_of(entry: TableEntry) -> Iterator[Finding]:
    """What keeps a table from ending as it is asked to."""
    if entry.ends is None:
        return
    if entry.interpolation != "cubic":
        hint = "interpolation: cubic, or leave ends out"
        yield Finding("table-form", f"a {entry.interpolation} table has no condition at its ends", hint)
    elif entry.period is not None:
        yield Finding(
            "table-form", "a periodic table has no ends: it goes on smoothly there", "leave ends or period out"
        )


def in_si(entry: TableEntry, scope: Scope, files: NamedFiles, wrong: list[Wrong]) -> Columns | None:
    """The columns x and y of an entry in SI, from its file or its lists; what is wrong is added."""
    sizes = [unit_size(key, getattr(entry, key), wrong) for key in ("x_unit", "y_unit")]
    if entry.file is not None:
        if isinstance(entry.x, list) or isinstance(entry.y, list):
            hint = "with a file, x and y name its columns"
            wrong.append(Wrong((), Finding("table-form", "both a file and lists of numbers", hint)))
            return None
        wanted = (entry.x if entry.x is not None else 1, entry.y if entry.y is not None else 2)
        columns = from_file(wanted, entry.file, files, wrong)
        for column, size in zip(columns or (), sizes, strict=False):
            values = np.frombuffer(column)  # the same memory
            with np.errstate(over="ignore"):  # judged below, with its place
                values *= size
        return columns
    if isinstance(entry.x, list) and isinstance(entry.y, list):
        given = (("x", entry.x, sizes[0]), ("y", entry.y, sizes[1]))
        read_items = ([read(item, size, scope, (key, i), wrong) for i, item in enumerate(items)]
                      for key, items, size in given)  # fmt: skip
        return [array("d", [value for value in values if value is not None]) for values in read_items]
    hint = "give {file, x, y} with columns by name or number, or the lists {x: [...], y: [...]}"
    wrong.append(Wrong((), Finding("table-form", "neither a file nor lists of numbers x and y", hint)))
    return None


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


def too_small_or_large(columns: Columns, entry: TableEntry) -> Iterator[Wrong]:
    """The first number of each column that is not computed with."""
    for key, column in zip(("x", "y"), columns, strict=True):
        beyond = ~are_in_range(np.frombuffer(column))
        if beyond.any():
            i = int(beyond.argmax())
            in_file = entry.file is not None
            yield Wrong(("file",) if in_file else (key, i), out_of_range(column[i], f"number {i + 1} of {key} (SI)"))


def shape_of(x: array[float], y: array[float], entry: TableEntry) -> Iterator[Wrong]:
    """What keeps points from being a function."""
    at = () if entry.file is None else ("file",)
    if len(x) != len(y):
        yield Wrong(at, Finding("table-shape", f"{len(x)} values of x and {len(y)} of y", "each x has its y"))
        return
    if len(x) < 2:
        yield Wrong(at, Finding("table-shape", "a table needs two points at least", CONSTANT))
        return
    points = np.frombuffer(x)
    falls = points[1:] <= points[:-1]
    if falls.any():
        i = int(falls.argmax()) + 1
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


def from_file(wanted: tuple[object, object], file: str, files: NamedFiles, wrong: list[Wrong]) -> Columns | None:
    """The columns x and y of a CSV file by their names or numbers, as they stand there."""
    try:
        text = files.text(file)
    except Finding as finding:
        wrong.append(Wrong(("file",), finding))
        return None
    try:
        return columns_of(text, *wanted)
    except NoColumn as error:
        key = ("x", "y")[error.number]
        absent = error.finding
        message = f"{absent.message} in '{files.path(file)}'"
        wrong.append(Wrong((key,), Finding(absent.code, message, absent.hint)))
        return None
    except CsvError as error:
        wrong.append(Wrong(("file",), error.finding, SourceLocation(str(files.path(file)), error.line, error.column)))
        return None
