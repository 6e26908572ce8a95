"""`heun check`: compare specs and folders of specs with what they expect, and with golden files."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from heuncli.app.cli import jobs
from heuncli.app.cli.documents import UNLIMITED, emit_document
from heuncli.app.cli.entry import BUG, UsageError, format_problems, print_explain_hint, select_exit_code
from heuncli.app.cli.output import emit, encode_text, print_stderr
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.target import choose_format, is_same_file, require_other_file, require_writable
from heuncli.app.commands.check.checking import CheckTask, check_spec
from heuncli.app.commands.check.golden import (
    find_orphans,
    make_spec_name,
    map_golden_files,
    require_consistent_golden_options,
)
from heuncli.app.commands.check.request import FORMATS, CheckRequest
from heuncli.app.commands.check.results import FAILED, CheckResult, CheckSummary, make_document, render_github
from heuncli.app.commands.check.spec_files import FoundSpec, SkippedFolder, find_specs, select_specs
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.text_safety import escape

NAMED = "give a folder of specs, or files; folders named broken and hidden folders are skipped"
JOB_FORMATS = ("markdown", "github")  # formats that include errors: nobody sees standard error there


def main(request: CheckRequest) -> int:
    """Run the command; returns the exit code."""
    if request.references:
        return _check_references(request)
    _require_consistent_options(request)
    skipped: list[SkippedFolder] = []
    specs = [spec for argument in request.paths for spec in find_specs(argument, skipped)]
    for folder in skipped if not request.quiet else ():
        if folder.reason:
            print_stderr(f"heun: {escape(folder.path)} skipped: {escape(folder.reason)}")
    if not specs:
        message = f"no *.yaml in {', '.join(request.paths)}" if request.paths else "no PATH is given"
        raise UsageError(Problem("nothing-to-check", message, hint=NAMED))
    form = choose_format(request.format, request.output, FORMATS)
    golden_files = map_golden_files(specs, request.golden) if request.golden is not None else {}
    orphans = _report_orphans(request, specs, golden_files)
    selected = select_specs(specs, request.select) if request.select is not None else specs
    paths = [spec.path for spec in selected]
    _require_other_files(request, paths)
    checked = _check_all(selected, golden_files, request)
    _require_other_files(request, paths)  # also the tables of invalid specs
    summary = CheckSummary(checked, skipped, orphans, request.strict)
    if form in JOB_FORMATS or any(not result.error for result in checked):  # without any solved spec there is no result
        if form == "github":
            emit(render_github(summary), request.output)
        else:
            emit_document(make_document(summary, form), form, request.output, style=UNLIMITED)
    if request.junit is not None:
        from heuncli.app.commands.check.junit import render_junit

        files.write(encode_text(render_junit(checked, orphans, request.strict)), request.junit)
    print_explain_hint([problem for result in checked for problem in result.problems])
    _print_slowest(checked, request.durations)
    _write_goldens(checked, request)
    codes = [result.exit_code for result in checked] + [FAILED] * (request.strict and bool(orphans))
    return select_exit_code(codes)


def _check_references(request: CheckRequest) -> int:
    """Check the published cases instead of specs; returns the exit code."""
    from heuncli.app.commands.check import references  # only needed here

    references.require_alone(request)
    _require_consistent_options(request)
    code, checked = references.check_published_cases(request)
    _print_slowest(checked, request.durations)
    return code


def _require_consistent_options(request: CheckRequest) -> None:
    """Raise UsageError if options contradict each other, or a number is invalid."""
    require_consistent_golden_options(request)
    for word, number in (("--jobs", request.jobs), ("--durations", request.durations)):
        if number is not None and number < 1:
            raise UsageError(
                Problem("bad-option", f"{word} {number}: expected 1 or more", hint=f"for example {word} 2")
            )
    if request.junit is not None:
        require_writable(request.junit, "--junit")
        if request.output is not None and is_same_file(request.junit, request.output):
            raise UsageError(Problem("bad-option", "--junit and -o name the same file", hint="name another file"))


def _require_other_files(request: CheckRequest, paths: Sequence[str]) -> None:
    """Require that no report overwrites a spec. Raises UsageError, OutputError."""
    require_other_file(request.output, paths)
    if request.junit is not None:
        require_other_file(request.junit, paths, "--junit")


def _report_orphans(request: CheckRequest, specs: Sequence[FoundSpec], golden_files: dict[str, str]) -> list[str]:
    """Print and return the golden files without a spec; none if single specs are named, since the others are not known
    then.
    """
    if request.golden is None or any(one.folder is None for one in specs):
        return []
    orphans = find_orphans(request.golden, golden_files.values())
    for path in orphans if not request.quiet or request.strict else ():
        print_stderr(f"{'heun' if request.strict else 'warning'}: {escape(path)}: a golden file without a spec")
    return orphans


def _check_all(specs: Sequence[FoundSpec], golden_files: dict[str, str], request: CheckRequest) -> list[CheckResult]:
    """Check all specs; returns the results in their order, and prints their messages as they come."""
    tasks = [_make_task(one, golden_files.get(one.path), request) for one in specs]
    job_count = jobs.choose_job_count(request.jobs, len(tasks))
    checked: list[CheckResult] = []
    work = partial(check_spec, request=request, jobs=job_count)
    separate_process = request.time_limit_each is not None

    def is_last(result: CheckResult) -> bool:
        """Return whether a result ends the check: with -x the first failure."""
        return request.first and bool(result.exit_code)

    with show_progress(request.quiet) as report:
        for checked_spec in jobs.run_in_order(work, tasks, job_count, _make_death_result, is_last, separate_process):
            if checked_spec.is_usage_error:
                raise UsageError(*checked_spec.problems)
            checked.append(checked_spec)
            for line in checked_spec.messages:
                print_stderr(line)
            report(len(checked), len(tasks), checked_spec.path)
    return checked


def _make_task(spec: FoundSpec, file: str | None, request: CheckRequest) -> CheckTask:
    """Make the task of a spec, with its golden file if it is compared with one."""
    if file is None or request.golden is None or spec.problem is not None:
        return CheckTask(spec)
    return CheckTask(spec, file, make_spec_name(file, spec.path, request.golden))


def _make_death_result(task: CheckTask, death: jobs.ProcessDeath) -> CheckResult:
    """Make the result of a spec whose process died."""
    path = task.spec.path
    hint = "possibly out of memory: try --jobs 1; otherwise please report it with the spec"
    problem = death.make_problem("checked it", hint)
    error = death.code if death.is_time_up else BUG
    return CheckResult(path, problems=(problem,), error=error, messages=tuple(format_problems([problem], f"{path}: ")))


def _print_slowest(results: Sequence[CheckResult], limit: int | None) -> None:
    """Print the slowest specs to standard error, since times differ from run to run and results do not."""
    if limit is None:
        return
    print_stderr(f"slowest {min(limit, len(results))} of {len(results)}:")
    for result in sorted(results, key=lambda result: -result.seconds)[:limit]:
        print_stderr(f"{result.seconds:9.3f} s  {escape(result.path)}")


def _write_goldens(results: Sequence[CheckResult], request: CheckRequest) -> None:
    """Write the golden files that are to be written; none if an existing one cannot be used. Raises OutputError."""
    updates = [one.golden for one in results if one.golden is not None and one.golden.text is not None]
    if any(problem.code == "not-golden" for one in results for problem in one.problems):
        if updates:
            print_stderr("heun: no golden file was written: an existing one cannot be used")
        return
    for golden in updates:
        _write_golden(golden.path, encode_text(golden.text or ""))
        if not request.quiet:
            print_stderr(f"heun: {escape(golden.path)} {'written' if golden.is_new else 'rewritten'}")


def _write_golden(path: str, content: bytes) -> None:
    """Write a golden file and its folders; if that fails no new folder is left empty. Raises OutputError."""
    missing = [folder for folder in Path(path).parents if not folder.exists()]
    try:
        try:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
        except OSError as reason:
            raise OutputError(files.write_problem(path, reason)) from None
        files.write(content, path)
    except OutputError:
        for folder in missing:  # the innermost first
            with contextlib.suppress(OSError):  # it was never made, or another file stands in it
                folder.rmdir()
        raise
