"""Read the table of `--variants FILE`: a CSV file, one column per parameter and one row per variant.

Impure: reads the file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from heuncli.analyses.variants.parameters import make_axis
from heuncli.app.commands.sweep.axes import AxisArgument, AxisColumn
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.column_layout import iter_rows
from heuncli.scene.file_format.headings import split_heading
from heuncli.scene.file_format.quantity import parse_number_with_unit
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

MAX_BYTES = 1_000_000_000  # bytes
CODE = "variants-table"
DECIMAL_COMMA = re.compile(r"\A([+-]?\d*),(\d+(?:[eE][+-]?\d+)?(?:\s*[^\d\s,.].*)?)\Z")
SEPARATORS = (";", "\t", ",")
FORM = "one column per parameter, its name in the first row: n [rpm],L [mm]"
QUOTES = 'a quote in a quoted cell is doubled, as "", and the cell ends on its line'


class TableCell(NamedTuple):
    """The text of a cell, and the column of the line in which it begins, from 1."""

    text: str
    column: int


def read_axes(path: str) -> tuple[AxisArgument, ...]:
    """Read the columns of a table of variants, all of one length. Raises SpecError with every problem."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    rows = iter_rows(_read_text(path, file))
    n, line = next(rows, (1, ""))
    if not line:
        raise SpecError(Problem(CODE, "the table holds no rows", SourceLocation(file, 1, 1), FORM))
    problems: list[Problem] = []
    mark = next((mark for mark in SEPARATORS if mark in line), ",")
    heads = _split_row(file, n, line, mark, problems)
    names = _parse_heads(file, n, heads, problems)
    texts: list[list[str]] = [[] for _ in heads]
    places: list[list[tuple[int, int]]] = [[] for _ in heads]
    for line_number, row in rows:
        cells = _split_row(file, line_number, row, mark, problems)
        if not cells:
            continue
        if len(cells) != len(heads):
            message = f"the row has {len(cells)} cells, the first row {len(heads)}"
            problems.append(
                Problem(
                    CODE,
                    message,
                    SourceLocation(file, line_number, 1),
                    "give one cell per column, or leave out the row",
                )
            )
            continue
        for k, cell in enumerate(cells):
            texts[k].append(_format_value(file, line_number, cell, names[k], mark, problems))
            places[k].append((line_number, cell.column))
    if not problems and not texts[0]:
        problems.append(Problem(CODE, "there is no variant below the header", SourceLocation(file, n, 1), FORM))
    if problems:
        raise SpecError(*problems)
    return tuple(
        AxisArgument(make_axis(name, texts[k]), name, AxisColumn(file, (n, heads[k].column), places[k]))
        for k, (name, _) in enumerate(names)
    )


def _read_text(path: str, file: str) -> str:
    """Read the table as UTF-8; file: its name in locations. Raises SpecError."""
    try:
        return read_bytes(path, MAX_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SpecError(Problem(CODE, "it is not UTF-8", SourceLocation(file, 1, 1), "save it as UTF-8")) from None
    except Finding as found:
        raise SpecError(Problem(found.code, found.message, SourceLocation(file, 1, 1), found.hint)) from None


def _parse_heads(file: str, n: int, heads: Sequence[TableCell], problems: list[Problem]) -> list[tuple[str, str]]:
    """Return the names of the columns and their units (empty: none)."""
    names: list[tuple[str, str]] = []
    for cell in heads:
        place = SourceLocation(file, n, cell.column)
        name, unit = split_heading(cell.text)
        if not name or parse_number_with_unit(name) is not None:
            problems.append(Problem(CODE, f"'{cell.text}' is not the name of a parameter", place, FORM))
        elif any(name == other for other, _ in names):
            problems.append(Problem(CODE, f"there are two columns '{name}'", place, "give one column per parameter"))
        try:
            if unit:
                parse_unit(unit)
        except Finding as finding:
            problems.append(Problem(finding.code, finding.message, place, finding.hint))
        names.append((name, unit))
    return names


def _format_value(file: str, n: int, cell: TableCell, head: tuple[str, str], mark: str, problems: list[Problem]) -> str:
    """Return a cell in the form of `--set`."""
    name, unit = head
    if not cell.text:
        hint = "give every parameter a value in each row, even that of the spec"
        problems.append(
            Problem(CODE, f"an empty cell in the column '{name}'", SourceLocation(file, n, cell.column), hint)
        )
    text = DECIMAL_COMMA.sub(r"\1.\2", cell.text) if mark == ";" else cell.text
    figure = parse_number_with_unit(text) if unit else None
    return f"{text} {unit}" if figure is not None and not figure.unit else text


def _split_row(file: str, n: int, line: str, mark: str, problems: list[Problem]) -> list[TableCell]:
    """Return the cells of a row; adds a problem if its quotes are wrong."""
    try:
        return list(_iter_cells(line, mark))
    except Finding as finding:
        problems.append(Problem(finding.code, finding.message, SourceLocation(file, n, 1), finding.hint))
        return []


def _iter_cells(line: str, mark: str) -> Iterator[TableCell]:
    """Yield the cells between the separators outside quotes. Raises Finding."""
    cell_start = 0
    while cell_start <= len(line):
        start = cell_start + len(line[cell_start:]) - len(line[cell_start:].lstrip(" "))
        if line.startswith('"', start):
            end = start + 1
            while (end := line.find('"', end)) >= 0 and line.startswith('""', end):
                end += 2
            cell_end = line.find(mark, end) if end >= 0 else -1
            cell_end = len(line) if cell_end < 0 else cell_end
            if end < 0 or line[end + 1 : cell_end].strip():
                raise Finding(CODE, "a quote that is not closed in its cell", QUOTES)
            yield TableCell(line[start + 1 : end].replace('""', '"').strip(), start + 1)
        else:
            cell_end = line.find(mark, cell_start)
            cell_end = len(line) if cell_end < 0 else cell_end
            yield TableCell(line[cell_start:cell_end].strip(), start + 1)
        cell_start = cell_end + 1
