"""The options of figures: width and view of a drawing, format and file of a figure. Impure: terminal, files."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from heuncli.app.cli import terminal
from heuncli.app.cli.target import is_output, require_writable
from heuncli.base.errors import Finding, Problem, UsageError

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

WIDTH = 100  # columns where there is no terminal
MIN_WIDTH, MAX_WIDTH = 40, 400  # columns that --width accepts


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


def require_view(words: str | None) -> None:
    """Require that `--view` is valid, before any work. Raises UsageError."""
    if words is None:
        return
    import numpy as np

    from heuncli.output.machine_geometry.views import parse_view  # with all that shows a machine

    try:
        parse_view(words, np.zeros(3))
    except Finding as finding:
        problem = Problem(finding.code, f"--view {words}: {finding.message}", hint=finding.hint)
        raise UsageError(problem) from None


def require_figure_form(name: str, option: str) -> str:
    """Return the format of a figure file by its ending, and check that it can be written. Raises UsageError, SpecError,
    OutputError.
    """
    from heuncli.output.drawing.drawing_files import find_form, require_encoder  # with all that draws

    form = find_form(name, option)
    require_writable(name, option)
    require_encoder(form, f"{option} {name}")
    return form


def require_save_form(name: str | None, output: str | None) -> str | None:
    """Return the figure format of `--save`, whose file must differ from the table's. Raises as
    `require_figure_form`.
    """
    if name is None:
        return None
    form = require_figure_form(name, "--save")
    if is_output(name, output):
        raise UsageError(
            Problem("bad-option", f"--save {name}: the table is written to this file", hint="name another file")
        )
    return form
