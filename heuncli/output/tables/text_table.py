"""Tables of text: aligned columns for the terminal, and the same as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.base.wrapping import wrap_text
from heuncli.output.tables.markdown_text import escape_line, escape_markdown

GAP = "  "
INDENT = "  "
DEFAULT_WIDTH = 120  # of tables without a terminal width
Align = Literal["left", "point"]  # `point`: decimal points are aligned


class TextColumn(NamedTuple):
    """A column's head and the alignment of its cells.

    vector: in a table too wide for a page, neighbours of one vector stay together
    is_shown_once: the column is not repeated in the further parts of a wide table
    is_optional: as the last column of a wide table it is left out
    """

    head: str
    align: Align = "point"
    vector: str = ""
    is_shown_once: bool = False
    is_optional: bool = False


class TextTable(NamedTuple):
    """A heading, columns, rows of cells, and notes below. A row that is a single string is a title over the rows after
    it.
    """

    heading: str
    columns: tuple[TextColumn, ...] = ()
    rows: tuple[tuple[str, ...] | str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing below the heading."""
        return not self.rows and not self.notes


def format_head(label: str, unit: str) -> str:
    """Format the head of a column of numbers; a plain number has no unit, or "1"."""
    return label if unit in ("", "1") else f"{label} [{unit}]"


def append_unit(text: str, unit: str) -> str:
    """Append the unit to a number, unless it is a plain one."""
    return text if unit in ("", "1") else f"{text} {unit}"


def format_plain(table: TextTable, width: int | None = None) -> str:
    """Format the table as aligned text that ends with a newline. Headings, titles and notes are wrapped to the width,
    if any.
    """
    if table.is_empty:
        return ""
    indent = INDENT if any(isinstance(row, str) for row in table.rows) else ""
    lines = wrap_text(escape(table.heading), width) if table.heading else []
    if table.columns:
        cells = align_cells(table)
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        texts = iter(_format_row(row, widths, table.columns, indent) for row in cells)
        lines += [head for head in [next(texts)] if head]
        for row in table.rows:
            lines += wrap_text(escape(row), width) if isinstance(row, str) else [next(texts)]
    notes = [line for note in table.notes for line in wrap_text(indent + escape(note), width)]
    return "\n".join([*lines, *notes, ""])


def format_labelled_lines(lines: Sequence[tuple[str, str]], width: int = DEFAULT_WIDTH) -> str:
    """Format labels with a text after each; the text is wrapped below itself."""
    indent = max(len(label) for label, _ in lines) + 2
    lines_of_text = []
    for label, text in lines:
        first, *rest = wrap_text(escape(text), width - indent, 0)
        lines_of_text += [label.ljust(indent) + first, *(" " * indent + line for line in rest)]
    return "".join(line + "\n" for line in lines_of_text)


def format_markdown(table: TextTable) -> str:
    """Format the table as Markdown; title rows become rows with a bold first cell."""
    if table.is_empty:
        return ""
    lines = [f"### {escape_line(table.heading)}", ""] if table.heading else []
    if table.columns:
        rows = [row if isinstance(row, str) else tuple(map(escape_markdown, row)) for row in table.rows]
        lines += [format_markdown_rows(table.columns, rows), ""]
    for note in table.notes:
        lines += [escape_line(note), ""]
    return "\n".join(lines)


def align_cells(table: TextTable) -> list[tuple[str, ...]]:
    """Return head and rows of cells without title rows; the cells of a `point` column are padded to a common decimal
    point.
    """
    rows = [row for row in table.rows if not isinstance(row, str)]
    columns = []
    for index, column in enumerate(table.columns):
        cells = [escape(row[index]) for row in rows]
        columns.append([column.head, *(_pad_to_point(cells) if column.align == "point" else cells)])
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


def _format_row(cells: Sequence[str], widths: Sequence[int], columns: Sequence[TextColumn], indent: str) -> str:
    padded = [
        cell.ljust(width) if column.align == "left" else cell.rjust(width)
        for cell, width, column in zip(cells, widths, columns, strict=True)
    ]
    return (indent + GAP.join(padded)).rstrip()


def format_markdown_rows(columns: Sequence[TextColumn], rows: Iterable[Sequence[str] | str]) -> str:
    """Format the rows of a table below their heads. Cells are Markdown already; a row that is a single string is a
    title, still to be escaped.
    """
    heads = [escape_markdown(column.head) for column in columns]
    rules = ["---" if column.align == "left" else "---:" for column in columns]
    blank = [""] * (len(columns) - 1)
    cells = ([embolden(escape_markdown(row)), *blank] if isinstance(row, str) else row for row in rows)
    return "\n".join("| " + " | ".join(row) + " |" for row in (heads, rules, *cells))


def embolden(text: str) -> str:
    """Make Markdown bold, unless it is empty."""
    return f"**{text}**" if text else text
