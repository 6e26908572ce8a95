"""The condition that ends a run."""

from __future__ import annotations

from heuncli.motion.integration.conditions import Conditions, read_coordinates
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


class EndingCondition:
    """The condition that ends a run, evaluated where a piece begins and where branches change. Remembers its last
    value.
    """

    def __init__(self, layout: Layout) -> None:
        self.conditions = Conditions(layout)
        self.layout = layout
        self.number = next(i for i, condition in enumerate(self.conditions.conditions) if condition.ends)
        self.previous_truth: float | None = None

    def has_become_true(self, t: float, state: Array) -> bool:
        """Return whether it became true at t, in an integrated state (n',); at the start it may already be true."""
        branches = self.layout.pack.expressions.branches()
        now = self.conditions.evaluate_held(t, branches, read_coordinates(self.layout, t, state))[self.number]
        became = self.previous_truth == 0.0 and now == 1.0 and t > 0.0
        self.previous_truth = now
        return became
