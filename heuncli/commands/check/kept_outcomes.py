"""What a golden file says to the numbers of today: an outcome for each that differs, and what is written anew."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.commands.check.checked import Golden
from heuncli.commands.check.request import CheckRequest
from heuncli.telling.change_words import number_text, why
from heuncli.telling.changes import EXTRA, MISSING, Change, changes
from heuncli.telling.kept import KeptFile, KeptRun, text_of
from heuncli.telling.outcomes import KEPT, Outcome
from heuncli.version import VERSION

NO_FILE = "no golden file: --update writes it"


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
    if not found:
        block = {"golden": file, "passed": True, "message": "as kept"}
        return [Outcome(KEPT, file, None, block=block)], Golden(file)
    since = _since(old, new)
    outcomes = [_outcome(file, case, change, since, request.update) for case, change in found]
    return outcomes, Golden(file, text_of(new) if request.update else None)


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
    parts = ["the spec"] if old.spec.sha256 != new.spec.sha256 else []
    tables = sorted(
        name for name in old.tables.keys() | new.tables.keys() if old.tables.get(name) != new.tables.get(name)
    )
    parts += [f"table {name}" for name in tables]
    changed = f"{' and '.join(parts)} changed since it was kept" if parts else ""
    version = f"kept by version {old.heun}" if old.heun != VERSION else ""
    return "; ".join(part for part in (changed, version) if part)


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
