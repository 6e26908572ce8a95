"""`--variants FILE`: a CSV table of variants, a column a parameter and a row a variant. Impure: reads the file.

n [rpm]; L/mm; case         a unit behind the name counts for all plain numbers below it
1000;    120;  warm         each cell in the form of --set; quotes where it holds what separates
"1500";  2*r;  cold         empty lines and lines that begin with # do not count
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from heuncli.analyses.variants.axes import ParameterAxis, figure_of
from heuncli.app.commands.sweep.given import GivenAxis, GivenColumn
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.columns import rows_of
from heuncli.scene.file_format.headings import heading
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

LARGEST = 1_000_000_000  # bytes
CODE = "variants-table"
DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?(?:\s*[^\d\s,.].*)?)\Z")
MARKS = (";", "\t", ",")
FORM = "a column a parameter, its name in the first row: n [rpm],L [mm]"
QUOTES = 'a quote in a quoted cell is doubled, as "", and the cell ends on its line'


class Cell(NamedTuple):
    """What stands in a cell, and the column of the line in which it begins, from 1."""

    text: str
    column: int


def axes_in(path: str) -> tuple[GivenAxis, ...]:
    """The columns of a table of variants, all of one length. Raises SpecError with all that is wrong."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    rows = rows_of(_text(path, file))
    n, line = next(rows, (1, ""))
    if not line:
        raise SpecError(Problem(CODE, "the table holds no rows", SourceLocation(file, 1, 1), FORM))
    problems: list[Problem] = []
    mark = next((mark for mark in MARKS if mark in line), ",")
    heads = _cells(file, n, line, mark, problems)
    names = _named(file, n, heads, problems)
    texts: list[list[str]] = [[] for _ in heads]
    places: list[list[tuple[int, int]]] = [[] for _ in heads]
    for at, row in rows:
        cells = _cells(file, at, row, mark, problems)
        if not cells:
            continue
        if len(cells) != len(heads):
            message = f"the row has {len(cells)} cells, the first one {len(heads)}"
            problems.append(Problem(CODE, message, SourceLocation(file, at, 1), "a cell each, or leave the row out"))
            continue
        for k, cell in enumerate(cells):
            texts[k].append(_value(file, at, cell, names[k], mark, problems))
            places[k].append((at, cell.column))
    if not problems and not texts[0]:
        problems.append(Problem(CODE, "there is no variant below the names", SourceLocation(file, n, 1), FORM))
    if problems:
        raise SpecError(*problems)
    return tuple(
        GivenAxis(ParameterAxis(name, tuple(texts[k])), name, GivenColumn(file, (n, heads[k].column), places[k]))
        for k, (name, _) in enumerate(names)
    )


def _text(path: str, file: str) -> str:
    try:
        return read_bytes(path, LARGEST).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SpecError(Problem(CODE, "it is not UTF-8", SourceLocation(file, 1, 1), "save it as UTF-8")) from None
    except Finding as found:
        raise SpecError(Problem(found.code, found.message, SourceLocation(file, 1, 1), found.hint)) from None


def _named(file: str, n: int, heads: Sequence[Cell], problems: list[Problem]) -> list[tuple[str, str]]:
    """The names of the columns and their units (empty: none)."""
    found: list[tuple[str, str]] = []
    for cell in heads:
        place = SourceLocation(file, n, cell.column)
        name, unit = heading(cell.text)
        if not name or figure_of(name) is not None:
            problems.append(Problem(CODE, f"'{cell.text}' is not the name of a parameter", place, FORM))
        elif any(name == other for other, _ in found):
            problems.append(Problem(CODE, f"there are two columns '{name}'", place, "one column a parameter"))
        try:
            if unit:
                parse_unit(unit)
        except Finding as finding:
            problems.append(Problem(finding.code, finding.message, place, finding.hint))
        found.append((name, unit))
    return found


def _value(file: str, n: int, cell: Cell, head: tuple[str, str], mark: str, problems: list[Problem]) -> str:
    """A cell in the form of `--set`."""
    name, unit = head
    if not cell.text:
        hint = "each row has a value of every parameter; that of the spec is written, too"
        problems.append(
            Problem(CODE, f"an empty cell in the column '{name}'", SourceLocation(file, n, cell.column), hint)
        )
    text = DECIMAL_COMMA.sub(r"\1.\2", cell.text) if mark == ";" else cell.text
    figure = figure_of(text) if unit else None
    return f"{text} {unit}" if figure is not None and not figure.unit else text


def _cells(file: str, n: int, line: str, mark: str, problems: list[Problem]) -> list[Cell]:
    """The cells of a row; what is wrong with its quotes is added."""
    try:
        return list(_split(line, mark))
    except Finding as finding:
        problems.append(Problem(finding.code, finding.message, SourceLocation(file, n, 1), finding.hint))
        return []


def _split(line: str, mark: str) -> Iterator[Cell]:
    """The cells between the marks that stand in no quotes. Raises Finding."""
    begin = 0
    while begin <= len(line):
        start = begin + len(line[begin:]) - len(line[begin:].lstrip(" "))
        if line.startswith('"', start):
            end = start + 1
            while (end := line.find('"', end)) >= 0 and line.startswith('""', end):
                end += 2
            behind = line.find(mark, end) if end >= 0 else -1
            behind = len(line) if behind < 0 else behind
            if end < 0 or line[end + 1 : behind].strip():
                raise Finding(CODE, "a quote that does not end with its cell", QUOTES)
            yield Cell(line[start + 1 : end].replace('""', '"').strip(), start + 1)
        else:
            behind = line.find(mark, begin)
            behind = len(line) if behind < 0 else behind
            yield Cell(line[begin:behind].strip(), start + 1)
        begin = behind + 1
