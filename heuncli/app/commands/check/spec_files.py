"""Find the specs in folders and their subfolders, each folder once, or those that `-k` selects, and their golden files.

A link may lead from a folder to one of its parents, or to the same folder many times; so folders are identified by
device and inode, not by path. A folder that cannot be read is reported in its place, and the others are still searched.
Impure: reads folders and files.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePath
from typing import Any

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.check.request import CheckRequest
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.change import Change, describe_failure, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, find_changes
from heuncli.output.snapshots.golden_file import GoldenFile, RunSnapshot, format_golden_file
from heuncli.output.snapshots.outcomes import GOLDEN, Outcome
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.scene.file_format.source import MAX_SIZE, read_source
from heuncli.version import VERSION

SPECS = frozenset({".yaml", ".yml"})
SKIPPED_FOLDER = "broken"  # folders of deliberately invalid specs
PLAIN_TITLE = re.compile(r"^title:[ \t]+(?![|>&*!\"'\[{])([^#\n]*)", re.MULTILINE)


class FoundSpec(NamedTuple):
    """A spec that was found.

    path: its file
    folder: the folder that was searched, or None if the spec was named directly
    problem: why a folder cannot be read, in place of a spec
    """

    path: str
    folder: str | None = None
    problem: Problem | None = None


class SkippedFolder(NamedTuple):
    """A folder that is not searched, and why, in words."""

    path: str
    reason: str


def find_specs(argument: str, skipped: list[SkippedFolder]) -> Iterator[FoundSpec]:
    """Yield the file itself, or every spec in the folder and below it, sorted; hidden folders and those named `broken`
    are skipped.
    """
    if argument == STANDARD_INPUT or not os.path.isdir(argument):  # noqa: PTH112  # Path's raises where the way there is closed
        yield FoundSpec(argument)
        return
    seen: dict[tuple[int, int], str] = {}
    pending = [(str(Path(argument)), True)]  # a stack: folders may be nested deeper than the recursion limit
    while pending:
        path, is_folder = pending.pop()
        if not is_folder:
            yield FoundSpec(path, argument)
            continue
        try:
            state = Path(path).stat()
            known = seen.setdefault((state.st_dev, state.st_ino), path)
            if known == path:
                pending += reversed(list_entries(path, skipped))
            else:
                skipped.append(SkippedFolder(path, f"same folder as {known}"))
        except OSError as error:
            yield FoundSpec(path, argument, make_unreadable_problem(path, error))


def list_entries(folder: str, skipped: list[SkippedFolder]) -> list[tuple[str, bool]]:
    """List the specs and the folders to search, sorted, each with whether it is a folder. Raises OSError."""
    with os.scandir(folder) as entries:
        entries_found = sorted((entry.path, entry.name, leads_to_directory(entry)) for entry in entries)
    skipped += [
        SkippedFolder(path, "") for path, name, is_folder in entries_found if is_folder and name == SKIPPED_FOLDER
    ]
    return [
        (path, is_folder)
        for path, name, is_folder in entries_found
        if (name != SKIPPED_FOLDER and not name.startswith(".") if is_folder else Path(name).suffix in SPECS)
    ]


def leads_to_directory(entry: os.DirEntry[str]) -> bool:
    """Return whether an entry is a folder or a link to one; a circular link is none."""
    try:
        return entry.is_dir()
    except OSError:
        return False


def make_unreadable_problem(path: str, error: OSError) -> Problem:
    """Make the problem of a folder that cannot be read."""
    hint = "check its permissions, or give the other folders; these are checked"
    message = f"the folder cannot be read: {error.strerror or error}"
    return Problem("unreadable", message, SourceLocation(path, 1, 1), hint)


def select_specs(specs: Sequence[FoundSpec], text: str) -> list[FoundSpec]:
    """Return the specs with the text in path or title. Raises UsageError if there is none."""
    needle = text.casefold()
    chosen = [one for one in specs if needle in one.path.casefold() or needle in read_title(one).casefold()]
    if not chosen:
        hint = "it is looked for in paths and titles, in capitals or not"
        raise UsageError(Problem("nothing-to-check", f"-k {text}: none of {len(specs)} specs", hint=hint))
    return chosen


def read_title(one: FoundSpec) -> str:
    """Return the title of a spec; empty if it has none or cannot be read, which the check reports later."""
    if one.problem is not None or one.path == STANDARD_INPUT:
        return ""
    try:
        text = read_bytes(one.path, MAX_SIZE).decode("utf-8", "replace")
        if (plain := PLAIN_TITLE.search(text)) is not None:
            return plain[1]
        data = read_source(one.path, None).data if "title" in text else {}
    except (Finding, HeunError):
        return ""
    title = data.get("title") if isinstance(data, dict) else None
    return title if isinstance(title, str) else ""


class GoldenUpdate(NamedTuple):
    """The golden file of a spec: its path, and its new text if it is to be written."""

    path: str
    text: str | None = None
    is_new: bool = False


SUFFIX = ".json"
CI_OFF = ("", "0", "false", "no")  # values of CI that mean "no"


class GoldenError(HeunError):
    """A golden file that cannot be used."""

    exit_code = 2


def require_consistent_options(request: CheckRequest) -> None:
    """Raise UsageError if the options about golden files contradict each other."""
    if request.golden is None:
        for word, is_given in (
            ("--update", request.update), ("--strict", request.strict),
            ("--golden-tolerance", request.golden_tolerance is not None),
        ):  # fmt: skip
            if is_given:
                raise UsageError(Problem("bad-option", f"{word} without --golden", hint="for example --golden golden"))
        return
    if request.force and not request.update:
        raise UsageError(
            Problem("bad-option", "--force without --update", hint="--force allows --update where CI is set")
        )
    share = request.golden_tolerance
    if share is not None and not 0.0 < share < 1.0:
        hint = "for example 1e-6; without it, the stated errors apply"
        raise UsageError(
            Problem("bad-option", f"--golden-tolerance {share:g}: expected a fraction between 0 and 1", hint=hint)
        )
    if request.update and not request.force and os.environ.get("CI", "").lower() not in CI_OFF:
        hint = "run it locally, review the changes and commit the files; --force writes here too"
        raise UsageError(Problem("bad-option", "--update where CI is set: a pipeline would approve itself", hint=hint))
    folder = Path(request.golden)
    if folder.exists() and not folder.is_dir():
        raise UsageError(Problem("bad-option", f"--golden {request.golden}: not a folder", hint="give a folder"))
    if not folder.exists() and not request.update:
        hint = "--update creates it from the current results"
        raise UsageError(Problem("bad-option", f"--golden {request.golden}: there is no such folder", hint=hint))


def map_golden_files(specs: Sequence[FoundSpec], folder: str) -> dict[str, str]:
    """Return the golden file of each spec, by the spec's path. Raises UsageError if two specs would have the same
    one.
    """
    files: dict[str, str] = {}
    owners: dict[str, str] = {}
    for one in specs:
        if one.path == STANDARD_INPUT:
            raise UsageError(Problem("bad-option", "--golden with standard input: it has no path", hint="name a file"))
        file = find_golden_file(one, folder)
        other = owners.setdefault(file, one.path)
        if os.path.realpath(other) != os.path.realpath(one.path):
            hint = "give their common parent folder, or check them separately with separate golden folders"
            raise UsageError(
                Problem("bad-option", f"--golden: {other} and {one.path} would both use {file}", hint=hint)
            )
        files[one.path] = file
    return files


def find_golden_file(one: FoundSpec, folder: str) -> str:
    """Return the path of a spec's golden file."""
    if one.folder is not None:
        return str(Path(folder, os.path.relpath(one.path, one.folder)).with_suffix(SUFFIX))
    parts = [part for part in PurePath(one.path).parts if part not in (os.curdir, os.pardir, os.sep)]
    tails = [str(Path(folder, *parts[start:]).with_suffix(SUFFIX)) for start in range(len(parts))]
    return next((tail for tail in tails if Path(tail).is_file()), tails[-1])


