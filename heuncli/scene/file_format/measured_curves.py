"""Curves of expectations: two columns of a CSV file, in SI (manual/format.md, "Expect"). Impure: reads files."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.number_range import are_in_range, range_error
from heuncli.base.records import replace
from heuncli.base.units import Dimension, describe
from heuncli.scene.file_format.columns import Columns, iter_rows
from heuncli.scene.file_format.format import ExpectEntry
from heuncli.scene.file_format.models import Curve
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.tables import ColumnUnit, TableProblem, has_error, read_file_columns

ONE_POINT_HINT = "a curve needs at least two points; for one number use at: and is:"
ASCENDING_HINT = "sort the rows by x, with one row for each x"


def build_curve(
    item: ExpectEntry,
    x_of: str | None,
    run: tuple[float, float] | None,
    column_dimensions: tuple[tuple[Dimension, ...], tuple[Dimension, ...]],
    files: NamedFiles,
) -> tuple[Curve | None, list[TableProblem]]:
    """Build the curve of an expectation (None if it cannot be used) and list its problems.

    x_of: path of the result that x is; None: time
    run: first and last instant of the run, if they matter
    column_dimensions: the dimensions that each column may have; empty if unknown
    """
    assert item.curve is not None
    problems: list[TableProblem] = []
    columns, units = read_curve_columns(item, x_of, files, problems)
    file = str(files.path(item.curve))
    for unit, dimensions in zip(units, column_dimensions, strict=False):
        if unit.heading is not None and unit.dimension is not None and dimensions and unit.dimension not in dimensions:
            expected = " or ".join(describe(one) for one in dimensions)
            kind = describe(unit.dimension)
            message = f"column {unit.heading.number} is {kind} according to its heading, expected {expected}"
            finding = Finding("wrong-dimension", message, "choose another column, or give its unit: x_unit, y_unit")
            problems.append(TableProblem((), finding, SourceLocation(file, unit.heading.line, 1)))
    if columns is None or has_error(problems):
        return None, problems
    sizes = [unit.size for unit in units]
    lines = find_point_lines(files.read_text(item.curve), len(columns[0]))
    first_error = next(check_curve_points(columns, sizes, None if x_of is not None else run), None)
    if first_error is not None:
        i, finding = first_error
        return None, [*problems, TableProblem((), finding, SourceLocation(file, lines[i] if len(lines) else 1, 1))]
    required_share = item.within if item.within is not None else 1.0
    return Curve(file, columns[0], columns[1], lines, x_of, required_share), problems


def read_curve_columns(
    item: ExpectEntry, x_of: str | None, files: NamedFiles, problems: list[TableProblem]
) -> tuple[Columns | None, list[ColumnUnit]]:
    """Read the columns in SI, with their units. If x is a path, it is the column of that name, or else the first
    one.
    """
    assert item.curve is not None
    x_column = item.x if item.x is not None else 1
    y_column = item.y if item.y is not None else 2
    file_problems: list[TableProblem] = []
    units = (item.x_unit, item.y_unit)
    columns, read_units = read_file_columns((x_column, y_column), units, item.curve, files, file_problems)
    if x_of is not None and any(problem.keys == ("x",) for problem in file_problems):
        file_problems = []
        columns, read_units = read_file_columns((1, y_column), units, item.curve, files, file_problems)
    problems += [
        replace(problem, keys=("curve",)) if problem.keys == ("file",) else problem for problem in file_problems
    ]
    return columns, read_units


def find_point_lines(text: str, points: int) -> array[int]:
    """Return the line numbers of the points of a text; a row of headings before them is skipped."""
    return array("q", [n for n, _ in iter_rows(text)][-points:] if points else [])


def check_curve_points(
    columns: Columns, sizes: list[float], run: tuple[float, float] | None
) -> Iterator[tuple[int, Finding]]:
    """Yield what prevents points from forming a curve within a run: the index of a point, and what is wrong with it."""
    x, y = (np.frombuffer(column) for column in columns)
    for name, values in (("x", x), ("y", y)):
        is_outside = ~are_in_range(values)
        if is_outside.any():
            i = int(is_outside.argmax())
            yield i, range_error(float(values[i]), f"{name} (SI)")
    if len(x) < 2:
        yield len(x) - 1, Finding("curve-points", f"{'only one point' if len(x) else 'no points'}", ONE_POINT_HINT)
        return
    is_falling = x[1:] <= x[:-1]
    if is_falling.any():
        i = int(is_falling.argmax()) + 1
        value, previous = x[i] / sizes[0], x[i - 1] / sizes[0]
        yield i, Finding("curve-points", f"x must increase, but {value:.9g} follows {previous:.9g}", ASCENDING_HINT)
    if run is not None:
        slack = tolerances.SAME_INSTANT * (run[1] - run[0])
        outside = (x < run[0] - slack) | (x > run[1] + slack)
        if outside.any():
            i = int(outside.argmax())
            message = f"{x[i]:.9g} s is outside the run, which lasts from {run[0]:.9g} to {run[1]:.9g} s"
            yield (
                i,
                Finding("curve-points", message, "remove these rows, or run longer; for milliseconds give x_unit: ms"),
            )
