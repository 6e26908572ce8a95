"""The report from cover to end: which chapters there are, in which order, and what each is made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from heuncli.output.client_report.checks import check_parts
from heuncli.output.client_report.first_page import first_page
from heuncli.output.client_report.happenings import happening_parts
from heuncli.output.client_report.histories import history_parts
from heuncli.output.client_report.load_table import load_tables
from heuncli.output.client_report.machine import drawing_parts, model_parts
from heuncli.output.client_report.parts import Chapter, ClientReport, Part, Sentence, Verbatim, has_content
from heuncli.output.client_report.reported import Reported
from heuncli.output.client_report.sections import section_parts
from heuncli.output.client_report.trust import open_parts, trust_parts

MOST_LINES = 2000  # of a spec that is printed
CHAPTERS: Sequence[tuple[str, str, Callable[[Reported], list[Part]]]] = (
    ("machine", "The machine", drawing_parts),
    ("loads", "Loads", load_tables),
    ("sections", "Sections", section_parts),
    ("histories", "Histories", history_parts),
    ("happenings", "Blows and events", happening_parts),
    ("checks", "Checks", check_parts),
    ("trust", "How far the numbers can be trusted", trust_parts),
    ("open", "What is open", open_parts),
    ("model", "The model and its assumptions", model_parts),
    ("spec", "The spec", lambda of: spec_parts(of)),
)


def report_of(of: Reported) -> ClientReport:
    """The report; a chapter with nothing to tell is left out. Raises what solving raises."""
    made = [Chapter(name, title, list(filter(has_content, parts(of)))) for name, title, parts in CHAPTERS]
    lead = list(filter(has_content, first_page(of)))
    return ClientReport(of.spec.title or "untitled", lead, [chapter for chapter in made if chapter.parts])


def spec_parts(of: Reported) -> list[Part]:
    """The spec as it was read."""
    lines = of.text.removeprefix("\ufeff").splitlines()
    parts: list[Part] = [Sentence(f"{of.spec.path}, SHA-256 {of.spec.sha256}"), Verbatim("\n".join(lines[:MOST_LINES]))]
    if len(lines) > MOST_LINES:
        parts.append(Sentence(f"... and {len(lines) - MOST_LINES} more lines, left out here", "unsure"))
    return parts
