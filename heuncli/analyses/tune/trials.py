"""The variants that were tried, each once, and by what they are judged.

    goal     f = ± goal / scale            to be least
    excess   c_i = excess_i / scale_i      0 or less where constraint i is met

The scales are those of a first sample over the whole box: half of it lies within one scale of the best. Impure: keeps
what was tried.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from heuncli.analyses.tune.results import Trial, TrialOutcome, TuneTask, texts_at
from heuncli.results.results import Array

Answers = Callable[[Sequence[Mapping[str, str]]], Iterable[TrialOutcome]]
Tell = Callable[[int, int, str], None]
TIME_LIMIT = "time-limit"  # the code of a variant that was not solved because the time is up
SNAPPED = 1e-9  # of the width of a variable's interval: nearer to a bound is at it
UNSOLVED = 1.0  # scales above the worst that was solved: what an optimiser is told of what has no value


class Trials:
    """Tries variants, as many as are allowed; what was tried before is not solved again."""

    def __init__(self, task: TuneTask, answers: Answers, tell: Tell) -> None:
        self.task, self.answers, self.tell = task, answers, tell
        self.history: list[Trial] = []
        self.phase = ""
        self.time_is_up = False
        self.scale, self.scales = 1.0, tuple(1.0 for _ in task.constraints)
        self._known: dict[tuple[str, ...], Trial] = {}

    @property
    def left(self) -> int:
        """How many more may be solved."""
        return 0 if self.time_is_up else self.task.most - len(self.history)

    def at(self, place: Array) -> Trial | None:
        """The variant at a place (n,); None where no more may be solved."""
        return self.at_all([place])[0]

    def at_all(self, places: Sequence[Array]) -> list[Trial | None]:
        """The variants at some places, those of them solved together that are new."""
        snapped = [snap(place) for place in places]
        names = [self._name(place) for place in snapped]
        new: dict[tuple[str, ...], tuple[float, ...]] = {}
        for name, place in zip(names, snapped, strict=True):
            if name not in self._known and name not in new and len(new) < self.left:
                new[name] = place
        values = [texts_at(self.task.variables, place) for place in new.values()]
        for (name, place), outcome in zip(new.items(), self.answers(values) if values else (), strict=False):
            if outcome.code == TIME_LIMIT:
                self.time_is_up = True
                break
            trial = Trial(len(self.history) + 1, self.phase, place, outcome)
            self.history.append(trial)
            self._known[name] = trial
            self.tell(len(self.history), self.task.most, self.phase)
        return [self._known.get(name) for name in names]

    def _name(self, place: tuple[float, ...]) -> tuple[str, ...]:
        return tuple(texts_at(self.task.variables, place).values())

    def set_scales(self) -> None:
        """Scale goal and constraints by what was solved so far."""
        solved = [trial for trial in self.history if trial.solved]
        if not solved:
            return
        goals = np.array([self.task.goal.sign * trial.goal for trial in solved])
        self.scale = size_of(float(np.median(goals) - goals.min()), float(np.ptp(goals)), float(np.abs(goals).max()))
        excesses = np.abs([self.excesses(trial) for trial in solved])
        limits = [abs(one.limit) for one in self.task.constraints]
        self.scales = tuple(
            size_of(float(np.median(column)), float(column.max()), limit)
            for column, limit in zip(excesses.T, limits, strict=True)
        )

    def excesses(self, trial: Trial) -> list[float]:
        """By how much a solved variant passes each limit; negative: how much is left."""
        return [one.excess(value) for one, value in zip(self.task.constraints, trial.kept_to, strict=True)]

    def scaled_goal(self, trial: Trial) -> float:
        """f of a solved variant."""
        return self.task.goal.sign * trial.goal / self.scale

    def scaled_excesses(self, trial: Trial) -> list[float]:
        """c of a solved variant."""
        return [excess / scale for excess, scale in zip(self.excesses(trial), self.scales, strict=True)]

    def passed(self, trial: Trial) -> float:
        """By how much the constraints are passed, in scales; 0 where all are met or just met."""
        return sum(max(excess, 0.0) for excess in self.scaled_excesses(trial))

    def meets_all(self, trial: Trial) -> bool:
        """Whether a solved variant keeps all constraints."""
        return all(one.met(value) for one, value in zip(self.task.constraints, trial.kept_to, strict=True))

    def rank(self, trial: Trial | None, middle: float) -> float:
        """By which any two variants compare: what keeps the constraints comes first, then what passes them least.

        middle: of f, about which its differences are told apart best.
        """
        if trial is None or not trial.solved:
            return 4.0
        if self.meets_all(trial):
            return math.atan(self.scaled_goal(trial) - middle) / math.pi
        passed = self.passed(trial)
        return 2.0 + passed / (1.0 + passed)

    def merit(self, trial: Trial, weight: float | None) -> float:
        """f, and what the constraints are passed by with a weight (None: that alone), of a solved variant."""
        passed = self.passed(trial)
        return passed if weight is None else self.scaled_goal(trial) + weight * passed

    def worst(self, judge: Callable[[Trial], float]) -> float:
        """What stands for a variant that cannot be solved, or may not."""
        return max((judge(trial) for trial in self.history if trial.solved), default=0.0) + UNSOLVED

    def best(self, but: Callable[[Trial], bool] = lambda trial: True) -> Trial | None:
        """The best of those that keep all constraints; else the one that passes them least."""
        solved = [trial for trial in self.history if trial.solved and but(trial)]
        kept = [trial for trial in solved if self.meets_all(trial)]
        if kept:
            return min(kept, key=self.scaled_goal)
        return min(solved, key=self.passed, default=None)

    def comes_before(self, one: Trial, other: Trial) -> bool:
        """Whether a variant is better than another one, which is solved."""
        if not one.solved:
            return False
        if self.meets_all(one) and self.meets_all(other):
            return self.scaled_goal(one) < self.scaled_goal(other)
        return self.passed(one) < self.passed(other)

    @property
    def feasible(self) -> bool:
        """Whether one that keeps all constraints is known."""
        best = self.best()
        return best is not None and self.meets_all(best)

    @property
    def floor(self) -> float:
        """What two values of f are not told apart by: the stated error of the best, or what is asked for."""
        best = self.best()
        error = best.outcome.readings[0].error if best is not None else None
        return max((error or 0.0) / self.scale, self.task.precision)

    def failures(self) -> Counter[str]:
        """How many could not be solved, by their codes."""
        return Counter(trial.failure[0] for trial in self.history if not trial.solved)


def snap(place: Array) -> tuple[float, ...]:
    """A place in the box, at its bounds where it is next to them."""
    return tuple(0.0 if x < SNAPPED else 1.0 if x > 1.0 - SNAPPED else float(x) for x in place)


def size_of(*sizes: float) -> float:
    """The first that is a size."""
    return next((size for size in sizes if math.isfinite(size) and size > 0.0), 1.0)
