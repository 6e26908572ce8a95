"""What was found of one spec, as plain values: its cases, what went wrong, how long it took, what is to be said."""

from __future__ import annotations

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.outcomes import Outcome

FAILED = 1


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
