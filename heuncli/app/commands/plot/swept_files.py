"""The file of a sweep, its store or its CSV, as columns of numbers. Impure: reads the file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from itertools import islice
from pathlib import PurePath

import numpy as np

from heuncli.analyses.sweep_store.columns import CODE, NUMBER, REASON, WORDS, parameters_of
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.sweep_store.store.store import opened
from heuncli.analyses.sweep_store.which import chosen, name_and_number
from heuncli.analyses.variants.asking import Measured
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli.entry import UsageError
from heuncli.base import tolerances
from heuncli.base.errors import Finding, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.swept import SweptNumbers, SweptTable, SweptVariable
from heuncli.results.results import Array
from heuncli.scene.file_format.reading import read_bytes

ASKED_BY = "heun plot"
LARGEST = 1_000_000_000  # bytes
LARGEST_NUMBER = tolerances.MOST_MAGNITUDE**2  # of a product of two that are computed with
ERROR, AT = " error", " at [s]"  # behind a measure, the heads of its other columns
WRITES_ONE = "heun sweep SPEC ... -o sweep.csv writes one"
NO_NUMBER = Measured(None)
NOT_SAID = "not known"


def table_of(word: str) -> SweptTable:
    """The sweep in a file. Raises UsageError, OutputError."""
    if PurePath(word).suffix.lower() == ".csv":
        return _of_csv(word)
    name, asked = name_and_number(word, ASKED_BY)
    store = opened(name)
    with closing(store.connection):
        sweeps = list(store.sweeps())
        sweep = chosen(name, asked, sweeps, ASKED_BY)
        found = _of_rows(sweep.head, store.rows(sweep.number, sweep.head.plan.names))
    which = f", sweep {sweep.number} of {len(sweeps)}" if len(sweeps) > 1 else ""
    return found._replace(origin=f"{name}{which}: {sweep.head.path}")


def _of_rows(head: SweepHead, rows: Iterable[SweptRow]) -> SweptTable:
    """The rows of a store."""
    parameters, count = parameters_of(head.plan), len(head.measures)
    cells: list[list[float | str]] = [[] for _ in parameters]
    found: list[list[Measured]] = [[] for _ in head.measures]
    codes: list[str] = []
    for row in rows:
        codes.append(row.answer.code)
        for column, one in zip(cells, parameters, strict=True):
            column.append(one.value(row.values[one.name]))
        for measure, answer in zip(found, row.answer.measures or (NO_NUMBER,) * count, strict=True):
            measure.append(answer)
    variables = tuple(
        _variable(one.name, one.unit or "", column) for one, column in zip(parameters, cells, strict=True)
    )
    measures = tuple(
        SweptNumbers(
            of.text, of.unit,
            np.array([math.nan if one.value is None else one.value for one in own], dtype=np.float64),
            np.array([one.error or 0.0 for one in own], dtype=np.float64),
            tuple(_short(one.word) for one in own),
        )
        for of, own in zip(head.measures, found, strict=True)
    )  # fmt: skip
    random = _is_random(head.plan)
    return SweptTable(head.title or head.path, head.path, variables, measures, tuple(codes), head.plan.size, random)


def _is_random(plan: Plan) -> bool | None:
    """Whether variants were drawn or listed; of those that go together the rows tell."""
    if plan.draws is not None or plan.columns:
        return True
    return None if plan.together else False


def _variable(name: str, unit: str, cells: Sequence[float | str]) -> SweptVariable:
    """A column of what was varied: numbers, or places among texts in the order in which these come."""
    if all(isinstance(cell, float) for cell in cells):
        return SweptVariable(name, unit, np.array(cells, dtype=np.float64))
    texts = tuple(dict.fromkeys(map(str, cells)))
    places = {text: float(k) for k, text in enumerate(texts)}
    return SweptVariable(name, "", np.array([places[str(cell)] for cell in cells]), texts)


class CsvColumns(NamedTuple):
    """Where what stands in a sweep's CSV: places of the parameters, and of the first column of each measure."""

    heads: Sequence[str]
    parameters: Sequence[int]
    measures: Sequence[int]


