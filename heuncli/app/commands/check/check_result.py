"""The result of checking one spec, as plain values: outcomes, problems, duration, messages."""

from __future__ import annotations

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.outcomes import Outcome

FAILED = 1


class GoldenUpdate(NamedTuple):
    """The golden file of a spec: its path, and its new text if it is to be written."""

    path: str
    text: str | None = None
    is_new: bool = False


class CheckResult(NamedTuple):
    """The result of one file: its outcomes, or the problems that kept it from being solved, with their exit code.

    messages: lines for standard error
    is_usage_error: the command line itself is wrong; the command ends with a usage error
    """

    path: str
    outcomes: tuple[Outcome, ...] = ()
    problems: tuple[Problem, ...] = ()
    error: int = 0
    seconds: float = 0.0
    messages: tuple[str, ...] = ()
    golden: GoldenUpdate | None = None
    is_usage_error: bool = False

    @property
    def exit_code(self) -> int:
        """The exit code that this file alone would give."""
        return self.error or (0 if all(outcome.has_passed for outcome in self.outcomes) else FAILED)
