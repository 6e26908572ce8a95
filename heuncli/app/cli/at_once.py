"""What the command answers before anything else is imported: its version, and its help. Impure: reads a file, writes.

The help stands in help.txt, as typer lays it out where a line has 80 characters or more: most of the time of
`heun --help` went into making the same text again. `python -m tests.manual.tables` renews it.
"""

from __future__ import annotations

import os
import sys

from heuncli.app.cli.line_width import line_width
from heuncli.base.errors import HeunError
from heuncli.version import VERSION

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

HELP = os.path.join(os.path.dirname(__file__), "help.txt")  # noqa: PTH118, PTH120 - pathlib takes 5 ms
USUAL = 80  # characters of a line from which on typer's text stays as it is


def answered(argv: Sequence[str]) -> bool:
    """Whether a command line is answered; where anything is out of the ordinary it is left to those who can say so."""
    try:
        text = text_for(argv)
        if text is None or sys.stdout is None:
            return False
        left = memoryview(text.encode("ascii"))
        while left:
            left = left[os.write(sys.stdout.fileno(), left) :]
    except (HeunError, OSError, ValueError):
        return False
    return True


def text_for(argv: Sequence[str]) -> str | None:
    """The answer to a command line, if it is one of these. Raises KernelError where no kernel can be had."""
    if argv[:1] == ["--version"]:
        return version() + "\n"
    if [*argv] == ["--help"] and line_width() >= USUAL:
        with open(HELP, encoding="utf-8") as file:  # noqa: PTH123
            return file.read()
    return None


def version() -> str:
    """The version, and which kernel runs."""
    from heuncli.kernel.form import KERNEL

    return f"heun {VERSION} ({KERNEL} kernel, Python {sys.version.split()[0]})"
