"""`heun check --references [NAME...]`: the cases that others published, solved and held against what they printed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

from heuncli.analyses.published.cases import case_of
from heuncli.analyses.published.compared import compared
from heuncli.analyses.published.files import names
from heuncli.app.cli import alarm, jobs
from heuncli.app.cli.entry import BUG, UsageError, contained, lines_of, say_what_explains, worst
from heuncli.app.cli.output import as_bytes, emit, say
from heuncli.app.cli.progress import progress
from heuncli.app.cli.target import format_of
from heuncli.app.commands.check.checked import Checked
from heuncli.app.commands.check.references_told import FORMS, CheckedCase, outcomes_of
from heuncli.app.commands.check.request import FORMATS, CheckRequest
from heuncli.app.commands.check.told import AllChecked, for_github
from heuncli.base import files
from heuncli.base.errors import HeunError, Problem
from heuncli.base.nearest import did_you_mean
from heuncli.study.model.options import Options

NOT_WITH = (("--golden", "golden"), ("--update", "update"), ("--strict", "strict"), ("-k", "select"))
PLACE = "heuncli/analyses/published/numbers/{}.yaml"


def require_alone(request: CheckRequest) -> None:
    """Raise UsageError where --references stands with options that mean nothing beside it."""
    for word, field in NOT_WITH:
        if getattr(request, field):
            hint = "published cases are held against what was printed, and nothing else"
            raise UsageError(Problem("bad-option", f"--references with {word}: these do not go together", hint=hint))


def main(request: CheckRequest) -> tuple[int, list[Checked]]:
    """Check the cases; returns the exit code, and what was found of each."""
    chosen = _chosen(request)
    form = format_of(request.format, request.output, FORMATS)
    checked = _all(chosen, request)
    own = [one.checked for one in checked]
    text = for_github(AllChecked(own)) if form == "github" else FORMS[form](checked, bool(request.paths))
    emit(text, request.output)
    if request.junit is not None:
        from heuncli.app.commands.check.junit import junit_text

        files.write(as_bytes(junit_text(own, (), strict=False)), request.junit)
    say_what_explains([problem for one in own for problem in one.problems])
    return worst([one.exit_code for one in checked]), own


def _chosen(request: CheckRequest) -> Sequence[str]:
    """The names asked for, else all. Raises UsageError."""
    known = names()
    for name in request.paths:
        if name not in known:
            hint = did_you_mean(name, known, "cases")
            raise UsageError(Problem("bad-option", f"--references {name}: there is no such published case", hint=hint))
    return tuple(dict.fromkeys(request.paths)) or known


def _all(chosen: Sequence[str], request: CheckRequest) -> list[CheckedCase]:
    at_once = jobs.how_many(request.jobs, len(chosen))
    is_last = _fails if request.first else _none
    checked: list[CheckedCase] = []
    with progress(request.quiet) as tell:
        apart = request.time_limit_each is not None
        for one in jobs.each(partial(check, request=request), chosen, at_once, _dead, is_last, apart=apart):
            checked.append(one)
            for line in one.checked.said:
                say(line)
            tell(len(checked), len(chosen), one.case.name)
    return checked


def check(name: str, request: CheckRequest) -> CheckedCase:
    """One case, solved and compared."""
    begun, case = time.perf_counter(), case_of(name)
    place = PLACE.format(name)

    def work() -> CheckedCase:
        options = Options(time_limit=alarm.remaining(), reduce=not request.no_reduce)
        tables = compared(case, options)
        alarm.disarm()
        return CheckedCase(case, tables, Checked(place, tuple(outcomes_of(tables))))

    try:
        found = contained(partial(alarm.limited, work, request.time_limit_each), ("check", "--references", name))
    except HeunError as error:
        said = tuple(lines_of(error.problems, label=f"{name}: "))
        found = CheckedCase(case, (), Checked(place, (), error.problems, error.exit_code, said=said))
    return found._replace(checked=found.checked._replace(seconds=time.perf_counter() - begun))


def _fails(one: CheckedCase) -> bool:
    return bool(one.exit_code)


def _none(one: CheckedCase) -> bool:
    return False


def _dead(name: str, died: jobs.Died) -> CheckedCase:
    """What stands for a case whose process died."""
    problem = died.problem("checked it", "please report it")
    said = tuple(lines_of([problem], f"{name}: "))
    error = died.code if died.is_time_up else BUG
    return CheckedCase(case_of(name), (), Checked(PLACE.format(name), (), (problem,), error, said=said))
