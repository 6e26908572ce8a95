"""Entries of `tables:` -> functions: columns of a CSV file or lists in the spec, in SI. Impure: reads files."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.number_range import are_in_range, out_of_range
from heuncli.base.records import record, replace
from heuncli.base.units import Dimension, parse_unit
from heuncli.scene.expressions.curves import fit
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format.columns import LONGEST_NUMBER, Columns, CsvError, Heading, NoColumn, read_columns
from heuncli.scene.file_format.format import TableEntry
from heuncli.scene.file_format.headings import unit_in_heading
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.quantity import Scope, number

# what to do about it
SLOPES = "keep x and y within some ten powers of ten, in units of their own: x_unit, y_unit"
CONSTANT = "a value that does not change is a parameter"
TAKEN = "say the unit of the heading, or correct the heading"
UNIT_KEYS = ("x_unit", "y_unit")
UNIT_CODE = "column-unit"
EXAMPLES = {  # of units with two meanings, one of them
    "g": "m/s^2", "G": "m/s^2", "t": "tonne", "lb": "lbf",
    **dict.fromkeys(("1/min", "min-1", "min^-1", "1/s", "s-1", "s^-1", "Hz"), "rpm"),
}  # fmt: skip


@record
class Wrong:
    """A finding at a key of the entry, or at a location in its file; a warning keeps nothing from being used."""

    keys: tuple[str | int, ...]
    finding: Finding
    location: SourceLocation | None = None
    is_warning: bool = False


class ColumnUnit(NamedTuple):
    """The unit of a column: its size in SI, and its dimension where that is certain. heading: where it stands there."""

    size: float
    dimension: Dimension | None
    heading: Heading | None = None


def is_faulty(wrong: list[Wrong]) -> bool:
    """Whether an entry cannot be used."""
    return any(not one.is_warning for one in wrong)


def build_table(
    name: str, entry: TableEntry, scope: Scope, files: NamedFiles
) -> tuple[TableFunction | None, list[Wrong]]:
    """The table of an entry, None where it cannot be used, and what is wrong with it."""
    wrong = [Wrong(("ends",), told) for told in ends_of(entry)]
    columns, units = in_si(entry, scope, files, wrong)
    if columns is None or is_faulty(wrong):
        return None, wrong
    x, y = columns
    wrong += too_small_or_large(columns, entry)
    wrong += shape_of(x, y, entry) if not is_faulty(wrong) else ()
    if is_faulty(wrong):
        return None, wrong
    if entry.period is not None:
        x[-1], y[-1] = x[0] + entry.period, y[0]
    curve = entry.ends if entry.ends == "natural" else entry.interpolation
    table = fit(name, x, y, curve, entry.outside, entry.period)
    table = replace(table, dimensions=(units[0].dimension, units[1].dimension))
    if not np.isfinite(np.frombuffer(table.numbers)).all():
        message = "its points lie too close together or too far apart for a slope"
        return None, [*wrong, Wrong((), Finding("table-shape", message, SLOPES))]
    return table, wrong


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


def in_si(
    entry: TableEntry, scope: Scope, files: NamedFiles, wrong: list[Wrong]
) -> tuple[Columns | None, list[ColumnUnit]]:
    """The columns x and y of an entry in SI, from its file or its lists, and their units; what is wrong is added."""
    if entry.file is not None:
        if isinstance(entry.x, list) or isinstance(entry.y, list):
            hint = "with a file, x and y name its columns"
            wrong.append(Wrong((), Finding("table-form", "both a file and lists of numbers", hint)))
            return None, []
        wanted = (entry.x if entry.x is not None else 1, entry.y if entry.y is not None else 2)
        return from_file(wanted, (entry.x_unit, entry.y_unit), entry.file, files, wrong)
    units = [given_unit(key, getattr(entry, key), wrong) or ColumnUnit(1.0, None) for key in UNIT_KEYS]
    if isinstance(entry.x, list) and isinstance(entry.y, list):
        given = (("x", entry.x, units[0].size), ("y", entry.y, units[1].size))
        read_items = ([read(item, size, scope, (key, i), wrong) for i, item in enumerate(items)]
                      for key, items, size in given)  # fmt: skip
        return [array("d", [value for value in values if value is not None]) for values in read_items], units
    hint = "give {file, x, y} with columns by name or number, or the lists {x: [...], y: [...]}"
    wrong.append(Wrong((), Finding("table-form", "neither a file nor lists of numbers x and y", hint)))
    return None, units


def given_unit(key: str, unit: str | None, wrong: list[Wrong]) -> ColumnUnit | None:
    """The unit that an entry gives for a column; None where it gives none."""
    if unit is None:
        return None
    try:
        return ColumnUnit(*parse_unit(unit))
    except Finding as finding:
        wrong.append(Wrong((key,), finding))
        return ColumnUnit(1.0, None)


def column_unit(key: str, given: str | None, heading: Heading | None, file: str, wrong: list[Wrong]) -> ColumnUnit:
    """The unit of a column of a file: what the entry gives, else what its heading states, else SI.

    Warns where both differ, and where the heading states what is no unit; refuses what has two meanings.
    """
    unit = given_unit(key, given, wrong)
    stated = unit_in_heading(heading.text) if heading is not None else None
    if heading is None or stated is None:
        return unit or ColumnUnit(1.0, None)
    column = f"the heading of column {heading.number}"
    shown = f"'{stated.text}'" if len(stated.text) <= LONGEST_NUMBER else "a unit"
    location = SourceLocation(file, heading.line, 1)
    if unit is not None:
        if stated.size is not None and stated.dimension is not None:
            is_same = math.isclose(stated.size, unit.size)
            if stated.dimension != unit.dimension or not is_same:
                finding = Finding(UNIT_CODE, f"{column} says {shown}, {key} says '{given}', which is taken", TAKEN)
                wrong.append(Wrong((key,), finding, location, is_warning=True))
        return unit
    if stated.size is not None:
        return ColumnUnit(stated.size, stated.dimension, heading)
    if stated.meanings:
        message = f"{column} says {shown}, which may be {stated.meanings}"
        taken = "" if stated.is_certain else "; the numbers are taken in SI"
        finding = Finding(UNIT_CODE, message + taken, f"say which: {key}: {EXAMPLES.get(stated.text, stated.text)}")
        wrong.append(Wrong((key,), finding, location, is_warning=not stated.is_certain))
    else:
        message = f"{column} says {shown}, which is no unit that heun knows; the numbers are taken in SI"
        hint = f"say their unit: {key}: N, for example; '1' takes them as they stand"
        wrong.append(Wrong((key,), Finding(UNIT_CODE, message, hint), location, is_warning=True))
    return ColumnUnit(1.0, None)


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


def from_file(
    wanted: tuple[object, object],
    given: tuple[str | None, str | None],
    file: str,
    files: NamedFiles,
    wrong: list[Wrong],
) -> tuple[Columns | None, list[ColumnUnit]]:
    """The columns x and y of a CSV file in SI, and their units.

    wanted: names or numbers of the columns. given: the units that the entry gives. What is wrong is added.
    """
    try:
        text = files.text(file)
    except Finding as finding:
        wrong.append(Wrong(("file",), finding))
        return None, []
    path = str(files.path(file))
    try:
        columns, headings = read_columns(text, *wanted)
    except NoColumn as error:
        key = ("x", "y")[error.number]
        absent = error.finding
        wrong.append(Wrong((key,), Finding(absent.code, f"{absent.message} in '{path}'", absent.hint)))
        return None, []
    except CsvError as error:
        wrong.append(Wrong(("file",), error.finding, SourceLocation(path, error.line, error.column)))
        return None, []
    units = [column_unit(*one, path, wrong) for one in zip(UNIT_KEYS, given, headings, strict=True)]
    for column, unit in zip(columns, units, strict=True):
        values = np.frombuffer(column)  # the same memory
        with np.errstate(over="ignore"):  # judged by the caller, with its place
            values *= unit.size
    return columns, units
