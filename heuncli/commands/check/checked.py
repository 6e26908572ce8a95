"""What was found of one spec, as plain values: its cases, what went wrong, how long it took, what is to be said."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from heuncli.errors import Problem
from heuncli.named_tuples import NamedTuple

FAILED = 1
NONE: Mapping[str, Any] = MappingProxyType({})
EXPECTED, KEPT = "expect", "golden"


class Outcome(NamedTuple):
    """One comparison: of what and when, expected, found and allowed in words, and if it fails why.

    kind: with what the spec expects, or with what was kept; case: the load case; block: the same for JSON; warned: a
    thing that is told and does not fail; skipped: nothing was compared.
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

    @property
    def passed(self) -> bool:
        """Whether it holds."""
        return self.failure is None or self.warned

    @property
    def name(self) -> str:
        """The case, what it is of, and when, in one line."""
        case = f"{self.case}: " if self.case else ""
        return f"{case}{self.of} {self.when}".strip()


class Golden(NamedTuple):
    """The golden file of a spec: where it lies, and its text anew where that is to be written."""

    path: str
    text: str | None = None
    is_new: bool = False


class Checked(NamedTuple):
    """One file: its outcomes, or the problems that kept it from being solved, with the exit code of that error.

    said: lines for standard error; refused: the command line itself is wrong, nothing is told.
    """

    path: str
    outcomes: tuple[Outcome, ...] = ()
    problems: tuple[Problem, ...] = ()
    error: int = 0
    seconds: float = 0.0
    said: tuple[str, ...] = ()
    golden: Golden | None = None
    refused: bool = False

    @property
    def exit_code(self) -> int:
        """What this file alone would leave with."""
        return self.error or (0 if all(outcome.passed for outcome in self.outcomes) else FAILED)
