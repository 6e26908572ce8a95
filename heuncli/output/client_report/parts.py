"""What a report is made of, before it is written as a page or as markdown: chapters of sentences, tables, drawings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Figure
from heuncli.output.tables.text_table import TextColumn, TextTable

MOST_NAMED = 8
Mood = Literal["plain", "good", "bad", "unsure"]


class Sentence(NamedTuple):
    """A sentence, or a few; mood: whether it says that all is well, that something fails, or is not known."""

    text: str
    mood: Mood = "plain"


class Facts(NamedTuple):
    """Words with what stands for them, a line each."""

    rows: Sequence[tuple[str, str]]


class Listing(NamedTuple):
    """Sentences, each on its own; title: what they tell."""

    title: str
    items: Sequence[str]


class ReportCell(NamedTuple):
    """A cell of a table; governs: whether no other of its kind is larger."""

    text: str
    governs: bool = False


class ReportTable(NamedTuple):
    """A table: its columns, its rows of cells, and what is said below. A row that is a text is a line across."""

    caption: str
    columns: Sequence[TextColumn]
    rows: Sequence[Sequence[ReportCell] | str]
    notes: Sequence[str] = ()


class Drawing(NamedTuple):
    """A figure and what it shows."""

    figure: Figure
    caption: str


class Verbatim(NamedTuple):
    """A text as it stands in a file, with numbers of lines."""

    text: str


Part = Sentence | Facts | Listing | ReportTable | Drawing | Verbatim


class Chapter(NamedTuple):
    """A chapter; name: by which a link leads to it."""

    name: str
    title: str
    parts: Sequence[Part]


class ClientReport(NamedTuple):
    """A report: its title, what stands below it, and its chapters."""

    title: str
    lead: Sequence[Part]
    chapters: Sequence[Chapter]


def has_content(part: Part) -> bool:
    """Whether anything stands below the heading of a part."""
    if isinstance(part, ReportTable):
        return bool(part.rows or part.notes)
    if isinstance(part, Listing):
        return bool(part.items)
    return bool(part.rows) if isinstance(part, Facts) else True


def grid_of(table: TextTable, caption: str | None = None) -> ReportTable:
    """A table as `heun run` prints it; caption: in the place of its heading."""
    rows = [row if isinstance(row, str) else tuple(map(ReportCell, row)) for row in table.rows]
    return ReportTable(table.heading if caption is None else caption, table.columns, rows, table.notes)


def some(names: Sequence[str]) -> str:
    """The first of some names, and how many more there are."""
    rest = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(names[:MOST_NAMED]) + rest
