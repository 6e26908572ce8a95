"""Render tables for the terminal: styled headings, and wide tables split into parts that fit. Impure: queries the
terminal.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from heuncli.app.cli.line_width import find_line_width
from heuncli.base.wrapping import wrap_text
from heuncli.output.tables.page_width import split_to_width
from heuncli.output.tables.text_table import TextTable, format_plain

MIN_WIDTH = 40  # columns; with fewer a table cannot be read
BOLD, CYAN, END = "\x1b[1m", "\x1b[36m", "\x1b[0m"
PLAIN_TERMINALS = ("", "dumb", "unknown")  # terminals that know no escape codes


def is_terminal() -> bool:
    """Return whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def supports_styles() -> bool:
    """Return whether escape codes may be written: the terminal knows them, and NO_COLOR is not set."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM", "") not in PLAIN_TERMINALS


def find_width() -> int:
    """Return the columns of the terminal, MIN_WIDTH at least, or 80 if unknown."""
    return max(find_line_width(), MIN_WIDTH)


def render_tables(tables: Sequence[TextTable]) -> list[str]:
    """Render the tables as text for this terminal, in its width and with its styles."""
    columns, codes = find_width(), supports_styles()
    return [_render_part(part, columns, codes) for table in tables for part in split_to_width(table, columns)]


def _render_part(part: TextTable, columns: int, use_styles: bool) -> str:
    text = format_plain(part, columns)
    if not use_styles:
        return text
    lines = text.splitlines()
    heads = len(wrap_text(part.heading, columns)) if part.heading else 0
    across = {line for row in part.rows if isinstance(row, str) for line in wrap_text(row, columns)}
    for number, line in enumerate(lines):
        if number < heads or line in across:
            lines[number] = f"{BOLD if number < heads else CYAN}{line}{END}"
    return "".join(f"{line}\n" for line in lines)
