"""Curves of expectations: two columns of a CSV file, in SI (manual/format.md, "Expect"). Impure: reads files."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.number_range import are_in_range, out_of_range
from heuncli.base.records import replace
from heuncli.base.units import Dimension, describe
from heuncli.scene.file_format.columns import Columns, rows_of
from heuncli.scene.file_format.format import ExpectEntry
from heuncli.scene.file_format.models import Curve
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.tables import ColumnUnit, Wrong, from_file, is_faulty

ONE_POINT = "a curve has two points at least; one number is expected by at: and is:"
ASCENDING = "sort the rows by x, and keep one of each"


def build_curve(
    item: ExpectEntry,
    x_of: str | None,
    run: tuple[float, float] | None,
    known: tuple[tuple[Dimension, ...], tuple[Dimension, ...]],
    files: NamedFiles,
) -> tuple[Curve | None, list[Wrong]]:
    """The curve of an expectation, None where it cannot be used, and what is wrong with it.

    x_of: the path whose number x is, None for time; run: its first and last instant, where they matter; known: the
    dimensions that the numbers of each column may have, none where that is not known.
    """
    assert item.curve is not None
    wrong: list[Wrong] = []
    columns, units = columns_in(item, x_of, files, wrong)
    file = str(files.path(item.curve))
    for unit, dimensions in zip(units, known, strict=False):
        if unit.heading is not None and unit.dimension is not None and dimensions and unit.dimension not in dimensions:
            expected = " or ".join(describe(one) for one in dimensions)
            message = f"column {unit.heading.number} is {describe(unit.dimension)} by its heading, expected {expected}"
            finding = Finding("wrong-dimension", message, "name another column, or say its unit: x_unit, y_unit")
            wrong.append(Wrong((), finding, SourceLocation(file, unit.heading.line, 1)))
    if columns is None or is_faulty(wrong):
        return None, wrong
    sizes = [unit.size for unit in units]
    lines = lines_of(files.text(item.curve), len(columns[0]))
    found = next(faults(columns, sizes, None if x_of is not None else run), None)
    if found is not None:
        i, finding = found
        return None, [*wrong, Wrong((), finding, SourceLocation(file, lines[i] if len(lines) else 1, 1))]
    within = item.within if item.within is not None else 1.0
    return Curve(file, columns[0], columns[1], lines, x_of, within), wrong


def columns_in(
    item: ExpectEntry, x_of: str | None, files: NamedFiles, wrong: list[Wrong]
) -> tuple[Columns | None, list[ColumnUnit]]:
    """The columns in SI and their units; what x is a path of stands in the column of its name, or in the first."""
    assert item.curve is not None
    given = item.x if item.x is not None else 1
    y = item.y if item.y is not None else 2
    found: list[Wrong] = []
    units = (item.x_unit, item.y_unit)
    columns, read_units = from_file((given, y), units, item.curve, files, found)
    if x_of is not None and any(one.keys == ("x",) for one in found):
        found = []
        columns, read_units = from_file((1, y), units, item.curve, files, found)
    wrong += [replace(one, keys=("curve",)) if one.keys == ("file",) else one for one in found]
    return columns, read_units


def lines_of(text: str, points: int) -> array[int]:
    """The lines on which the points of a text stand; what stands before them is the row of names."""
    return array("q", [n for n, _ in rows_of(text)][-points:] if points else [])


def faults(columns: Columns, sizes: list[float], run: tuple[float, float] | None) -> Iterator[tuple[int, Finding]]:
    """What keeps points from being a curve within a run: the place of a point, and what is wrong with it."""
    x, y = (np.frombuffer(column) for column in columns)
    for name, values in (("x", x), ("y", y)):
        beyond = ~are_in_range(values)
        if beyond.any():
            i = int(beyond.argmax())
            yield i, out_of_range(float(values[i]), f"{name} (SI)")
    if len(x) < 2:
        yield len(x) - 1, Finding("curve-points", f"{'one point' if len(x) else 'no point'} alone", ONE_POINT)
        return
    falls = x[1:] <= x[:-1]
    if falls.any():
        i = int(falls.argmax()) + 1
        now, before = x[i] / sizes[0], x[i - 1] / sizes[0]
        yield i, Finding("curve-points", f"x must ascend, but {now:.9g} follows {before:.9g}", ASCENDING)
    if run is not None:
        slack = tolerances.SAME_INSTANT * (run[1] - run[0])
        outside = (x < run[0] - slack) | (x > run[1] + slack)
        if outside.any():
            i = int(outside.argmax())
            message = f"{x[i]:.9g} s is out of the run, which goes from {run[0]:.9g} to {run[1]:.9g} s"
            yield (
                i,
                Finding("curve-points", message, "leave these rows out, or run longer; of ms say x_unit: ms"),
            )
