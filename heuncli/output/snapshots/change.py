"""One difference between two runs."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
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
