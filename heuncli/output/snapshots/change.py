"""One difference between two runs."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.kept import Value


class Change(NamedTuple):
    """One difference: of what, where in its course, before and after; allowed: by how much they may differ.

    why: in words, where the two are not numbers that differ; alike: how many more values of the same quantity changed.
    """

    path: str
    what: str
    unit: str
    old: Value | str | None
    new: Value | str | None
    allowed: float | None = None
    why: str = ""
    alike: int = 0
    at: float | None = None

    @property
    def difference(self) -> float | None:
        """New less old; None where the two are not numbers."""
        if isinstance(self.old, str) or isinstance(self.new, str) or self.old is None or self.new is None:
            return None
        return self.new - self.old

    @property
    def relative(self) -> float:
        """The difference over the larger of the two; without numbers infinite: such changes come first."""
        if self.difference is None or isinstance(self.old, str) or isinstance(self.new, str):
            return float("inf")
        return abs(self.difference) / max(abs(self.old or 0.0), abs(self.new or 0.0))

    @property
    def excess(self) -> float:
        """The difference over what is allowed."""
        if self.difference is None or not self.allowed:
            return float("inf")
        return abs(self.difference) / self.allowed
