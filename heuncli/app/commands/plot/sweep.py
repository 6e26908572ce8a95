"""`heun plot sweep.sqlite`, or sweep.csv: draw the measures of a sweep over its parameters. Impure: reads the file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import islice
from pathlib import PurePath

import numpy as np

from heuncli.analyses.sweep_rows import (
    CODE,
    NUMBER,
    REASON,
    SweepHead,
    SweptRow,
    find_missing_words,
    make_parameter_columns,
    to_cell,
)
from heuncli.analyses.sweep_store import choose_sweep, open_store, split_store_argument
from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureValue
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.target import parse_units
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import PlotTarget
from heuncli.base import tolerances
from heuncli.base.errors import Finding, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.sweep_tables import SweepNumbers, SweepTable, SweepVariable
from heuncli.output.figures.sweeps import make_sweep_figure
from heuncli.results.results import Array
from heuncli.scene.file_format.reading import read_bytes


def draw_sweep(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw measures over the varied parameters. Raises UsageError, OutputError, NotDrawable."""
    if len(target.files) > 1:
        message = f"heun plot {' '.join(target.files)}: one sweep at a time, without a spec"
        raise UsageError(Problem("bad-option", message, hint="call it once for each"))
    return make_sweep_figure(read_sweep(target.files[0]), parse_units(request.units), target.paths)


COMMAND = "heun plot"
MAX_BYTES = 1_000_000_000  # bytes
MAX_NUMBER = tolerances.MOST_MAGNITUDE**2  # the largest product of two numbers in range
ERROR, AT = " error", " at [s]"  # suffixes of a measure's other columns
WRITES_ONE = "heun sweep SPEC ... -o sweep.csv writes one"
UNKNOWN_TEXT = MISSING_KINDS["unknown"].short


def read_sweep(word: str) -> SweepTable:
    """Read a sweep from a store (FILE:NUMBER for one of several) or from CSV. Raises UsageError, OutputError."""
    if PurePath(word).suffix.lower() == ".csv":
        return _read_csv(word)
    name, number = split_store_argument(word, COMMAND)
    store = open_store(name)
    with closing(store.connection):
        sweeps = list(store.iter_sweeps())
        sweep = choose_sweep(name, number, sweeps, COMMAND)
        table = _make_table(sweep.head, store.find_rows(sweep.number, sweep.head.plan))
    sweep_text = f", sweep {sweep.number} of {len(sweeps)}" if len(sweeps) > 1 else ""
    return table._replace(origin=f"{name}{sweep_text}: {sweep.head.path}")


def _make_table(head: SweepHead, rows: Iterable[SweptRow]) -> SweepTable:
    """Make the table from the rows of a store."""
    parameters = make_parameter_columns(head.plan)
    cells: list[list[float | str]] = [[] for _ in parameters]
    results: list[list[MeasureValue]] = [[] for _ in head.measures]
    codes: list[str] = []
    for row in rows:
        codes.append(row.result.code)
        for column, parameter in zip(cells, parameters, strict=True):
            column.append(to_cell(row.values[parameter.name]))
        for k, measure in enumerate(results):
            measure.append(row.result.get_measure(k))
    variables = tuple(
        _make_variable(parameter.name, parameter.unit or "", column)
        for parameter, column in zip(parameters, cells, strict=True)
    )
    measures = tuple(
        SweepNumbers(
            head_measure.text, head_measure.unit,
            np.array([math.nan if one.value is None else one.value for one in column_results], dtype=np.float64),
            np.array([one.error or 0.0 for one in column_results], dtype=np.float64),
            tuple(MISSING_KINDS[one.word].short if one.word else "" for one in column_results),
        )
        for head_measure, column_results in zip(head.measures, results, strict=True)
    )  # fmt: skip
    random = _is_random(head.plan)
    return SweepTable(head.title or head.path, head.path, variables, measures, tuple(codes), head.plan.size, random)


def _is_random(plan: Plan) -> bool | None:
    """Return whether the variants were drawn at random or listed; None if the axes vary together, when the rows
    decide.
    """
    if plan.draws is not None or plan.columns:
        return True
    return None if plan.together else False


def _make_variable(name: str, unit: str, cells: Sequence[float | str]) -> SweepVariable:
    """Make the column of a parameter: numbers, or for texts their index in order of appearance."""
    if all(isinstance(cell, float) for cell in cells):
        return SweepVariable(name, unit, np.array(cells, dtype=np.float64))
    texts = tuple(dict.fromkeys(map(str, cells)))
    places = {text: float(k) for k, text in enumerate(texts)}
    return SweepVariable(name, "", np.array([places[str(cell)] for cell in cells]), texts)


