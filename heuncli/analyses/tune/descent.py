"""Down to the next minimum, by two methods in turn, each begun anew from the best.

COBYLA (Powell 1994) lays planes through its trials, of the goal and of each constraint: it is quick where these are
smooth, and ends early where two of them meet in a kink, as those of a largest force do. The simplex of Nelder and Mead
(1965) compares alone, creeps along kinks, and takes constraints as kinks of its merit: a weight times what they are
passed by. What neither improves any more is a minimum, as far as either can tell.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.tune.results import Trial
from heuncli.analyses.tune.trials import Trials
from heuncli.results.results import Array

FIRST, WIDEST, LEAST = 0.1, 0.1, 1e-4  # steps that a method begins with, of the width of the box
SHRUNK = 0.1  # of the steps before, at least: what follows looks around as far as the last one moved, twice
END, ABOVE_NOISE = 0.01, 3.0  # of COBYLA's steps: of the root of the floor; of the floor, at least
NEAR = 1e-3  # of the simplex, whose corners lie as near to each other when it ends, and differ by less than the floor
PLANES_EACH, CORNERS_EACH = 30, 40  # the most evaluations of one run, for each variable and one more
WEIGHT, RAISED = (
    3.0,
    4.0,
)  # of what constraints are passed by: first, and times which where that does not keep them
KEPT = 1e-4  # scales by which the best by merit may pass the constraints before the weight is raised
AIM = 1e-7  # scales that the planes stay inside of the constraints: rounding is not to pass them
MOST_RUNS = 40
STILL, STILL_OF_MANY, FEW = 2, 4, 2  # runs in turn that gain nothing when it ends; how many variables are few: of more
# the simplex may collapse along a kink, and does so less from its other sides


def descend(trials: Trials) -> float | None:
    """Improve the best until no method does; returns what the last runs improved f by, None where it was not ended.

    Impure: tries variants.
    """
    trials.phase = "descent"
    weight, step = WEIGHT, FIRST
    gains: list[float] = []
    still = STILL if len(trials.task.variables) <= FEW else STILL_OF_MANY
    for run in range(MOST_RUNS):
        own = weight if trials.feasible else None
        begin = least(trials, own)
        if begin is None or not trials.left:
            return None
        if run % 2 == 0:
            by_planes(trials, begin, step, own)
        else:
            by_simplex(trials, begin, step, own, mirrored=run % 4 == 3)
        end = least(trials, own)
        assert end is not None
        gains.append(trials.merit(begin, own) - trials.merit(end, own))
        moved = float(np.abs(np.subtract(end.place, begin.place)).max())
        step = min(WIDEST, max(2.0 * moved, SHRUNK * step, LEAST))
        if own is not None and trials.passed(end) > KEPT:
            weight *= RAISED
        elif len(gains) >= still and max(gains[-still:]) < trials.floor and (own is None) is not trials.feasible:
            return max(gains[-still:]) if trials.left else None
    return None


def try_from(trials: Trials, begin: Trial) -> None:
    """One run of each method from a variant that is not the best. Impure: tries variants."""
    trials.phase = "elsewhere"
    weight = WEIGHT if trials.feasible else None
    before = len(trials.history)
    by_planes(trials, begin, FIRST, weight)
    reached = least(trials, weight, before)
    if reached is not None and trials.merit(reached, weight) < trials.merit(begin, weight):
        begin = reached
    by_simplex(trials, begin, FIRST / 2.0, weight, mirrored=False)


def least(trials: Trials, weight: float | None, since: int = 0) -> Trial | None:
    """The best by merit of those tried, or of those tried since."""
    solved = [trial for trial in trials.history[since:] if trial.solved]
    return min(solved, key=lambda trial: trials.merit(trial, weight), default=None)


def by_planes(trials: Trials, begin: Trial, step: float, weight: float | None) -> None:
    """COBYLA from a variant."""
    from scipy.optimize import NonlinearConstraint, minimize

    worst = trials.worst(trials.scaled_goal)
    n, count = len(begin.place), len(trials.task.constraints)

    def goal(place: Array) -> float:
        trial = trials.at(place)
        if weight is None and count:
            return 0.0
        return trials.scaled_goal(trial) if trial is not None and trial.solved else worst

    def excesses(place: Array) -> list[float]:
        trial = trials.at(place)
        return trials.scaled_excesses(trial) if trial is not None and trial.solved else [worst_excess] * count

    worst_excess = trials.worst(lambda trial: max(trials.scaled_excesses(trial), default=0.0))
    kept_to = [NonlinearConstraint(excesses, -np.inf, -AIM)] if count else []
    most = min(PLANES_EACH * (n + 1), trials.left + n + 2)
    minimize(
        goal, np.array(begin.place), method="COBYLA", bounds=[(0.0, 1.0)] * n, constraints=kept_to,
        options={"rhobeg": step, "tol": min(last_step(trials.floor), step), "maxiter": most},
    )  # fmt: skip


def last_step(floor: float) -> float:
    """Where COBYLA ends: over a longer step a smooth valley falls by the floor, over a shorter one nothing is seen."""
    return max(END * math.sqrt(floor), ABOVE_NOISE * floor)


def by_simplex(trials: Trials, begin: Trial, step: float, weight: float | None, mirrored: bool) -> None:
    """Nelder and Mead from a variant; mirrored: with the corners of the first simplex on the other sides."""
    from scipy.optimize import minimize

    worst = trials.worst(lambda trial: trials.merit(trial, weight))

    def merit(place: Array) -> float:
        trial = trials.at(place)
        return trials.merit(trial, weight) if trial is not None and trial.solved else worst

    n = len(begin.place)
    most = min(CORNERS_EACH * (n + 1), trials.left + n + 2)
    minimize(
        merit, np.array(begin.place), method="Nelder-Mead", bounds=[(0.0, 1.0)] * n,
        options={
            "initial_simplex": simplex(np.array(begin.place), -step if mirrored else step), "adaptive": n > 2,
            "xatol": NEAR, "fatol": trials.floor, "maxfev": most,
        },
    )  # fmt: skip


def simplex(place: Array, step: float) -> Array:
    """A place and its neighbours along each variable, all in the box, (n + 1, n)."""
    corners = np.tile(place, (len(place) + 1, 1))
    for i, x in enumerate(place):
        corners[i + 1, i] = x + step if 0.0 <= x + step <= 1.0 else x - step
    return corners
