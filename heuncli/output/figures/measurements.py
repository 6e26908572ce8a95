"""Read the file of measured points: two columns of a CSV. Impure: reads files.

A column is given by its name in the first row, with its unit or without (F, of F [kN] or F/kN), or by its number from
1. Numbers are in the unit after the name there or in the request (2[kN]); without one in SI.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import Dimension, are_in_range, describe, parse_unit, range_error
from heuncli.output.figures.curves import MeasuredPoints
from heuncli.results.results import Array
from heuncli.results.results_schema import parse_index
from heuncli.scene.file_format.column_layout import (
    CsvError,
    MissingColumnError,
    decode_text,
    detect_layout,
    iter_rows,
)
from heuncli.scene.file_format.columns import read_column_numbers
from heuncli.scene.file_format.headings import split_heading
from heuncli.scene.file_format.reading import read_bytes

MAX_BYTES = 200_000_000  # bytes
EXAMPLE_HINT = "for example --with bench.csv:t:F, columns by the names in the first row or by numbers from 1"


class PointsQuery(NamedTuple):
    """The columns x and y of a file, as given in the option."""

    words: str
    file: str
    x: str
    y: str


class CsvColumn(NamedTuple):
    """The key by which a column is read, and its unit; empty for SI."""

    key: str
    unit: str


def parse_points_query(words: str) -> PointsQuery:
    """Parse FILE:X:Y; the file's name may contain colons, the columns none. Raises SpecError."""
    file, *columns = words.rsplit(":", 2)
    if len(columns) != 2 or not file or not all(columns):
        raise SpecError(Problem("bad-option", f"--with {words}: expected FILE:X:Y", hint=EXAMPLE_HINT))
    return PointsQuery(words, file, columns[0].strip(), columns[1].strip())


def read_points(query: PointsQuery, x_unit: str, units: Sequence[str]) -> MeasuredPoints:
    """Read the points.

    x_unit: SI unit of the horizontal axis
    units: SI units of the panels; the first is for a column without unit

    Raises SpecError with the location.
    """
    try:
        text = decode_text(read_bytes(query.file, MAX_BYTES))
        column_names = detect_layout(text).names
        columns = [_find_column(query, word, column_names) for word in (query.x, query.y)]
        x, y = (np.frombuffer(column) for column in read_column_numbers(text, *(column.key for column in columns)))
    except Finding as finding:
        raise _make_error(query, finding) from None
    except MissingColumnError as error:
        raise _make_error(query, error.finding) from None
    except CsvError as error:
        raise _make_error(query, error.finding, (error.line, error.column)) from None
    if not len(x):
        raise _make_error(query, Finding("table-file", "it contains no row of numbers", "one row per point: 0.1,12.5"))
    x_values = _to_si(query, query.x, columns[0].unit, x, [x_unit])
    y_values = _to_si(query, query.y, columns[1].unit, y, units)
    for values in (x_values[1], y_values[1]):
        _require_in_range(query, values, text)
    return MeasuredPoints(f"{query.file}: {query.y}", y_values[0], x_values[1], y_values[1])


def _find_column(query: PointsQuery, word: str, heads: Sequence[str]) -> CsvColumn:
    """Find a column by its whole heading, by its name without the unit, or by its number, with a unit after it or
    without.

    Raises SpecError if the file has another unit.
    """
    name, unit = split_heading(word)
    if word in heads or not name:
        return CsvColumn(word, split_heading(word)[1])
    place = parse_index(name)
    head = next((head for head in heads if split_heading(head)[0] == name), name)
    if place is not None and name not in heads:
        head = heads[place - 1] if 0 < place <= len(heads) else ""
    unit_of_head = split_heading(head)[1]
    if unit and unit_of_head and unit != unit_of_head:
        finding = Finding("table-file", f"column '{head}' is in {unit_of_head}, not in {unit}", "leave the unit out")
        raise _make_error(query, finding)
    return CsvColumn(name if place is not None and name not in heads else head, unit or unit_of_head)


def _to_si(query: PointsQuery, name: str, column_unit: str, values: Array, units: Sequence[str]) -> tuple[str, Array]:
    """Return the matching SI unit of a column, and its numbers in it; column_unit: empty if it has none."""
    if not column_unit:
        return units[0], values
    try:
        size, dimension = parse_unit(column_unit)
    except Finding as finding:
        raise _make_error(query, finding) from None
    found = next((unit for unit in units if _find_dimension(unit) == dimension), None)
    if found is None:
        expected = " or ".join(dict.fromkeys(describe(_find_dimension(unit)) for unit in units))
        message = f"column '{name}' is {describe(dimension)}, but the axis shows {expected}"
        raise _make_error(query, Finding("dimension", message, "also draw a path of that kind, or use another column"))
    return found, values * size


def _find_dimension(unit: str) -> Dimension:
    """Return the dimension of a unit of the results; without a unit that of numbers."""
    return parse_unit(unit or "1")[1]


def _require_in_range(query: PointsQuery, values: Array, text: str) -> None:
    """Raise SpecError if a magnitude is too large or too small to compute with."""
    out_of_bounds = ~are_in_range(values)
    if out_of_bounds.any():
        lines = [n for n, _ in iter_rows(text)][-len(values) :]
        i = int(out_of_bounds.argmax())
        raise _make_error(query, range_error(float(values[i]), "a number (SI)"), (lines[i], 1))


def _make_error(query: PointsQuery, finding: Finding, position: tuple[int, int] | None = None) -> SpecError:
    """Return the error of a file or of a column in it."""
    message = f"--with {query.words}: {finding.message}"
    place = SourceLocation(query.file, *position) if position is not None else None
    return SpecError(Problem(finding.code, message, place, finding.hint))
