"""The golden files of `heun check --golden`: where they are, what changed since, and what --update writes.

Impure: reads folders.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path, PurePath
from typing import Any

from heuncli.app.cli.entry import UsageError
from heuncli.app.commands.check.request import CheckRequest
from heuncli.app.commands.check.spec_files import FoundSpec
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.change import Change, describe_failure, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, find_changes
from heuncli.output.snapshots.golden_file import GoldenFile, RunSnapshot, format_golden_file
from heuncli.output.snapshots.outcomes import GOLDEN, Outcome
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.version import VERSION


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


def require_consistent_golden_options(request: CheckRequest) -> None:
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
    for spec in specs:
        if spec.path == STANDARD_INPUT:
            raise UsageError(Problem("bad-option", "--golden with standard input: it has no path", hint="name a file"))
        file = find_golden_file(spec, folder)
        other = owners.setdefault(file, spec.path)
        if os.path.realpath(other) != os.path.realpath(spec.path):
            hint = "give their common parent folder, or check them separately with separate golden folders"
            raise UsageError(
                Problem("bad-option", f"--golden: {other} and {spec.path} would both use {file}", hint=hint)
            )
        files[spec.path] = file
    return files


def find_golden_file(spec: FoundSpec, folder: str) -> str:
    """Return the path of a spec's golden file."""
    if spec.folder is not None:
        return str(Path(folder, os.path.relpath(spec.path, spec.folder)).with_suffix(SUFFIX))
    parts = [part for part in PurePath(spec.path).parts if part not in (os.curdir, os.pardir, os.sep)]
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
    """Make the error of a golden file that cannot be used, located at its first line."""
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
    """List what changed in a run; one change if the run is new or gone."""
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
    """Make the outcome of a changed number; it passes if --update writes the golden file."""
    message = describe_failure(change) + (f"; {context}" if context else "")
    block: dict[str, Any] = {"golden": file, **({"case": case} if case else {}), "of": change.path, "when": change.what}
    block |= {"unit": change.unit, "expected": change.old, "found": change.new, "tolerance": change.tolerance}
    block |= {"passed": is_written, "message": message} | ({"written": True} if is_written else {})
    return Outcome(
        GOLDEN, change.path, message, case=case, when=change.what, expected_text=format_value(change.old, change.unit),
        found_text=format_value(change.new, change.unit), block=block, is_warning=is_written,
        tolerance_text="" if change.tolerance is None else f"{change.tolerance:.3g}",
    )  # fmt: skip
