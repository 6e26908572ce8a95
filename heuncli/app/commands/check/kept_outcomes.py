"""What a golden file says to the numbers of today: an outcome for each that differs, and what is written anew."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.app.commands.check.checked import Golden
from heuncli.app.commands.check.request import CheckRequest
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.change_words import number_text, why
from heuncli.output.snapshots.changes import EXTRA, MISSING, changes
from heuncli.output.snapshots.kept import KeptFile, KeptRun, text_of
from heuncli.output.snapshots.outcomes import KEPT, Outcome
from heuncli.version import VERSION

NO_FILE = "no golden file: --update writes it"
HOLDS_LESS = "kept by an earlier version without means, so less is compared; --update renews it"


def kept_outcomes(
    file: str, old: KeptFile | None, new: KeptFile, request: CheckRequest
) -> tuple[list[Outcome], Golden]:
    """The outcomes, and the file, with its text where --update writes it."""
    if old is None:
        text = text_of(new) if request.update else None
        if request.update:
            return [], Golden(file, text, is_new=True)
        block = {"golden": file, "passed": not request.strict, "message": NO_FILE}
        return [Outcome(KEPT, file, NO_FILE, block=block, warned=not request.strict)], Golden(file)
    found = [(case, change) for case, run, was in _runs(old, new) for change in _of(was, run, request)]
    since = _since(old, new)
    if not found:
        return _unchanged(file, old, new, request)
    outcomes = [_outcome(file, case, change, since, request.update) for case, change in found]
    return outcomes, Golden(file, text_of(new) if request.update else None)


def _unchanged(file: str, old: KeptFile, new: KeptFile, request: CheckRequest) -> tuple[list[Outcome], Golden]:
    """The outcome where no number left its bounds, and what --update renews then: the digests, or what a file of an
    earlier format does not hold."""
    notes = [f"{changed}, and no number left its bounds"] if (changed := _changed_files(old, new)) else []
    notes += [] if old.holds_courses else [HOLDS_LESS]
    text = None
    if request.update and notes:
        kept = old.model_copy(update={"spec": new.spec, "tables": new.tables})
        text = text_of(kept if old.holds_courses else new)
    note = "; ".join(notes)
    block = {"golden": file, "passed": True, "message": note or "as kept"} | ({"written": True} if text else {})
    return [Outcome(KEPT, file, None, block=block, note=note)], Golden(file, text)


def _runs(old: KeptFile, new: KeptFile) -> Iterator[tuple[str, KeptRun | None, KeptRun | None]]:
    """Each run that is kept or was made: the scene as it stands, and its cases by their names."""
    yield "", new.base, old.base
    for name in sorted(old.cases.keys() | new.cases.keys()):
        yield name, new.cases.get(name), old.cases.get(name)


def _of(old: KeptRun | None, new: KeptRun | None, request: CheckRequest) -> list[Change]:
    if old is None or new is None:
        return [Change("the case", "", "", None, None, why=EXTRA if old is None else MISSING)]
    return changes(old, new, request.golden_tolerance)


def _since(old: KeptFile, new: KeptFile) -> str:
    """What else is not as it was when the numbers were kept."""
    changed = _changed_files(old, new)
    version = f"kept by version {old.heun}" if old.heun != VERSION else ""
    return "; ".join(part for part in (changed, version) if part)


def _changed_files(old: KeptFile, new: KeptFile) -> str:
    """Which of the spec and its tables changed since the numbers were kept."""
    parts = ["the spec"] if old.spec.sha256 != new.spec.sha256 else []
    tables = sorted(
        name for name in old.tables.keys() | new.tables.keys() if old.tables.get(name) != new.tables.get(name)
    )
    parts += [f"table {name}" for name in tables]
    return f"{' and '.join(parts)} changed since it was kept" if parts else ""


def _outcome(file: str, case: str, change: Change, since: str, written: bool) -> Outcome:
    message = why(change) + (f"; {since}" if since else "")
    block: dict[str, Any] = {"golden": file, **({"case": case} if case else {}), "of": change.path, "when": change.what}
    block |= {"unit": change.unit, "expected": change.old, "found": change.new, "tolerance": change.allowed}
    block |= {"passed": written, "message": message} | ({"written": True} if written else {})
    return Outcome(
        KEPT, change.path, message, case=case, when=change.what, expected=number_text(change.old, change.unit),
        found=number_text(change.new, change.unit), block=block, warned=written,
        allowed="" if change.allowed is None else f"{change.allowed:.3g}",
    )  # fmt: skip
