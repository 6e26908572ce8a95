"""A report as markdown: the same sentences and tables, pictures in letters. What a spec says is text, never markup."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from heuncli.base.foreign_text import shown
from heuncli.output.client_report.parts import (
    ClientReport,
    Drawing,
    Facts,
    Listing,
    Part,
    ReportCell,
    ReportTable,
    Sentence,
    Verbatim,
)
from heuncli.output.drawing.canvas import Look
from heuncli.output.drawing.letters import drawn
from heuncli.output.tables.markdown_text import escape_line, escape_markdown, fence_text

LOOK = Look(100, braille=True, colours=False)
SIGNS = {"plain": "", "good": "**✓** ", "bad": "**✗** ", "unsure": "**!** "}


def as_markdown(report: ClientReport) -> str:
    """The text."""
    blocks = [f"# {escape_line(report.title)}", *_parts(report.lead)]
    for number, chapter in enumerate(report.chapters, 1):
        blocks += [f"## {number} {escape_markdown(chapter.title)}", *_parts(chapter.parts)]
    return "\n\n".join(blocks) + "\n"


def _parts(parts: Sequence[Part]) -> Iterator[str]:
    for part in parts:
        yield WRITTEN[type(part)](part)


def _sentence(part: Sentence) -> str:
    return SIGNS[part.mood] + escape_line(part.text)


def _facts(part: Facts) -> str:
    return _table(
        ["", ""], ["---", "---"], [[escape_markdown(label), escape_markdown(text)] for label, text in part.rows]
    )


def _listing(part: Listing) -> str:
    title = f"**{escape_markdown(part.title)}**\n\n" if part.title else ""
    return title + "\n".join(f"- {escape_line(item)}" for item in part.items)


def _grid(part: ReportTable) -> str:
    """A table under its heading; a line across is a row with a bold first cell."""
    name, _, rest = part.caption.partition("  ")
    blocks = [f"### {escape_line(name)}", *([escape_line(rest)] if rest else [])]
    if part.columns:
        blank = [""] * (len(part.columns) - 1)
        rows = [
            [f"**{escape_markdown(row)}**", *blank] if isinstance(row, str) else list(map(_cell, row))
            for row in part.rows
        ]
        rules = ["---" if column.align == "left" else "---:" for column in part.columns]
        blocks.append(_table([escape_markdown(column.head) for column in part.columns], rules, rows))
    if part.notes:
        blocks.append("\n".join(f"- {escape_line(note)}" for note in part.notes))
    return "\n\n".join(blocks)


def _across(row: str) -> str:
    name, _, rest = row.partition("  ")
    return f"**{escape_markdown(name)}**" + (f" {escape_markdown(rest)}" if rest else "")


def _cell(cell: ReportCell) -> str:
    return f"**{escape_markdown(cell.text)}**" if cell.governs and cell.text else escape_markdown(cell.text)


def _table(heads: Sequence[str], rules: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (heads, rules, *rows))


def _drawing(part: Drawing) -> str:
    return f"{escape_line(part.caption)}\n\n{fence_text(drawn(part.figure, LOOK).rstrip())}"


def _verbatim(part: Verbatim) -> str:
    lines = part.text.split("\n")
    width = len(str(len(lines)))
    return fence_text("\n".join(f"{number:>{width}}  {shown(line)}".rstrip() for number, line in enumerate(lines, 1)))


WRITTEN: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _sentence, Facts: _facts, Listing: _listing, ReportTable: _grid, Drawing: _drawing, Verbatim: _verbatim,
}  # fmt: skip
