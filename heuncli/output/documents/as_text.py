"""Write a document as text: aligned columns, wrapped sentences, tables split to the width of a page or a terminal.

A table that is too wide is split into parts, each of which begins with the columns that name its rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape
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
)
from heuncli.results.results import Array
from heuncli.version import VERSION

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

DEFAULT_WIDTH = 120  # of pages without a terminal width
DRAWING_WIDTH = 100  # of a drawing
GAP = "  "
INDENT = "  "
CONTINUED = "continued"
MIN_TEXT_WIDTH = 24  # minimum width of a last column of text that is wrapped
PLAIN_CODES = ("", "", "")  # of a terminal: before a heading, before a title, after both
BLOCK_CHARACTERS = "▁▂▃▄▅▆▇█"
ASCII_CHARACTERS = "_.-:=+*#"
UNKNOWN_CHARACTERS = {BLOCK_CHARACTERS: "·", ASCII_CHARACTERS: " "}  # for unknown numbers


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


def format_plain(table: OutputTable, width: int | None = None, codes: tuple[str, str, str] = PLAIN_CODES) -> str:
    """Format the table as aligned text that ends with a newline. Headings, titles and notes are wrapped to the width,
    if any.

    codes: of a terminal: before a heading, before a title, after both
    """
    if table.is_empty:
        return ""
    heading_code, title_code, end_code = codes
    indent = INDENT if any(isinstance(row, str) for row in table.rows) else ""
    lines = _mark(wrap_text(escape(table.heading), width), heading_code, end_code) if table.heading else []
    if table.columns:
        cells = align_cells(table)
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        texts = iter(_format_row(row, widths, table.columns, indent) for row in cells)
        lines += [head for head in [next(texts)] if head]
        for row in table.rows:
            if isinstance(row, str):
                lines += _mark(wrap_text(escape(row), width), title_code, end_code)
            else:
                lines.append(next(texts))
    notes = [line for note in table.notes for line in wrap_text(indent + escape(note), width)]
    return "\n".join([*lines, *notes, ""])


def _mark(lines: Sequence[str], code: str, end_code: str) -> list[str]:
    """Put escape codes of a terminal around lines."""
    return [f"{code}{line}{end_code}" if code else line for line in lines]


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


def split_to_width(table: OutputTable, width: int) -> list[OutputTable]:
    """Split the table into parts no wider than `width`, if possible; each part repeats the leading columns of words."""
    if not table.columns:
        return [table]
    widths = [max(map(len, column)) + len(GAP) for column in zip(*align_cells(table), strict=True)]
    indent = len(INDENT) if any(isinstance(row, str) for row in table.rows) else 0
    excess = indent + sum(widths) - len(GAP) - width
    if excess <= 0:
        return [table]
    if len(widths) > 1 and not table.columns[-1].is_number and widths[-1] - len(GAP) - excess >= MIN_TEXT_WIDTH:
        return [table._replace(rows=tuple(wrap_last_column(table, widths[-1] - len(GAP) - excess)))]
    if any(column.is_optional for column in table.columns):
        kept = [i for i, column in enumerate(table.columns) if not column.is_optional]
        return split_to_width(select_columns(table, kept), width)
    lead = 1 + max((i for i, column in enumerate(table.columns[:3]) if not column.is_number), default=0)
    repeated = [i for i in range(lead) if not table.columns[i].is_shown_once]
    widths_left = [width - indent + len(GAP) - sum(widths[i] for i in columns) for columns in (range(lead), repeated)]
    parts = distribute_columns(widths, group_vector_columns(table, lead, widths, widths_left[1]), widths_left)
    tables = []
    for number, part in enumerate(parts):
        shown_columns = [*(repeated if number else range(lead)), *part]
        notes = table.notes if number == len(parts) - 1 else ()
        shown = select_columns(table, shown_columns)
        tables.append(shown._replace(heading=make_part_heading(table, number), notes=notes))
    return tables


def select_columns(table: OutputTable, columns: Sequence[int]) -> OutputTable:
    """Return the table with some of its columns, by their indices."""
    rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in columns) for row in table.rows)
    return table._replace(columns=tuple(table.columns[i] for i in columns), rows=rows)


def wrap_last_column(table: OutputTable, text_width: int) -> Iterator[tuple[Cell, ...] | str]:
    """Wrap the text of the last column to a width, in rows of its own."""
    for row in table.rows:
        if isinstance(row, str):
            yield row
            continue
        first, *rest = wrap_text(format_cell(row[-1]), text_width, 0)
        yield (*row[:-1], first)
        yield from ((*[""] * (len(row) - 1), line) for line in rest)


def make_part_heading(table: OutputTable, part: int) -> str:
    """Return the heading of a part: the whole heading for the first, only its title for the others."""
    if not part or not table.heading:
        return "" if part else table.heading
    lead, separator, remainder = table.heading.partition(")  ")  # of an impact: its instant and names
    impact_title, table_heading = (
        (lead + separator, remainder) if lead.startswith("IMPULSE at") and remainder else ("", table.heading)
    )
    return f"{impact_title}{table_heading.partition('  ')[0]}  {CONTINUED}"


def group_vector_columns(table: OutputTable, lead: int, widths: Sequence[int], max_width: int) -> list[list[int]]:
    """Group the columns after the leading ones: those of one vector stay together as long as they fit."""
    column_groups: list[list[int]] = []
    for column in range(lead, len(widths)):
        vector, last_group = table.columns[column].vector, column_groups[-1] if column_groups else []
        is_same_vector = vector and last_group and table.columns[last_group[-1]].vector == vector
        if is_same_vector and sum(widths[i] for i in (*last_group, column)) <= max_width:
            last_group.append(column)
        else:
            column_groups.append([column])
    return column_groups


def distribute_columns(
    widths: Sequence[int], column_groups: Sequence[list[int]], widths_left: Sequence[int]
) -> list[list[int]]:
    """Distribute the groups of columns over parts.

    widths_left: room in the first part, and in each of the others
    """
    parts: list[list[int]] = [[]]
    for columns in column_groups:
        if parts[-1] and sum(widths[i] for i in (*parts[-1], *columns)) > widths_left[len(parts) > 1]:
            parts.append([])
        parts[-1] += columns
    return parts


def choose_characters(encoding: str | None) -> str:
    """Return the characters that a terminal of this encoding shows; None stands for UTF-8."""
    try:
        BLOCK_CHARACTERS.encode(encoding or "utf-8")
    except (UnicodeError, LookupError):
        return ASCII_CHARACTERS
    return BLOCK_CHARACTERS


def draw_sparkline(
    values: Sequence[float] | Array, width: int, limits: tuple[float, float], characters: str = BLOCK_CHARACTERS
) -> str:
    """Draw a character for each number between the limits; of more than `width` numbers, neighbours are joined to their
    maximum.

    An unknown number (nan) becomes a dot. If both limits are equal, all characters are low.
    """
    shown_values = reduce_to_width(np.asarray(values, dtype=np.float64), width)
    low, high = limits
    heights = (shown_values - low) / (high - low) if high > low else np.where(np.isnan(shown_values), np.nan, 0.0)
    return "".join(
        UNKNOWN_CHARACTERS[characters] if np.isnan(height) else _choose_character(height, characters)
        for height in heights.tolist()
    )


def _choose_character(height: float, characters: str) -> str:
    """Return the character of a height from 0 to 1."""
    return characters[min(max(int(height * len(characters)), 0), len(characters) - 1)]


def reduce_to_width(values: Array, width: int) -> Array:
    """Reduce the numbers to at most `width`: the maximum of neighbours, nan if none of them is known."""
    if len(values) <= width:
        return values
    starts = np.arange(width) * len(values) // width
    lowest = np.where(np.isnan(values), -np.inf, values)
    greatest: Array = np.maximum.reduceat(lowest, starts)
    return np.where(np.isneginf(greatest), np.nan, greatest)


def draw_histogram(values: Array, limits: tuple[float, float], bins: int, characters: str = BLOCK_CHARACTERS) -> str:
    """Draw how many of the numbers lie in each of the bins between the limits."""
    known = values[np.isfinite(values)]
    low, high = limits
    if not known.size or not high > low:
        return characters[-1] * min(known.size, 1)
    counts, _ = np.histogram(known, bins, (low, high))
    return "".join(
        " " if count == 0 else _choose_character(count / counts.max(), characters) for count in counts.tolist()
    )
