"""`heun check`: specs and folders of specs against what they expect."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from heuncli.cli import alarm, memory
from heuncli.cli.entry import UsageError, contained, report_problems, worst
from heuncli.cli.guard import require_other_file
from heuncli.cli.output import emit, say
from heuncli.cli.solving import warn
from heuncli.cli.target import format_of
from heuncli.commands.check.folders import Found, PassedBy, specs_below
from heuncli.commands.check.request import CheckRequest
from heuncli.errors import HeunError, Problem, SpecError
from heuncli.foreign_text import shown
from heuncli.records import record
from heuncli.report.digits import OPEN
from heuncli.report.export import dump
from heuncli.report.plurals import count
from heuncli.report.text_table import TextColumn, TextTable, plain
from heuncli.results import Array
from heuncli.spec.load import load
from heuncli.study.ask.expectations import Case, compare
from heuncli.study.model.memory_estimate import Room
from heuncli.study.model.options import Options
from heuncli.study.model.selection import EVERYTHING, asked_by
from heuncli.study.workflow import solve

FORMATS = ("table", "json")
ENDINGS = {".json": "json", ".txt": "table", "": "table"}
FAILED = 1
NAMED = "name a folder of specs, or the files themselves; folders named broken and hidden ones are passed by"


@record
class Checked:
    """One file: its cases, or the error that kept it from being solved."""

    path: str
    cases: tuple[Case, ...]
    error: HeunError | None = None

    @property
    def exit_code(self) -> int:
        """What this file alone would leave with."""
        if self.error is not None:
            return self.error.exit_code
        return 0 if all(case.passed for case in self.cases) else FAILED


def main(request: CheckRequest) -> int:
    """Run the command; returns the exit code."""
    skipped: list[PassedBy] = []
    found = [one for argument in request.paths for one in specs_below(argument, skipped)]
    paths = [one.path for one in found]
    for folder in skipped if not request.quiet else ():
        if folder.reason:
            say(f"heun: {shown(folder.path)} passed by: {shown(folder.reason)}")
    if not paths:
        raise UsageError(Problem("nothing-to-check", f"no *.yaml in {', '.join(request.paths)}", hint=NAMED))
    require_other_file(request.output, paths)
    form = format_of(request.format, request.output, ENDINGS, FORMATS)
    checked = [_check(one, request) for one in found]
    require_other_file(request.output, paths)  # the tables of specs that are wrong, too
    if any(one.error is None for one in checked):  # with errors alone there is no result
        emit(_json(checked) if form == "json" else _table(checked, skipped), request.output)
    return worst([one.exit_code for one in checked])


def _check(found: Found, request: CheckRequest) -> Checked:
    path = found.path
    try:
        if found.problem is not None:
            raise SpecError(found.problem)
        work = partial(alarm.limited, partial(_compared, path, request), request.time_limit_each)
        return contained(work, ("check", path))
    except UsageError:
        raise
    except HeunError as error:
        report_problems(error.problems, label="" if _placed(error) else f"{path}: ")
        return Checked(path, (), error.with_traceback(None))  # whose frames hold all that was solved


def _compared(path: str, request: CheckRequest) -> Checked:
    spec = load(path)
    require_other_file(request.output, [path])
    asked = asked_by([item.of for item in spec.expect], spec) if spec.expect else EVERYTHING
    room = Room(*memory.room("table"))
    options = Options(wanted=asked.reports, entries=asked.entries, time_limit=alarm.remaining(), room=room)
    study = solve(spec, options)
    cases = tuple(compare(study, item) for item in spec.expect)
    alarm.disarm()
    warn(spec, study.results, request.quiet, f"heun: {path}", study.later_warnings)
    return Checked(path, cases)


def _placed(error: HeunError) -> bool:
    return all(problem.location for problem in error.problems)


def _table(checked: Sequence[Checked], skipped: Sequence[PassedBy]) -> str:
    cases = [case for one in checked for case in one.cases]
    rows = tuple(
        (
            f"{one.path}:{case.location.line}",
            case.of,
            case.when,
            _expected(case),
            _text(case.found),
            case.failure or "",
        )
        for one in checked
        for case in one.cases
        if not case.passed
    )
    heads = ("file", "of", "at", "expected", "found", "why it fails")
    failures = TextTable("FAILED", tuple(TextColumn(head, "left") for head in heads), rows)
    errors = sum(one.error is not None for one in checked)
    silent = sum(not one.cases and one.error is None for one in checked)
    parts = [count(len(checked), "spec"), f"{sum(case.passed for case in cases)} passed", f"{len(rows)} failed"]
    parts += [f"{count(errors, 'spec')} not solved"] if errors else []
    parts += [f"{count(silent, 'spec')} ran with nothing expected"] if silent else []
    parts += [f"{shown(folder.path)} passed by" for folder in skipped]
    return (plain(failures) + "\n" if rows else "") + ", ".join(parts) + "\n"


def _json(checked: Sequence[Checked]) -> str:
    cases: list[dict[str, Any]] = []
    for one in checked:
        if one.error is not None:
            cases.append({"file": one.path, "passed": False, "exit": one.exit_code, "message": str(one.error)})
        elif not one.cases:
            cases.append({"file": one.path, "passed": True, "message": "ran; nothing expected"})
        for case in one.cases:
            cases.append(
                {
                    "file": one.path,
                    "line": case.location.line,
                    "of": case.of,
                    "when": case.when,
                    **_wanted(case),
                    "passed": case.passed,
                    "message": case.failure or "",
                }
            )
    passed = sum(bool(case["passed"]) for case in cases)
    return dump({"passed": passed, "failed": len(cases) - passed, "cases": cases})


def _wanted(case: Case) -> dict[str, Any]:
    """What was expected and found; of bounds the extreme that decides, with its instant and place."""
    if case.below is None and case.above is None:
        return {"expected": case.expected, "found": case.found, "tolerance": case.tolerance}
    bounds = {"below": case.below, "above": case.above}
    block: dict[str, Any] = {key: bound for key, bound in bounds.items() if bound is not None}
    block |= {"found": case.found, "at": case.extreme.at if case.extreme is not None else None}
    return block | (case.extreme.place._asdict() if case.extreme is not None and case.extreme.place is not None else {})


def _expected(case: Case) -> str:
    bounds = [f"{word} {bound:.9g}" for word, bound in (("above", case.above), ("below", case.below))
              if bound is not None]  # fmt: skip
    return ", ".join(bounds) or _text(case.expected)


def _text(values: Array | None) -> str:
    if values is None:
        return ""
    texts = [OPEN if np.isnan(value) else f"{value:.9g}" for value in np.ravel(values)[:6]]
    more = ", ..." if values.size > len(texts) else ""
    return texts[0] if values.ndim == 0 else f"[{', '.join(texts)}{more}]"
