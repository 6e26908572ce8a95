"""The file of measured points: two columns of a CSV. Impure: reads files.

A column is named as its first row has it, with its unit or without (F, of F [kN] or F/kN), or by its number from 1.
Numbers are in the unit that stands behind the name there or in what is asked for (2[kN]); without one in SI.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.number_range import are_in_range, out_of_range
from heuncli.base.units import NUMBER, Dimension, describe, parse_unit
from heuncli.output.figures.measured_points import MeasuredPoints
from heuncli.results.results import Array
from heuncli.results.results_schema import counted
from heuncli.scene.file_format.columns import CsvError, NoColumn, columns_of, layout_of, rows_of
from heuncli.scene.file_format.headings import heading
from heuncli.scene.file_format.reading import read_bytes

LARGEST = 200_000_000  # bytes
FORM = "such as --with bench.csv:t:F, columns by the names in the first row or by numbers from 1"


class AskedPoints(NamedTuple):
    """Columns x and y of a file, as they are asked for."""

    words: str
    file: str
    x: str
    y: str


class CsvColumn(NamedTuple):
    """By what the columns of a file are read, and its unit; empty: SI."""

    key: str
    unit: str


def asked_points(words: str) -> AskedPoints:
    """What FILE:X:Y names; a file's own name may hold colons, columns none. Raises SpecError."""
    file, *columns = words.rsplit(":", 2)
    if len(columns) != 2 or not file or not all(columns):
        raise SpecError(Problem("bad-option", f"--with {words}: expected FILE:X:Y", hint=FORM))
    return AskedPoints(words, file, columns[0].strip(), columns[1].strip())


def measured(asked: AskedPoints, x_unit: str, units: Sequence[str]) -> MeasuredPoints:
    """The points, for a picture over x_unit whose panels have some units, the first of which takes what has none.

    Raises SpecError with the place.
    """
    try:
        text = bytes(read_bytes(asked.file, LARGEST)).decode("utf-8-sig")
        heads = layout_of(text).names
        columns = [_column(asked, word, heads) for word in (asked.x, asked.y)]
        x, y = (np.frombuffer(column) for column in columns_of(text, *(column.key for column in columns)))
    except UnicodeDecodeError:
        raise _refused(asked, Finding("table-file", "it is not UTF-8", "save it as CSV in UTF-8")) from None
    except Finding as finding:
        raise _refused(asked, finding) from None
    except NoColumn as error:
        raise _refused(asked, error.finding) from None
    except CsvError as error:
        raise _refused(asked, error.finding, (error.line, error.column)) from None
    if not len(x):
        raise _refused(asked, Finding("table-file", "there is no row of numbers in it", "a row a point: 0.1,12.5"))
    over = _in_si(asked, asked.x, columns[0].unit, x, [x_unit])
    up = _in_si(asked, asked.y, columns[1].unit, y, units)
    for values in (over[1], up[1]):
        _require_in_range(asked, values, text)
    return MeasuredPoints(f"{asked.file}: {asked.y}", up[0], over[1], up[1])


def _column(asked: AskedPoints, word: str, heads: Sequence[str]) -> CsvColumn:
    """A column by its whole heading, by its name without the unit, or by its number, with a unit behind it or without.

    Raises SpecError where the file says another unit.
    """
    name, unit = heading(word)
    if word in heads or not name:
        return CsvColumn(word, heading(word)[1])
    place = counted(name)
    head = next((head for head in heads if heading(head)[0] == name), name)
    if place is not None and name not in heads:
        head = heads[place - 1] if 0 < place <= len(heads) else ""
    said = heading(head)[1]
    if unit and said and unit != said:
        finding = Finding("table-file", f"column '{head}' is in {said}, not in {unit}", "leave the unit out")
        raise _refused(asked, finding)
    return CsvColumn(name if place is not None and name not in heads else head, unit or said)


def _in_si(asked: AskedPoints, name: str, own: str, values: Array, units: Sequence[str]) -> tuple[str, Array]:
    """Of which of the units a column in a unit of its own (empty: none) is, and its numbers in SI."""
    if not own:
        return units[0], values
    try:
        size, dimension = parse_unit(own)
    except Finding as finding:
        raise _refused(asked, finding) from None
    found = next((unit for unit in units if _dimension(unit) == dimension), None)
    if found is None:
        known = " or ".join(dict.fromkeys(describe(_dimension(unit)) for unit in units))
        message = f"column '{name}' is {describe(dimension)}, and what is drawn there is {known}"
        raise _refused(asked, Finding("dimension", message, "draw a path of that kind, too, or another column"))
    return found, values * size


def _dimension(unit: str) -> Dimension:
    """The dimension of a unit of the results; of none that of numbers."""
    return NUMBER if unit in ("", "1") else parse_unit(unit)[1]


def _require_in_range(asked: AskedPoints, values: Array, text: str) -> None:
    """Refuse magnitudes that nothing is computed with. Raises SpecError."""
    beyond = ~are_in_range(values)
    if beyond.any():
        lines = [n for n, _ in rows_of(text)][-len(values) :]
        i = int(beyond.argmax())
        raise _refused(asked, out_of_range(float(values[i]), "a number (SI)"), (lines[i], 1))


def _refused(asked: AskedPoints, finding: Finding, at: tuple[int, int] | None = None) -> SpecError:
    """The error of a file or of a column in it."""
    message = f"--with {asked.words}: {finding.message}"
    place = SourceLocation(asked.file, *at) if at is not None else None
    return SpecError(Problem(finding.code, message, place, finding.hint))
