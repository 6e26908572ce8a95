"""Outcomes of comparisons with the expectations of a spec or with its golden file, as plain values.

A GitHub workflow reads them as lines of the output of a step, and shows each at the line of the file that it names:

    ::error file=FILE,line=3,col=5,title=TITLE::MESSAGE
In the message % and the ends of lines are written as %25, %0D and %0A, in a property also : and , (%3A, %2C).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePath
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape_lines
from heuncli.results.results import Array
from heuncli.study.quantities.digits import OPEN
from heuncli.study.queries.expectations import Case

EMPTY_BLOCK: Mapping[str, Any] = {}  # a dict, which can be sent to another process
EXPECTED, GOLDEN = "expect", "golden"
MAX_OF_KIND = 9  # of a kind: GitHub shows ten, and the last one gives the number of further ones
MESSAGE_ESCAPES = {"%": "%25", "\r": "%0D", "\n": "%0A"}
PROPERTY_ESCAPES = MESSAGE_ESCAPES | {":": "%3A", ",": "%2C"}


class Outcome(NamedTuple):
    """One comparison.

    kind: with what the spec expects, or with the golden file
    subject: what is compared
    failure: why it fails, or None
    case: the load case
    expected_text, found_text, tolerance_text: the numbers in words
    block: the same for JSON
    is_warning: whether it is reported but does not fail
    is_skipped: whether nothing was compared
    note: a remark if it passes
    """

    kind: str
    subject: str
    failure: str | None
    line: int = 1
    column: int = 1
    case: str = ""
    when: str = ""
    expected_text: str = ""
    found_text: str = ""
    tolerance_text: str = ""
    block: Mapping[str, Any] = EMPTY_BLOCK
    is_warning: bool = False
    is_skipped: bool = False
    note: str = ""

    @property
    def has_passed(self) -> bool:
        """Whether the comparison holds, or only warns."""
        return self.failure is None or self.is_warning

    @property
    def name(self) -> str:
        """Case, subject and time in one line."""
        case = f"{self.case}: " if self.case else ""
        return f"{case}{self.subject} {self.when}".strip()


def make_outcome(case: Case, path: str, case_name: str = "") -> Outcome:
    """Convert the comparison of an expectation to plain values.

    case_name: of the load case
    """
    block = {
        **({"case": case_name} if case_name else {}),
        "file": path,
        "line": case.location.line,
        "of": case.path,
        "when": case.when,
        **_make_block(case),
    }
    block |= {"passed": case.is_met, "message": case.failure or ""}
    has_bounds = case.upper_bound is not None or case.lower_bound is not None
    return Outcome(
        EXPECTED,
        case.path,
        case.failure,
        case.location.line,
        case.location.column,
        case=case_name,
        when=case.when,
        expected_text=_format_expected(case),
        found_text=_format_numbers(case.found_values),
        tolerance_text="" if has_bounds else f"{case.tolerance:.3g}",
        block=_to_lists(block),
    )


def _to_lists(value: Any) -> Any:
    """Replace arrays by lists, which are smaller to send to another process."""
    if isinstance(value, dict):
        return {key: _to_lists(member) for key, member in value.items()}
    if isinstance(value, np.ndarray):
        return _to_lists(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_to_lists(member) for member in value]
    return value


def _make_block(case: Case) -> dict[str, Any]:
    """Return what was expected and found; for bounds the decisive extreme with its instant and place."""
    if case.upper_bound is None and case.lower_bound is None:
        block_of_value = {"expected": case.expected_values, "found": case.found_values, "tolerance": case.tolerance}
        return block_of_value | (case.worst_point if case.curve is not None else {})
    bounds = {"below": case.upper_bound, "above": case.lower_bound}
    block: dict[str, Any] = {key: bound for key, bound in bounds.items() if bound is not None}
    block |= {"found": case.found_values, "at": case.extreme.time if case.extreme is not None else None}
    return block | (case.extreme.place._asdict() if case.extreme is not None and case.extreme.place is not None else {})


def _format_expected(case: Case) -> str:
    bounds = [f"{word} {bound:.9g}" for word, bound in (("above", case.lower_bound), ("below", case.upper_bound))
              if bound is not None]  # fmt: skip
    return ", ".join(bounds) or _format_numbers(case.expected_values)


def _format_numbers(values: Array | None) -> str:
    if values is None:
        return ""
    texts = [OPEN if np.isnan(value) else f"{value:.9g}" for value in np.ravel(values)[:6]]
    more = ", ..." if values.size > len(texts) else ""
    return texts[0] if values.ndim == 0 else f"[{', '.join(texts)}{more}]"


class Annotation(NamedTuple):
    """An annotation: `error`, `warning` or `notice`, its place in a file, and its text."""

    kind: str
    title: str
    message: str
    file: str = ""
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        file = PurePath(self.file).as_posix() if self.file else ""  # GitHub finds no file that begins with ./
        named_values = (("file", file), ("line", self.line), ("col", self.column), ("title", self.title))
        properties = ",".join(
            f"{name}={_escape(str(value), PROPERTY_ESCAPES)}" for name, value in named_values if value
        )
        message = _escape(self.message, MESSAGE_ESCAPES)
        return f"::{self.kind}{' ' * bool(properties)}{properties}::{message}"


def _escape(text: str, escapes: dict[str, str]) -> str:
    """Escape control characters of terminals, and then the characters that would end a message or property."""
    visible = "\r".join(map(escape_lines, text.split("\r")))
    return "".join(escapes.get(letter, letter) for letter in visible)


def iter_lines(annotations: Iterable[Annotation]) -> Iterator[str]:
    """Yield the lines: at most nine of a kind, and then one that gives the number of further ones."""
    counts: dict[str, int] = {}
    for annotation in annotations:
        counts[annotation.kind] = counts.get(annotation.kind, 0) + 1
        if counts[annotation.kind] <= MAX_OF_KIND:
            yield f"{annotation}\n"
    for kind, count in counts.items():
        if count > MAX_OF_KIND:
            more = count - MAX_OF_KIND
            yield f"{Annotation(kind, f'{more} more', f'{more} more of this kind: see the log or the report')}\n"
