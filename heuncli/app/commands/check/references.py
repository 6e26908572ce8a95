"""`heun check --references [NAME...]`: solve published cases, and compare them with the printed numbers."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

from heuncli.analyses.published.cases import list_names, read_case
from heuncli.analyses.published.comparison import compare_case
from heuncli.app.cli import jobs, timeout
from heuncli.app.cli.documents import UNLIMITED, emit_document
from heuncli.app.cli.entry import BUG, UsageError, format_problems, print_explain_hint, run_contained, select_exit_code
from heuncli.app.cli.output import emit, encode_text, print_stderr
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.check.references_page import ReferenceResult, iter_outcomes, make_document
from heuncli.app.commands.check.request import FORMATS, CheckRequest
from heuncli.app.commands.check.results import CheckResult, CheckSummary, render_github
from heuncli.base import files
from heuncli.base.errors import HeunError, Problem
from heuncli.base.spelling import suggest
from heuncli.output.documents.as_text import PLAIN
from heuncli.study.model.options import Options

EXCLUDED_OPTIONS = (("--golden", "golden"), ("--update", "update"), ("--strict", "strict"), ("-k", "select"))
PLACE = "heuncli/analyses/published/numbers/{}.yaml"


def require_alone(request: CheckRequest) -> None:
    """Raise UsageError for options that have no meaning together with --references."""
    for word, field in EXCLUDED_OPTIONS:
        if getattr(request, field):
            hint = "--references only compares published cases with their published results"
            raise UsageError(Problem("bad-option", f"--references and {word} cannot be combined", hint=hint))


def check_published_cases(request: CheckRequest) -> tuple[int, list[CheckResult]]:
    """Check the cases; returns the exit code, and the result of each case."""
    case_names = _select_names(request)
    form = choose_format(request.format, request.output, FORMATS)
    checked = _check_all(case_names, request)
    spec_results = [result.check for result in checked]
    if form == "github":
        emit(render_github(CheckSummary(spec_results)), request.output)
    else:
        style = PLAIN if request.paths else UNLIMITED
        emit_document(make_document(checked, form, show_numbers=bool(request.paths)), form, request.output, style=style)
    if request.junit is not None:
        from heuncli.app.commands.check.junit import render_junit

        files.write(encode_text(render_junit(spec_results, (), strict=False)), request.junit)
    print_explain_hint([problem for result in spec_results for problem in result.problems])
    return select_exit_code([result.exit_code for result in checked]), spec_results


def _select_names(request: CheckRequest) -> Sequence[str]:
    """Return the requested names, or all. Raises UsageError."""
    known = list_names()
    for name in request.paths:
        if name not in known:
            hint = suggest(name, known, "cases")
            raise UsageError(Problem("bad-option", f"--references {name}: there is no such published case", hint=hint))
    return tuple(dict.fromkeys(request.paths)) or known


def _check_all(case_names: Sequence[str], request: CheckRequest) -> list[ReferenceResult]:
    """Check the cases; returns the results in their order, and prints their messages as they come."""
    job_count = jobs.choose_job_count(request.jobs, len(case_names))
    checked: list[ReferenceResult] = []
    work = partial(check_case, request=request)
    separate_process = request.time_limit_each is not None

    def is_last(result: ReferenceResult) -> bool:
        """Return whether a result ends the check: with -x the first failure."""
        return request.first and bool(result.exit_code)

    with show_progress(request.quiet) as report:
        for checked_case in jobs.run_in_order(
            work, case_names, job_count, _make_death_result, is_last, separate_process
        ):
            checked.append(checked_case)
            for line in checked_case.check.messages:
                print_stderr(line)
            report(len(checked), len(case_names), checked_case.case.name)
    return checked


def check_case(name: str, request: CheckRequest) -> ReferenceResult:
    """Solve one case, and compare it with the printed numbers."""
    start, case = time.perf_counter(), read_case(name)
    place = PLACE.format(name)

    def work() -> ReferenceResult:
        """Solve the case within the time limit, and compare it."""
        options = Options(time_limit=timeout.remaining_time(), reduce=not request.no_reduce)
        tables = compare_case(case, options)
        timeout.disarm()
        return ReferenceResult(case, tables, CheckResult(place, tuple(iter_outcomes(tables))))

    try:
        result = run_contained(
            partial(timeout.run_with_limit, work, request.time_limit_each), ("check", "--references", name)
        )
    except HeunError as error:
        messages = tuple(format_problems(error.problems, label=f"{name}: "))
        result = ReferenceResult(case, (), CheckResult(place, (), error.problems, error.exit_code, messages=messages))
    return result._replace(check=result.check._replace(seconds=time.perf_counter() - start))


def _make_death_result(name: str, death: jobs.ProcessDeath) -> ReferenceResult:
    """Make the result of a case whose process died."""
    problem = death.make_problem("checked it", "please report it")
    messages = tuple(format_problems([problem], f"{name}: "))
    error = death.code if death.is_time_up else BUG
    return ReferenceResult(
        read_case(name), (), CheckResult(PLACE.format(name), (), (problem,), error, messages=messages)
    )
