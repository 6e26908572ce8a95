"""The axes of a sweep, each value with its place: words of the command line, or columns of the table `--variants FILE`.

The table is a CSV file, one column per parameter and one row per variant. Names and units of all axes are checked
before the first variant runs, and all problems reported at once. Problems that depend on the size of a value (a
negative mass, a loop that does not close) are not checked here: such a variant gets the reason in its row. Impure:
reads the table.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from heuncli.analyses.variants.evaluation import SPELLING_CODES, VariantEvaluator, varies_cases
from heuncli.analyses.variants.parameters import (
    CASE,
    ParameterAxis,
    RandomVariable,
    format_value,
    make_axis,
    parse_axis_values,
)
from heuncli.analyses.variants.spec_numbers import SpecNumbers
from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.units import parse_unit
from heuncli.scene.file_format.column_layout import iter_rows
from heuncli.scene.file_format.headings import split_heading
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.parameters import parse_path
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue, parse_number_with_unit
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

MAX_SAMPLES = 1000  # of an axis; each is read twice before the first variant runs


class AxisColumn(NamedTuple):
    """A column of a table of variants: its file, and the location of its head and of each cell (line, column from
    1).
    """

    file: str
    head: tuple[int, int]
    cells: Sequence[tuple[int, int]]


class AxisArgument(NamedTuple):
    """An axis, and the word of the command line or the column that defines it."""

    parameter: ParameterAxis | RandomVariable
    word: str
    column: AxisColumn | None = None

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.parameter.name

    @property
    def is_all_cases(self) -> bool:
        """Whether it is the word `case=all`."""
        if self.name != CASE or self.column is not None or isinstance(self.parameter, RandomVariable):
            return False
        return [*self.parameter.values] == [ALL_CASES]

    def list_samples(self) -> dict[ParameterValue, int]:
        """Return one value of each kind (numbers of each unit, and all other texts), with its index among the values;
        of a random variable one typical value.
        """
        axis = self.parameter
        if isinstance(axis, RandomVariable):
            return {NumberWithUnit(axis.a, axis.unit): 0}
        if axis.unit is not None:
            return {axis.find_value(0): 0}
        known_kinds: set[str] = set()
        samples: dict[ParameterValue, int] = {}
        for k, value in enumerate(axis.values):
            text = str(value)
            number = parse_number_with_unit(text)
            kind = f"number {number.unit}" if number is not None else text
            if kind not in known_kinds:
                known_kinds.add(kind)
                samples[text] = k
                if len(samples) >= MAX_SAMPLES:
                    break
        return samples

    def locate_problem(self, problem: Problem, k: int | None = None) -> Problem:
        """Return a problem of the k-th value, or of the name, with its location."""
        if self.column is None:
            place, prefix = None, f"{self.word}: "
        else:
            line, column = self.column.head if k is None else self.column.cells[k]
            place, prefix = SourceLocation(self.column.file, line, column, self.name), ""
        inner_location = problem.location
        inner_text = (
            f"at {inner_location}: {inner_location.path}: "
            if inner_location is not None and not inner_location.file.startswith("--set ")
            else ""
        )
        return Problem(problem.code, f"{prefix}{inner_text}{problem.message}", place, problem.hint)


def parse_axis(word: str) -> AxisArgument:
    """Parse one word of the command line. Raises AxisError."""
    return AxisArgument(parse_axis_values(word), word)


def parse_shard(word: str | None) -> tuple[int, int]:
    """Return the number of the part, and of how many. Raises UsageError."""
    if word is None:
        return 1, 1
    k, slash, n = word.partition("/")
    numbers = [int(text) for text in (k, n) if text.isascii() and text.isdecimal() and len(text) < 10]
    if not slash or len(numbers) < 2 or not 1 <= numbers[0] <= numbers[1]:
        message = f"--shard {word}: expected K/N, the K-th part of N"
        raise UsageError(Problem("bad-option", message, hint="for example --shard 2/8; the last is 8/8"))
    return numbers[0], numbers[1]


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


# Codes of problems that do not depend on a value's size, besides those that begin with unknown-.
NAME_CODES = frozenset({
    "no-such-key", "dimension", "wrong-dimension", "wrong-kind", "expression-syntax", "expression-limit",
    "function-arguments", "parameter-circle", "not-in-time", "not-yaml", "bad-character", "too-deep", "empty",
})  # fmt: skip
ONCE = "give one axis per parameter"


def find_problems(
    axes: Sequence[AxisArgument], evaluator: VariantEvaluator, overrides: Collection[str]
) -> list[Problem]:
    """Return the problems of the axes' names and units.

    overrides: names that --set sets in all variants
    """
    problems = list(_find_duplicates(axes, evaluator, overrides))
    for one in axes if not problems else ():
        if one.name == CASE and varies_cases(evaluator.spec):
            problems += _check_cases(one, evaluator)
        elif one.name == CASE and CASE not in evaluator.spec.parameters:
            problem = Problem(
                "no-such-key", "the spec has no load cases", hint="cases: {NAME: {set: {PARAMETER: VALUE}}}"
            )
            problems.append(one.locate_problem(problem))
        else:
            problems += _check_values(one, evaluator)
    return list(dict.fromkeys(problems))


def _find_duplicates(
    axes: Sequence[AxisArgument], evaluator: VariantEvaluator, overrides: Collection[str]
) -> Iterator[Problem]:
    """Yield parameters that two words vary, or that are both varied and set."""
    data = {"parameters": dict.fromkeys(evaluator.spec.parameters)}
    paths = [parse_path(one.name, data) for one in axes]
    fixed = [parse_path(name, data) for name in overrides]
    for k, one in enumerate(axes):
        if paths[k] in paths[:k]:
            yield one.locate_problem(Problem("bad-option", f"{one.name} is varied twice", hint=ONCE))
        elif paths[k] in fixed:
            message = f"{one.name} is varied, and set by --set"
            yield one.locate_problem(Problem("bad-option", message, hint="leave one of them out"))


def _check_cases(one: AxisArgument, evaluator: VariantEvaluator) -> Iterator[Problem]:
    """Yield load cases that do not exist."""
    known = evaluator.spec.cases
    for value, k in one.list_samples().items():
        text = format_value(value)
        if text not in known and not one.is_all_cases:
            hint = suggest(text, known, "cases")
            yield one.locate_problem(Problem("unknown-case", f"there is no load case '{text}'", hint=hint), k)


def _check_values(one: AxisArgument, evaluator: VariantEvaluator) -> Iterator[Problem]:
    """Yield the problems of an axis that do not depend on the size of its values, at the first location of each
    kind.
    """
    for value, k in one.list_samples().items():
        try:
            evaluator.load({one.name: value})
        except SpecError as error:
            relevant = [each for each in error.problems if each.code in NAME_CODES or each.code.startswith("unknown-")]
            count_text = f"; {len(relevant)} places in all" if len(relevant) > 1 else ""
            for problem in relevant[:1]:
                extended = problem._replace(message=problem.message + count_text)
                yield one.locate_problem(extended, None if problem.code == "no-such-key" else k)


def find_warnings(axes: Sequence[AxisArgument], evaluator: VariantEvaluator) -> list[str]:
    """Return warnings about the axes, one sentence each, before their variants are solved."""
    warnings = []
    for one in axes:
        for value, k in one.list_samples().items():
            with suppress(SpecError):
                spec = evaluator.load({one.name: value})
                located = [
                    one.locate_problem(problem, k) for problem in spec.warnings if problem.code in SPELLING_CODES
                ]
                warnings += [str(problem._replace(hint=_make_unit_hint(one, evaluator))) for problem in located]
    unused = evaluator.find_unused_parameters([one.name for one in axes])
    warnings += [f"{one.word}: {one.name} has no effect" for one in axes if one.name in unused]
    return list(dict.fromkeys(warnings))


def _make_unit_hint(one: AxisArgument, evaluator: VariantEvaluator) -> str:
    unit = SpecNumbers(evaluator.recipe, evaluator.spec).find_number(one.name).unit
    return (
        f"in the head of the column: {one.name} [{unit}]"
        if one.column is not None
        else f"with the unit: {one.word}{unit}"
    )