def make_spec_name(file: str, spec: str, folder: str) -> str:
    """Return the path by which a golden file names its spec: its own path below the folder, with the spec's ending."""
    return PurePath(os.path.relpath(file, folder)).with_suffix(PurePath(spec).suffix).as_posix()


def require_inside(file: str, folder: str) -> None:
    """Raise GoldenError if a file is a link that leads out of the folder, or a folder itself."""
    inside, real = os.path.realpath(folder), os.path.realpath(file)
    if os.path.commonpath([inside, real]) != inside:
        raise make_golden_error(
            file,
            Finding("not-golden", f"this link leads out of {escape(folder)}, to {escape(real)}", "remove the link"),
        )
    if Path(file).is_dir():
        raise make_golden_error(
            file, Finding("not-golden", "this is a folder", "remove it, or choose another place for --golden")
        )


def make_golden_error(file: str, finding: Finding) -> GoldenError:
    """Make the error of a golden file."""
    return GoldenError(Problem(finding.code, finding.message, SourceLocation(file, 1, 1), finding.hint))


def find_orphans(folder: str, files: Iterable[str]) -> list[str]:
    """Return the golden files in a folder that belong to none of the specs, sorted."""
    known = {os.path.realpath(file) for file in files}
    paths = (str(path) for path in sorted(Path(folder).rglob("*" + SUFFIX)) if path.is_file())
    return [path for path in paths if os.path.realpath(path) not in known]


