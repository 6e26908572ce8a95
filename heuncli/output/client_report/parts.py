"""The parts of a report, before it is rendered as HTML or Markdown: chapters of sentences, tables and figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Figure
from heuncli.output.tables.text_table import TextColumn, TextTable

MAX_NAMES = 8
Mood = Literal["plain", "good", "bad", "unsure"]


class Sentence(NamedTuple):
    """One or a few sentences; mood: whether they report that all is well, a failure, or an uncertainty."""

    text: str
    mood: Mood = "plain"


class Facts(NamedTuple):
    """Labels with their texts, one per line."""

    rows: Sequence[tuple[str, str]]


class Listing(NamedTuple):
    """A list of sentences under a title."""

    title: str
    items: Sequence[str]


class ReportCell(NamedTuple):
    """A cell of a table; is_governing: whether its value governs, so that it is bold."""

    text: str
    is_governing: bool = False


class ReportTable(NamedTuple):
    """A table: its columns, its rows of cells, and the notes below. A row that is a string is a group heading."""

    caption: str
    columns: Sequence[TextColumn]
    rows: Sequence[Sequence[ReportCell] | str]
    notes: Sequence[str] = ()


class Drawing(NamedTuple):
    """A figure with its caption."""

    figure: Figure
    caption: str


class Verbatim(NamedTuple):
    """The text of a file, shown with line numbers."""

    text: str


Part = Sentence | Facts | Listing | ReportTable | Drawing | Verbatim


class Chapter(NamedTuple):
    """A chapter; name: the target of links to it."""

    name: str
    title: str
    parts: Sequence[Part]


class ClientReport(NamedTuple):
    """A report: its title, the parts below it, and its chapters."""

    title: str
    lead: Sequence[Part]
    chapters: Sequence[Chapter]


def has_content(part: Part) -> bool:
    """Return whether a part has any content below its heading."""
    if isinstance(part, ReportTable):
        return bool(part.rows or part.notes)
    if isinstance(part, Listing):
        return bool(part.items)
    return bool(part.rows) if isinstance(part, Facts) else True


def to_report_table(table: TextTable, caption: str | None = None) -> ReportTable:
    """Convert a table of `heun run` to a table of the report.

    caption: replaces the table's heading
    """
    rows = [row if isinstance(row, str) else tuple(map(ReportCell, row)) for row in table.rows]
    return ReportTable(table.heading if caption is None else caption, table.columns, rows, table.notes)


def join_names(names: Sequence[str]) -> str:
    """Join the first few names, and state how many more there are."""
    rest = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + rest
