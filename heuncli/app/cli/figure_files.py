"""Check the output file of a figure before any work."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import is_same_file
from heuncli.app.cli.target import require_writable
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.output.drawing.drawing_files import find_form, require_encoder


def require_figure_form(name: str, option: str) -> str:
    """Return the format of a figure file by its ending, and check that it can be written. Raises UsageError, SpecError,
    OutputError.
    """
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
    if is_same_file("/dev/stdout" if output in (None, STDOUT) else output, name):
        raise UsageError(
            Problem("bad-option", f"--save {name}: the table is written to this file", hint="name another file")
        )
    return form