NO_FILE = "no golden file: --update writes it"
HOLDS_LESS = "written by an earlier version without mean values, so less is compared; --update renews it"


def compare_golden(
    file: str, old: GoldenFile | None, new: GoldenFile, request: CheckRequest
) -> tuple[list[Outcome], GoldenUpdate]:
    """Compare the numbers; returns the outcomes, and the golden file with its text if --update writes it."""
    if old is None:
        text = format_golden_file(new) if request.update else None
        if request.update:
            return [], GoldenUpdate(file, text, is_new=True)
        block = {"golden": file, "passed": not request.strict, "message": NO_FILE}
        return [Outcome(GOLDEN, file, NO_FILE, block=block, is_warning=not request.strict)], GoldenUpdate(file)
    changes_found = [
        (case, change) for case, run, old_run in _pair_runs(old, new) for change in _list_changes(old_run, run, request)
    ]
    context = _describe_context(old, new)
    if not changes_found:
        return _make_unchanged_outcome(file, old, new, request)
    outcomes = [_make_outcome(file, case, change, context, request.update) for case, change in changes_found]
    return outcomes, GoldenUpdate(file, format_golden_file(new) if request.update else None)


def _make_unchanged_outcome(
    file: str, old: GoldenFile, new: GoldenFile, request: CheckRequest
) -> tuple[list[Outcome], GoldenUpdate]:
    """Make the outcome if no number changed, and what --update renews then: the digests, or what a file of an earlier
    format lacks.
    """
    notes = [f"{changed}, but no number left its bounds"] if (changed := _describe_changed_files(old, new)) else []
    notes += [] if old.has_courses else [HOLDS_LESS]
    text = None
    if request.update and notes:
        renewed = old.model_copy(update={"spec": new.spec, "tables": new.tables})
        text = format_golden_file(renewed if old.has_courses else new)
    note = "; ".join(notes)
    block = {"golden": file, "passed": True, "message": note or "unchanged"} | ({"written": True} if text else {})
    return [Outcome(GOLDEN, file, None, block=block, note=note)], GoldenUpdate(file, text)


def _pair_runs(old: GoldenFile, new: GoldenFile) -> Iterator[tuple[str, RunSnapshot | None, RunSnapshot | None]]:
    """Yield each run by name, new and old; the scene as it is first."""
    yield "", new.base, old.base
    for name in sorted(old.cases.keys() | new.cases.keys()):
        yield name, new.cases.get(name), old.cases.get(name)


def _list_changes(old: RunSnapshot | None, new: RunSnapshot | None, request: CheckRequest) -> list[Change]:
    if old is None or new is None:
        return [Change("the case", "", "", None, None, reason=EXTRA if old is None else MISSING)]
    return find_changes(old, new, request.golden_tolerance)


def _describe_context(old: GoldenFile, new: GoldenFile) -> str:
    """Describe what else changed since the golden file was written: spec, tables, version."""
    changed = _describe_changed_files(old, new)
    version = f"written by version {old.heun}" if old.heun != VERSION else ""
    return "; ".join(part for part in (changed, version) if part)


def _describe_changed_files(old: GoldenFile, new: GoldenFile) -> str:
    """Describe which of the spec and its tables changed since the golden file was written."""
    parts = ["the spec"] if old.spec.sha256 != new.spec.sha256 else []
    tables = sorted(
        name for name in old.tables.keys() | new.tables.keys() if old.tables.get(name) != new.tables.get(name)
    )
    parts += [f"table {name}" for name in tables]
    return f"{' and '.join(parts)} changed since it was written" if parts else ""


def _make_outcome(file: str, case: str, change: Change, context: str, is_written: bool) -> Outcome:
    message = describe_failure(change) + (f"; {context}" if context else "")
    block: dict[str, Any] = {"golden": file, **({"case": case} if case else {}), "of": change.path, "when": change.what}
    block |= {"unit": change.unit, "expected": change.old, "found": change.new, "tolerance": change.tolerance}
    block |= {"passed": is_written, "message": message} | ({"written": True} if is_written else {})
    return Outcome(
        GOLDEN, change.path, message, case=case, when=change.what, expected_text=format_value(change.old, change.unit),
        found_text=format_value(change.new, change.unit), block=block, is_warning=is_written,
        tolerance_text="" if change.tolerance is None else f"{change.tolerance:.3g}",
    )  # fmt: skip
