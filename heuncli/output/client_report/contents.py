"""Put the report together: its chapters, their order, and the function that makes each one."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from heuncli.output.client_report.checks import make_check_parts
from heuncli.output.client_report.events_section import make_event_parts
from heuncli.output.client_report.first_page import make_first_page
from heuncli.output.client_report.histories import make_history_parts
from heuncli.output.client_report.load_table import make_load_parts
from heuncli.output.client_report.machine import make_drawing_parts, make_model_parts
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.client_report.sections import make_section_parts
from heuncli.output.client_report.trust import make_open_parts, make_trust_parts
from heuncli.output.documents.document import Chapter, OutputDocument, Part, Sentence, Verbatim, has_content

MAX_SPEC_LINES = 2000  # of a spec that is printed
CHAPTERS: Sequence[tuple[str, str, Callable[[ReportData], list[Part]]]] = (
    ("machine", "The machine", make_drawing_parts),
    ("loads", "Loads", make_load_parts),
    ("sections", "Sections", make_section_parts),
    ("histories", "Time histories", make_history_parts),
    ("happenings", "Impulses and events", make_event_parts),
    ("checks", "Checks", make_check_parts),
    ("trust", "Accuracy of the results", make_trust_parts),
    ("open", "Indeterminate loads", make_open_parts),
    ("model", "The model and its assumptions", make_model_parts),
    ("spec", "Spec", lambda of: make_spec_parts(of)),
)


def make_report(data: ReportData) -> OutputDocument:
    """Make the report without the chapters that have no content. Raises the errors of the solver."""
    chapters = [Chapter(name, title, list(filter(has_content, parts(data)))) for name, title, parts in CHAPTERS]
    parts = [*make_first_page(data), *(chapter for chapter in chapters if chapter.parts)]
    return OutputDocument(data.spec.title or "untitled", parts=parts, level=1)


def make_spec_parts(data: ReportData) -> list[Part]:
    """Make the printout of the spec file."""
    lines = data.text.removeprefix("\ufeff").splitlines()
    parts: list[Part] = [
        Sentence(f"{data.spec.path}, SHA-256 {data.spec.sha256}"),
        Verbatim("\n".join(lines[:MAX_SPEC_LINES]), is_numbered=True),
    ]
    if len(lines) > MAX_SPEC_LINES:
        parts.append(Sentence(f"... and {len(lines) - MAX_SPEC_LINES} more lines, not printed", "unsure"))
    return parts
