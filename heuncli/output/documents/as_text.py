"""Write a document as text: aligned columns, wrapped sentences, tables split to the width of a page or a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape
from heuncli.output.documents.document import (
    Brand,
    Chapter,
    Drawing,
    Facts,
    Listing,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    Verbatim,
    has_content,
)
from heuncli.output.documents.text_table import PLAIN_CODES, format_plain, split_to_width
from heuncli.version import VERSION

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

DEFAULT_WIDTH = 120  # of pages without a terminal width
DRAWING_WIDTH = 100  # of a drawing


def draw_figure(figure: Figure) -> str:
    """Draw a figure in letters, without colours."""
    from heuncli.output.drawing.canvas import TerminalStyle  # where there are drawings
    from heuncli.output.drawing.letters import draw_text

    return draw_text(figure, TerminalStyle(DRAWING_WIDTH, has_braille=True, has_colours=False))


class TextStyle(NamedTuple):
    """How text is laid out.

    width: of its lines, or None
    codes: of a terminal: before a heading, before a title, after both
    draw: draws a figure
    """

    width: int | None = DEFAULT_WIDTH
    codes: tuple[str, str, str] = PLAIN_CODES
    draw: Callable[[Figure], str] = draw_figure


PLAIN = TextStyle()


def render_text(document: OutputDocument, style: TextStyle = PLAIN) -> str:
    """Render the document as text that ends with a newline."""
    return "".join(iter_text(document, style))


def iter_text(document: OutputDocument, style: TextStyle = PLAIN) -> Iterator[str]:
    """Yield the document in pieces, with a blank line between its parts; a sentence stands close to the one before, and
    so do lines that are shown as they are.
    """
    lead = [("heun", f"{VERSION}  {document.title}")] if document.title is not None else []
    facts = Facts([*lead, *document.facts])
    previous: Part | None = None
    for part in [facts, *document.parts]:
        if has_content(part):
            is_close = isinstance(previous, Sentence) and isinstance(part, Sentence | Verbatim)
            yield ("" if previous is None or is_close else "\n") + RENDERERS[type(part)](part, style)
            previous = part


def _render_facts(part: Facts, style: TextStyle) -> str:
    return format_labelled_lines(part.rows, DEFAULT_WIDTH if style.width is None else min(style.width, DEFAULT_WIDTH))


def _render_sentence(part: Sentence, style: TextStyle) -> str:
    return _join_lines(wrap_text(escape(part.text), style.width))


def _render_brand(part: Brand, style: TextStyle) -> str:
    return _join_lines(wrap_text(escape(", ".join(filter(None, (part.company, part.project)))), style.width))


def _render_listing(part: Listing, style: TextStyle) -> str:
    title = wrap_text(escape(part.title), style.width) if part.title else []
    return _join_lines(
        [*title, *(line for item in part.items for line in wrap_text(f"  - {escape(item)}", style.width, 2))]
    )


def _render_drawing(part: Drawing, style: TextStyle) -> str:
    caption = _join_lines(wrap_text(escape(part.caption), style.width)) if part.caption else ""
    return caption + style.draw(part.figure).lstrip("\n")


def _render_verbatim(part: Verbatim, style: TextStyle) -> str:
    return _join_lines(list(map(escape, part.text.split("\n"))))


def _render_chapter(part: Chapter, style: TextStyle) -> str:
    title = f"{style.codes[0]}{escape(part.title)}{style.codes[2]}\n"
    return "\n".join([title, "".join(iter_text(OutputDocument(parts=part.parts), style))])


def _render_table(part: OutputTable, style: TextStyle) -> str:
    parts = [part] if style.width is None else split_to_width(part, style.width)
    return "\n".join(format_plain(each, style.width, style.codes) for each in parts)


RENDERERS: dict[type[Part], Callable[[Any, TextStyle], str]] = {
    Sentence: _render_sentence,
    Facts: _render_facts,
    Brand: _render_brand,
    Listing: _render_listing,
    OutputTable: _render_table,
    Drawing: _render_drawing,
    Verbatim: _render_verbatim,
    Chapter: _render_chapter,
}


def _join_lines(lines: Sequence[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def format_labelled_lines(lines: Sequence[tuple[str, str]], width: int | None = DEFAULT_WIDTH) -> str:
    """Format labels with a text after each; the text is wrapped below itself."""
    indent = max(len(label) for label, _ in lines) + 2
    lines_of_text = []
    for label, text in lines:
        first, *rest = wrap_text(escape(text), None if width is None else width - indent, 0)
        lines_of_text += [label.ljust(indent) + first, *(" " * indent + line for line in rest)]
    return _join_lines(lines_of_text)
