"""Tables on a terminal: headings set off, and wide tables split into parts that fit. Impure: asks the terminal."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from heuncli.app.cli.line_width import line_width
from heuncli.base.wrapping import wrapped
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import TextTable, plain

LEAST_WIDTH = 40  # below it words stand one to a line, and nothing can be read across
BOLD, CYAN, END = "\x1b[1m", "\x1b[36m", "\x1b[0m"
PLAIN = ("", "dumb", "unknown")  # terminals that know no escape codes


def present() -> bool:
    """Whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def styled() -> bool:
    """Whether escape codes may go to a terminal: it knows them, and nobody has said NO_COLOR."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM", "") not in PLAIN


def width() -> int:
    """The columns of the terminal, LEAST_WIDTH at least; 80 where it tells none."""
    return max(line_width(), LEAST_WIDTH)


def write(tables: Sequence[TextTable]) -> list[str]:
    """The tables as text for the terminal at hand, in its width and with its colours (or none: NO_COLOR)."""
    room, codes = width(), styled()
    return [_part(part, room, codes) for table in tables for part in fit(table, room)]


def _part(part: TextTable, room: int, codes: bool) -> str:
    text = plain(part, room)
    if not codes:
        return text
    lines = text.splitlines()
    heads = len(wrapped(part.heading, room)) if part.heading else 0
    across = {line for row in part.rows if isinstance(row, str) for line in wrapped(row, room)}
    for number, line in enumerate(lines):
        if number < heads or line in across:
            lines[number] = f"{BOLD if number < heads else CYAN}{line}{END}"
    return "".join(f"{line}\n" for line in lines)
