"""Write a document as Markdown: the same sentences and tables, with figures as text. Text from a spec is never
markup.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from heuncli.base.text_safety import escape
from heuncli.output.documents.as_text import draw_figure
from heuncli.output.documents.document import (
    Brand,
    Cell,
    Chapter,
    Drawing,
    Facts,
    Listing,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    Verbatim,
    format_cell,
    has_content,
    is_governing,
    use_decimal_comma,
)
from heuncli.version import VERSION

MOOD_SIGNS = {"plain": "", "good": "**✓** ", "bad": "**✗** ", "unsure": "**!** "}
# Characters with a meaning anywhere in a line. Brackets alone, such as those of units, have none: a link needs more.
MARKUP = r"(?i)([\\`*_{<#|~&$]|!(?=\[)|\](?=[(\[:])|\[(?=\^)|:(?=//)|(?<=www)\.|(?<=[a-z0-9])@(?=[a-z0-9]))"
LINE_START_MARKUP = r"^(\d*)([-+=.)>\[])"  # with a meaning at its beginning only


def render_markdown(document: OutputDocument) -> str:
    """Render the document as Markdown text that ends with a newline."""
    title = [f"{'#' * document.level} {escape_line(document.title)}"] if document.title is not None else []
    facts = [_render_facts(Facts([("heun", VERSION), *document.facts]))] if document.facts else []
    return "\n\n".join([*title, *facts, *_iter_blocks(document.parts)]) + "\n"


def _iter_blocks(parts: Iterable[Part], prefix: str = "") -> Iterator[str]:
    """Yield the blocks of the parts. Chapters are numbered; prefix: the number of the chapter that they belong to."""
    number = 0
    for part in parts:
        if isinstance(part, Chapter):
            number += 1
            yield f"{'#' * (2 + prefix.count('.'))} {prefix}{number} {escape_markdown(part.title)}"
            yield from _iter_blocks(part.parts, f"{prefix}{number}.")
        elif has_content(part):
            yield RENDERERS[type(part)](part)


def _render_sentence(part: Sentence) -> str:
    return MOOD_SIGNS[part.mood] + escape_line(part.text)


def _render_facts(part: Facts) -> str:
    return "\n".join(f"- {escape_line(label + ': ' * bool(label) + text)}" for label, text in part.rows)


def _render_brand(part: Brand) -> str:
    return escape_line(", ".join(filter(None, (part.company, part.project))))


def _render_listing(part: Listing) -> str:
    title = f"**{escape_markdown(part.title)}**\n\n" if part.title else ""
    return title + "\n".join(f"- {escape_line(item)}" for item in part.items)


def render_table(part: OutputTable) -> str:
    """Render a table under its heading; a title becomes a row with a bold first cell."""
    name, _, rest = part.heading.partition("  ")
    blocks = [f"### {escape_line(name)}"] if name else []
    blocks += [escape_line(rest)] if rest else []
    if part.columns and part.rows:
        blocks.append(format_rows(part.columns, part.rows))
    if part.notes:
        blocks.append("\n".join(f"- {escape_line(note)}" for note in part.notes))
    return "\n\n".join(blocks)


def format_rows(columns: Sequence[OutputColumn], rows: Sequence[Sequence[Cell] | str]) -> str:
    """Format the rows of a table below their heads."""
    heads = [escape_markdown(column.title) for column in columns]
    rules = ["---:" if column.is_number else "---" for column in columns]
    blank = [""] * (len(columns) - 1)
    cells = ([_embolden(escape_markdown(row)), *blank] if isinstance(row, str) else map(_format_cell, row)
             for row in rows)  # fmt: skip
    return "\n".join("| " + " | ".join(row) + " |" for row in (heads, rules, *cells))


def _format_cell(cell: Cell) -> str:
    text = escape_markdown(format_cell(cell))
    return _embolden(text) if is_governing(cell) else text


def _embolden(text: str) -> str:
    """Make Markdown bold, unless it is empty."""
    return f"**{text}**" if text else text


def _render_drawing(part: Drawing) -> str:
    caption = f"{escape_line(part.caption)}\n\n" if part.caption else ""
    text = draw_figure(part.figure).rstrip()
    return caption + fence_text(use_decimal_comma(text) if part.has_decimal_comma else text)


def _render_verbatim(part: Verbatim) -> str:
    lines = part.text.split("\n")
    if not part.is_numbered:
        return fence_text("\n".join(map(escape, lines)))
    width = len(str(len(lines)))
    return fence_text("\n".join(f"{number:>{width}}  {escape(line)}".rstrip() for number, line in enumerate(lines, 1)))


RENDERERS: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _render_sentence,
    Facts: _render_facts,
    Brand: _render_brand,
    Listing: _render_listing,
    OutputTable: render_table,
    Drawing: _render_drawing,
    Verbatim: _render_verbatim,
}


def escape_markdown(text: str) -> str:
    """Escape a text within a line, such as a cell."""
    import re  # imported here, as most commands write no markdown

    return re.sub(MARKUP, r"\\\1", escape(text))


def escape_line(text: str) -> str:
    """Escape a text at the beginning of a line, where more characters act as markup."""
    import re

    return re.sub(LINE_START_MARKUP, r"\1\\\2", escape_markdown(text).strip())


def fence_text(text: str, language: str = "text") -> str:
    """Put a text of several lines between fences that are longer than any in it."""
    fence = "```"
    while fence in text:
        fence += "`"
    return f"{fence}{language}\n{text}\n{fence}"
