"""`heun validate`: every error of every file at once."""

from __future__ import annotations

from heuncli.cli.entry import tell, worst
from heuncli.cli.output import emit
from heuncli.cli.requests import Validate
from heuncli.errors import SpecError
from heuncli.report.words import count
from heuncli.spec.load import load
from heuncli.spec.models import Spec


def main(request: Validate) -> int:
    """Run the command; returns the exit code."""
    codes, lines = [0], []
    for path in request.specs:
        try:
            spec = load(path)
        except SpecError as error:
            tell(error.problems)
            codes.append(error.exit_code)
            continue
        if not request.quiet:
            tell(spec.warnings, label="warning: ")
        lines.append(f"{path}: fine ({_summary(spec)})\n")
    code = worst(codes)
    if code == 0 and not request.quiet:
        emit("".join(lines))
    return code


def _summary(spec: Spec) -> str:
    parts = [count(len(spec.bodies), "body"), count(len(spec.joints), "joint")]
    parts += [count(len(spec.sections), "section")] if spec.sections else []
    parts += [count(len(spec.warnings), "warning")] if spec.warnings else []
    return ", ".join(parts)
