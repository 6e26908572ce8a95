"""Answer `--version` and `--help` before anything else is imported. Impure: reads a file, writes.

The help text stands in help.txt, as typer lays it out for lines of 80 characters or more; making it each time took most
of the time of `heun --help`. `python -m tests.manual.tables` renews it.
"""

from __future__ import annotations

import os
import sys

from heuncli.app.cli.terminal import find_line_width
from heuncli.base.errors import HeunError
from heuncli.version import VERSION

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

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
