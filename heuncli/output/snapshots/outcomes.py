"""A comparison with what a spec expects, or with what was kept of it, as plain values that are told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.study.ask.expectations import Case
from heuncli.study.quantities.digits import OPEN

NONE: Mapping[str, Any] = {}  # a dict, which one process can hand to another
EXPECTED, KEPT = "expect", "golden"


class Outcome(NamedTuple):
    """One comparison: of what and when, expected, found and allowed in words, and if it fails why.

    kind: with what the spec expects, or with what was kept; case: the load case; block: the same for JSON; warned: a
    thing that is told and does not fail; skipped: nothing was compared; note: what is said of one that holds.
    """

    kind: str
    of: str
    failure: str | None
    line: int = 1
    column: int = 1
    case: str = ""
    when: str = ""
    expected: str = ""
    found: str = ""
    allowed: str = ""
    block: Mapping[str, Any] = NONE
    warned: bool = False
    skipped: bool = False
    note: str = ""

    @property
    def passed(self) -> bool:
        """Whether it holds."""
        return self.failure is None or self.warned

    @property
    def name(self) -> str:
        """The case, what it is of, and when, in one line."""
        case = f"{self.case}: " if self.case else ""
        return f"{case}{self.of} {self.when}".strip()


def outcome_of(case: Case, path: str, of: str = "") -> Outcome:
    """An expectation's comparison as plain values; of: the load case."""
    block = {
        **({"case": of} if of else {}),
        "file": path,
        "line": case.location.line,
        "of": case.of,
        "when": case.when,
        **_wanted(case),
    }
    block |= {"passed": case.passed, "message": case.failure or ""}
    bounded = case.below is not None or case.above is not None
    return Outcome(
        EXPECTED, case.of, case.failure, case.location.line, case.location.column, case=of, when=case.when,
        expected=_expected(case), found=_text(case.found), allowed="" if bounded else f"{case.tolerance:.3g}",
        block=_plain(block),
    )  # fmt: skip


def _plain(value: Any) -> Any:
    """Without arrays, which are more to send."""
    if isinstance(value, dict):
        return {key: _plain(member) for key, member in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(member) for member in value]
    return value


def _wanted(case: Case) -> dict[str, Any]:
    """What was expected and found; of bounds the extreme that decides, with its instant and place."""
    if case.below is None and case.above is None:
        told = {"expected": case.expected, "found": case.found, "tolerance": case.tolerance}
        return told | (case.worst_point if case.curve is not None else {})
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
