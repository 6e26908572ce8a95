"""Task, trials and results of a tuning.

Variables are reported in their own units and searched as places in [0, 1], 0 at the lower bound; measures are in SI.

The variants that were tried, each once, and the quantities by which they compare.
    goal     f = ± goal / scale            to be least
    excess   c_i = excess_i / scale_i      0 or less where constraint i is met
The scales are those of a first sample over the whole box: half of it lies within one scale of the best. Impure: stores
the trials.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Literal

import numpy as np

from heuncli.analyses.variants.evaluation import Values
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, Comparison, Reason, VariantResult
from heuncli.analyses.variants.parameters import DesignVariable
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array
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
    limit: what ends it, `worse`, `bound`, `jump`, the measure of a constraint or a code; or `less` and `more`, if the
    true distance is smaller or larger
    jumps: the measure of the goal or a constraint that jumps there, in the words of the task; empty if none does
    """

    distance: float
    limit: str
    jumps: str = ""


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


SolveVariants = Callable[[Sequence[Values]], Iterable[VariantResult]]
ReportProgress = Callable[[int, int, str], None]
PlaceKey = tuple[NumberWithUnit, ...]  # the values at a place: places that round to the same ones are one variant
SNAP_DISTANCE = 1e-9  # of the width of a variable's interval: closer to a bound means at it
UNSOLVED_PENALTY = 1.0  # scales above the worst solved value: the value of unsolved variants for the optimiser


