"""Find the best of a scene's variants: an overview, a descent, and a last search around it.
    overview   differential evolution over the whole box
    descent    COBYLA and a simplex in turn, until neither improves the goal by more than its floor
    freedom    how far each variable may move
    elsewhere  a descent from the best separate variant of the overview, if evaluations are left
A better variant found by the last two starts a new descent. The floor is the goal's own stated error, or a small share
of its range if that is larger. Impure: tries variants.
"""

from __future__ import annotations

import math

from heuncli.analyses.tune.descent import descend, descend_from
from heuncli.analyses.tune.global_search import OVERVIEW_PHASE, search_globally
from heuncli.analyses.tune.results import Ending, ToleranceRange, Trial, TuneResults
from heuncli.analyses.tune.tolerance_ranges import find_tolerance_ranges
from heuncli.analyses.tune.trials import Trials
from heuncli.analyses.variants.measures import VariantResult

MIN_SEPARATION = 0.2  # of the box: distance at which another minimum may lie
MAX_DESCENTS = 4  # descents at most
ACTIVE_MARGIN = 1e-5  # scales: a constraint with a smaller margin is active


class Tuning:
    """A running search; if it is interrupted, the results so far are available."""

    def __init__(self, trials: Trials, spec_outcome: VariantResult) -> None:
        """spec_outcome: the scene with its own values"""
        self.trials, self.spec_outcome = trials, spec_outcome
        self.gain: float | None = None
        self.tolerance_ranges: tuple[ToleranceRange, ...] = ()

    def run(self) -> None:
        """Search. Impure: tries variants."""
        search_globally(self.trials)
        if self.trials.best() is None:
            return
        for _ in range(MAX_DESCENTS):
            self.gain = descend(self.trials)
            if not (self._finds_better_around() or self._finds_better_elsewhere()):
                return
        self.gain = None  # every descent found something better

    def _finds_better_around(self) -> bool:
        """Return whether the last search around the best finds a better variant."""
        best = self.trials.best()
        if self.gain is None or best is None or not self.trials.satisfies_all(best):
            return False
        self.tolerance_ranges = find_tolerance_ranges(self.trials, best)
        return self._has_improved(best)

    def _finds_better_elsewhere(self) -> bool:
        """Return whether the descent from the best separate variant of the overview finds a better one."""
        trials = self.trials
        best = trials.best()
        if self.gain is None or best is None or not trials.remaining:
            return False
        separate = trials.best(
            lambda trial: trial.phase == OVERVIEW_PHASE and compute_distance(trial, best) > MIN_SEPARATION
        )
        if separate is None or any(
            compute_distance(trial, separate) < MIN_SEPARATION / 2.0 and trials.is_better(trial, separate)
            for trial in trials.history
        ):
            return False  # there is none, or it lies on the slope towards another trial
        descend_from(trials, separate)
        return self._has_improved(best)

    def _has_improved(self, best: Trial) -> bool:
        """Return whether the current best is better by more than the floor."""
        trials = self.trials
        current = trials.best()
        assert current is not None
        if not trials.satisfies_all(best):
            return trials.compute_violation(best) - trials.compute_violation(current) > trials.floor
        return trials.scaled_goal(best) - trials.scaled_goal(current) > trials.floor

    def to_results(self) -> TuneResults:
        """Return the results so far."""
        trials = self.trials
        best = trials.best()
        is_feasible = best is not None and trials.satisfies_all(best)
        is_converged = self.gain is not None and is_feasible
        unfinished_ending: Ending = (
            "time" if trials.time_is_up else "infeasible" if trials.remaining and not is_feasible else "evaluations"
        )
        return TuneResults(
            task=trials.task,
            spec_outcome=self.spec_outcome,
            history=tuple(trials.history),
            best=best,
            is_feasible=is_feasible,
            ending="converged" if is_converged else unfinished_ending,
            gain=None if self.gain is None else self.gain * trials.scale,
            floor=trials.floor * trials.scale,
            tolerance_ranges=self.tolerance_ranges,
            active_constraints=self._find_active(best),
            scales=trials.scales,
            failures=trials.count_failures(),
        )

    def _find_active(self, best: Trial | None) -> tuple[bool, ...]:
        """Return which constraints limit the goal: their margin is zero within their error."""
        trials = self.trials
        if best is None or not trials.satisfies_all(best):
            return tuple(False for _ in trials.task.constraints)
        errors = [one.error or 0.0 for one in best.outcome.measures[1:]]
        margins = zip(trials.compute_excesses(best), errors, trials.scales, strict=True)
        return tuple(bool(abs(excess) <= max(error, ACTIVE_MARGIN * scale)) for excess, error, scale in margins)


def compute_distance(one: Trial, other: Trial) -> float:
    """Return the largest difference between the places of two trials."""
    return max((abs(a - b) for a, b in zip(one.place, other.place, strict=True)), default=math.inf)
