"""A chart of speed against accuracy as a table, as JSON (manual/results.md) and as CSV, a line a run."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

from heuncli.analyses.charting.results import COMPLETED, FAILED, KINDS, UNFINISHED, ChartedRun, ChartResults, ChartRow
from heuncli.app.commands.charting.scale import power
from heuncli.base.method_rows import row_of
from heuncli.output.tables.export import FORMAT
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, labelled
from heuncli.version import VERSION

HEADING = "RUNS  processor time of the integration alone, median; errors at the judged instants, * on the front"
OF = {
    "motion": "motion: largest error of any point, of the scene's size",
    "reactions": "reactions: of joints, of the largest",
    "sections": "sections: of the largest",
}
AT_MOST = "≤"
COLUMNS = (
    "method", "chart", "tolerance", "step", "seconds", "repeats", "steps", "evaluations",
    *(f"error_{kind}" for kind in KINDS), "at_most", "status", "at", "code", "reason", "front",
)  # fmt: skip


def heading(chart: ChartResults) -> list[tuple[str, str]]:
    """Label and text of the lines above the table."""
    reference = chart.reference
    instants = f"{reference.instants} instants" if reference.instants != 1 else "1 instant"
    return [
        ("heun", f"{VERSION}  {chart.title}"),
        ("chart", f"speed against accuracy, judged at {instants} up to t = {reference.until:.6g} s"),
        ("reference", reference.words),
        *(("", note) for note in (*reference.notes, *chart.notes)),
    ]


def write_heading(chart: ChartResults, width: int = WIDTH) -> str:
    """The heading as text of so many columns."""
    return labelled(heading(chart), width)


def table(chart: ChartResults) -> TextTable:
    """The runs, a row each, those of a method under its name."""
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
    for name, runs in chart.by_method.items():
        rows.append(title(name))
        rows += [(*cells(run, kinds, same[-1]), *([brief(run)] * remarks)) for same in alike(runs) for run in same[:1]]
    notes = ["; ".join(OF[kind] for kind in kinds)]
    if any(run.bounded for run in chart.runs):
        notes.append(f"{AT_MOST}: the run differs from the reference by no more than that one may err itself")
    notes += reasons(chart)
    return TextTable(HEADING, tuple(columns), tuple(rows), tuple(notes))


def alike(runs: Sequence[ChartedRun]) -> Iterator[list[ChartedRun]]:
    """The runs of a method in groups: neighbours of one remark (failed, not run) share a row, others have their own."""
    for remarks, group in groupby(runs, key=brief):
        if remarks:
            yield list(group)
        else:
            yield from ([run] for run in group)


def title(name: str) -> str:
    """A method, and what it is."""
    row = row_of(name)
    return name if row is None else f"{row.name}  order {row.order}, {row.kind}, {row.steps}: {row.purpose}"


def cells(run: ChartedRun, kinds: Sequence[str], last: ChartedRun) -> Iterator[str]:
    """A run's cells but for the remark; last: of those that are told in one row."""
    known = run.status == COMPLETED
    yield "*" if run.front else ""
    yield local(run.row) if last is run else f"{local(run.row)} to {local(last.row)}"
    yield milliseconds(run.seconds) if known and run.seconds is not None else ""
    yield str(run.steps) if known else ""
    yield str(run.evaluations) if known else ""
    for kind in kinds:
        yield error(run, kind)


def milliseconds(seconds: float) -> str:
    """Three digits, without a power of ten."""
    value = float(f"{1e3 * seconds:.3g}")
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def local(row: ChartRow) -> str:
    """The tolerance, or the step with its unit."""
    if row.local == 0.0:
        return "-"
    return f"{row.local:g} s" if row.fixed else f"{power(row.local) if is_round(row.local) else f'{row.local:g}'}"


def is_round(value: float) -> bool:
    """Whether one digit tells all of a number."""
    return float(f"{value:.0e}") == value


def error(run: ChartedRun, kind: str) -> str:
    """An error to two digits, or its bound."""
    value = run.error[kind]
    if value is None:
        return ""
    return f"{AT_MOST if kind in run.bounded else ' '}{value:.1e}"


def brief(run: ChartedRun) -> str:
    """What kept a run from its end, in a few words; of what failed the reason stands below the table."""
    if run.status == FAILED:
        at = f" at t = {run.at:.6g} s" if run.at is not None else ""
        return f"fails{at} [{run.code}]"
    return remark(run)


def reasons(chart: ChartResults) -> list[str]:
    """Why runs failed, once for each method and reason."""
    found: dict[tuple[str, str], str] = {}
    for run in chart.runs:
        if run.status == FAILED:
            found.setdefault((run.row.method, run.code), without_instant(run))
    return [f"[{code}] {method}: {reason}" for (method, code), reason in found.items()]


def without_instant(run: ChartedRun) -> str:
    """A run's reason without the instant that it may begin with."""
    begin, colon, reason = run.reason.partition(": ")
    return reason if colon and begin.startswith("at t = ") else run.reason


def remark(run: ChartedRun) -> str:
    """What kept a run from its end, and why."""
    if run.status == COMPLETED:
        return ""
    if run.status == FAILED:
        at = f" at t = {run.at:.6g} s" if run.at is not None else ""
        return f"fails{at}: {without_instant(run)}"
    return run.reason if run.code == UNFINISHED else f"not run: {run.reason}"


def block(chart: ChartResults) -> dict[str, Any]:
    """The chart as the JSON has it."""
    reference = chart.reference
    return {
        "heun": FORMAT,
        "title": chart.title,
        "spec": dict(chart.spec),
        "version": VERSION,
        "reference": reference.words,
        "reference_error": dict(reference.own),
        "judged": {"until": reference.until, "instants": reference.instants},
        "horizon": reference.horizon,
        "notes": [*reference.notes, *chart.notes],
        "runs": [run_block(run) for run in chart.runs],
    }


def run_block(run: ChartedRun) -> dict[str, Any]:
    """A run as the JSON has it; at_most: the kinds of which the error is a bound."""
    row, done = run.row, run.status == COMPLETED
    return {
        "method": row.method,
        "chart": row.attitude,
        "step" if row.fixed else "tolerance": row.local if row.local else None,
        "seconds": run.seconds if done else None,
        "repeats": run.repeats,
        "steps": run.steps,
        "evaluations": run.evaluations,
        "error": dict(run.error),
        "at_most": sorted(run.bounded),
        "status": run.status,
        "at": run.at,
        "code": run.code or None,
        "reason": run.reason or None,
        "front": run.front,
    }


def to_csv(chart: ChartResults) -> str:
    """The runs, a line each; what is not known is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for run in chart.runs:
        own = run_block(run)
        own |= {f"error_{kind}": value for kind, value in run.error.items()}
        own |= {"at_most": " ".join(own["at_most"]), "front": "true" if run.front else "false"}
        values = [own.get(name) for name in COLUMNS]
        writer.writerow(["" if v is None else repr(v) if isinstance(v, float) else v for v in values])
    return text.getvalue()