class Trials:
    """Tries variants, up to the permitted number; repeated variants are not solved again."""

    def __init__(self, task: TuneTask, solve_variants: SolveVariants, report_progress: ReportProgress) -> None:
        self.task, self.solve_variants, self.report_progress = task, solve_variants, report_progress
        self.history: list[Trial] = []
        self.phase = ""
        self.time_is_up = False
        self.scale, self.scales = 1.0, tuple(1.0 for _ in task.constraints)
        self._known: dict[PlaceKey, Trial] = {}

    @property
    def remaining(self) -> int:
        """Number of variants that may still be solved."""
        return 0 if self.time_is_up else self.task.max_variants - len(self.history)

    def try_place(self, place: Array) -> Trial | None:
        """Return the trial at a place (n,); None if no more may be solved."""
        return self.try_places([place])[0]

    def try_places(self, places: Sequence[Array]) -> list[Trial | None]:
        """Return the trials at several places; new ones are solved together."""
        snapped = [snap_to_bounds(place) for place in places]
        keys = [self._make_key(place) for place in snapped]
        new_places: dict[PlaceKey, tuple[float, ...]] = {}
        for key, place in zip(keys, snapped, strict=True):
            if key not in self._known and key not in new_places and len(new_places) < self.remaining:
                new_places[key] = place
        values = [make_values(self.task.variables, place) for place in new_places.values()]
        for (key, place), outcome in zip(
            new_places.items(), self.solve_variants(values) if values else (), strict=False
        ):
            if outcome.code == TIME_LIMIT_CODE:
                self.time_is_up = True
                break
            trial = Trial(len(self.history) + 1, self.phase, place, outcome)
            self.history.append(trial)
            self._known[key] = trial
            self.report_progress(len(self.history), self.task.max_variants, self.phase)
        return [self._known.get(key) for key in keys]

    def _make_key(self, place: tuple[float, ...]) -> PlaceKey:
        """Return the values of a place, as the spec would get them."""
        return tuple(make_values(self.task.variables, place).values())

    def set_scales(self) -> None:
        """Set the scales of goal and constraints from the trials solved so far."""
        solved_trials = [trial for trial in self.history if trial.is_solved]
        if not solved_trials:
            return
        goals = np.array([self.task.goal.sign * trial.goal for trial in solved_trials])
        self.scale = first_positive(
            float(np.median(goals) - goals.min()), float(np.ptp(goals)), float(np.abs(goals).max())
        )
        excesses = np.abs([self.compute_excesses(trial) for trial in solved_trials])
        limits = [abs(constraint.value) for constraint in self.task.constraints]
        self.scales = tuple(
            first_positive(float(np.median(column)), float(column.max()), limit)
            for column, limit in zip(excesses.T, limits, strict=True)
        )

    def compute_excesses(self, trial: Trial) -> list[float]:
        """Return by how much a solved variant exceeds each limit; negative: the margin."""
        return [
            constraint.compute_excess(value)
            for constraint, value in zip(self.task.constraints, trial.constraint_values, strict=True)
        ]

    def compute_scaled_goal(self, trial: Trial) -> float:
        """Return f of a solved variant."""
        return self.task.goal.sign * trial.goal / self.scale

    def compute_scaled_excesses(self, trial: Trial) -> list[float]:
        """Return c of a solved variant."""
        return [excess / scale for excess, scale in zip(self.compute_excesses(trial), self.scales, strict=True)]

    def compute_violation(self, trial: Trial) -> float:
        """Return the sum of the constraint violations, in scales; 0 if all are satisfied."""
        return sum(max(excess, 0.0) for excess in self.compute_scaled_excesses(trial))

    def satisfies_all(self, trial: Trial) -> bool:
        """Return whether a solved variant satisfies all constraints."""
        return all(
            constraint.is_met(value)
            for constraint, value in zip(self.task.constraints, trial.constraint_values, strict=True)
        )

    def compute_rank(self, trial: Trial | None, median_goal: float) -> float:
        """Return the rank by which any two variants compare: feasible ones come first, then those of least violation.

        median_goal: value of f about which differences are resolved best
        """
        if trial is None or not trial.is_solved:
            return 4.0
        if self.satisfies_all(trial):
            return math.atan(self.compute_scaled_goal(trial) - median_goal) / math.pi
        violation = self.compute_violation(trial)
        return 2.0 + violation / (1.0 + violation)

    def compute_merit(self, trial: Trial, weight: float | None) -> float:
        """Return f plus the weighted violation of a solved variant; without a weight the violation alone."""
        violation = self.compute_violation(trial)
        return violation if weight is None else self.compute_scaled_goal(trial) + weight * violation

    def find_worst_value(self, evaluate: Callable[[Trial], float]) -> float:
        """Return the value that represents an unsolved variant."""
        return max((evaluate(trial) for trial in self.history if trial.is_solved), default=0.0) + UNSOLVED_PENALTY

    def find_best(self, accepts: Callable[[Trial], bool] = lambda trial: True) -> Trial | None:
        """Return the best feasible trial; if there is none, the one of least violation."""
        candidates = [trial for trial in self.history if trial.is_solved and accepts(trial)]
        feasible_trials = [trial for trial in candidates if self.satisfies_all(trial)]
        if feasible_trials:
            return min(feasible_trials, key=self.compute_scaled_goal)
        return min(candidates, key=self.compute_violation, default=None)

    def is_better(self, trial: Trial, other: Trial) -> bool:
        """Return whether a variant is better than another one, which is solved."""
        if not trial.is_solved:
            return False
        if self.satisfies_all(trial) and self.satisfies_all(other):
            return self.compute_scaled_goal(trial) < self.compute_scaled_goal(other)
        return self.compute_violation(trial) < self.compute_violation(other)

    @property
    def has_feasible(self) -> bool:
        """Whether a feasible variant is known."""
        best = self.find_best()
        return best is not None and self.satisfies_all(best)

    @property
    def floor(self) -> float:
        """The smallest difference of f that counts: the stated error of the best, or the requested precision."""
        best = self.find_best()
        error = best.outcome.measures[0].error if best is not None else None
        return max((error or 0.0) / self.scale, self.task.precision)

    def count_failures(self) -> Counter[str]:
        """Return the number of unsolved variants by code."""
        return Counter(trial.failure.code for trial in self.history if not trial.is_solved)


def snap_to_bounds(place: Array) -> tuple[float, ...]:
    """Return a place in the box, moved to a bound if it is very near."""
    return tuple(0.0 if x < SNAP_DISTANCE else 1.0 if x > 1.0 - SNAP_DISTANCE else float(x) for x in place)


def first_positive(*sizes: float) -> float:
    """Return the first finite positive size, or 1."""
    return next((size for size in sizes if math.isfinite(size) and size > 0.0), 1.0)
