"""One spec against what it expects, and against what was kept of it. Runs in a process of its own, or in this one."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import starmap
from pathlib import Path

from heuncli.app.cli import alarm, memory
from heuncli.app.cli.entry import UsageError, contained, lines_of
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.solving import warning_lines
from heuncli.app.commands.check import goldens
from heuncli.app.commands.check.checked import Checked
from heuncli.app.commands.check.folders import Found
from heuncli.app.commands.check.kept_outcomes import NO_FILE, kept_outcomes
from heuncli.app.commands.check.request import CheckRequest
from heuncli.base.errors import Finding, HeunError, SpecError
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.keep import keep
from heuncli.output.snapshots.kept import ANOTHER, FORMAT, MOST_BYTES, KeptFile, KeptRun, KeptSpec, read_kept
from heuncli.output.snapshots.outcomes import EXPECTED, Outcome, outcome_of
from heuncli.output.snapshots.selection import told_by_default
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Expect, Spec
from heuncli.scene.file_format.reading import read_bytes
from heuncli.study.ask.expectations import compare
from heuncli.study.ask.study import Study
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.options import Options
from heuncli.study.model.selection import EVERYTHING, Selection, asked_by
from heuncli.study.workflow import solve
from heuncli.version import VERSION

STOPPED = "the scene was not solved"


class Task(NamedTuple):
    """A spec to be checked, and its golden file, if it is held against one; name: of the spec in that file."""

    found: Found
    file: str | None = None
    name: str = ""


def check(task: Task, request: CheckRequest, jobs: int) -> Checked:
    """Check one spec; jobs: among how many at work memory is shared."""
    path, begun = task.found.path, time.perf_counter()
    items: list[tuple[str, Expect]] = []
    try:
        if task.found.problem is not None:
            raise SpecError(task.found.problem)
        work = partial(alarm.limited, partial(_compared, task, request, jobs, items), request.time_limit_each)
        checked = contained(work, ("check", path))
    except UsageError as error:
        return Checked(path, problems=error.problems, error=error.exit_code, refused=True)
    except HeunError as error:
        placed = all(problem.location for problem in error.problems)
        lines = lines_of(error.problems, label="" if placed else f"{path}: ")
        outcomes = () if isinstance(error, goldens.GoldenError) else tuple(starmap(_skipped, items))
        checked = Checked(path, outcomes, error.problems, error.exit_code, said=tuple(lines))
    return checked._replace(seconds=time.perf_counter() - begun)


def _skipped(case: str, item: Expect) -> Outcome:
    """What would have been compared, of a spec that was not solved."""
    line, column = item.location.line, item.location.column
    return Outcome(EXPECTED, item.of, STOPPED, line, column, case=case, skipped=True)


def _compared(task: Task, request: CheckRequest, jobs: int, items: list[tuple[str, Expect]]) -> Checked:
    """What was found of a spec; items: what it expects, as soon as that is known."""
    path = task.found.path
    spec, cases = load_with_cases(path)
    scenes = {"": spec, **cases}
    items += [(name, item) for name, one in scenes.items() for item in one.expect]
    require_other_file(request.output, [path])
    require_other_file(request.junit, [path], "--junit")
    old = _golden(task, request) if task.file is not None else None
    outcomes: list[Outcome] = []
    said: list[str] = []
    runs: dict[str, KeptRun] = {}
    for name, one in scenes.items():
        study = _solved(one, task, request, jobs)
        outcomes += [outcome_of(compare(study, item), path, name) for item in one.expect]
        if task.file is not None:
            runs[name] = keep(study, told_by_default(one), _even_at(old, name))
        place = f"heun: {path}: case {name}" if name else f"heun: {path}"
        said += [] if request.quiet else warning_lines(one, study.results, place, study.later_warnings)
    golden = None
    if task.file is not None:
        more, golden = kept_outcomes(task.file, old, _file(task, spec, runs), request)
        outcomes += more
        if old is None and not request.update and not request.strict and not request.quiet:
            said.append(f"warning: {shown(path)}: {NO_FILE}")
        said += [f"note: {shown(path)}: {outcome.note}" for outcome in more if outcome.note and not request.quiet]
    alarm.disarm()
    return Checked(path, tuple(outcomes), said=tuple(said), golden=golden)


def _solved(spec: Spec, task: Task, request: CheckRequest, jobs: int) -> Study:
    """A scene with all that is to be compared."""
    asked = _asked(spec, task.file is not None)
    room, each = memory.room("table")
    options = Options(
        wanted=asked.reports, entries=asked.entries, time_limit=alarm.remaining(), room=Room(room / jobs, each),
        reduce=not request.no_reduce,
    )  # fmt: skip
    return solve(spec, options)


def _asked(spec: Spec, keeps: bool) -> Selection:
    """What of the results is needed: all that is expected, all that tables tell where that is kept."""
    asked = asked_by([path for item in spec.expect for path in item.paths], spec) if spec.expect else None
    if not keeps:
        return asked or EVERYTHING
    told = Selection(told_by_default(spec))
    return told if asked is None else told.with_all(asked)


def _golden(task: Task, request: CheckRequest) -> KeptFile | None:
    """What was kept of a spec; None where there is no file. Raises GoldenError."""
    assert task.file is not None and request.golden is not None
    goldens.require_inside(task.file, request.golden)
    if not Path(task.file).exists():
        return None
    try:
        kept = read_kept(read_bytes(task.file, MOST_BYTES).decode("utf-8"))
    except UnicodeDecodeError as error:
        raise goldens.told(task.file, Finding("not-golden", f"this is not UTF-8: {error.reason}", ANOTHER)) from None
    except Finding as finding:
        raise goldens.told(task.file, finding) from None
    if kept.spec.path != task.name:
        message = f"kept of another spec: {kept.spec.path}, not {task.name}"
        raise goldens.told(task.file, Finding("not-golden", message, "move it back, or remove it and --update"))
    return kept


def _file(task: Task, spec: Spec, runs: Mapping[str, KeptRun]) -> KeptFile:
    """The golden file of a spec as it would be written now."""
    tables = {name: _digest(table.x.tobytes() + table.y.tobytes()) for name, table in spec.tables.items()}
    cases = {name: run for name, run in runs.items() if name}
    of = KeptSpec(path=task.name, sha256=spec.sha256)
    return KeptFile(format=FORMAT, heun=VERSION, spec=of, tables=tables, base=runs[""], cases=cases)


def _even_at(old: KeptFile | None, case: str) -> Sequence[float]:
    """The even instants at which a run was kept."""
    run = None if old is None else old.cases.get(case) if case else old.base
    return run.even_at if run is not None else ()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