def _of_csv(path: str) -> SweptTable:
    """The CSV that `heun sweep` writes."""
    rows = _rows(path)
    columns = _columns(path, next(rows, []))
    table: list[list[str]] = []
    for number, row in enumerate(rows, 2):
        if len(row) != len(columns.heads):
            raise _no_sweep(path, f"row {number} has {len(row)} cells, the first one {len(columns.heads)}")
        table.append(row)
    by_column = list(zip(*table, strict=True)) or [() for _ in columns.heads]
    codes, reasons = by_column[-2], by_column[-1]
    variables = []
    for k in columns.parameters:
        name, unit = _named(columns.heads[k].replace(" (parameter)", ""))
        cells = [_number(cell) for cell in by_column[k]]
        numbers = not any(map(math.isnan, cells))
        _require_in_range(path, columns.heads[k], np.array(cells))
        variables.append(_variable(name, unit, cells if numbers else list(by_column[k])))
    measures = []
    for k in columns.measures:
        text, unit = _named(columns.heads[k])
        values, errors = (np.array([_number(cell) for cell in by_column[k + j]]) for j in (0, 1))
        _require_in_range(path, columns.heads[k], values, errors)
        lost = tuple(_lost(columns.heads[k], *why) for why in zip(values, codes, reasons, strict=True))
        measures.append(SweptNumbers(text, unit, values, np.nan_to_num(errors), lost))
    origin = f"{path}: {len(table):,} variants"
    return SweptTable(PurePath(path).name, origin, tuple(variables), tuple(measures), tuple(codes), None)


def _require_in_range(path: str, head: str, *columns: Array) -> None:
    """Raise UsageError for numbers so large that no run has them, and that no axis holds."""
    for values in columns:
        beyond = np.isfinite(values) & (np.abs(values) > LARGEST_NUMBER)
        if beyond.any():
            row = int(beyond.argmax())
            raise _no_sweep(path, f"row {row + 2}: {head} is {values[row]:g}")


def _rows(path: str) -> Iterator[list[str]]:
    """The rows of a CSV file. Raises UsageError."""
    try:
        text = read_bytes(path, LARGEST).decode("utf-8-sig")
    except Finding as found:
        raise UsageError(Problem(found.code, f"{ASKED_BY} {path}: {found.message}", hint=found.hint)) from None
    except UnicodeDecodeError:
        raise _no_sweep(path, "it is not UTF-8") from None
    try:
        yield from csv.reader(io.StringIO(text, newline=""), strict=True)
    except csv.Error as error:
        raise _no_sweep(path, str(error)) from None


def _columns(path: str, heads: Sequence[str]) -> CsvColumns:
    """What stands in the columns. Raises UsageError."""
    if not heads:
        raise _no_sweep(path, "it is empty")
    if heads[0] != NUMBER or list(heads[-2:]) != [CODE, REASON]:
        raise _no_sweep(path, f"its columns are {', '.join(islice(heads, 4))}, ...")
    measures = [
        k for k in range(1, len(heads) - 4) if (heads[k + 1], heads[k + 2]) == (heads[k] + ERROR, heads[k] + AT)
    ]
    if not measures or measures != list(range(measures[0], len(heads) - 2, 3)):
        raise _no_sweep(path, "it has no measures, each with its error and its instant")
    return CsvColumns(heads, range(1, measures[0]), measures)


def _no_sweep(path: str, why: str) -> UsageError:
    return UsageError(Problem("bad-option", f"{path}: this is no CSV of a sweep: {why}", hint=WRITES_ONE))


def _named(head: str) -> tuple[str, str]:
    """The name and the unit of a column `name [unit]`."""
    name, bracket, unit = head.removesuffix("]").rpartition(" [")
    return (name, unit) if bracket and head.endswith("]") else (head, "")


def _number(cell: str) -> float:
    """A number, nan where there is none."""
    try:
        found = float(cell)
    except ValueError:
        return math.nan
    return found if math.isfinite(found) else math.nan


def _lost(measure: str, value: float, code: str, reason: str) -> str:
    """Why a solved variant has no number."""
    if code or not math.isnan(value):
        return ""
    return next((_short(word) for word, (_, why) in WORDS.items() if f"{measure}: {why}" in reason), NOT_SAID)


def _short(word: str) -> str:
    """The word for what is lost, as notes have it."""
    return {"unknown": NOT_SAID, "beyond": "beyond the horizon"}.get(word, word)
