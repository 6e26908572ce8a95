"""How flat the best is: how far each variable may move, the others standing, before the goal is worse by some amount.

Near a minimum the goal rises as s^p with the way s, p = 2 where it is smooth, 1 in a kink: the logarithms are followed
along a straight line until the amount is met. It is also a last look around: what is found better there begins the
descent anew.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.tune.results import Leeway, Move, Trial
from heuncli.analyses.tune.trials import Trials

HUNDREDTH = 0.01
FIRST = 0.01  # of the width of the box
LEAST = 1e-8  # of it, as a way: ten of the digits in which values are told
NEAR = 0.8  # of the amount: so near to it from below a way is taken as met
POWERS = (1.0, 2.0)  # of the way, between which the goal rises
MOST = 7  # evaluations for one amount to one side
MOST_TIMES, LEAST_POWER = 1e20, 0.1  # beyond which nothing is foretold
JUMPS, STEEP = 6.0, 0.5  # a rise by a higher power of the way is a jump within it; by a lesser one, before it


def freedoms(trials: Trials, best: Trial) -> tuple[Leeway, ...]:
    """Of each variable. Impure: tries variants."""
    trials.phase = "freedom"
    floor, hundredth = trials.floor * trials.scale, HUNDREDTH * abs(best.goal)
    hundredth *= hundredth > floor  # of next to nothing it is not told from nothing
    found = []
    for which in range(len(best.place)):
        down, up = (_Side(trials, best, which, way) for way in (-1.0, 1.0))
        wide = down.move(hundredth), up.move(hundredth)
        found.append(Leeway((down.move(floor), up.move(floor)), wide))
    return tuple(found)


class _Side:
    """One variable to one side of the best: the ways that were gone, and by how much the goal was worse there."""

    def __init__(self, trials: Trials, best: Trial, which: int, way: float) -> None:
        self.trials, self.best, self.which, self.way = trials, best, which, way
        place = best.place[which]
        self.room = place if way < 0.0 else 1.0 - place
        self.gone: dict[float, float] = {}  # by the way [of the box]; infinite where it is no longer an answer
        self.why: dict[float, str] = {}

    def move(self, amount: float) -> Move | None:
        """The way until the goal is worse by an amount; None where no evaluation is left, or the amount is nothing."""
        if self.room <= 0.0:
            return Move(0.0, "bound")
        if not amount > 0.0:
            return None
        for _ in range(MOST):
            low, high = self._around(amount)
            if low == self.room or (low > 0.0 and self.gone.get(low, 0.0) >= NEAR * amount):
                break
            if high <= LEAST or (low > 0.0 and high <= low * (2.0 - NEAR)):
                break
            if not self._go(self._next(low, high, amount)):
                return None
        low, high = self._around(amount)
        if low == self.room:
            return Move(self._in_unit(low), "bound")
        if high == math.inf:
            return Move(self._in_unit(low), "worse" if self.gone[low] >= NEAR * amount else "more")
        if high in self.why:
            return Move(self._in_unit(low), self.why[high])
        if self._jumps(low, high, amount):
            return Move(self._in_unit(low), "jump")
        return Move(self._in_unit(low), "worse") if low else Move(self._in_unit(high), "less")

    def _around(self, amount: float) -> tuple[float, float]:
        """The longest way that does not make it worse by the amount, before the shortest that does (infinite: none)."""
        high = min((s for s, worse in self.gone.items() if worse > amount), default=math.inf)
        return max((s for s, worse in self.gone.items() if worse <= amount and s < high), default=0.0), high

    def _next(self, low: float, high: float, amount: float) -> float:
        """The way to go next."""
        if not self.gone:
            return min(FIRST, self.room)
        rises: dict[float, float] = {s: worse for s, worse in self.gone.items() if 0.0 < worse < math.inf}
        if high == math.inf:
            ratio = min(max(amount / rises[low], 1.5), 100.0) if low in rises else 4.0
            return min(low * ratio, self.room)
        if low in rises and high in rises:
            power = math.log(rises[high] / rises[low]) / math.log(high / low)
            guess = along(low, 0.9 * amount / rises[low], power)
            return guess if 1.02 * low < guess < high / 1.02 else math.sqrt(low * high)
        if low > 0.0:
            return math.sqrt(low * high)
        if high in rises:
            return max(along(high, 0.9 * amount / rises[high], self._power()), LEAST)
        return max(0.1 * high, LEAST)

    def _power(self) -> float:
        """Of the way by which the goal rises, from the two shortest that were gone."""
        ways = sorted(s for s, worse in self.gone.items() if 0.0 < worse < math.inf)[:2]
        if len(ways) < 2:
            return POWERS[0]
        rise = math.log(self.gone[ways[1]] / self.gone[ways[0]]) / math.log(ways[1] / ways[0])
        return min(max(rise, POWERS[0]), POWERS[1])

    def _go(self, s: float) -> bool:
        """Try the variant at a way; False where none may be tried any more."""
        place = np.array(self.best.place)
        place[self.which] += self.way * s
        trial = self.trials.at(place)
        if trial is None:
            return False
        if not trial.solved:
            self.gone[s], self.why[s] = math.inf, trial.failure[0]
            return True
        broken = [
            one.measure for one, value in zip(self.trials.task.constraints, trial.kept_to, strict=True)
            if not one.met(value)
        ]  # fmt: skip
        if broken:
            self.gone[s], self.why[s] = math.inf, broken[0]
        else:
            self.gone[s] = self.trials.task.goal.sign * (trial.goal - self.best.goal)
        return True

    def _jumps(self, low: float, high: float, amount: float) -> bool:
        """Whether the goal jumps between a way on which it is not worse by an amount, and the next one."""
        if low > 0.0:
            before = self.gone[low] if self.gone[low] > 0.0 else amount
            return math.log(self.gone[high] / before) > JUMPS * math.log(high / low)
        longer = min((s for s, worse in self.gone.items() if s > high and 0.0 < worse < math.inf), default=None)
        return longer is not None and self.gone[high] > self.gone[longer] * math.pow(high / longer, STEEP)

    def _in_unit(self, s: float) -> float:
        """A way in the unit of the variable."""
        variable = self.trials.task.variables[self.which]
        return float(s * (variable.high - variable.low))


def along(way: float, ratio: float, power: float) -> float:
    """The way at which what rises by a power of it is `ratio` times what it is at another one."""
    return way * math.pow(min(ratio, MOST_TIMES), 1.0 / max(power, LEAST_POWER))
