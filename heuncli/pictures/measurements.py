"""Measured points over a history: from the column of a CSV file to what is drawn. Impure: reads files.

A column is named as its first row has it, with its unit or without (F, of F [kN] or F/kN), or by its number from 1.
Numbers are in the unit that stands behind the name; without one in SI.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.drawing.figure import Item, Spot, Trace
from heuncli.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.expressions.units import NUMBER, Dimension, describe, parse_unit
from heuncli.named_tuples import NamedTuple
from heuncli.number_range import are_in_range, out_of_range
from heuncli.results import Array
from heuncli.results_schema import counted
from heuncli.spec.columns import CsvError, NoColumn, columns_of, layout_of, rows_of
from heuncli.spec.headings import heading
from heuncli.spec.reading import read_bytes

LARGEST = 200_000_000  # bytes
MOST_SPOTS = 150  # points that are told apart; more are drawn as a line
SEEN = 1000  # stretches of a long line, in each of which its least and its greatest are drawn
FORM = "such as --with bench.csv:t:F, columns by the names in the first row or by numbers from 1"


class Measured(NamedTuple):
    """Points that were measured, (n,): over what a panel shows, in SI, and of which unit."""

    name: str
    unit: str
    x: Array
    y: Array


class AskedPoints(NamedTuple):
    """Columns x and y of a file, as they are asked for."""

    words: str
    file: str
    x: str
    y: str


def asked_points(words: str) -> AskedPoints:
    """What FILE:X:Y names; a file's own name may hold colons, columns none. Raises SpecError."""
    file, *columns = words.rsplit(":", 2)
    if len(columns) != 2 or not file or not all(columns):
        raise SpecError(Problem("bad-option", f"--with {words}: expected FILE:X:Y", hint=FORM))
    return AskedPoints(words, file, columns[0].strip(), columns[1].strip())


def measured(asked: AskedPoints, x_unit: str, units: Sequence[str]) -> Measured:
    """The points, for a picture over x_unit whose panels have some units, the first of which takes what has none.

    Raises SpecError with the place.
    """
    try:
        text = bytes(read_bytes(asked.file, LARGEST)).decode("utf-8-sig")
        names = [_full_name(word, layout_of(text).names) for word in (asked.x, asked.y)]
        x, y = (np.frombuffer(column) for column in columns_of(text, *names))
    except UnicodeDecodeError:
        raise _refused(asked, Finding("table-file", "it is not UTF-8", "save it as CSV in UTF-8")) from None
    except Finding as finding:
        raise _refused(asked, finding) from None
    except NoColumn as error:
        raise _refused(asked, error.finding) from None
    except CsvError as error:
        raise _refused(asked, error.finding, (error.line, error.column)) from None
    over = _in_si(asked, names[0], x, [x_unit])
    up = _in_si(asked, names[1], y, units)
    for values in (over[1], up[1]):
        _require_in_range(asked, values, text)
    return Measured(f"{asked.file}: {names[1]}", up[0], over[1], up[1])


def _full_name(word: str, names: Sequence[str]) -> str:
    """The whole heading of a column that is named without its unit; the word where there is none such."""
    if word in names or counted(word) is not None:
        return word
    return next((name for name in names if heading(name)[0] == word), word)


def _in_si(asked: AskedPoints, name: str, values: Array, units: Sequence[str]) -> tuple[str, Array]:
    """Of which of the units a column is, and its numbers in SI."""
    own = heading(name)[1]
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


def seen(points: Measured, pen: int, size_x: float, size_y: float) -> Iterator[Item]:
    """Squares, or where there are many a thin line through them; sizes: from SI to the units that are shown."""
    x, y = size_x * points.x, size_y * points.y
    if len(x) <= MOST_SPOTS:
        for a, b in zip(x.tolist(), y.tolist(), strict=True):
            yield Spot(a, b, "", pen, "square")
        return
    if len(x) > 2 * SEEN:
        parts = np.array_split(np.arange(len(y)), SEEN)
        ends = [(part[np.argmin(y[part])], part[np.argmax(y[part])]) for part in parts]
        kept = np.unique(np.array(ends))
        x, y = x[kept], y[kept]
    yield Trace(points.name, x, y, pen, thin=True)
