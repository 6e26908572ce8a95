"""Find the best of a scene's variants, and how far each variable may move from there.

Near a minimum the goal rises as s^p with the distance s, p = 2 where it is smooth, 1 at a kink: the logarithms are
followed along a straight line until the amount is reached. This is also a last search around the best: a better variant
found here starts a new descent.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.sweep_rows import is_jump
from heuncli.analyses.tune.results import Ending, ToleranceMove, ToleranceRange, Trial, TuneResults
from heuncli.analyses.tune.search import MOVES_PHASE, OVERVIEW_PHASE, descend, descend_from, search_globally
from heuncli.analyses.tune.trials import Trials
from heuncli.analyses.variants.measures import VariantResult

HUNDREDTH = 0.01  # relative worsening of the goal up to which variables may move
FIRST_DISTANCE = 0.01  # first distance that is tried, relative to the width of the box
MIN_DISTANCE = 1e-8  # smallest one: ten times the last digit in which values are shown
MIN_SHARE = 0.8  # share of the amount: a distance at which the goal is worse by this is accepted
AIMED_SHARE = 0.9  # share of the amount at which the next distance aims
MIN_FACTOR = 1.02  # smallest ratio of the next distance to those that bracket it
POWER_RANGE = (1.0, 2.0)  # least and largest power of the distance with which the goal rises
MAX_TRIALS = 7  # evaluations for one amount to one side
MAX_RATIO, MIN_POWER = 1e20, 0.1  # limits of the extrapolation
# If the goal rises by a higher power of the distance, it jumps within it; if by a lower one, it jumps before it:
JUMP_POWER, STEEP_POWER = 6.0, 0.5


def find_tolerance_ranges(trials: Trials, best: Trial) -> tuple[ToleranceRange, ...]:
    """Find the tolerance range of each variable. Impure: tries variants."""
    trials.phase = MOVES_PHASE
    floor, hundredth = trials.floor * trials.scale, HUNDREDTH * abs(best.goal)
    if hundredth <= floor:
        hundredth = 0.0
    ranges = []
    for index in range(len(best.place)):
        down, up = (_SideSearch(trials, best, index, sign) for sign in (-1.0, 1.0))
        hundredth_moves = down.find_move(hundredth), up.find_move(hundredth)
        ranges.append(ToleranceRange((down.find_move(floor), up.find_move(floor)), hundredth_moves))
    return tuple(ranges)


class _SideSearch:
    """Search along one variable to one side of the best: how far it may move before the goal is worse by an amount.

    max_distance: up to the variable's bound; distances are relative to the width of the box
    worsening: by how much the goal was worse, by distance; infinite where a constraint is violated or nothing is solved
    reasons: of the infinite ones, the code of the failure or the measure of the constraint
    tried: the solved variants, by distance
    """

    def __init__(self, trials: Trials, best: Trial, index: int, sign: float) -> None:
        """index: of the variable; sign: 1 to move up, -1 down"""
        self.trials, self.best, self.index, self.sign = trials, best, index, sign
        place = best.place[index]
        self.max_distance = place if sign < 0.0 else 1.0 - place
        self.worsening: dict[float, float] = {}
        self.reasons: dict[float, str] = {}
        self.tried: dict[float, Trial] = {0.0: best}

    def find_move(self, amount: float) -> ToleranceMove | None:
        """Find the distance at which the goal is worse by an amount; None if no evaluation is left, or the amount is 0.

        Impure: tries variants.
        """
        if self.max_distance <= 0.0:
            return ToleranceMove(0.0, "bound")
        if not amount > 0.0:
            return None
        for _ in range(MAX_TRIALS):
            low, high = self._bracket(amount)
            if low == self.max_distance or (low > 0.0 and self.worsening.get(low, 0.0) >= MIN_SHARE * amount):
                break
            if high <= MIN_DISTANCE or (low > 0.0 and high <= low * (2.0 - MIN_SHARE)):
                break
            if not self._try_distance(self._choose_distance(low, high, amount)):
                return None
        low, high = self._bracket(amount)
        if low == self.max_distance:
            return ToleranceMove(self._to_unit(low), "bound")
        if high == math.inf:
            return ToleranceMove(self._to_unit(low), "worse" if self.worsening[low] >= MIN_SHARE * amount else "more")
        if high in self.reasons:
            return ToleranceMove(self._to_unit(low), self.reasons[high], self._find_jumping_constraint(low, high))
        if self._has_jump(low, high, amount):
            return ToleranceMove(self._to_unit(low), "jump", self.trials.task.goal.measure)
        return ToleranceMove(self._to_unit(low), "worse") if low else ToleranceMove(self._to_unit(high), "less")

    def _bracket(self, amount: float) -> tuple[float, float]:
        """Return the longest distance at which the goal is not worse by the amount, and the shortest at which it is.

        They are 0 and infinite where none is known.
        """
        high = min((s for s, increase in self.worsening.items() if increase > amount), default=math.inf)
        low = max((s for s, increase in self.worsening.items() if increase <= amount and s < high), default=0.0)
        return low, high

    def _choose_distance(self, low: float, high: float, amount: float) -> float:
        """Return the next distance to try."""
        if not self.worsening:
            return min(FIRST_DISTANCE, self.max_distance)
        rises: dict[float, float] = {s: increase for s, increase in self.worsening.items() if 0.0 < increase < math.inf}
        if high == math.inf:
            ratio = min(max(amount / rises[low], 1.5), 100.0) if low in rises else 4.0
            return min(low * ratio, self.max_distance)
        if low in rises and high in rises:
            power = math.log(rises[high] / rises[low]) / math.log(high / low)
            guess = scale_step(low, AIMED_SHARE * amount / rises[low], power)
            return guess if MIN_FACTOR * low < guess < high / MIN_FACTOR else math.sqrt(low * high)
        if low > 0.0:
            return math.sqrt(low * high)
        if high in rises:
            return max(scale_step(high, AIMED_SHARE * amount / rises[high], self._estimate_power()), MIN_DISTANCE)
        return max(0.1 * high, MIN_DISTANCE)

    def _estimate_power(self) -> float:
        """Return the power of the distance with which the goal rises, from the two shortest distances."""
        distances = sorted(s for s, increase in self.worsening.items() if 0.0 < increase < math.inf)[:2]
        if len(distances) < 2:
            return POWER_RANGE[0]
        power = math.log(self.worsening[distances[1]] / self.worsening[distances[0]]) / math.log(
            distances[1] / distances[0]
        )
        return min(max(power, POWER_RANGE[0]), POWER_RANGE[1])

    def _try_distance(self, s: float) -> bool:
        """Try the variant at a distance; return False if no more may be tried. Impure: tries a variant."""
        place = np.array(self.best.place)
        place[self.index] += self.sign * s
        trial = self.trials.try_place(place)
        if trial is None:
            return False
        if not trial.is_solved:
            self.worsening[s], self.reasons[s] = math.inf, trial.failure.code
            return True
        self.tried[s] = trial
        violated = [
            constraint.measure
            for constraint, value in zip(self.trials.task.constraints, trial.constraint_values, strict=True)
            if not constraint.is_met(value)
        ]
        if violated:
            self.worsening[s], self.reasons[s] = math.inf, violated[0]
        else:
            self.worsening[s] = self.trials.task.goal.sign * (trial.goal - self.best.goal)
        return True

    def _has_jump(self, low: float, high: float, amount: float) -> bool:
        """Return whether the goal jumps between a distance at which it is not worse by an amount, and the next one."""
        if low > 0.0:
            lower = self.worsening[low] if self.worsening[low] > 0.0 else amount
            return math.log(self.worsening[high] / lower) > JUMP_POWER * math.log(high / low)
        longer = min(
            (s for s, increase in self.worsening.items() if s > high and 0.0 < increase < math.inf), default=None
        )
        return longer is not None and self.worsening[high] > self.worsening[longer] * math.pow(
            high / longer, STEEP_POWER
        )

    def _find_jumping_constraint(self, low: float, high: float) -> str:
        """Return the constraint that is violated by a jump between two distances; empty if it rises to its limit.

        Without a jump it changes between them by no more than up to the shorter one, as a power of the distance; if
        the shorter one is 0, by less than up to the next longer one.
        """
        longer = min((s for s in self.tried if s > high), default=None)
        if high not in self.tried or (low == 0.0 and longer is None):
            return ""
        for k, constraint in enumerate(self.trials.task.constraints):
            if constraint.measure != self.reasons[high]:
                continue
            first, before, after = (self.tried[s].constraint_values[k] for s in (0.0, low, high))
            error = sum(self.tried[s].outcome.measures[k + 1].error or 0.0 for s in (low, high))
            if low > 0.0:
                change = ((high / low) ** JUMP_POWER - 1.0) * abs(before - first)
            else:
                assert longer is not None
                change = abs(self.tried[longer].constraint_values[k] - first) * (high / longer) ** STEEP_POWER
            return constraint.measure if is_jump(after - before, change, error) else ""
        return ""

    def _to_unit(self, s: float) -> float:
        """Convert a distance to the unit of the variable."""
        variable = self.trials.task.variables[self.index]
        return float(s * (variable.high - variable.low))


def scale_step(step: float, ratio: float, power: float) -> float:
    """Scale a step so that a quantity growing like step**power changes by `ratio`."""
    return step * math.pow(min(ratio, MAX_RATIO), 1.0 / max(power, MIN_POWER))


MIN_SEPARATION = 0.2  # distance at which another minimum may lie, relative to the width of the box
MAX_DESCENTS = 4  # descents at most
ACTIVE_MARGIN = 1e-5  # margin up to which a constraint is active, in scales


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
        if self.trials.find_best() is None:
            return
        for _ in range(MAX_DESCENTS):
            self.gain = descend(self.trials)
            if not (self._finds_better_around() or self._finds_better_elsewhere()):
                return
        self.gain = None  # every descent found something better

    def _finds_better_around(self) -> bool:
        """Return whether the last search around the best finds a better variant."""
        best = self.trials.find_best()
        if self.gain is None or best is None or not self.trials.satisfies_all(best):
            return False
        self.tolerance_ranges = find_tolerance_ranges(self.trials, best)
        return self._has_improved(best)

    def _finds_better_elsewhere(self) -> bool:
        """Return whether the descent from the best separate variant of the overview finds a better one."""
        trials = self.trials
        best = trials.find_best()
        if self.gain is None or best is None or not trials.remaining:
            return False
        separate = trials.find_best(
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
        current = trials.find_best()
        assert current is not None
        if not trials.satisfies_all(best):
            return trials.compute_violation(best) - trials.compute_violation(current) > trials.floor
        return trials.compute_scaled_goal(best) - trials.compute_scaled_goal(current) > trials.floor

    def make_results(self) -> TuneResults:
        """Return the results so far."""
        trials = self.trials
        best = trials.find_best()
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
