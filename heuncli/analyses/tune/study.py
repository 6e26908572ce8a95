"""The best of a scene's variants: an overview, a descent, a last look around.

    overview   differential evolution over the whole box
    descent    COBYLA and a simplex in turn, until neither improves the goal by more than its floor
    freedom    how far each variable may move
    elsewhere  a descent from the best of the overview that lies apart, if evaluations are left

What is found better by the last two is gone down from anew.

The floor is the goal's own stated error, or a small share of what it ranges over if that is more. Impure: tries
variants.
"""

from __future__ import annotations

import math

from heuncli.analyses.tune.descent import descend, try_from
from heuncli.analyses.tune.freedom import freedoms
from heuncli.analyses.tune.overview import OVERVIEW, look_over
from heuncli.analyses.tune.results import Ending, Leeway, Trial, TrialOutcome, TuneResults
from heuncli.analyses.tune.trials import Trials

APART = 0.2  # of the box: another minimum may lie as far from the best
ANEW = 4  # descents at most
ACTIVE = 1e-5  # scales: a constraint with less left over is one that holds the goal back


class Tuning:
    """A search under way: whatever interrupts it, what was found so far can be told."""

    def __init__(self, trials: Trials, own: TrialOutcome) -> None:
        """own: the scene as it is."""
        self.trials, self.own = trials, own
        self.gain: float | None = None
        self.freedoms: tuple[Leeway, ...] = ()

    def run(self) -> None:
        """Search. Impure: tries variants."""
        look_over(self.trials)
        if self.trials.best() is None:
            return
        for _ in range(ANEW):
            self.gain = descend(self.trials)
            if not (self._finds_better_around() or self._finds_better_elsewhere()):
                return
        self.gain = None  # there always was something better

    def _finds_better_around(self) -> bool:
        """Whether the last look around the best finds a better one."""
        best = self.trials.best()
        if self.gain is None or best is None or not self.trials.meets_all(best):
            return False
        self.freedoms = freedoms(self.trials, best)
        return self._is_better_than(best)

    def _finds_better_elsewhere(self) -> bool:
        """Whether the way down from the best of the overview that lies apart leads to a better one."""
        trials = self.trials
        best = trials.best()
        if self.gain is None or best is None or not trials.left:
            return False
        apart = trials.best(lambda trial: trial.phase == OVERVIEW and distance(trial, best) > APART)
        if apart is None or any(
            distance(trial, apart) < APART / 2.0 and trials.comes_before(trial, apart) for trial in trials.history
        ):
            return False  # there is none, or it lies on the slope down to another
        try_from(trials, apart)
        return self._is_better_than(best)

    def _is_better_than(self, best: Trial) -> bool:
        """Whether there is now something better, by more than the floor."""
        trials = self.trials
        now = trials.best()
        assert now is not None
        if not trials.meets_all(best):
            return trials.passed(best) - trials.passed(now) > trials.floor
        return trials.scaled_goal(best) - trials.scaled_goal(now) > trials.floor

    def results(self) -> TuneResults:
        """What was found so far."""
        trials = self.trials
        best = trials.best()
        feasible = best is not None and trials.meets_all(best)
        converged = self.gain is not None and feasible
        ended: Ending = "time" if trials.time_is_up else "infeasible" if trials.left and not feasible else "evaluations"
        return TuneResults(
            task=trials.task,
            own=self.own,
            history=tuple(trials.history),
            best=best,
            feasible=feasible,
            ending="converged" if converged else ended,
            gain=None if self.gain is None else self.gain * trials.scale,
            floor=trials.floor * trials.scale,
            freedoms=self.freedoms,
            active=self._active(best),
            scales=trials.scales,
            failures=trials.failures(),
        )

    def _active(self, best: Trial | None) -> tuple[bool, ...]:
        """Which constraints hold the goal back: what is left of them is nothing, within their error."""
        trials = self.trials
        if best is None or not trials.meets_all(best):
            return tuple(False for _ in trials.task.constraints)
        errors = [one.error or 0.0 for one in best.outcome.readings[1:]]
        left = zip(trials.excesses(best), errors, trials.scales, strict=True)
        return tuple(bool(abs(excess) <= max(error, ACTIVE * scale)) for excess, error, scale in left)


def distance(one: Trial, other: Trial) -> float:
    """The largest difference of their places."""
    return max((abs(a - b) for a, b in zip(one.place, other.place, strict=True)), default=math.inf)
