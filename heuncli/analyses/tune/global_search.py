"""Search the whole box: differential evolution (Storn and Price 1997), from a sample that fills it evenly.

The members of a generation are independent, so they are solved together, in as many processes as there are.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heuncli.analyses.tune.trials import Trials
from heuncli.results.results import Array

OVERVIEW_PHASE = "overview"
EVALUATION_SHARE = 0.4  # of all evaluations
MEMBERS_PER_VARIABLE, MIN_MEMBERS = 4, 8  # members of a generation per variable plus one; at least
MUTATION, RECOMBINATION = (0.4, 0.9), 0.8  # mutation: factors of the difference of others; share of changed variables
CONVERGENCE = 1e-3  # spread of the ranks below which the descent takes over


def search_globally(trials: Trials) -> None:
    """Find the good regions of the box. Impure: tries variants."""
    from scipy import optimize  # imported only for tuning

    trials.phase = OVERVIEW_PHASE
    task = trials.task
    first = make_first_generation(trials)
    trials.try_places(list(first))
    trials.set_scales()
    goals = [trials.scaled_goal(trial) for trial in trials.history if trial.is_solved]
    median_goal = float(np.median(goals)) if goals else 0.0

    def rank_members(places: Array) -> Array:
        """Return the ranks of the members of a generation (n, m)."""
        return np.array([trials.compute_rank(trial, median_goal) for trial in trials.try_places(list(places.T))])

    generations = int(EVALUATION_SHARE * task.max_variants) // len(first) - 1
    if generations > 0 and trials.remaining:
        evolve: Any = optimize.differential_evolution  # the types do not know vectorized=True
        evolve(
            rank_members, [(0.0, 1.0)] * len(task.variables), init=first, maxiter=generations, mutation=MUTATION,
            recombination=RECOMBINATION, tol=CONVERGENCE, polish=False, vectorized=True, updating="deferred",
            seed=np.random.default_rng(task.seed),
        )  # fmt: skip
    trials.set_scales()


def make_first_generation(trials: Trials) -> Array:
    """Return the first members (m, n), including the spec's own values if these are within bounds."""
    from scipy.stats import qmc

    task = trials.task
    n = len(task.variables)
    members = max(MIN_MEMBERS, MEMBERS_PER_VARIABLE * (n + 1))
    sobol_points = qmc.Sobol(n, seed=np.random.default_rng(task.seed)).random_base2(math.ceil(math.log2(members)))
    places: Array = sobol_points[: max(min(members, task.max_variants), 5)]
    spec_places = [variable.spec_place for variable in task.variables]
    if all(place is not None for place in spec_places):
        places[0] = np.array(spec_places, dtype=float)
    return places
