"""Over the whole box: differential evolution (Storn and Price 1997), from a sample that fills it evenly.

The members of a generation do not hang on each other: they are solved together, in as many processes as there are.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heuncli.analyses.tune.trials import Trials
from heuncli.results.results import Array

OVERVIEW = "overview"
SHARE = 0.4  # of all evaluations
MEMBERS_EACH, LEAST_MEMBERS = 4, 8  # of a generation, for each variable and one more; at least
CHANGE, CROSSED = (0.4, 0.9), 0.8  # how far members are moved by the difference of others; how many places it changes
GATHERED = 1e-3  # once ranks of all members are as near to each other, the rest is left to the descent


def look_over(trials: Trials) -> None:
    """Find where in the box it is good. Impure: tries variants."""
    from scipy import optimize  # where something is tuned

    trials.phase = OVERVIEW
    task = trials.task
    first = sample(trials)
    trials.at_all(list(first))
    trials.set_scales()
    goals = [trials.scaled_goal(trial) for trial in trials.history if trial.solved]
    middle = float(np.median(goals)) if goals else 0.0

    def ranks(places: Array) -> Array:
        """Of the members of a generation (n, m)."""
        return np.array([trials.rank(trial, middle) for trial in trials.at_all(list(places.T))])

    generations = int(SHARE * task.most) // len(first) - 1
    if generations > 0 and trials.left:
        evolve: Any = optimize.differential_evolution  # whose types know of no generation solved at once
        evolve(
            ranks, [(0.0, 1.0)] * len(task.variables), init=first, maxiter=generations, mutation=CHANGE,
            recombination=CROSSED, tol=GATHERED, polish=False, vectorized=True, updating="deferred",
            seed=np.random.default_rng(task.seed),
        )  # fmt: skip
    trials.set_scales()


def sample(trials: Trials) -> Array:
    """The first members (m, n): the spec's own values among them, where these lie in the box."""
    from scipy.stats import qmc

    task = trials.task
    n = len(task.variables)
    members = max(LEAST_MEMBERS, MEMBERS_EACH * (n + 1))
    drawn = qmc.Sobol(n, seed=np.random.default_rng(task.seed)).random_base2(math.ceil(math.log2(members)))
    places: Array = drawn[: max(min(members, task.most), 5)]
    own = [variable.own_place for variable in task.variables]
    if all(place is not None for place in own):
        places[0] = np.array(own, dtype=float)
    return places
