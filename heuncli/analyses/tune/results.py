"""Task, trials and results of a tuning.

Variables are reported in their own units and searched as places in [0, 1], 0 at the lower bound; measures are in SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from heuncli.analyses.variants.conditions import Comparison
from heuncli.analyses.variants.measures import Reason, VariantResult
from heuncli.analyses.variants.parameters import DesignVariable
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.scene.file_format.quantity import NumberWithUnit

Ending = Literal["converged", "evaluations", "time", "infeasible"]


class TuneGoal(NamedTuple):
    """A measure to be minimised, or maximised (`is_maximised`), and its SI unit (empty: none)."""

    measure: str
    unit: str
    is_maximised: bool

    @property
    def sign(self) -> float:
        """Factor that makes the measure one to be minimised."""
        return -1.0 if self.is_maximised else 1.0


@record
class TuneTask:
    """A tuning task: variables, goal, constraints.

    max_variants: maximum number of variants
    precision: relative resolution of the goal, as a share of its range
    seed: of random numbers
    """

    variables: tuple[DesignVariable, ...]
    goal: TuneGoal
    constraints: tuple[Comparison, ...] = ()
    max_variants: int = 400
    precision: float = 1e-6
    seed: int = 0


class Trial(NamedTuple):
    """A variant that was tried: its place, the phase of the search, and its result: the goal, then the constraints."""

    number: int
    phase: str
    place: tuple[float, ...]
    outcome: VariantResult

    @property
    def is_solved(self) -> bool:
        """Whether all measures are known."""
        return self.outcome.is_complete

    @property
    def failure(self) -> Reason:
        """Why the variant, or a measure of it, is unknown."""
        return self.outcome.explain_first()

    @property
    def goal(self) -> float:
        """The value of the goal of a solved variant."""
        value = self.outcome.measures[0].value
        assert value is not None
        return value

    @property
    def constraint_values(self) -> tuple[float, ...]:
        """The values of the constraints of a solved variant."""
        return tuple(one.value for one in self.outcome.measures[1:] if one.value is not None)


class ToleranceMove(NamedTuple):
    """How far a variable may move to one side before the goal is worse by some amount.

    distance: in the variable's unit
    limit: what ends the move: `worse`, `bound`, `jump`, the measure of a constraint, or the code of a failure; `less`
    and `more` say that the true distance is smaller or larger
    jumps: the measure of the goal or a constraint that jumps there, in the words of the task; empty if none does
    """

    distance: float
    limit: str
    jumps: str = ""


class ToleranceRange(NamedTuple):
    """How far one variable may move, down and up: until the goal is worse by the floor, and by a hundredth of itself.

    None where no evaluation was left
    """

    floor_moves: tuple[ToleranceMove | None, ToleranceMove | None] = (None, None)
    hundredth_moves: tuple[ToleranceMove | None, ToleranceMove | None] = (None, None)


@record
class TuneResults:
    """Results of a tuning.

    spec_outcome: the scene with its own values
    best: the best variant that satisfies all constraints, or, if not `is_feasible`, the one with the least violation;
    None if nothing was solved
    ending: why the search ended
    gain: improvement of the goal by the last two restarts, None if it did not converge
    floor: smallest improvement searched for
    tolerance_ranges: of each variable, empty if no evaluation was left
    active_constraints: which constraints limit the goal
    scales: scale of each constraint's margin over the box
    failures: number of unsolved variants by code
    """

    task: TuneTask
    spec_outcome: VariantResult
    history: tuple[Trial, ...]
    best: Trial | None
    is_feasible: bool
    ending: Ending
    gain: float | None
    floor: float
    tolerance_ranges: tuple[ToleranceRange, ...]
    active_constraints: tuple[bool, ...]
    scales: tuple[float, ...]
    failures: Mapping[str, int]

    @property
    def best_texts(self) -> dict[str, str]:
        """The values of the best variant, in the form of --set."""
        assert self.best is not None
        return {name: value.format() for name, value in make_values(self.task.variables, self.best.place).items()}

    @property
    def is_spec_better(self) -> bool:
        """Whether the scene's own values satisfy all constraints and beat the best variant by more than the floor."""
        assert self.best is not None
        spec_trial = Trial(0, "", (), self.spec_outcome)
        if not spec_trial.is_solved or not all(
            map(Comparison.is_met, self.task.constraints, spec_trial.constraint_values)
        ):
            return False
        return not self.is_feasible or self.task.goal.sign * (self.best.goal - spec_trial.goal) > self.floor

    @property
    def nearest_violated(self) -> int | None:
        """Index of the constraint violated by the best that is nearest to being satisfied, by its scale."""
        assert self.best is not None
        cells = zip(self.task.constraints, self.best.constraint_values, self.scales, strict=True)
        violations = {
            i: constraint.compute_excess(value) / scale
            for i, (constraint, value, scale) in enumerate(cells)
            if not constraint.is_met(value)
        }
        return min(violations, key=violations.__getitem__, default=None)

    def find_bound(self, index: int) -> str:
        """Return the bound at which a variable of the best variant lies: `low`, `high` or empty."""
        assert self.best is not None
        place = self.best.place[index]
        return "low" if place <= 0.0 else "high" if place >= 1.0 else ""


def make_values(variables: tuple[DesignVariable, ...], place: tuple[float, ...]) -> dict[str, NumberWithUnit]:
    """Return the values at a place."""
    return {variable.name: variable.to_value(x) for variable, x in zip(variables, place, strict=True)}
