"""The chapter of impacts and events: tables of what happens at single instants."""

from __future__ import annotations

import numpy as np

from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import Part, Sentence
from heuncli.output.tables.event_table import make_events_table
from heuncli.output.tables.impulse_tables import ImpactReport, make_impulse_tables


def make_event_parts(data: ReportData) -> list[Part]:
    """Make the tables of impacts and events of each case."""
    parts: list[Part] = []
    for run in data.runs:
        tables = _make_run_parts(run)
        if tables and data.has_cases:
            parts.append(Sentence(f"Case {run.case_label}:"))
        parts += tables
    return parts


def _make_run_parts(run: ReportedRun) -> list[Part]:
    page, results = run.page, run.results
    has_events = any(np.size(event["time"]) for event in results.events.values())
    tables = [make_events_table(results)] if has_events else []
    if results.impulses:
        tables += make_impulse_tables(
            ImpactReport(page.results, page.labels, page.certain, page.magnitudes, page.impact_extremes, page.details)
        )
    return list(tables)
