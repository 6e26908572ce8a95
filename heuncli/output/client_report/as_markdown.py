"""Render a report as Markdown: the same sentences and tables, with figures as text. Text from a spec is never
markup.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from heuncli.base.text_safety import escape
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
from heuncli.output.drawing.canvas import TerminalStyle
from heuncli.output.drawing.letters import draw_text
from heuncli.output.tables.markdown_text import escape_line, escape_markdown, fence_text
from heuncli.output.tables.text_table import TextColumn, embolden, format_markdown_rows

LOOK = TerminalStyle(100, has_braille=True, has_colours=False)
MOOD_SIGNS = {"plain": "", "good": "**✓** ", "bad": "**✗** ", "unsure": "**!** "}


def render_markdown(report: ClientReport) -> str:
    """Render the report as Markdown text."""
    blocks = [f"# {escape_line(report.title)}", *_render_parts(report.lead)]
    for number, chapter in enumerate(report.chapters, 1):
        blocks += [f"## {number} {escape_markdown(chapter.title)}", *_render_parts(chapter.parts)]
    return "\n\n".join(blocks) + "\n"


def _render_parts(parts: Sequence[Part]) -> Iterator[str]:
    for part in parts:
        yield RENDERERS[type(part)](part)


def _render_sentence(part: Sentence) -> str:
    return MOOD_SIGNS[part.mood] + escape_line(part.text)


def _render_facts(part: Facts) -> str:
    return format_markdown_rows([TextColumn("", "left")] * 2, [tuple(map(escape_markdown, row)) for row in part.rows])


def _render_listing(part: Listing) -> str:
    title = f"**{escape_markdown(part.title)}**\n\n" if part.title else ""
    return title + "\n".join(f"- {escape_line(item)}" for item in part.items)


def _render_table(part: ReportTable) -> str:
    """Render a table under its heading; a group heading becomes a row with a bold first cell."""
    name, _, rest = part.caption.partition("  ")
    blocks = [f"### {escape_line(name)}", *([escape_line(rest)] if rest else [])]
    if part.columns:
        rows = [row if isinstance(row, str) else tuple(map(_format_cell, row)) for row in part.rows]
        blocks.append(format_markdown_rows(part.columns, rows))
    if part.notes:
        blocks.append("\n".join(f"- {escape_line(note)}" for note in part.notes))
    return "\n\n".join(blocks)


def _format_cell(cell: ReportCell) -> str:
    text = escape_markdown(cell.text)
    return embolden(text) if cell.is_governing else text


def _render_drawing(part: Drawing) -> str:
    return f"{escape_line(part.caption)}\n\n{fence_text(draw_text(part.figure, LOOK).rstrip())}"


def _render_verbatim(part: Verbatim) -> str:
    lines = part.text.split("\n")
    width = len(str(len(lines)))
    return fence_text("\n".join(f"{number:>{width}}  {escape(line)}".rstrip() for number, line in enumerate(lines, 1)))


RENDERERS: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _render_sentence,
    Facts: _render_facts,
    Listing: _render_listing,
    ReportTable: _render_table,
    Drawing: _render_drawing,
    Verbatim: _render_verbatim,
}
