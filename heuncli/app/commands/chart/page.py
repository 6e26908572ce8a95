"""Render a chart of speed versus accuracy as a table, as JSON (manual/results.md) and as CSV, one line per run."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

from heuncli.analyses.work_precision.results import (
    COMPLETED,
    FAILED,
    KINDS,
    ChartResults,
    ChartRun,
    format_setting,
    make_remark,
    remove_instant,
)
from heuncli.base.method_rows import find_method
from heuncli.output.tables.export import FORMAT
from heuncli.output.tables.text_table import DEFAULT_WIDTH, TextColumn, TextTable, format_labelled_lines
from heuncli.version import VERSION

HEADING = "RUNS  median processor time of the integration only; errors at the compared instants; * Pareto front"
ERROR_WORDS = {
    "motion": "motion: largest error of any point, relative to the model size",
    "reactions": "reactions: of joints, relative to the largest",
    "sections": "sections: relative to the largest",
}
AT_MOST = "≤"
COLUMNS = (
    "method", "chart", "tolerance", "step", "seconds", "repeats", "steps", "evaluations",
    *(f"error_{kind}" for kind in KINDS), "at_most", "status", "at", "code", "reason", "front",
)  # fmt: skip


def format_heading(chart: ChartResults) -> list[tuple[str, str]]:
    """Return label and text of the lines above the table."""
    reference = chart.reference
    instants = f"{reference.instants} instants" if reference.instants != 1 else "1 instant"
    return [
        ("heun", f"{VERSION}  {chart.title}"),
        ("chart", f"speed versus accuracy, compared at {instants} up to t = {reference.last_time:.6g} s"),
        ("reference", reference.description),
        *(("", note) for note in (*reference.notes, *chart.notes)),
    ]


def render_heading(chart: ChartResults, width: int = DEFAULT_WIDTH) -> str:
    """Render the heading as text of `width` columns."""
    return format_labelled_lines(format_heading(chart), width)


def make_table(chart: ChartResults) -> TextTable:
    """Make the table of the runs, one row each, under the name of their method."""
    kinds = chart.kinds
    columns = [
        TextColumn("", "left"),
        TextColumn("tolerance or step", "left"),
        TextColumn("time [ms]"),
        TextColumn("steps"),
    ]
    columns += [TextColumn("evaluations"), *(TextColumn(kind, "left") for kind in kinds)]
    remarks = any(run.status != COMPLETED for run in chart.runs)
    columns += [TextColumn("", "left")] * remarks
    rows: list[tuple[str, ...] | str] = []
    for name, runs in chart.runs_by_method.items():
        rows.append(format_title(name))
        rows += [
            (*make_cells(run, kinds, same[-1]), *([make_short_remark(run)] * remarks))
            for same in group_runs(runs)
            for run in same[:1]
        ]
    notes = ["; ".join(ERROR_WORDS[kind] for kind in kinds)]
    if any(run.upper_bounds for run in chart.runs):
        notes.append(f"{AT_MOST}: the run differs from the reference by no more than the error of the reference")
    notes += list_reasons(chart)
    return TextTable(HEADING, tuple(columns), tuple(rows), tuple(notes))


def group_runs(runs: Sequence[ChartRun]) -> Iterator[list[ChartRun]]:
    """Group the runs of a method: neighbours with the same remark (failed, not run) share a row, the others have their
    own.
    """
    for remarks, group in groupby(runs, key=make_short_remark):
        if remarks:
            yield list(group)
        else:
            yield from ([run] for run in group)


def format_title(name: str) -> str:
    """Return the name of a method, and what it is."""
    row = find_method(name)
    return name if row is None else f"{row.name}  order {row.order}, {row.kind}, {row.steps}: {row.purpose}"


def make_cells(run: ChartRun, kinds: Sequence[str], last: ChartRun) -> Iterator[str]:
    """Yield the cells of a run, without the remark.

    last: the last of the runs that share the row
    """
    is_complete = run.status == COMPLETED
    yield "*" if run.front else ""
    yield format_setting(run.row) if last is run else f"{format_setting(run.row)} to {format_setting(last.row)}"
    yield format_milliseconds(run.seconds) if is_complete and run.seconds is not None else ""
    yield str(run.steps) if is_complete else ""
    yield str(run.evaluations) if is_complete else ""
    for kind in kinds:
        yield format_error(run, kind)


def format_milliseconds(seconds: float) -> str:
    """Format seconds as milliseconds, with three digits and without a power of ten."""
    value = float(f"{1e3 * seconds:.3g}")
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def format_error(run: ChartRun, kind: str) -> str:
    """Format an error to two digits, or its bound."""
    value = run.error[kind]
    if value is None:
        return ""
    return f"{AT_MOST if kind in run.upper_bounds else ' '}{value:.1e}"


def make_short_remark(run: ChartRun) -> str:
    """Return in a few words why a run did not end; the reason of a failure stands below the table."""
    if run.status == FAILED:
        instant_text = f" at t = {run.failure_time:.6g} s" if run.failure_time is not None else ""
        return f"fails{instant_text} [{run.code}]"
    return make_remark(run)


def list_reasons(chart: ChartResults) -> list[str]:
    """List why runs failed, once for each method and code."""
    reasons_by_run: dict[tuple[str, str], str] = {}
    for run in chart.runs:
        if run.status == FAILED:
            reasons_by_run.setdefault((run.row.method, run.code), remove_instant(run))
    return [f"[{code}] {method}: {reason}" for (method, code), reason in reasons_by_run.items()]


def to_block(chart: ChartResults) -> dict[str, Any]:
    """Return the chart as the JSON has it."""
    reference = chart.reference
    return {
        "heun": FORMAT,
        "title": chart.title,
        "spec": dict(chart.spec),
        "version": VERSION,
        "reference": reference.description,
        "reference_error": dict(reference.error),
        "judged": {"until": reference.last_time, "instants": reference.instants},
        "horizon": reference.horizon,
        "notes": [*reference.notes, *chart.notes],
        "runs": [make_run_block(run) for run in chart.runs],
    }


def make_run_block(run: ChartRun) -> dict[str, Any]:
    """Return a run as the JSON has it; `at_most` lists the kinds whose error is an upper bound."""
    row, is_complete = run.row, run.status == COMPLETED
    return {
        "method": row.method,
        "chart": row.attitude,
        "step" if row.has_fixed_step else "tolerance": row.local if row.local else None,
        "seconds": run.seconds if is_complete else None,
        "repeats": run.repeats,
        "steps": run.steps,
        "evaluations": run.evaluations,
        "error": dict(run.error),
        "at_most": sorted(run.upper_bounds),
        "status": run.status,
        "at": run.failure_time,
        "code": run.code or None,
        "reason": run.reason or None,
        "front": run.front,
    }


def to_csv(chart: ChartResults) -> str:
    """Return one line per run; unknown values are empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for run in chart.runs:
        row = make_run_block(run)
        row |= {f"error_{kind}": value for kind, value in run.error.items()}
        row |= {"at_most": " ".join(row["at_most"]), "front": "true" if run.front else "false"}
        values = [row.get(name) for name in COLUMNS]
        writer.writerow(["" if v is None else repr(v) if isinstance(v, float) else v for v in values])
    return text.getvalue()
