"""The condition that ends a run."""

from __future__ import annotations

from heuncli.motion.integration.conditions import Conditions, coordinates_in
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


class EndingCondition:
    """The condition that ends a run, asked where a piece begins and where branches turn. Remembers what it was."""

    def __init__(self, layout: Layout) -> None:
        self.conditions = Conditions(layout)
        self.layout = layout
        self.number = next(i for i, condition in enumerate(self.conditions.conditions) if condition.ends)
        self.was: float | None = None

    def ends(self, t: float, state: Array) -> bool:
        """Whether it became true at t, by the state of what is integrated (n',); at the start it may be so already."""
        branches = self.layout.pack.expressions.branches()
        now = self.conditions.held(t, branches, coordinates_in(self.layout, t, state))[self.number]
        became = self.was == 0.0 and now == 1.0 and t > 0.0
        self.was = now
        return became
