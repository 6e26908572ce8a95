"""One difference between two runs, and how it is written in words and numbers."""

from __future__ import annotations

import math

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import append_unit
from heuncli.output.snapshots.golden_file import Value


class Change(NamedTuple):
    """One difference between two runs: its path, which value of it, before and after.

    tolerance: by how much the two may differ
    reason: in words, if the two are not numbers that differ
    n_similar: number of further changed values of the same quantity
    time: the instant of the value, if it has one
    """

    path: str
    what: str
    unit: str
    old: Value | str | None
    new: Value | str | None
    tolerance: float | None = None
    reason: str = ""
    n_similar: int = 0
    time: float | None = None

    @property
    def difference(self) -> float | None:
        """New minus old; None if the two are not numbers."""
        if isinstance(self.old, str) or isinstance(self.new, str) or self.old is None or self.new is None:
            return None
        return self.new - self.old

    @property
    def relative(self) -> float:
        """The difference over the larger of the two. Infinite without numbers, so that such changes are sorted
        first.
        """
        if self.difference is None or isinstance(self.old, str) or isinstance(self.new, str):
            return float("inf")
        return abs(self.difference) / max(abs(self.old or 0.0), abs(self.new or 0.0))

    @property
    def excess(self) -> float:
        """The difference over the tolerance; infinite without one."""
        if self.difference is None or not self.tolerance:
            return float("inf")
        return abs(self.difference) / self.tolerance


def format_value(value: Value | str | None, unit: str) -> str:
    """Format a value to nine digits with its unit; a word stays as it is."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return append_unit(f"{value:.9g}", unit)


def format_difference(change: Change) -> str:
    """Format the difference, and its percentage of the old value."""
    difference = change.difference
    if difference is None or not difference:
        return ""
    return f"{append_unit(f'{difference:+.3g}', change.unit)} ({format_percent(change)})"


def format_percent(change: Change) -> str:
    """Format the change relative to the old value in percent; a change from zero in words."""
    old, difference = change.old, change.difference
    if difference is None or isinstance(old, str) or not old or not math.isfinite(difference / old):
        return "from 0" if difference is not None else ""
    percent = 100.0 * difference / abs(old)
    return f"{percent:+.3g} %"


def describe_failure(change: Change) -> str:
    """Return the sentence that says what is wrong."""
    if change.reason:
        return change.reason
    more = f"; {change.n_similar} more values changed" if change.n_similar else ""
    return f"changed by {format_difference(change)}, allowed {change.tolerance or 0.0:.3g}{more}"
