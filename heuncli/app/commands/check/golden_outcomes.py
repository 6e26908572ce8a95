"""Compare a golden file with the new numbers: an outcome for each that differs, and the text to write."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.app.commands.check.check_result import GoldenUpdate
from heuncli.app.commands.check.request import CheckRequest
from heuncli.output.snapshots.change import Change, describe_failure, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, find_changes
from heuncli.output.snapshots.golden_file import GoldenFile, RunSnapshot, format_golden_file
from heuncli.output.snapshots.outcomes import GOLDEN, Outcome
from heuncli.version import VERSION

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
