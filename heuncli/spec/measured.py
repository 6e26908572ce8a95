"""Curves of expectations: two columns of a CSV file, in SI (manual/format.md, "Expect"). Impure: reads files."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from heuncli import tolerances
from heuncli.errors import Finding, SourceLocation
from heuncli.number_range import are_in_range, out_of_range
from heuncli.spec.columns import Columns, rows_of
from heuncli.spec.format import ExpectEntry
from heuncli.spec.models import Curve
from heuncli.spec.named_files import NamedFiles
from heuncli.spec.tables import Wrong, from_file, unit_size

ONE_POINT = "a curve has two points at least; one number is expected by at: and is:"
ASCENDING = "sort the rows by x, and keep one of each"


def build_curve(
    item: ExpectEntry, x_of: str | None, run: tuple[float, float] | None, files: NamedFiles
) -> tuple[Curve | None, list[Wrong]]:
    """The curve of an expectation, or what is wrong with it.

    x_of: the path whose number x is, None for time; run: its first and last instant, where they matter.
    """
    assert item.curve is not None
    wrong: list[Wrong] = []
    sizes = [unit_size(key, getattr(item, key), wrong) for key in ("x_unit", "y_unit")]
    columns = columns_in(item, x_of, files, wrong)
    if columns is None or wrong:
        return None, wrong
    for column, size in zip(columns, sizes, strict=True):
        values = np.frombuffer(column)  # the same memory
        with np.errstate(over="ignore"):  # judged below, with its line
            values *= size
    file = str(files.path(item.curve))
    lines = lines_of(files.text(item.curve), len(columns[0]))
    found = next(faults(columns, sizes, None if x_of is not None else run), None)
    if found is not None:
        i, finding = found
        return None, [Wrong((), finding, SourceLocation(file, lines[i] if len(lines) else 1, 1))]
    within = item.within if item.within is not None else 1.0
    return Curve(file, columns[0], columns[1], lines, x_of, within), []


def columns_in(item: ExpectEntry, x_of: str | None, files: NamedFiles, wrong: list[Wrong]) -> Columns | None:
    """The columns as they stand in the file; what x is a path of stands in the column of its name, or in the first."""
    assert item.curve is not None
    given = item.x if item.x is not None else 1
    y = item.y if item.y is not None else 2
    found: list[Wrong] = []
    columns = from_file((given, y), item.curve, files, found)
    if x_of is not None and any(one.keys == ("x",) for one in found):
        found = []
        columns = from_file((1, y), item.curve, files, found)
    wrong += [Wrong(("curve",) if one.keys == ("file",) else one.keys, one.finding, one.location) for one in found]
    return columns


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
