"""`heun validate`: report every error of every file."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import report_problems, run_contained, select_exit_code
from heuncli.app.cli.options import TIME_LIMIT_EACH, Option
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.target import require_other_file
from heuncli.base.errors import HeunError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.tables.nouns import format_count
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Spec


class ValidateRequest(NamedTuple):
    """The options and arguments of `heun validate`."""

    specs: Annotated[tuple[str, ...], Option((), "YAML files; - reads standard input.", "SPEC...", completes="spec")]
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, Option(("--quiet", "-q"), "Print only errors.")] = False


def main(request: ValidateRequest) -> int:
    """Run the command; returns the exit code."""
    codes, lines = [0], []
    for path in request.specs:
        try:
            work = partial(timeout.run_with_limit, partial(_validate_spec, path), request.time_limit_each, subject=path)
            spec, warnings = run_contained(work, ("validate", path))
        except HeunError as error:
            report_problems(error.problems, "" if isinstance(error, SpecError) else f"{path}: ")
            codes.append(error.exit_code)
            continue
        if not request.quiet:
            for warning in warnings:
                print_stderr(f"warning: {warning}")
        lines.append(f"{escape(path)}: valid ({_format_summary(spec, len(warnings))})\n")
    require_other_file(None, request.specs)
    code = select_exit_code(codes)
    if code == 0 and not request.quiet:
        emit("".join(lines))
    return code


def _validate_spec(path: str) -> tuple[Spec, list[str]]:
    """Validate a spec; returns it and its warnings. Raises SpecError, LimitError."""
    spec, _ = load_with_cases(path)
    warnings = [*map(str, spec.warnings), *_check_sections(spec)]
    timeout.disarm()
    return spec, warnings


def _check_sections(spec: Spec) -> list[str]:
    """Return the warnings of the sections. Raises SpecError with every section that cannot be cut and every invalid
    coupling.
    """
    if not (spec.sections or spec.couplings):
        return []
    from heuncli.study.model.setup import build_with_cuts  # imports NumPy, which other specs do not need

    return [f"{escape(spec.path)}: {warning}" for cut in build_with_cuts(spec)[1] for warning in cut.warnings]


def _format_summary(spec: Spec, warnings: int) -> str:
    """Format what a spec has, and its number of warnings."""
    parts = [format_count(len(spec.bodies), "body"), format_count(len(spec.joints), "joint")]
    parts += [format_count(len(spec.sections), "section")] if spec.sections else []
    parts += [format_count(warnings, "warning")] if warnings else []
    return ", ".join(parts)
