"""`heun run`: read, solve, report."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from heuncli.cli import alarm, memory
from heuncli.cli.entry import UsageError
from heuncli.cli.guard import require_other_file
from heuncli.cli.output import emit
from heuncli.cli.solving import choice, overrides, solver_options
from heuncli.cli.target import format_of
from heuncli.cli.units import TABLES, say_what_stays, units
from heuncli.commands.run.request import FORMATS, RunRequest
from heuncli.commands.run.scene import RunTask, leave, solved
from heuncli.errors import Problem
from heuncli.kinetostatics.joint_axes import JOINT_AXES
from heuncli.nearest import did_you_mean, nearest
from heuncli.records import replace
from heuncli.report.page import EXPORT_DEFAULT
from heuncli.results_schema import REPORT_OF, REPORTS, SHARES, quantity, with_shared
from heuncli.spec.load import load, load_with_cases
from heuncli.spec.models import Spec
from heuncli.spec.names import ALL_CASES
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.selection import EntryKeys, Selection, asked_by, entries_of, entry_at
from heuncli.telling.selection import told_by_default

if TYPE_CHECKING:
    from heuncli.commands.run.collective import CollectiveTask
    from heuncli.study.ask.measure import MeasureRequest


def main(request: RunRequest) -> int:
    """Run the command; returns the exit code."""
    if request.watch:
        from heuncli.commands.run.watching import watch  # of few runs

        watch(request, main)
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    asked: list[MeasureRequest] = []
    if request.measure:
        from heuncli.cli import measure  # with paths and JSON 2 ms that tables do not need

        asked = measure.parse_all(request.measure)
    counted = _counted(request)
    only = _only(request.only) if request.only is not None else None
    shown = units(request.units)
    axes = "world" if request.axes is None else choice("--axes", request.axes, JOINT_AXES)
    options = replace(solver_options(request), axes=axes)
    begun = time.perf_counter()
    given = overrides(request.set)
    if request.case == ALL_CASES:
        spec, cases = load_with_cases(request.spec, given, checking=False)
    else:
        spec, cases = load(request.spec, overrides=given, checking=False, case=request.case), {}
    require_other_file(request.output, [request.spec])
    options = replace(options, load_seconds=time.perf_counter() - begun, time_limit=alarm.remaining())
    options = replace(options, room=Room(*memory.room("table" if asked or counted else form)))
    if asked:
        measure.check(asked, spec)
    if counted is not None:
        from heuncli.commands.run.collective import require_paths

        require_paths(counted, spec)
    paths = [each.path for each in asked] if counted is None else counted.paths
    what = asked_by(paths, spec) if paths else _asked(request, only, spec, form)
    exported = form not in TABLES and not paths and request.at is None and request.case != ALL_CASES
    options = replace(options, wanted=what.reports, entries=what.entries, in_parts=exported)
    task = RunTask(request, form, options, what, asked, shown, counted)
    if request.case == ALL_CASES:
        from heuncli.commands.run.cases import run_all  # of few runs

        return run_all(task, spec, cases)
    study, pieces = solved(task, spec)
    emit(pieces, request.output)
    say_what_stays(request.units, "--measure" if asked else form, request.quiet)
    return leave(task, spec, study)


def _counted(request: RunRequest) -> CollectiveTask | None:
    """The collectives that are asked for."""
    if all(getattr(request, name) is None for name in ("collective", "slope", "cycles", "bins", "repeat")):
        return None
    from heuncli.commands.run import collective  # with what counts

    if request.collective is None:
        collective.require_collective(request)
    return collective.parse(request)


def _only(words: str) -> tuple[frozenset[str], tuple[str, ...]]:
    """The reports of `--only`, and the paths of single entries; what is no report may be such."""
    names = [REPORT_OF.get(word.strip(), word.strip()) for word in words.split(",")]
    paths = tuple(name for name in names if name not in (*REPORTS, SHARES))
    for name in paths:
        if not all(part.isidentifier() or part.isdecimal() for part in name.split(".")):
            choice("--only", name, (*REPORTS, SHARES))
    return frozenset(names) - frozenset(paths), paths


def _asked(
    request: RunRequest, only: tuple[frozenset[str], tuple[str, ...]] | None, spec: Spec, form: str
) -> Selection:
    """What is asked for: by --only, else by the spec's `report`, else what the format shows by default."""
    wanted = told_by_default(spec) if form in TABLES or spec.report is not None else EXPORT_DEFAULT
    entries = frozenset[EntryKeys]()
    if only is not None:
        wanted, paths = only
        single = [_entry(path, spec) for path in paths]
        entries = frozenset(entry for entry in single if REPORT_OF[entry[0]] not in wanted)
        wanted = wanted | {REPORT_OF[entry[0]] for entry in single}
    return Selection(with_shared(wanted | {SHARES} if request.by_cause else wanted), entries)


def _entry(path: str, spec: Spec) -> EntryKeys:
    """The entry that a path of `--only` names."""
    words = path.split(".")
    known = entries_of(spec)
    entry, rest = entry_at(words, known)
    if entry is not None and not rest:
        return entry
    names = [".".join((*block, name)) for block, own in known.items() if block[0] == words[0] for name in own]
    message = f"--only {path}: not an entry of the results"
    if entry is not None:
        hint = f"say {'.'.join(entry)}; --measure prints single numbers"
    elif quantity(words) is not None and REPORT_OF.get(words[0]):
        hint = f"say {words[0]}; --measure prints single numbers"
    elif words[0] not in REPORT_OF:
        message = f"--only {path}: known: {', '.join((*REPORTS, SHARES))}, or entries of them, as joints.NAME"
        hint = _meant(path, known)
    else:
        hint = did_you_mean(path, names, "entries") if names else f"the scene has no {words[0]}"
    raise UsageError(Problem("bad-option", message, hint=hint))


def _meant(path: str, known: Mapping[EntryKeys, Mapping[str, Any]]) -> str:
    """What may be meant by a path of `--only` that begins with no block."""
    from heuncli.path_hints import meant  # only on the way to an error

    entry = meant(path, lambda words: entry_at(words, known)[0] is not None)
    if entry is not None:
        return f"did you mean {'.'.join(entry_at(entry.split('.'), known)[0] or ())}?"
    near = nearest(path, (*REPORTS, SHARES))
    return f"did you mean {near}?" if near else "such as --only foundation,joints.NAME"
