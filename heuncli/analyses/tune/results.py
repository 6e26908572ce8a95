"""Task, trials and results of a tuning.

Variables are reported in their own units and searched as places in [0, 1], 0 at the lower bound; measures are in SI.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record

RESOLUTION_DIGITS = 9  # of a variable, relative to the width of its interval: a thousandth of the search's resolution
Ending = Literal["converged", "evaluations", "time", "infeasible"]


class DesignVariable(NamedTuple):
    """A parameter with two bounds, in its unit; spec_value: its value in the spec, None if it has none."""

    name: str
    low: float
    high: float
    unit: str
    spec_value: float | None = None

    def to_value(self, place: float) -> float:
        """Return the value at a place of [0, 1], rounded to significant digits, so that the value shown is the value
        solved.
        """
        if place <= 0.0:
            return self.low
        if place >= 1.0:
            return self.high
        width = self.high - self.low
        decimals = RESOLUTION_DIGITS - math.floor(math.log10(width))
        return min(max(round(self.low + place * width, decimals), self.low), self.high)

    def to_text(self, place: float) -> str:
        """Return the value at a place, in the form of --set."""
        value = repr(self.to_value(place))
        return f"{value} {self.unit}" if self.unit else value

    @property
    def spec_place(self) -> float | None:
        """The place of the spec's value; None if it is out of bounds."""
        if self.spec_value is None or not self.low <= self.spec_value <= self.high:
            return None
        return (self.spec_value - self.low) / (self.high - self.low)


class TuneGoal(NamedTuple):
    """A measure to be minimised, or maximised (`is_maximised`), and its SI unit (empty: none)."""

    measure: str
    unit: str
    is_maximised: bool

    @property
    def sign(self) -> float:
        """Factor that makes the measure one to be minimised."""
        return -1.0 if self.is_maximised else 1.0


class TuneConstraint(NamedTuple):
    """An upper or lower limit for a measure; SI."""

    measure: str
    sign: Literal["<", ">", "<=", ">="]
    limit: float
    unit: str

    def compute_excess(self, value: float) -> float:
        """Return by how much the limit is exceeded; negative: the margin."""
        return value - self.limit if self.sign in ("<", "<=") else self.limit - value

    def is_met(self, value: float) -> bool:
        """Return whether the constraint is satisfied."""
        excess = self.compute_excess(value)
        return excess < 0.0 or (excess == 0.0 and len(self.sign) == 2)


@record
class TuneTask:
    """A tuning task: variables, goal, constraints.

    max_variants: maximum number of variants
    precision: relative resolution of the goal, as a share of its range
    seed: of random numbers
    """

    variables: tuple[DesignVariable, ...]
    goal: TuneGoal
    constraints: tuple[TuneConstraint, ...] = ()
    max_variants: int = 400
    precision: float = 1e-6
    seed: int = 0


class MeasureReading(NamedTuple):
    """A measure of a variant: value, stated error and instant; value None: unknown, `reason` says why."""

    value: float | None
    error: float | None = None
    instant: float | None = None
    reason: str = ""


class TrialOutcome(NamedTuple):
    """Outcome of a variant: readings of goal and constraints, or the code and reason why there are none.

    warnings: sentences of the run
    """

    readings: tuple[MeasureReading, ...] = ()
    code: str = ""
    reason: str = ""
    warnings: tuple[str, ...] = ()


class Trial(NamedTuple):
    """A variant that was tried: its place, the phase of the search, and its outcome."""

    number: int
    phase: str
    place: tuple[float, ...]
    outcome: TrialOutcome

    @property
    def is_solved(self) -> bool:
        """Whether all measures are known."""
        return bool(self.outcome.readings) and all(one.value is not None for one in self.outcome.readings)

    @property
    def failure(self) -> tuple[str, str]:
        """Code of what is unknown, and a sentence."""
        outcome = self.outcome
        word = next((one.reason for one in outcome.readings if one.value is None), "")
        return (outcome.code, outcome.reason) if outcome.code else (word, UNKNOWN.get(word, word))

    @property
    def goal(self) -> float:
        """The value of the goal of a solved variant."""
        value = self.outcome.readings[0].value
        assert value is not None
        return value

    @property
    def constraint_values(self) -> tuple[float, ...]:
        """The values of the constraints of a solved variant."""
        return tuple(one.value for one in self.outcome.readings[1:] if one.value is not None)


UNKNOWN = {
    "absent": "the measured event does not happen",
    "open": "a measure is open: statically indeterminate",
    "beyond": "a measure is past the horizon",
    "unknown": "a measure is not known: singular position",
}


class ToleranceMove(NamedTuple):
    """How far a variable may move to one side before the goal is worse by some amount.

    distance: in the variable's unit
    limit: what ends it, `worse`, `bound`, `jump`, the measure of a constraint or a code; or `less` and `more`, if the
    true distance is smaller or larger
    """

    distance: float
    limit: str


class ToleranceRange(NamedTuple):
    """How far one variable may move, down and up: until the goal is worse by the floor, and by a hundredth of it."""

    of_floor: tuple[ToleranceMove | None, ToleranceMove | None] = (None, None)
    of_hundredth: tuple[ToleranceMove | None, ToleranceMove | None] = (None, None)


@record
class TuneResults:
    """Results of a tuning.

    spec_outcome: the scene with its own values
    best: the best variant that satisfies all constraints, or, if not `is_feasible`, the one with the least violation;
    None if nothing was solved
    gain: improvement of the goal by the last two restarts; floor: smallest improvement searched for
    tolerance_ranges: of each variable, empty if no evaluation was left
    active_constraints: which constraints limit the goal
    scales: scale of each constraint's margin over the box
    """

    task: TuneTask
    spec_outcome: TrialOutcome
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
        return make_texts(self.task.variables, self.best.place)

    @property
    def is_spec_better(self) -> bool:
        """Whether the scene's own values satisfy all constraints and beat the best variant by more than the floor."""
        assert self.best is not None
        spec_trial = Trial(0, "", (), self.spec_outcome)
        if not spec_trial.is_solved or not all(
            map(TuneConstraint.is_met, self.task.constraints, spec_trial.constraint_values)
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


def make_texts(variables: tuple[DesignVariable, ...], place: tuple[float, ...]) -> dict[str, str]:
    """Return the values at a place, in the form of --set."""
    return {variable.name: variable.to_text(x) for variable, x in zip(variables, place, strict=True)}
