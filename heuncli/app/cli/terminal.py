"""Ask whether there is a terminal, how wide it is, and whether it shows styles; answer `--version` and `--help`.

These answers need nothing else to be imported. The help text stands in help.txt, as typer lays it out for lines of 80
characters or more; making it each time took most of the time of `heun --help`. `python -m tests.manual.tables` renews
it. Impure: queries the terminal, reads a file, writes.
"""

from __future__ import annotations

import os
import sys

from heuncli.base.errors import HeunError
from heuncli.version import VERSION

TYPE_CHECKING = False  # that of `typing` takes 2 ms
if TYPE_CHECKING:
    from collections.abc import Sequence

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


HELP = os.path.join(os.path.dirname(__file__), "help.txt")  # noqa: PTH118, PTH120 - pathlib takes 5 ms
MIN_HELP_WIDTH = 80  # characters of a line; with fewer typer lays out the help differently


def try_answer(argv: Sequence[str]) -> bool:
    """Answer the command line if possible; returns whether it did. Anything unusual is left to the full command
    line.
    """
    try:
        text = find_text(argv)
        if text is None or sys.stdout is None:
            return False
        remaining = memoryview(text.encode("ascii"))
        while remaining:
            remaining = remaining[os.write(sys.stdout.fileno(), remaining) :]
    except (HeunError, OSError, ValueError):
        return False
    return True


def find_text(argv: Sequence[str]) -> str | None:
    """Return the text for `--version` or `--help`, or None for other command lines. Raises KernelError if no kernel can
    be loaded.
    """
    if argv[:1] == ["--version"]:
        return format_version() + "\n"
    if [*argv] == ["--help"] and find_line_width() >= MIN_HELP_WIDTH:
        with open(HELP, encoding="utf-8") as file:  # noqa: PTH123
            return file.read()
    return None


def format_version() -> str:
    """Return the version, and which kernel runs."""
    from heuncli.kernel.form import KERNEL

    return f"heun {VERSION} ({KERNEL} kernel, Python {sys.version.split()[0]})"
