"""`heun run --case all`: solve every load case, and find the envelope: each extreme with the case that governs it."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.app.cli.documents import render_document
from heuncli.app.cli.entry import select_exit_code
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_cases
from heuncli.app.cli.target import TABLES, note_si_format
from heuncli.app.commands.run.scene import RunTask, finish, note_measure_units, render_parts, solve_and_render
from heuncli.output.documents.as_data import dump_json, format_line
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable
from heuncli.output.snapshots.envelopes import Bound, NumberEnvelope, make_envelope
from heuncli.output.snapshots.golden_file import RunSnapshot
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.output.tables.summary_document import RunParts, Summary, merge_cases
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import Units

COLUMNS = (
    OutputColumn("of", "path"), OutputColumn("unit", "text"),
    OutputColumn("min"), OutputColumn("at", "instant", "s"), OutputColumn("case", "text"),
    OutputColumn("max"), OutputColumn("at", "instant", "s"), OutputColumn("case", "text"),
)  # fmt: skip
ALL_ALIKE = "all equal"  # if cases differ by no more than their errors
NO_IMPULSES = "without impulses, which are in the tables of each case"


def run_all(task: RunTask, spec: Spec, cases: Mapping[str, Spec]) -> int:
    """Solve every case and write the results; returns the exit code."""
    require_cases(cases)
    texts: dict[str, str] = {}
    summaries: list[Summary] = []
    runs: dict[str, RunSnapshot] = {}
    codes = [0]
    for name, scene in cases.items():
        study, pieces, summary = solve_and_render(task, scene, name)
        texts[name] = "".join(pieces)
        summaries += [summary] if summary is not None else []
        if not (task.measures or task.collective):
            runs[name] = take_run_snapshot(study, task.selection.reports, whole_course=False)
        codes.append(finish(task, scene, study, f"heun: case {name}"))
    lead = _render_summary(task, spec.title, list(cases), merge_cases(summaries)) if summaries else ""
    emit(lead + _render_text(task, texts, runs), task.request.output)
    if task.measures:
        note_measure_units(task, study)
    else:
        note_si_format(task.request.units, task.form, task.request.quiet)
    return select_exit_code(codes)


def _render_summary(task: RunTask, title: str, names: Sequence[str], summary: Summary) -> str:
    """Render the summary of all cases, which stands above their tables."""
    if summary.is_empty:
        return ""
    parts = RunParts(title, [("cases", ", ".join(names))], summary, ())
    return "".join(render_parts(task, parts)) + "\n"


def _render_text(task: RunTask, texts: Mapping[str, str], runs: Mapping[str, RunSnapshot]) -> str:
    """Render all cases and their envelope in the requested format."""
    if task.form == "json":
        blocks = {name: json.loads(text) for name, text in texts.items()}
        return dump_json({"cases": blocks} | ({"envelope": dict(_iter_blocks(runs))} if runs else {}))
    if task.measures:
        return "".join(f"{name} {line}\n" for name, text in texts.items() for line in text.splitlines())
    if task.form == "csv":
        return "".join(_iter_csv(texts))
    if task.collective:
        return "\n".join(texts.values())
    assert task.form in TABLES
    document = OutputDocument(parts=[_make_table(make_envelope(runs), task.units, _make_notes(runs))])
    return "\n".join([*texts.values(), "".join(render_document(document, task.form, task.request.output))])


def _iter_csv(texts: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of all cases, each after the name of its case; the heads once."""
    for number, (name, text) in enumerate(texts.items()):
        head, *rows = csv.reader(io.StringIO(text, newline=""))
        yield from [format_line(["case", *head])] if not number else []
        yield from (format_line([name, *row]) for row in rows)


def _iter_blocks(runs: Mapping[str, RunSnapshot]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the rows of the envelope for JSON."""
    horizons = {name: run.horizon for name, run in runs.items() if run.horizon is not None}
    for row in make_envelope(runs):
        block: dict[str, Any] = {"unit": row.unit}
        block |= {"min": _make_bound_block(row.least), "max": _make_bound_block(row.greatest)}
        block |= {"not_in": dict(row.unclear)} if row.unclear else {}
        yield row.path, block | ({"horizon": horizons} if horizons else {})


def _make_bound_block(extreme: Bound | None) -> dict[str, Any] | None:
    """Return an extreme for JSON; `alike` lists other cases that reach it within the stated errors."""
    if extreme is None:
        return None
    block = {"value": extreme.value, "at": extreme.time, "case": extreme.case}
    return block | ({"alike": list(extreme.similar)} if extreme.similar else {})


def _make_table(rows: Sequence[NumberEnvelope], units: Units, notes: Sequence[str]) -> OutputTable:
    """Make the table of the envelope; rows that are 0 in all cases are left out."""
    rows_shown = [row for row in rows if row.unclear or not all(map(_is_zero, (row.least, row.greatest)))]
    unclear = [f"{row.path}: {row.unclear_text}" for row in rows_shown if row.unclear]
    body = tuple(_make_row(row, units) for row in rows_shown if row.least or row.greatest)
    return OutputTable("ENVELOPE  of all load cases", COLUMNS, body, (*notes, *unclear))


def _is_zero(extreme: Bound | None) -> bool:
    """Return whether there is no extreme, or only rounding in all cases."""
    return extreme is None or not extreme.value or extreme.is_rounding


def _format_governing(extreme: Bound) -> str:
    """Return the case that governs an extreme; empty if the value is rounding, ALL_ALIKE if all cases agree."""
    if extreme.is_rounding or extreme.case is None:
        return "" if extreme.is_rounding else ALL_ALIKE
    return (
        ", ".join(extreme.governing)
        if len(extreme.similar) <= 1
        else f"{extreme.case} and {len(extreme.similar)} equal"
    )


def _make_row(row: NumberEnvelope, units: Units) -> tuple[Cell, ...]:
    """Make the row of the envelope of a number."""
    unit, size = units.find(row.unit)
    ends: list[Cell] = []
    for extreme in (row.least, row.greatest):
        if extreme is None:
            ends += [None, None, ""]
            continue
        instant = None if extreme.is_rounding else extreme.time
        ends += [0 if extreme.is_rounding else float(extreme.value * size), instant, _format_governing(extreme)]
    return (row.path, unit, *ends)


def _make_notes(runs: Mapping[str, RunSnapshot]) -> list[str]:
    """Return notes on cases with a horizon, and on impulses, which only the tables of each case show."""
    notes = [NO_IMPULSES] if any(run.blows for run in runs.values()) else []
    return notes + [
        f"{name}: not reliable from its horizon on, t = {run.horizon:.6g} s"
        for name, run in runs.items()
        if run.horizon is not None
    ]
