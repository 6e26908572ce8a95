"""A report as markdown: the same sentences and tables, pictures in letters. What a spec says is text, never markup."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from heuncli.client_report.parts import (
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
from heuncli.drawing.canvas import Look
from heuncli.drawing.letters import drawn
from heuncli.foreign_text import shown

MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~&!$]|:(?=//)|(?<=www)\.)", re.IGNORECASE)  # what means something anywhere
BEGINS = re.compile(r"^(\d*)([-+=.)])")  # and at its beginning
LOOK = Look(100, braille=True, colours=False)
SIGNS = {"plain": "", "good": "**✓** ", "bad": "**✗** ", "unsure": "**!** "}


def as_markdown(report: ClientReport) -> str:
    """The text."""
    blocks = [f"# {line(report.title)}", *_parts(report.lead)]
    for number, chapter in enumerate(report.chapters, 1):
        blocks += [f"## {number} {escaped(chapter.title)}", *_parts(chapter.parts)]
    return "\n\n".join(blocks) + "\n"


def escaped(text: str) -> str:
    """A text within a line, such as a cell, that is shown as it is."""
    return MARKUP.sub(r"\\\1", shown(text))


def line(text: str) -> str:
    """A text at the beginning of a line, where more means something."""
    return BEGINS.sub(r"\1\\\2", escaped(text).strip())


def fenced(text: str, language: str = "text") -> str:
    """A text of several lines as it is, between fences that it does not hold itself."""
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"


def _parts(parts: Sequence[Part]) -> Iterator[str]:
    for part in parts:
        yield WRITTEN[type(part)](part)


def _sentence(part: Sentence) -> str:
    return SIGNS[part.mood] + line(part.text)


def _facts(part: Facts) -> str:
    return _table(["", ""], ["---", "---"], [[escaped(label), escaped(text)] for label, text in part.rows])


def _listing(part: Listing) -> str:
    title = f"**{escaped(part.title)}**\n\n" if part.title else ""
    return title + "\n".join(f"- {line(item)}" for item in part.items)


def _grid(part: ReportTable) -> str:
    """A table under its heading; a line across is a row with a bold first cell."""
    name, _, rest = part.caption.partition("  ")
    blocks = [f"### {line(name)}", *([line(rest)] if rest else [])]
    if part.columns:
        blank = [""] * (len(part.columns) - 1)
        rows = [[f"**{escaped(row)}**", *blank] if isinstance(row, str) else list(map(_cell, row)) for row in part.rows]
        rules = ["---" if column.align == "left" else "---:" for column in part.columns]
        blocks.append(_table([escaped(column.head) for column in part.columns], rules, rows))
    if part.notes:
        blocks.append("\n".join(f"- {line(note)}" for note in part.notes))
    return "\n\n".join(blocks)


def _across(row: str) -> str:
    name, _, rest = row.partition("  ")
    return f"**{escaped(name)}**" + (f" {escaped(rest)}" if rest else "")


def _cell(cell: ReportCell) -> str:
    return f"**{escaped(cell.text)}**" if cell.governs and cell.text else escaped(cell.text)


def _table(heads: Sequence[str], rules: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (heads, rules, *rows))


def _drawing(part: Drawing) -> str:
    return f"{line(part.caption)}\n\n{fenced(drawn(part.figure, LOOK).rstrip())}"


def _verbatim(part: Verbatim) -> str:
    lines = part.text.split("\n")
    width = len(str(len(lines)))
    return fenced("\n".join(f"{number:>{width}}  {shown(line)}".rstrip() for number, line in enumerate(lines, 1)))


WRITTEN: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _sentence, Facts: _facts, Listing: _listing, ReportTable: _grid, Drawing: _drawing, Verbatim: _verbatim,
}  # fmt: skip
