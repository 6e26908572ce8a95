"""Ask whether there is a terminal, how wide it is, and whether it shows styles. Impure: queries the terminal."""

from __future__ import annotations

import os
import sys

MIN_WIDTH = 40  # columns; with fewer a table cannot be read
BOLD, CYAN, END = "\x1b[1m", "\x1b[36m", "\x1b[0m"
PLAIN_TERMINALS = ("", "dumb", "unknown")  # terminals that know no escape codes
DEFAULT_WIDTH = 80


def is_terminal() -> bool:
    """Return whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def supports_styles() -> bool:
    """Return whether escape codes may be written: the terminal knows them, and NO_COLOR is not set."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM", "") not in PLAIN_TERMINALS


def find_width() -> int:
    """Return the columns of the terminal, MIN_WIDTH at least, or 80 if unknown."""
    return max(find_line_width(), MIN_WIDTH)


def find_line_width() -> int:
    """Return COLUMNS, else the width of the terminal that standard output was at the start, else 80."""
    try:
        if (columns := int(os.environ["COLUMNS"])) > 0:
            return columns
    except (KeyError, ValueError):
        pass
    try:
        return os.get_terminal_size(sys.__stdout__.fileno()).columns or DEFAULT_WIDTH  # type: ignore[union-attr]
    except (AttributeError, ValueError, OSError):
        return DEFAULT_WIDTH
