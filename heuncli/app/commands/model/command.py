"""`heun model`: which model is made of a scene, and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.commands.model.request import ModelRequest
from heuncli.base.errors import Problem
from heuncli.output.tables.export import dump
from heuncli.output.tables.model_text import note
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import describe

FORMATS = ("text", "json")


def main(request: ModelRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    require_sketch(request, form)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    model: Mapping[str, Any] = describe(spec, reduce=not request.no_reduce)
    text = dump(dict(model)) if form == "json" else note(spec.title, model)
    if request.sketch:
        from heuncli.app.commands.model.sketch import sketch  # what few ask for

        text += "\n" + sketch(spec, request)
    emit(text, request.output)
    warn(spec, None, request.quiet)
    return 0


def require_sketch(request: ModelRequest, form: str) -> None:
    """Say before the work what does not go with a drawing, or goes with it alone. Raises UsageError."""
    if request.sketch and form != "text":
        message = f"--sketch is a drawing in letters, and not in {form}"
        raise UsageError(Problem("bad-option", message, hint="heun plot SPEC scene -o x.svg draws the scene as a file"))
    given = [name for name, value in (("--view", request.view), ("--width", request.width)) if value is not None]
    if given and not request.sketch:
        message = f"{', '.join(given)}: of a drawing, which is not asked for"
        raise UsageError(Problem("bad-option", message, hint="add --sketch"))
    if request.view is not None:
        from heuncli.app.cli.views import require_view

        require_view(request.view)
