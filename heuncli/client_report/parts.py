"""What a report is made of, before it is written as a page or as markdown: chapters of sentences, tables, drawings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.drawing.figure import Figure
from heuncli.named_tuples import NamedTuple
from heuncli.report.text_table import TextColumn, TextTable

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


class Cell(NamedTuple):
    """A cell of a table; governs: whether no other of its kind is larger."""

    text: str
    governs: bool = False


class Grid(NamedTuple):
    """A table: its columns, its rows of cells, and what is said below. A row that is a text is a line across."""

    caption: str
    columns: Sequence[TextColumn]
    rows: Sequence[Sequence[Cell] | str]
    notes: Sequence[str] = ()


class Drawing(NamedTuple):
    """A figure and what it shows."""

    figure: Figure
    caption: str


class Verbatim(NamedTuple):
    """A text as it stands in a file, with numbers of lines."""

    text: str


Part = Sentence | Facts | Listing | Grid | Drawing | Verbatim


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


def grid_of(table: TextTable, caption: str | None = None) -> Grid:
    """A table as `heun run` prints it; caption: in the place of its heading."""
    rows = [row if isinstance(row, str) else tuple(map(Cell, row)) for row in table.rows]
    return Grid(table.heading if caption is None else caption, table.columns, rows, table.notes)
