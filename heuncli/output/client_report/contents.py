"""Put the report together: its chapters, their order, and the function that makes each one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from heuncli.output.client_report.accuracy import make_accuracy_parts, make_open_parts
from heuncli.output.client_report.checks import make_check_parts
from heuncli.output.client_report.diagrams import make_history_parts, make_polar_parts
from heuncli.output.client_report.first_page import make_first_page
from heuncli.output.client_report.loads import make_load_parts
from heuncli.output.client_report.machine import make_drawing_parts, make_model_parts
from heuncli.output.client_report.report_data import CHAPTER_NAMES, ON_REQUEST, ReportData, ReportedRun
from heuncli.output.client_report.sections import make_section_parts
from heuncli.output.documents.as_html import Sheet
from heuncli.output.documents.document import Brand, Chapter, OutputDocument, Part, Sentence, Verbatim, has_content
from heuncli.output.tables.event_table import make_events_table
from heuncli.output.tables.impulse_tables import ImpactReport, make_impulse_tables

MAX_SPEC_LINES = 2000  # of a spec that is printed
CHAPTERS: Mapping[str, tuple[str, Callable[[ReportData], list[Part]]]] = {
    "machine": ("The machine", lambda data: make_drawing_parts(data, is_first_page=False)),
    "loads": ("Loads", make_load_parts),
    "sections": ("Sections", make_section_parts),
    "histories": ("Time histories", make_history_parts),
    "polar": ("Load directions", make_polar_parts),
    "events": ("Impulses and events", lambda data: make_event_parts(data)),
    "checks": ("Checks", make_check_parts),
    "open": ("Indeterminate loads", make_open_parts),
    "model": ("The model", make_model_parts),
    "accuracy": ("Accuracy of the results", make_accuracy_parts),
    "spec": ("Spec", lambda data: make_spec_parts(data)),
}


def make_report(data: ReportData) -> OutputDocument:
    """Make the report without the chapters that have no content. Raises the errors of the solver."""
    names = data.chapters or [name for name in CHAPTER_NAMES if name not in ON_REQUEST]
    makers = [(name, *CHAPTERS[name]) for name in names]
    chapters = [Chapter(name, title, list(filter(has_content, make_parts(data)))) for name, title, make_parts in makers]
    imprint = data.imprint
    parts = [
        Brand(imprint.company, imprint.logo, imprint.project),
        *make_first_page(data),
        *(chapter for chapter in chapters if chapter.parts),
    ]
    return OutputDocument(data.spec.title or "untitled", parts=parts, level=1)


def make_sheet(data: ReportData, paper: str, *, is_landscape: bool) -> Sheet:
    """Make the paper, with title, revision and date at the head of its pages."""
    imprint = data.imprint
    revision = f"revision {imprint.revision}" if imprint.revision else ""
    right = ", ".join(filter(None, (revision, imprint.date)))
    left = ", ".join(filter(None, (imprint.part, data.spec.title or "untitled")))
    foot = ", ".join(filter(None, (imprint.company, imprint.project)))
    return Sheet("letter" if paper == "letter" else "a4", is_landscape, left, right, foot)


def make_spec_parts(data: ReportData) -> list[Part]:
    """Make the printout of the spec file."""
    lines = data.text.removeprefix("\ufeff").splitlines()
    parts: list[Part] = [
        Sentence(f"{data.file_name}, SHA-256 {data.spec.sha256}"),
        Verbatim("\n".join(lines[:MAX_SPEC_LINES]), is_numbered=True),
    ]
    if len(lines) > MAX_SPEC_LINES:
        parts.append(Sentence(f"... and {len(lines) - MAX_SPEC_LINES} more lines, not printed", "unsure"))
    return parts


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
