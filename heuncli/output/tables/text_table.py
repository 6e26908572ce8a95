"""A table as text cells, and two ways to write it: plain aligned text, and markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.wrapping import wrapped
from heuncli.output.tables.markdown_text import escape_line, escape_markdown

GAP = "  "
INDENT = "  "
WIDTH = 120  # of tables that no terminal sets one for
Align = Literal["left", "point"]  # `point`: decimal points stand under each other


class TextColumn(NamedTuple):
    """A column's head and how its cells stand.

    Where a table is too wide for a page: neighbours of one `vector` stay together; what stands `once` is not repeated;
    a last one that is `spare` is left out.
    """

    head: str
    align: Align = "point"
    vector: str = ""
    once: bool = False
    spare: bool = False


class TextTable(NamedTuple):
    """A heading, columns, rows of cells, and notes below. A row that is one string is a line across, over its rows."""

    heading: str
    columns: tuple[TextColumn, ...] = ()
    rows: tuple[tuple[str, ...] | str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def is_empty(self) -> bool:
        """Whether nothing stands below the heading."""
        return not self.rows and not self.notes


def head(label: str, unit: str) -> str:
    """What stands above a column of numbers."""
    return f"{label} [{unit}]" if unit != "1" else label


def plain(table: TextTable, width: int | None = None) -> str:
    """The table as aligned text; ends with a newline. Headings, titles and notes go on in more lines, if of a width."""
    if table.is_empty:
        return ""
    indent = INDENT if any(isinstance(row, str) for row in table.rows) else ""
    lines = wrapped(shown(table.heading), width) if table.heading else []
    if table.columns:
        cells = aligned(table)
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        texts = iter(_line(row, widths, table.columns, indent) for row in cells)
        lines += [head for head in [next(texts)] if head]
        for row in table.rows:
            lines += wrapped(shown(row), width) if isinstance(row, str) else [next(texts)]
    notes = [line for note in table.notes for line in wrapped(indent + shown(note), width)]
    return "\n".join([*lines, *notes, ""])


def labelled(lines: Sequence[tuple[str, str]], width: int = WIDTH) -> str:
    """Labels with a text behind each, which goes on below itself."""
    indent = max(len(label) for label, _ in lines) + 2
    found = []
    for label, text in lines:
        first, *rest = wrapped(shown(text), width - indent, 0)
        found += [label.ljust(indent) + first, *(" " * indent + line for line in rest)]
    return "".join(line + "\n" for line in found)


def markdown(table: TextTable) -> str:
    """The table as markdown; the lines across become rows with a bold first cell."""
    if table.is_empty:
        return ""
    lines = [f"### {escape_line(table.heading)}", ""] if table.heading else []
    if table.columns:
        lines.append(_markdown_row(column.head for column in table.columns))
        lines.append(_markdown_row("---" if column.align == "left" else "---:" for column in table.columns))
        blank = [""] * (len(table.columns) - 1)
        for row in table.rows:
            lines.append(_markdown_row([row, *blank], bold=True) if isinstance(row, str) else _markdown_row(row))
        lines.append("")
    for note in table.notes:
        lines += [escape_line(note), ""]
    return "\n".join(lines)


def aligned(table: TextTable) -> list[tuple[str, ...]]:
    """Head and rows of cells (without the lines across), the cells of a `point` column padded to a common point."""
    rows = [row for row in table.rows if not isinstance(row, str)]
    columns = []
    for index, column in enumerate(table.columns):
        cells = [shown(row[index]) for row in rows]
        columns.append([column.head, *(_pad(cells) if column.align == "point" else cells)])
    return list(zip(*columns, strict=True))


def _pad(cells: Sequence[str]) -> list[str]:
    """Cells with blanks behind, so that right-justified their points stand under each other."""
    tails = [len(cell) - _point(cell) for cell in cells]
    longest = max(tails, default=0)
    return [
        cell + " " * (longest - tail) if _is_number(cell) else cell for cell, tail in zip(cells, tails, strict=True)
    ]


def _point(cell: str) -> int:
    """Where the decimal point stands, or would stand."""
    return (cell.partition("e")[0] + ".").index(".") if _is_number(cell) else len(cell)


def _is_number(cell: str) -> bool:
    return cell.lstrip("-")[:1].isdecimal()


def _line(cells: Sequence[str], widths: Sequence[int], columns: Sequence[TextColumn], indent: str) -> str:
    padded = [
        cell.ljust(width) if column.align == "left" else cell.rjust(width)
        for cell, width, column in zip(cells, widths, columns, strict=True)
    ]
    return (indent + GAP.join(padded)).rstrip()


def _markdown_row(cells: Iterable[str], *, bold: bool = False) -> str:
    texts = map(escape_markdown, cells)
    return "| " + " | ".join(f"**{text}**" if bold and text else text for text in texts) + " |"
