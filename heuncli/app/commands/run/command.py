"""`heun run`: read, solve, report."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from heuncli.app.api import read
from heuncli.app.cli import alarm, memory
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import choice, overrides, solver_options
from heuncli.app.cli.target import format_of
from heuncli.app.cli.units import TABLES, say_what_stays, units
from heuncli.app.commands.run.request import FORMATS, RunRequest
from heuncli.app.commands.run.scene import RunTask, leave, solved
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.joint_axes import JOINT_AXES
from heuncli.output.snapshots.selection import only, selected, told_by_default
from heuncli.output.tables.page import EXPORT_DEFAULT
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.selection import asked_by

if TYPE_CHECKING:
    from heuncli.app.commands.run.collective import CollectiveTask
    from heuncli.study.ask.measure import MeasureRequest


def main(request: RunRequest) -> int:
    """Run the command; returns the exit code."""
    if request.watch:
        from heuncli.app.commands.run.watching import watch  # of few runs

        watch(request, main)
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    asked: list[MeasureRequest] = []
    if request.measure:
        from heuncli.output.snapshots import measure  # with paths and JSON 2 ms that tables do not need

        asked = measure.parse_all(request.measure)
    counted = _counted(request)
    alone = only(request.only.split(",")) if request.only is not None else None
    shown = units(request.units)
    axes = "world" if request.axes is None else choice("--axes", request.axes, JOINT_AXES)
    options = replace(solver_options(request), axes=axes)
    begun = time.perf_counter()
    spec, cases = read(request.spec, overrides(request.set), request.case)
    require_other_file(request.output, [request.spec])
    options = replace(options, load_seconds=time.perf_counter() - begun, time_limit=alarm.remaining())
    options = replace(options, room=Room(*memory.room("table" if asked or counted else form)))
    if asked:
        measure.check(asked, spec)
    if counted is not None:
        from heuncli.app.commands.run.collective import require_paths

        require_paths(counted, spec)
    paths = [each.path for each in asked] if counted is None else counted.paths
    if paths:
        what = asked_by(paths, spec)
    else:
        default = told_by_default(spec) if form in TABLES or spec.report is not None else EXPORT_DEFAULT
        what = selected(alone, spec, default, by_cause=request.by_cause)
    exported = form not in TABLES and not paths and request.at is None and request.case != ALL_CASES
    options = replace(options, wanted=what.reports, entries=what.entries, in_parts=exported)
    task = RunTask(request, form, options, what, asked, shown, counted)
    if request.case == ALL_CASES:
        from heuncli.app.commands.run.cases import run_all  # of few runs

        return run_all(task, spec, cases)
    study, pieces = solved(task, spec)
    emit(pieces, request.output)
    say_what_stays(request.units, "--measure" if asked else form, request.quiet)
    return leave(task, spec, study)


def _counted(request: RunRequest) -> CollectiveTask | None:
    """The collectives that are asked for. Raises UsageError."""
    if all(getattr(request, name) is None for name in ("collective", "slope", "cycles", "bins", "repeat")):
        return None
    from heuncli.app.commands.run import collective  # with what counts

    if request.collective is None:
        collective.require_collective(request)
    return collective.parse(request)
