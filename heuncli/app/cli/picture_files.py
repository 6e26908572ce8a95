"""Where a command's picture goes: judged before any work."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import same_file
from heuncli.app.cli.target import require_room
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT
from heuncli.output.drawing.as_file import form_of


def picture_form(name: str, option: str) -> str:
    """The form of a picture by the end of its name, before any work. Raises UsageError, SpecError, OutputError."""
    form = form_of(name, option)
    require_room(name, option)
    if form != "svg":
        from heuncli.output.drawing.matplotlib_file import require_plot

        require_plot(f"{option} {name}")
    return form


def saved_beside(name: str | None, output: str | None) -> str | None:
    """The form of the picture of `--save`, which goes elsewhere than the table. Raises as `picture_form`."""
    if name is None:
        return None
    form = picture_form(name, "--save")
    if same_file("/dev/stdout" if output in (None, STDOUT) else output, name):
        raise UsageError(
            Problem("bad-option", f"--save {name}: that is where the table goes", hint="name another file")
        )
    return form
