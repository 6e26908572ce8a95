"""Write a document as text: aligned columns, wrapped sentences, tables split to the width of a page or a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.base.wrapping import wrap_text
from heuncli.output.documents.document import (
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
)
from heuncli.version import VERSION

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

GAP = "  "
INDENT = "  "
DEFAULT_WIDTH = 120  # of pages without a terminal width
DRAWING_WIDTH = 100  # of a drawing


def draw_figure(figure: Figure) -> str:
    """Draw a figure in letters, without colours."""
    from heuncli.output.drawing.canvas import TerminalStyle  # where there are drawings
    from heuncli.output.drawing.letters import draw_text

    return draw_text(figure, TerminalStyle(DRAWING_WIDTH, has_braille=True, has_colours=False))


class TextStyle(NamedTuple):
    """How text is laid out: the width of lines, or None; the codes before a heading and a title, and after them; how
    figures are drawn.
    """

    width: int | None = DEFAULT_WIDTH
    heading_code: str = ""
    title_code: str = ""
    end_code: str = ""
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
    title = f"{style.heading_code}{escape(part.title)}{style.end_code}\n"
    return "\n".join([title, "".join(iter_text(OutputDocument(parts=part.parts), style))])


def _render_table(part: OutputTable, style: TextStyle) -> str:
    from heuncli.output.documents.table_width import split_to_width  # it lays out its tables by this file

    parts = [part] if style.width is None else split_to_width(part, style.width)
    return "\n".join(format_plain(each, style.width, style) for each in parts)


RENDERERS: dict[type[Part], Callable[[Any, TextStyle], str]] = {
    Sentence: _render_sentence,
    Facts: _render_facts,
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


def format_plain(table: OutputTable, width: int | None = None, style: TextStyle = PLAIN) -> str:
    """Format the table as aligned text that ends with a newline. Headings, titles and notes are wrapped to the width,
    if any.
    """
    if table.is_empty:
        return ""
    indent = INDENT if any(isinstance(row, str) for row in table.rows) else ""
    lines = _mark(wrap_text(escape(table.heading), width), style.heading_code, style) if table.heading else []
    if table.columns:
        cells = align_cells(table)
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        texts = iter(_format_row(row, widths, table.columns, indent) for row in cells)
        lines += [head for head in [next(texts)] if head]
        for row in table.rows:
            if isinstance(row, str):
                lines += _mark(wrap_text(escape(row), width), style.title_code, style)
            else:
                lines.append(next(texts))
    notes = [line for note in table.notes for line in wrap_text(indent + escape(note), width)]
    return "\n".join([*lines, *notes, ""])


def _mark(lines: Sequence[str], code: str, style: TextStyle) -> list[str]:
    """Put escape codes of a terminal around lines."""
    return [f"{code}{line}{style.end_code}" if code else line for line in lines]


def align_cells(table: OutputTable) -> list[tuple[str, ...]]:
    """Return head and rows of cells without title rows; numbers are padded to a common decimal point."""
    rows = [row for row in table.rows if not isinstance(row, str)]
    columns = []
    for index, column in enumerate(table.columns):
        cells = [escape(format_cell(row[index])) for row in rows]
        columns.append([column.title, *(_pad_to_point(cells) if column.is_number else cells)])
    return list(zip(*columns, strict=True))


def _pad_to_point(cells: Sequence[str]) -> list[str]:
    """Pad cells with blanks behind, so that their decimal points are aligned when they are right-justified."""
    tails = [len(cell) - _find_decimal_point(cell) for cell in cells]
    longest = max(tails, default=0)
    return [
        cell + " " * (longest - tail) if _is_number(cell) else cell for cell, tail in zip(cells, tails, strict=True)
    ]


def _find_decimal_point(text: str) -> int:
    """Return the index of the decimal point, or where it would be; for a text its length."""
    return (text.partition("e")[0] + ".").index(".") if _is_number(text) else len(text)


def _is_number(cell: str) -> bool:
    return cell.lstrip("-")[:1].isdecimal()


def _format_row(cells: Sequence[str], widths: Sequence[int], columns: Sequence[OutputColumn], indent: str) -> str:
    padded = [
        cell.rjust(width) if column.is_number else cell.ljust(width)
        for cell, width, column in zip(cells, widths, columns, strict=True)
    ]
    return (indent + GAP.join(padded)).rstrip()
