"""`heun validate`: every error of every file at once."""

from __future__ import annotations

from functools import partial

from heuncli.app.cli import alarm
from heuncli.app.cli.entry import contained, report_problems, worst
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, say
from heuncli.app.commands.validate.request import ValidateRequest
from heuncli.base.errors import HeunError, SpecError
from heuncli.base.foreign_text import shown
from heuncli.output.tables.plurals import count
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Spec


def main(request: ValidateRequest) -> int:
    """Run the command; returns the exit code."""
    codes, lines = [0], []
    for path in request.specs:
        try:
            work = partial(alarm.limited, partial(_judged, path), request.time_limit_each, subject=path)
            spec, warnings = contained(work, ("validate", path))
        except HeunError as error:
            report_problems(error.problems, "" if isinstance(error, SpecError) else f"{path}: ")
            codes.append(error.exit_code)
            continue
        if not request.quiet:
            for warning in warnings:
                say(f"warning: {warning}")
        lines.append(f"{shown(path)}: fine ({_summary(spec, len(warnings))})\n")
    require_other_file(None, request.specs)
    code = worst(codes)
    if code == 0 and not request.quiet:
        emit("".join(lines))
    return code


def _judged(path: str) -> tuple[Spec, list[str]]:
    """A spec that is fine, and its warnings. Raises SpecError, LimitError."""
    spec, _ = load_with_cases(path)
    warnings = [*map(str, spec.warnings), *_of_cuts(spec)]
    alarm.disarm()
    return spec, warnings


def _of_cuts(spec: Spec) -> list[str]:
    """Warnings of the sections. Raises SpecError with every one that cannot be cut, and couplings that do not fit."""
    if not (spec.sections or spec.couplings):
        return []
    from heuncli.study.model.setup import draw  # with NumPy, which other specs are judged without

    return [f"{shown(spec.path)}: {warning}" for cut in draw(spec)[1] for warning in cut.warnings]


def _summary(spec: Spec, warnings: int) -> str:
    parts = [count(len(spec.bodies), "body"), count(len(spec.joints), "joint")]
    parts += [count(len(spec.sections), "section")] if spec.sections else []
    parts += [count(warnings, "warning")] if warnings else []
    return ", ".join(parts)
