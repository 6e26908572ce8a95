"""`heun run`: solve a scene, and report its loads and motion.

`--watch` runs again whenever the spec, or a file that it reads, is saved. Checking the status of the files five times a
second works on every system, and also notices editors that replace the old file by a new one. Impure: files, time,
terminal.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

from heuncli.app.api import read
from heuncli.app.cli import terminal, timeout
from heuncli.app.cli.entry import UsageError, report_problems, run_contained
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.solving import (
    apply_captions,
    apply_captions_to_cases,
    make_solver_options,
    parse_overrides,
    require_choice,
)
from heuncli.app.cli.target import TABLES, choose_format, note_si_format, parse_units, require_other_file
from heuncli.app.commands.run.request import FORMATS, RunRequest
from heuncli.app.commands.run.scene import RunTask, finish, note_measure_units, solve_and_render
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.process import result_memory
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.loads.kinetostatics.reactions import JOINT_AXES
from heuncli.output.tables.page import EXPORT_DEFAULT
from heuncli.output.tables.report_selection import ReportChoice, find_default_reports, parse_choice, select_reports
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import ALL_CASES, as_mapping
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.scene.file_format.source import read_source
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.selection import Selection, select_paths

if TYPE_CHECKING:
    from pathlib import Path

    from heuncli.app.commands.run.collective import CollectiveTask
    from heuncli.study.queries.measure import MeasureRequest


HARDPOINT_REPORTS = frozenset({"joints", "forces"})


def main(request: RunRequest) -> int:
    """Run the command; returns the exit code."""
    if request.watch:
        watch(request, main)  # never returns
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    measures = _parse_measures(request)
    collectives = _parse_collectives(request)
    only_selection = parse_choice(request.only.split(",")) if request.only is not None else None
    units_shown = parse_units(request.units)
    is_overview = request.summary or request.hardpoints
    if is_overview:
        from heuncli.app.commands.run.overview import require_alone  # of few runs

        require_alone(request)
    options = replace(make_solver_options(request.solver), axes=_choose_axes(request))
    start = time.perf_counter()
    spec, cases = read(request.spec, parse_overrides(request.set), request.case)
    spec, cases = apply_captions(spec, request.captions), apply_captions_to_cases(cases, request.captions)
    require_other_file(request.output, [request.spec])
    options = replace(options, load_seconds=time.perf_counter() - start, time_limit=timeout.remaining_time())
    options = replace(options, memory_budget=MemoryBudget(*result_memory("table" if measures or collectives else form)))
    paths = _require_paths(request, spec, measures, collectives)
    is_table = form in TABLES or is_overview
    selection = _select_results(request, spec, paths, only_selection, is_table=is_table)
    is_export = not (is_table or paths) and request.at is None and request.case != ALL_CASES
    options = replace(options, requested_reports=selection.reports, entries=selection.entries, in_parts=is_export)
    task = RunTask(request, form, options, selection, measures, units_shown, collectives)
    if is_overview:
        from heuncli.app.commands.run.overview import run_overview

        return run_overview(task, spec, cases)
    if request.case == ALL_CASES:
        from heuncli.app.commands.run.cases import run_all  # of few runs

        return run_all(task, spec, cases)
    study, pieces, _ = solve_and_render(task, spec)
    emit(pieces, request.output)
    if measures:
        note_measure_units(task, study)
    else:
        note_si_format(request.units, form, request.quiet)
    return finish(task, spec, study)


def _parse_measures(request: RunRequest) -> list[MeasureRequest]:
    """Parse each --measure; empty if none is given. Raises UsageError."""
    if not request.measure:
        return []
    from heuncli.output.tables import measure  # with paths and JSON 2 ms that tables do not need

    return measure.parse_measures(request.measure)


def _choose_axes(request: RunRequest) -> str:
    """Return the axes of joint loads; hardpoints are turned afterwards, and may have the axes of any body. Raises
    UsageError.
    """
    if request.axes is None or request.hardpoints:
        return "world"
    return require_choice("--axes", request.axes, JOINT_AXES)


def _select_results(
    request: RunRequest, spec: Spec, paths: Sequence[str], report_choice: ReportChoice | None, *, is_table: bool
) -> Selection:
    """Select the results to compute: those of hardpoints, those that paths need, or the chosen or default reports."""
    if request.hardpoints:
        require_choice("--axes", request.axes or "world", (*JOINT_AXES, *spec.bodies))
        return Selection(HARDPOINT_REPORTS)
    if paths:
        return select_paths(paths, spec)
    default = find_default_reports(spec) if is_table or spec.report.results is not None else EXPORT_DEFAULT
    return select_reports(report_choice, spec, default, by_cause=request.by_cause)


def _parse_collectives(request: RunRequest) -> CollectiveTask | None:
    """Parse the requested collectives; None if there are none. Raises UsageError."""
    if all(getattr(request, name) is None for name in ("collective", "slope", "cycles", "bins", "repeat")):
        return None
    from heuncli.app.commands.run import collective  # imports the cycle counting

    if request.collective is None:
        collective.require_collective(request)
    return collective.parse_task(request)


def _require_paths(
    request: RunRequest, spec: Spec, measures: Sequence[MeasureRequest], collectives: CollectiveTask | None
) -> Sequence[str]:
    """Return the paths of the measures or collectives. Raises an error if the spec has no such results, or a unit does
    not fit.
    """
    if measures:
        from heuncli.output.tables import measure

        measure.require_known_paths(measures, spec)
        measure.require_fitting_units(measures, spec, parse_units(request.units), request.units)
    if collectives is None:
        return [each.path for each in measures]
    from heuncli.app.commands.run.collective import require_paths

    require_paths(collectives, spec)
    return collectives.paths


CHECK_INTERVAL = 0.2  # s between two checks
CLEAR = "\x1b[2J\x1b[3J\x1b[H"
State = tuple[tuple[str, int, int, int] | None, ...]


def watch(request: RunRequest, run: Callable[[RunRequest], int]) -> NoReturn:
    """Run again after each change, until interrupted. Raises UsageError if there is no file to watch."""
    for is_given, word in ((request.time_limit is not None, "--time-limit"), (request.spec == STANDARD_INPUT, "-")):
        if is_given:
            hint = "leave it out; --watch runs until Ctrl-C and needs a file"
            raise UsageError(Problem("bad-option", f"--watch and {word} cannot be combined", hint=hint))
    single_run = request._replace(watch=False)
    while True:
        old_state = read_state(request.spec)
        _clear_screen()
        try:
            run_contained(lambda: run(single_run), ("run", request.spec))
        except HeunError as error:
            report_problems(error.problems)
        if not request.quiet:
            print_stderr(f"heun: watching {escape(request.spec)}; Ctrl-C stops it")
        _wait_for_change(request.spec, old_state)


def _wait_for_change(spec: str, old_state: State) -> None:
    """Return once the files are saved; the spec is missing for a moment while an editor replaces it."""
    while True:
        state = read_state(spec)
        if state != old_state and state[0] is not None:
            return
        time.sleep(CHECK_INTERVAL)


def _clear_screen() -> None:
    """Clear the screen, if there is one."""
    if terminal.is_terminal() and terminal.supports_styles():
        sys.stdout.write(CLEAR)
        sys.stdout.flush()


def read_state(spec: str) -> State:
    """Return the status of the spec and of the files that it names; it differs after a save."""
    from pathlib import Path  # 3 ms that a single run does not need

    return tuple(_read_stamp(Path(name)) for name in (spec, *_iter_files(spec)))


def _read_stamp(path: Path) -> tuple[str, int, int, int] | None:
    """Return what changes when a file is saved; None if it is missing."""
    try:
        status = path.stat()
    except OSError:
        return None
    return str(path), status.st_mtime_ns, status.st_size, status.st_ino


FILE_KEYS = frozenset({"file", "curve", "logo"})  # of tables and meshes, of expected curves, of reports


def _iter_files(spec: str) -> Iterator[str]:
    """Yield the files that a spec names; none while it cannot be read."""
    from pathlib import Path

    try:
        data = as_mapping(read_source(spec, None).data)
    except (HeunError, Finding):
        return
    yield from (str(Path(spec).parent / name) for name in _iter_file_names(data))


def _iter_file_names(data: Any) -> Iterator[str]:
    """Yield the texts under a key of a file anywhere in a spec; the keys that a load case sets are dotted."""
    if isinstance(data, list):
        for item in data:
            yield from _iter_file_names(item)
    for key, value in as_mapping(data).items():
        if isinstance(value, str) and str(key).rpartition(".")[2] in FILE_KEYS:
            yield value
        else:
            yield from _iter_file_names(value)
