"""What happens in a motion at instants: blows, and changes of conditions that are watched."""

from __future__ import annotations

from heuncli.output.client_report.parts import Part, Sentence, grid_of
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.tables.event_table import events_table
from heuncli.output.tables.impulse_tables import BlowReport, impulse_tables


def happening_parts(of: Reported) -> list[Part]:
    """The tables of each case."""
    parts: list[Part] = []
    for run in of.runs:
        own = _of_run(run)
        if own and of.has_cases:
            parts.append(Sentence(f"Case {run.told}:"))
        parts += own
    return parts


def _of_run(run: ReportedRun) -> list[Part]:
    page, results = run.page, run.results
    tables = [events_table(results)] if results.events else []
    if results.impulses:
        tables += impulse_tables(
            BlowReport(page.results, page.labels, page.certain, page.of, page.struck, page.details)
        )
    return [grid_of(table) for table in tables]
