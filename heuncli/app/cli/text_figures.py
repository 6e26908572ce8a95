"""Render a figure as text, for the terminal or for the program that reads standard output."""

from __future__ import annotations

import os
import sys

from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem
from heuncli.output.drawing.figure import Figure

WIDTH = 100  # columns where there is no terminal
MIN_WIDTH, MAX_WIDTH = 40, 400


def require_width(width: int | None) -> None:
    """Raise UsageError for a width in which nothing can be drawn."""
    if width is not None and not MIN_WIDTH <= width <= MAX_WIDTH:
        message = f"--width {width}: expected {MIN_WIDTH} to {MAX_WIDTH} columns"
        raise UsageError(Problem("bad-option", message, hint=f"for example --width {WIDTH}"))


def render_text(figure: Figure, width: int | None, output: str | None = None, *, allows_colours: bool = True) -> str:
    """Render the figure as text, for the terminal or for a file."""
    from heuncli.output.drawing.canvas import make_terminal_style
    from heuncli.output.drawing.letters import draw_text

    to_terminal = output is None and terminal.is_terminal()
    columns = width or (terminal.find_width() - 1 if to_terminal else WIDTH)
    plain = to_terminal and os.environ.get("TERM", "") in terminal.PLAIN_TERMINALS
    encoding = "ascii" if plain else sys.stdout.encoding if to_terminal else None
    has_colours = allows_colours and to_terminal and terminal.supports_styles()
    return draw_text(figure, make_terminal_style(columns, encoding, has_colours=has_colours))
