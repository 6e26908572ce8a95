"""Check one spec against what it expects and against its golden file. Runs in a process of its own, or in this one."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import starmap
from pathlib import Path

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError, format_problems, run_contained
from heuncli.app.cli.solving import format_warnings
from heuncli.app.cli.target import require_other_file
from heuncli.app.commands.check.golden import NO_FILE, GoldenError, compare_golden, make_golden_error, require_inside
from heuncli.app.commands.check.request import CheckRequest
from heuncli.app.commands.check.results import CheckResult
from heuncli.app.commands.check.spec_files import FoundSpec
from heuncli.base.errors import Finding, HeunError, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.process import result_memory
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.golden_file import (
    FORMAT,
    MAX_BYTES,
    REWRITE_HINT,
    GoldenFile,
    RunSnapshot,
    SpecDigest,
    read_golden_file,
)
from heuncli.output.snapshots.outcomes import EXPECTED, Outcome, make_outcome
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.output.tables.report_selection import find_default_reports
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Expect, Spec
from heuncli.scene.file_format.reading import read_bytes
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.options import Options
from heuncli.study.model.selection import EVERYTHING, Selection, select_paths
from heuncli.study.queries.expectations import compare
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from heuncli.version import VERSION

STOPPED = "the model was not solved"


class CheckTask(NamedTuple):
    """A spec to check.

    spec: the spec
    file: its golden file, if it is compared with one
    name: the spec's name in that file
    """

    spec: FoundSpec
    file: str | None = None
    name: str = ""


def check_spec(task: CheckTask, request: CheckRequest, jobs: int) -> CheckResult:
    """Check one spec.

    jobs: number of processes that share the memory
    """
    path, start = task.spec.path, time.perf_counter()
    items: list[tuple[str, Expect]] = []
    try:
        if task.spec.problem is not None:
            raise SpecError(task.spec.problem)
        work = partial(
            timeout.run_with_limit, partial(_compare_spec, task, request, jobs, items), request.time_limit_each
        )
        checked = run_contained(work, ("check", path))
    except UsageError as error:
        return CheckResult(path, problems=error.problems, error=error.exit_code, is_usage_error=True)
    except HeunError as error:
        has_locations = all(problem.location for problem in error.problems)
        lines = format_problems(error.problems, label="" if has_locations else f"{path}: ")
        outcomes = () if isinstance(error, GoldenError) else tuple(starmap(_make_skipped_outcome, items))
        checked = CheckResult(path, outcomes, error.problems, error.exit_code, messages=tuple(lines))
    return checked._replace(seconds=time.perf_counter() - start)


def _make_skipped_outcome(case: str, item: Expect) -> Outcome:
    """Make the outcome of an expectation of a spec that was not solved."""
    line, column = item.location.line, item.location.column
    return Outcome(EXPECTED, item.of, STOPPED, line, column, case=case, is_skipped=True)


def _compare_spec(task: CheckTask, request: CheckRequest, jobs: int, items: list[tuple[str, Expect]]) -> CheckResult:
    """Solve a spec and compare it; adds its expectations to `items` as soon as they are known."""
    path = task.spec.path
    spec, cases = load_with_cases(path)
    scenes = {"": spec, **cases}
    items += [(name, item) for name, one in scenes.items() for item in one.expect]
    require_other_file(request.output, [path])
    require_other_file(request.junit, [path], "--junit")
    old = _read_golden(task, request) if task.file is not None else None
    outcomes: list[Outcome] = []
    messages: list[str] = []
    runs: dict[str, RunSnapshot] = {}
    for name, one in scenes.items():
        study = _solve_scene(one, task, request, jobs)
        outcomes += [make_outcome(compare(study, item), path, name) for item in one.expect]
        if task.file is not None:
            runs[name] = take_run_snapshot(study, find_default_reports(one), _find_even_instants(old, name))
        place = f"heun: {path}: case {name}" if name else f"heun: {path}"
        messages += [] if request.quiet else format_warnings(one, study.results, place, study.later_warnings)
    golden = None
    if task.file is not None:
        golden_outcomes, golden = compare_golden(task.file, old, _make_golden(task, spec, runs), request)
        outcomes += golden_outcomes
        if old is None and not request.update and not request.strict and not request.quiet:
            messages.append(f"warning: {escape(path)}: {NO_FILE}")
        messages += [
            f"note: {escape(path)}: {outcome.note}" for outcome in golden_outcomes if outcome.note and not request.quiet
        ]
    timeout.disarm()
    return CheckResult(path, tuple(outcomes), messages=tuple(messages), golden=golden)


def _solve_scene(spec: Spec, task: CheckTask, request: CheckRequest, jobs: int) -> Study:
    """Solve a scene for all that is compared."""
    selection = _select_results(spec, task.file is not None)
    available, bytes_each = result_memory("table")
    options = Options(
        requested_reports=selection.reports,
        entries=selection.entries,
        time_limit=timeout.remaining_time(),
        memory_budget=MemoryBudget(available / jobs, bytes_each),
        reduce=not request.no_reduce,
    )
    return solve(spec, options)


def _select_results(spec: Spec, has_golden: bool) -> Selection:
    """Return the results that are needed: all that is expected, and with a golden file all that tables show."""
    expected = select_paths([path for item in spec.expect for path in item.paths], spec) if spec.expect else None
    if not has_golden:
        return expected or EVERYTHING
    default = Selection(find_default_reports(spec))
    return default if expected is None else default.union(expected)


def _read_golden(task: CheckTask, request: CheckRequest) -> GoldenFile | None:
    """Read the golden file of a spec, or return None if there is none. Raises GoldenError."""
    assert task.file is not None and request.golden is not None
    require_inside(task.file, request.golden)
    if not Path(task.file).exists():
        return None
    try:
        golden_file = read_golden_file(read_bytes(task.file, MAX_BYTES).decode("utf-8"))
    except UnicodeDecodeError as error:
        raise make_golden_error(
            task.file, Finding("not-golden", f"this is not UTF-8: {error.reason}", REWRITE_HINT)
        ) from None
    except Finding as finding:
        raise make_golden_error(task.file, finding) from None
    if golden_file.spec.path != task.name:
        message = f"golden file of another spec: {golden_file.spec.path}, not {task.name}"
        raise make_golden_error(
            task.file, Finding("not-golden", message, "move it back, or remove it and use --update")
        )
    return golden_file


def _make_golden(task: CheckTask, spec: Spec, runs: Mapping[str, RunSnapshot]) -> GoldenFile:
    """Make the golden file of a spec as it would be written now."""
    tables = {name: _compute_digest(table.x.tobytes() + table.y.tobytes()) for name, table in spec.tables.items()}
    cases = {name: run for name, run in runs.items() if name}
    spec_entry = SpecDigest(path=task.name, sha256=spec.sha256)
    return GoldenFile(format=FORMAT, heun=VERSION, spec=spec_entry, tables=tables, base=runs[""], cases=cases)


def _find_even_instants(old: GoldenFile | None, case: str) -> Sequence[float]:
    """Return the instants at equal steps that the golden file holds for a case."""
    run = None if old is None else old.cases.get(case) if case else old.base
    return run.even_at if run is not None else ()


def _compute_digest(content: bytes) -> str:
    """Compute the SHA-256 of a file."""
    return hashlib.sha256(content).hexdigest()
