"""`heun check`: specs and folders of specs against what they expect, and against numbers that were kept."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from heuncli.app.cli import jobs
from heuncli.app.cli.entry import BUG, UsageError, lines_of, say_what_explains, worst
from heuncli.app.cli.guard import require_other_file, same_file
from heuncli.app.cli.output import as_bytes, emit, say
from heuncli.app.cli.progress import progress
from heuncli.app.cli.target import format_of, require_room
from heuncli.app.commands.check import goldens
from heuncli.app.commands.check.checked import FAILED, Checked
from heuncli.app.commands.check.checking import Task, check
from heuncli.app.commands.check.folders import Found, PassedBy, specs_below
from heuncli.app.commands.check.picking import picked
from heuncli.app.commands.check.request import FORMATS, CheckRequest
from heuncli.app.commands.check.told import FORMS, AllChecked
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.foreign_text import shown

NAMED = "name a folder of specs, or the files themselves; folders named broken and hidden ones are passed by"
OF_A_JOB = ("markdown", "github")  # formats that tell errors, too: nobody sees standard error beside them


def main(request: CheckRequest) -> int:
    """Run the command; returns the exit code."""
    if request.references:
        return _references(request)
    _require_sense(request)
    skipped: list[PassedBy] = []
    found = [one for argument in request.paths for one in specs_below(argument, skipped)]
    for folder in skipped if not request.quiet else ():
        if folder.reason:
            say(f"heun: {shown(folder.path)} passed by: {shown(folder.reason)}")
    if not found:
        message = f"no *.yaml in {', '.join(request.paths)}" if request.paths else "no PATH is given"
        raise UsageError(Problem("nothing-to-check", message, hint=NAMED))
    form = format_of(request.format, request.output, FORMATS)
    kept = goldens.files_of(found, request.golden) if request.golden is not None else {}
    orphans = _without_spec(request, found, kept)
    chosen = picked(found, request.select) if request.select is not None else found
    paths = [one.path for one in chosen]
    _require_other_files(request, paths)
    checked = _all(chosen, kept, request)
    _require_other_files(request, paths)  # the tables of specs that are wrong, too
    told = AllChecked(checked, skipped, orphans, request.strict)
    if form in OF_A_JOB or any(not one.error for one in checked):  # with errors alone there is no result
        emit(FORMS[form](told), request.output)
    if request.junit is not None:
        from heuncli.app.commands.check.junit import junit_text

        files.write(as_bytes(junit_text(checked, orphans, request.strict)), request.junit)
    say_what_explains([problem for one in checked for problem in one.problems])
    _say_slowest(checked, request.durations)
    codes = [one.exit_code for one in checked] + [FAILED] * (request.strict and bool(orphans))
    return worst([*codes, *_written(checked, request)])


def _references(request: CheckRequest) -> int:
    """The published cases in place of specs; returns the exit code."""
    from heuncli.app.commands.check import references  # that only these need

    references.require_alone(request)
    _require_sense(request)
    code, checked = references.main(request)
    _say_slowest(checked, request.durations)
    return code


def _require_sense(request: CheckRequest) -> None:
    """Raise UsageError where options do not go together, or numbers mean nothing."""
    goldens.require_sense(request)
    for word, number in (("--jobs", request.jobs), ("--durations", request.durations)):
        if number is not None and number < 1:
            raise UsageError(Problem("bad-option", f"{word} {number}: expected 1 or more", hint=f"such as {word} 2"))
    if request.junit is not None:
        require_room(request.junit, "--junit")
        if request.output is not None and same_file(request.junit, request.output):
            raise UsageError(Problem("bad-option", "--junit and -o name the same file", hint="name another file"))


def _require_other_files(request: CheckRequest, paths: Sequence[str]) -> None:
    require_other_file(request.output, paths)
    if request.junit is not None:
        require_other_file(request.junit, paths, "--junit")


def _without_spec(request: CheckRequest, found: Sequence[Found], kept: dict[str, str]) -> list[str]:
    """Golden files of no spec, told; where single specs are named nothing is known of the others."""
    if request.golden is None or any(one.below is None for one in found):
        return []
    orphans = goldens.without_spec(request.golden, kept.values())
    for path in orphans if not request.quiet or request.strict else ():
        say(f"{'heun' if request.strict else 'warning'}: {shown(path)}: a golden file without a spec")
    return orphans


def _all(chosen: Sequence[Found], kept: dict[str, str], request: CheckRequest) -> list[Checked]:
    """What was found of each, in their order; what there is to say is said as they come."""
    tasks = [_task(one, kept.get(one.path), request) for one in chosen]
    at_once = jobs.how_many(request.jobs, len(tasks))
    checked: list[Checked] = []
    work = partial(check, request=request, jobs=at_once)
    is_last = _fails if request.first else _none
    with progress(request.quiet) as tell:
        for one in jobs.each(work, tasks, at_once, _dead, is_last, apart=request.time_limit_each is not None):
            if one.refused:
                raise UsageError(*one.problems)
            checked.append(one)
            for line in one.said:
                say(line)
            tell(len(checked), len(tasks), one.path)
    return checked


def _task(one: Found, file: str | None, request: CheckRequest) -> Task:
    if file is None or request.golden is None or one.problem is not None:
        return Task(one)
    return Task(one, file, goldens.name_of(file, one.path, request.golden))


def _fails(one: Checked) -> bool:
    return bool(one.exit_code)


def _none(one: Checked) -> bool:
    return False


def _dead(task: Task, died: jobs.Died) -> Checked:
    """What stands for a spec whose process died."""
    path = task.found.path
    hint = "the memory may not have sufficed: --jobs 1; else please report it with the spec"
    problem = died.problem("checked it", hint)
    error = died.code if died.is_time_up else BUG
    return Checked(path, problems=(problem,), error=error, said=tuple(lines_of([problem], f"{path}: ")))


def _say_slowest(checked: Sequence[Checked], most: int | None) -> None:
    """The slowest specs, on standard error: times differ from run to run, results do not."""
    if most is None:
        return
    say(f"slowest {min(most, len(checked))} of {len(checked)}:")
    for one in sorted(checked, key=lambda one: -one.seconds)[:most]:
        say(f"{one.seconds:9.3f} s  {shown(one.path)}")


def _written(checked: Sequence[Checked], request: CheckRequest) -> list[int]:
    """Write the golden files that are to be written, none where one that stands there cannot be used; exit codes."""
    given = [one.golden for one in checked if one.golden is not None and one.golden.text is not None]
    if any(problem.code == "not-golden" for one in checked for problem in one.problems):
        if given:
            say("heun: no golden file was written: one that stands there cannot be used")
        return []
    for golden in given:
        _write_golden(golden.path, as_bytes(golden.text or ""))
        if not request.quiet:
            say(f"heun: {shown(golden.path)} {'written' if golden.is_new else 'written anew'}")
    return []


def _write_golden(path: str, content: bytes) -> None:
    """Write a golden file, with the folders above it; where it cannot be written no new folder is left empty."""
    missing = [folder for folder in Path(path).parents if not folder.exists()]
    try:
        try:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
        except OSError as reason:
            raise OutputError(files.failed(path, reason)) from None
        files.write(content, path)
    except OutputError:
        for folder in missing:  # the innermost first
            with contextlib.suppress(OSError):  # it was never made, or another file stands in it
                folder.rmdir()
        raise
