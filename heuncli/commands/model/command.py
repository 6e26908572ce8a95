"""`heun model`: which model is made of a scene, and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.cli.guard import require_other_file
from heuncli.cli.output import emit
from heuncli.cli.solving import overrides, warn
from heuncli.cli.target import format_of
from heuncli.commands.model.request import ModelRequest
from heuncli.report.export import dump
from heuncli.report.model_text import note
from heuncli.spec.load import load
from heuncli.study.workflow import describe

FORMATS = ("text", "json")


def main(request: ModelRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    model: Mapping[str, Any] = describe(spec, reduce=not request.no_reduce)
    emit(dump(dict(model)) if form == "json" else note(spec.title, model), request.output)
    warn(spec, None, request.quiet)
    return 0
