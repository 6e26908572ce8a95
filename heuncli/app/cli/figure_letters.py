"""A figure for the terminal that is at hand, or for what reads standard output in its place."""

from __future__ import annotations

import os
import sys

from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem
from heuncli.output.drawing.figure import Figure

WIDTH = 100  # columns where there is no terminal
LEAST, MOST = 40, 400


def require_width(width: int | None) -> None:
    """Raise UsageError for a width in which nothing can be drawn."""
    if width is not None and not LEAST <= width <= MOST:
        message = f"--width {width}: expected {LEAST} to {MOST} columns"
        raise UsageError(Problem("bad-option", message, hint=f"such as --width {WIDTH}"))


def in_letters(figure: Figure, width: int | None, output: str | None = None) -> str:
    """The figure as text, for the terminal or for a file."""
    from heuncli.output.drawing.canvas import look_of
    from heuncli.output.drawing.letters import drawn

    present = output is None and terminal.present()
    columns = width or (terminal.width() - 1 if present else WIDTH)
    plain = present and os.environ.get("TERM", "") in terminal.PLAIN
    encoding = "ascii" if plain else sys.stdout.encoding if present else None
    return drawn(figure, look_of(columns, encoding, colours=present and terminal.styled()))
