"""`heun chart`: speed against accuracy of the methods, on the user's own scene."""

from __future__ import annotations

import math

from heuncli.analyses.charting.plan import ChartOptions
from heuncli.analyses.charting.results import ChartResults
from heuncli.analyses.charting.study import chart
from heuncli.app.cli import alarm
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.picture_files import saved_beside
from heuncli.app.cli.progress import progress
from heuncli.app.cli.solving import overrides, warn
from heuncli.app.cli.target import format_of
from heuncli.app.commands.charting import page as report
from heuncli.app.commands.charting.request import ChartRequest
from heuncli.base.errors import Problem
from heuncli.base.method_rows import AUTO, METHODS, row_of
from heuncli.base.records import replace
from heuncli.output.drawing.as_file import as_file
from heuncli.output.tables.export import dump
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, plain
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.methods import meant

LEAST_WIDTH = 60  # of a terminal that a chart is drawn for


def main(request: ChartRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    drawn = saved_beside(request.save, request.output)
    wanted = ChartOptions(
        methods(request.methods),
        numbers("--tolerances", request.tolerances, 1.0),
        numbers("--steps", request.steps, math.inf),
    )
    spec = load(request.spec, overrides=overrides(request.set), checking=False, case=request.case)
    require_other_file(request.output, [request.spec])
    if request.save is not None:
        require_other_file(request.save, [request.spec], "--save")
    with progress(request.quiet) as tell:
        found = chart(spec, replace(wanted, time_limit=alarm.remaining()), tell)
    if drawn is not None and request.save is not None:
        from heuncli.app.commands.charting.picture import picture

        save(as_file(picture(found), drawn), request.save)
    emit(text(found, form, request.output), request.output, late=True)
    warn(spec, None, request.quiet)
    return 0


def text(found: ChartResults, form: str, output: str | None) -> str:
    """The chart in one of the formats."""
    if form == "json":
        return dump(report.block(found))
    if form == "csv":
        return report.to_csv(found)
    from heuncli.app.cli import terminal
    from heuncli.app.commands.charting.letters import WIDTH as FIELD
    from heuncli.app.commands.charting.letters import draw

    own = report.table(found)
    if output is None and terminal.present():
        width = min(max(terminal.width() - 1, LEAST_WIDTH), WIDTH)
        rows = "".join(terminal.write([own]))
    else:
        width = WIDTH
        rows = "".join(plain(part, WIDTH) for part in fit(own, WIDTH))
    return f"{report.write_heading(found, width)}\n{rows}\n{draw(found, min(width, FIELD))}"


def methods(words: str | None) -> tuple[str, ...] | None:
    """The names of `--methods` as the registry writes them."""
    if words is None:
        return None
    found = []
    for word in words.split(","):
        row = row_of(word.strip())
        if row is None:
            names = [each.name for each in METHODS]
            hint = meant(word.strip())
            if word.strip().lower() == AUTO:
                hint = f"auto chooses among these: {', '.join(names)}"
            raise UsageError(Problem("bad-option", f"--methods {word.strip()}: not a method", hint=hint))
        found.append(row.name)
    return tuple(dict.fromkeys(found))


def numbers(option: str, words: str | None, below: float) -> tuple[float, ...] | None:
    """Positive numbers between commas, all below a bound."""
    if words is None:
        return None
    try:
        found = [float(word) for word in words.split(",")]
    except ValueError:
        hint = f"such as {option} 1e-4,1e-6"
        raise UsageError(Problem("bad-option", f"{option} {words}: expected numbers", hint=hint)) from None
    for value in found:
        if not (0.0 < value < below and math.isfinite(value)):
            limit = "" if below == math.inf else f" below {below:g}"
            raise UsageError(
                Problem(
                    "bad-option",
                    f"{option} {value:g}: expected positive numbers{limit}",
                    hint=f"such as {option} 1e-4,1e-6",
                )
            )
    return tuple(found)
