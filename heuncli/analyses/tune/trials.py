"""Try variants, each once, and compute the quantities by which they compare.

    goal     f = ± goal / scale            to be least
    excess   c_i = excess_i / scale_i      0 or less where constraint i is met

The scales are those of a first sample over the whole box: half of it lies within one scale of the best. Impure: stores
the trials.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from heuncli.analyses.tune.results import Trial, TuneTask, make_values
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, VariantResult
from heuncli.analyses.variants.parameters import Values
from heuncli.results.results import Array
from heuncli.scene.file_format.quantity import NumberWithUnit

SolveVariants = Callable[[Sequence[Values]], Iterable[VariantResult]]
ReportProgress = Callable[[int, int, str], None]
PlaceKey = tuple[NumberWithUnit, ...]  # the values at a place: places that round to the same ones are one variant
SNAP_DISTANCE = 1e-9  # distance up to which a place counts as at its bound, relative to the width of the box
UNSOLVED_PENALTY = 1.0  # value of unsolved variants for the optimiser, in scales above the worst solved one
UNSOLVED_RANK, INFEASIBLE_RANK = 4.0, 2.0  # ranks of unsolved variants; of those that violate constraints, at least


class Trials:
    """Tries variants, up to the permitted number; repeated variants are not solved again.

    history: the trials, in their order
    phase: of the search, noted in each trial
    time_is_up: whether the time limit ended a trial
    scale: of the goal; scales: of the constraints
    """

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
            return UNSOLVED_RANK
        if self.satisfies_all(trial):
            return math.atan(self.compute_scaled_goal(trial) - median_goal) / math.pi
        violation = self.compute_violation(trial)
        return INFEASIBLE_RANK + violation / (1.0 + violation)

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
