"""`heun chart`: compare speed and accuracy of the integration methods on the user's scene."""

from __future__ import annotations

import math

from heuncli.analyses.work_precision.plan import ChartOptions
from heuncli.analyses.work_precision.study import chart
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.figure_options import require_save_form
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import save
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.solving import parse_overrides, print_warnings
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.chart.page import make_document
from heuncli.app.commands.chart.request import ChartRequest
from heuncli.base.errors import Problem
from heuncli.base.method_rows import AUTO, METHODS, find_method
from heuncli.base.records import replace
from heuncli.output.drawing.drawing_files import encode_drawing
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.methods import method_hint


def main(request: ChartRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    figure_form = require_save_form(request.save, request.output)
    options = ChartOptions(
        parse_methods(request.methods),
        parse_numbers("--tolerances", request.tolerances, 1.0),
        parse_numbers("--steps", request.steps, math.inf),
    )
    spec = load(request.spec, overrides=parse_overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    with show_progress(request.quiet) as report:
        results = chart(spec, replace(options, time_limit=timeout.remaining_time()), report)
    if figure_form is not None and request.save is not None:
        from heuncli.output.drawing.layout import lay_out
        from heuncli.output.figures.work_precision import make_work_precision_figure

        save(encode_drawing(lay_out(make_work_precision_figure(results)), figure_form), request.save)
    emit_document(make_document(results), form, request.output, late=True)
    print_warnings(spec, None, request.quiet)
    return 0


def parse_methods(words: str | None) -> tuple[str, ...] | None:
    """Parse the names of `--methods` as the registry writes them."""
    if words is None:
        return None
    method_names = []
    for word in words.split(","):
        row = find_method(word.strip())
        if row is None:
            names = [each.name for each in METHODS]
            hint = method_hint(word.strip())
            if word.strip().lower() == AUTO:
                hint = f"auto is not a single method; accepted: {', '.join(names)}"
            raise UsageError(Problem("bad-option", f"--methods {word.strip()}: unknown method", hint=hint))
        method_names.append(row.name)
    return tuple(dict.fromkeys(method_names))


def parse_numbers(option: str, words: str | None, upper_bound: float) -> tuple[float, ...] | None:
    """Parse positive numbers separated by commas, all below a bound."""
    if words is None:
        return None
    try:
        values = [float(word) for word in words.split(",")]
    except ValueError:
        hint = f"for example {option} 1e-4,1e-6"
        raise UsageError(Problem("bad-option", f"{option} {words}: expected numbers", hint=hint)) from None
    for value in values:
        if not (0.0 < value < upper_bound and math.isfinite(value)):
            limit = "" if upper_bound == math.inf else f" below {upper_bound:g}"
            raise UsageError(
                Problem(
                    "bad-option",
                    f"{option} {value:g}: expected positive numbers{limit}",
                    hint=f"for example {option} 1e-4,1e-6",
                )
            )
    return tuple(values)