class CsvColumns(NamedTuple):
    """The columns of a sweep's CSV: indices of the parameters, and of the first column of each measure."""

    heads: Sequence[str]
    parameters: Sequence[int]
    measures: Sequence[int]


def _read_csv(path: str) -> SweepTable:
    """Read the CSV that `heun sweep` writes."""
    rows = _iter_rows(path)
    columns = _find_columns(path, next(rows, []))
    table: list[list[str]] = []
    for number, row in enumerate(rows, 2):
        if len(row) != len(columns.heads):
            raise _make_error(path, f"row {number} has {len(row)} cells, the first row {len(columns.heads)}")
        table.append(row)
    by_column = list(zip(*table, strict=True)) or [() for _ in columns.heads]
    codes, reasons = by_column[-2], by_column[-1]
    variables = []
    for k in columns.parameters:
        name, unit = _split_unit(columns.heads[k].replace(" (parameter)", ""))
        cells = [_parse_number(cell) for cell in by_column[k]]
        numbers = not any(map(math.isnan, cells))
        _require_in_range(path, columns.heads[k], np.array(cells))
        variables.append(_make_variable(name, unit, cells if numbers else list(by_column[k])))
    measures = []
    heads = [columns.heads[k] for k in columns.measures]
    words_by_row = [find_missing_words(reason, heads) for reason in reasons]
    for k in columns.measures:
        text, unit = _split_unit(columns.heads[k])
        values, errors = (np.array([_parse_number(cell) for cell in by_column[k + j]]) for j in (0, 1))
        _require_in_range(path, columns.heads[k], values, errors)
        missing_words = tuple(
            _find_missing_word(words, columns.heads[k], value, code)
            for words, value, code in zip(words_by_row, values, codes, strict=True)
        )
        measures.append(SweepNumbers(text, unit, values, np.nan_to_num(errors), missing_words))
    origin = f"{path}: {len(table):,} variants"
    return SweepTable(PurePath(path).name, origin, tuple(variables), tuple(measures), tuple(codes), None)


def _require_in_range(path: str, head: str, *columns: Array) -> None:
    """Raise UsageError for numbers too large for any run and for the axes."""
    for values in columns:
        too_large = np.isfinite(values) & (np.abs(values) > MAX_NUMBER)
        if too_large.any():
            row = int(too_large.argmax())
            raise _make_error(path, f"row {row + 2}: {head} is {values[row]:g}")


def _iter_rows(path: str) -> Iterator[list[str]]:
    """Yield the rows of a CSV file. Raises UsageError."""
    try:
        text = read_bytes(path, MAX_BYTES).decode("utf-8-sig")
    except Finding as found:
        raise UsageError(Problem(found.code, f"{COMMAND} {path}: {found.message}", hint=found.hint)) from None
    except UnicodeDecodeError:
        raise _make_error(path, "it is not UTF-8") from None
    try:
        yield from csv.reader(io.StringIO(text, newline=""), strict=True)
    except csv.Error as error:
        raise _make_error(path, str(error)) from None


def _find_columns(path: str, heads: Sequence[str]) -> CsvColumns:
    """Find the columns by their heads. Raises UsageError."""
    if not heads:
        raise _make_error(path, "it is empty")
    if heads[0] != NUMBER or list(heads[-2:]) != [CODE, REASON]:
        raise _make_error(path, f"its columns are {', '.join(islice(heads, 4))}, ...")
    measures = [
        k for k in range(1, len(heads) - 4) if (heads[k + 1], heads[k + 2]) == (heads[k] + ERROR, heads[k] + AT)
    ]
    if not measures or measures != list(range(measures[0], len(heads) - 2, 3)):
        raise _make_error(path, "it has no measures, each with its error and its instant")
    return CsvColumns(heads, range(1, measures[0]), measures)


def _make_error(path: str, why: str) -> UsageError:
    """Make the error of a file that is no CSV of a sweep."""
    return UsageError(Problem("bad-option", f"{path}: not a CSV file of a sweep: {why}", hint=WRITES_ONE))


def _split_unit(head: str) -> tuple[str, str]:
    """Split the head of a column `name [unit]` into name and unit."""
    name, bracket, unit = head.removesuffix("]").rpartition(" [")
    return (name, unit) if bracket and head.endswith("]") else (head, "")


def _parse_number(cell: str) -> float:
    """Parse a number; nan if there is none."""
    try:
        value = float(cell)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def _find_missing_word(words: Mapping[str, str], measure: str, value: float, code: str) -> str:
    """Return why a solved variant has no number, in short; empty if it has one."""
    if code or not math.isnan(value):
        return ""
    return MISSING_KINDS[words[measure]].short if measure in words else UNKNOWN_TEXT
