"""The hardpoints of a run, or of all its load cases, as a table, as data and as CSV."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.output.documents.as_data import FORMAT
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable
from heuncli.output.summary.hardpoints import Hardpoint, HardpointRun
from heuncli.output.tables.extremes_tables import NOT_SEARCHED
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, Style, largest_magnitude, write_numbers, write_times
from heuncli.study.quantities.labels import Labels
from heuncli.version import VERSION

HEADING = (
    'HARDPOINTS  each joint and load at its greatest force: joints "from" on "to", others on the named end; '
    "moment about the point"
)
WEIGHT_NOTE = "weight and inertia of the bodies are not listed"
NO_ROWS = "nothing to show: no joint, coupling or load acts at an instant"
AXES = {"world": "world axes", "from": 'axes and origin of the "from" body', "to": 'axes and origin of the "to" body'}
VECTORS = (("position", "", "m"), ("force", "F", "N"), ("moment", "M", "N·m"))
CSV_NAMES = (
    "point", "kind", "on", "from", "axes", *XYZ, *(f"F{axis}" for axis in XYZ), *(f"M{axis}" for axis in XYZ),
    "time", "case",
)  # fmt: skip


def make_hardpoint_document(
    title: str, facts: Sequence[tuple[str, str]], runs: Sequence[HardpointRun], labels: Labels, axes: str
) -> OutputDocument:
    """Make the document of the hardpoints of one run, or of one for each load case."""
    rows = [row for run in runs for row in run.rows]
    table = make_hardpoint_table(runs, labels, axes)

    def make_block() -> dict[str, Any]:
        return {"heun": FORMAT, "version": VERSION, "title": title, "hardpoints": [_make_block(row) for row in rows]}

    return OutputDocument(title, facts, [table], make_block, lambda: _make_records(rows))


def make_hardpoint_table(runs: Sequence[HardpointRun], labels: Labels, axes: str) -> OutputTable:
    """Make the table: a title for each joint, coupling or load, below it a row an end and load case."""
    rows = [row for run in runs for row in run.rows]
    heading = f"{HEADING}; {AXES.get(axes, f'axes and origin of {axes}')}"
    if not rows:
        return OutputTable(heading, notes=(NO_ROWS,))
    units = {name: labels.units.find(unit) for name, _, unit in VECTORS}
    columns = [OutputColumn("on", "text"), OutputColumn("case", "text")]
    texts: list[list[str]] = []
    for name, symbol, unit in VECTORS:
        values = units[name][1] * np.array([getattr(row, name) for row in rows])
        style = _choose_style(runs, name, unit, values, units[name][1])
        cells = write_numbers(values.ravel().tolist(), style)
        texts += [cells[i::3] for i in range(3)]
        columns += [OutputColumn(f"{symbol}{axis} [{units[name][0]}]", vector=name) for axis in XYZ]
    texts.append(write_times([row.time for row in rows], max(run.span for run in runs)))
    columns.append(OutputColumn("at [s]"))
    groups: dict[tuple[str, str], list[int]] = {}
    for i, row in enumerate(rows):
        groups.setdefault((row.kind, row.name), []).append(i)
    has_cases = any(row.case for row in rows)
    shown = [i for i in range(len(columns)) if i != 1 or has_cases]
    body: list[Sequence[Cell] | str] = []
    for members in groups.values():
        body.append(_make_title([rows[i] for i in members]))
        for i in members:
            cells_of_row = [rows[i].end, rows[i].case, *(column[i] for column in texts)]
            body.append(tuple(cells_of_row[j] for j in shown))
    is_open = any(OPEN in column for column in texts)
    notes = [WEIGHT_NOTE, *[OPEN_NOTE] * is_open, *[NOT_SEARCHED] * (not all(run.is_searched for run in runs))]
    return OutputTable(heading, tuple(columns[j] for j in shown), tuple(body), tuple(notes))


def _make_title(rows: Sequence[Hardpoint]) -> str:
    first = rows[0]
    ends = {row.end for row in rows}
    between = f", {first.other_end} → {first.end}" if len(ends) == 1 and first.other_end else ""
    return f"{first.name}  {first.kind}{between}"


def _choose_style(
    runs: Sequence[HardpointRun], name: str, unit: str, values: np.ndarray[Any, Any], size: float
) -> Style:
    """Choose the decimals of all vectors of one unit."""
    kind = "motion" if name == "position" else "reactions"
    styles = [run.certain.choose_style(kind, unit, largest_magnitude(values) / size) for run in runs]
    return min(styles, key=lambda style: style.decimals)


def _make_block(row: Hardpoint) -> dict[str, Any]:
    vectors = {name: dict(zip(XYZ, vector, strict=True)) for name, vector in
               (("", row.position), ("F", row.force), ("M", row.moment))}  # fmt: skip
    numbers = {f"{name}{axis}": float(value) for name, vector in vectors.items() for axis, value in vector.items()}
    return {"point": row.name, "kind": row.kind, "on": row.end, "from": row.other_end, "axes": row.axes, **numbers,
            "time": row.time, "case": row.case or None}  # fmt: skip


def _make_records(rows: Sequence[Hardpoint]) -> OutputTable:
    return OutputTable("", tuple(OutputColumn(name) for name in CSV_NAMES), tuple(_iter_records(rows)))


def _iter_records(rows: Sequence[Hardpoint]) -> Iterator[tuple[Cell, ...]]:
    for row in rows:
        block = _make_block(row)
        yield tuple(None if value != value else value for value in (block[name] for name in CSV_NAMES))
