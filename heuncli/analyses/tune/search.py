"""Search for the best variant: over the whole box, and down to the next minimum.

COBYLA (Powell 1994) fits planes to its trials, for the goal and each constraint: it is quick where these are smooth,
and ends early at a kink, such as that of a largest force. The simplex of Nelder and Mead (1965) only compares, creeps
along kinks, and treats constraints as kinks of its merit: a weight times their violation. A point that neither improves
is a minimum, as far as both can tell.

The members of a generation are independent, so they are solved together, in as many processes as there are.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heuncli.analyses.tune.results import Trial
from heuncli.analyses.tune.trials import Trials
from heuncli.results.results import Array

# phases of the search, as the history names them
OVERVIEW_PHASE, DESCENT_PHASE, MOVES_PHASE, ELSEWHERE_PHASE = "overview", "descent", "moves", "elsewhere"
FIRST_STEP, MAX_STEP, MIN_STEP = 0.1, 0.1, 1e-4  # steps that a method begins with, relative to the width of the box
DISTANCE_FACTOR = 2.0  # step of the next run, relative to the distance that the last run moved
MIN_STEP_RATIO = 0.1  # smallest ratio of a run's first step to that of the run before
FINAL_STEP_FACTOR = 0.01  # COBYLA's last step, relative to the root of the floor
NOISE_FACTOR = 3.0  # smallest such step, relative to the floor
SIMPLEX_TOLERANCE = 1e-3  # distance of the simplex's corners when it ends; their values differ by less than the floor
COBYLA_TRIALS, SIMPLEX_TRIALS = 30, 40  # most evaluations of one run, per variable plus one
FIRST_WEIGHT, WEIGHT_FACTOR = 3.0, 4.0  # weight of violations: at first; the factor by which it rises while they last
MAX_VIOLATION = 1e-4  # scales by which the best by merit may violate the constraints before the weight is raised
CONSTRAINT_MARGIN = 1e-7  # scales by which COBYLA stays inside the constraints, so that rounding does not violate them
MAX_RUNS = 40
FEW_VARIABLES = 2
STALLED_RUNS_FEW, STALLED_RUNS_MANY = 2, 4  # runs in turn without gain that end the descent, of few variables, of more


def descend(trials: Trials) -> float | None:
    """Improve the best variant until no method does.

    Returns the improvement of f by the last runs, or None if the descent did not converge. Impure: tries variants.
    """
    trials.phase = DESCENT_PHASE
    weight, step = FIRST_WEIGHT, FIRST_STEP
    gains: list[float] = []
    stalled_runs = STALLED_RUNS_FEW if len(trials.task.variables) <= FEW_VARIABLES else STALLED_RUNS_MANY
    for run in range(MAX_RUNS):
        merit_weight = weight if trials.has_feasible else None
        start = find_best(trials, merit_weight)
        if start is None or not trials.remaining:
            return None
        if run % 2 == 0:
            run_cobyla(trials, start, step, merit_weight)
        else:
            run_simplex(trials, start, step, merit_weight, is_mirrored=run % 4 == 3)
        end = find_best(trials, merit_weight)
        assert end is not None
        gains.append(trials.compute_merit(start, merit_weight) - trials.compute_merit(end, merit_weight))
        distance = float(np.abs(np.subtract(end.place, start.place)).max())
        step = min(MAX_STEP, max(DISTANCE_FACTOR * distance, MIN_STEP_RATIO * step, MIN_STEP))
        # The first feasible trial changes the merit: then run again.
        is_weight_current = (merit_weight is not None) == trials.has_feasible
        if merit_weight is not None and trials.compute_violation(end) > MAX_VIOLATION:
            weight *= WEIGHT_FACTOR
        elif len(gains) >= stalled_runs and max(gains[-stalled_runs:]) < trials.floor and is_weight_current:
            return max(gains[-stalled_runs:]) if trials.remaining else None
    return None


def descend_from(trials: Trials, start: Trial) -> None:
    """Run each method once from a variant that is not the best. Impure: tries variants."""
    trials.phase = ELSEWHERE_PHASE
    weight = FIRST_WEIGHT if trials.has_feasible else None
    trial_count = len(trials.history)
    run_cobyla(trials, start, FIRST_STEP, weight)
    reached = find_best(trials, weight, trial_count)
    if reached is not None and trials.compute_merit(reached, weight) < trials.compute_merit(start, weight):
        start = reached
    run_simplex(trials, start, FIRST_STEP / 2.0, weight, is_mirrored=False)


def find_best(trials: Trials, weight: float | None, first: int = 0) -> Trial | None:
    """Return the best trial by merit of those from index `first` on."""
    candidates = [trial for trial in trials.history[first:] if trial.is_solved]
    return min(candidates, key=lambda trial: trials.compute_merit(trial, weight), default=None)


def run_cobyla(trials: Trials, start: Trial, step: float, weight: float | None) -> None:
    """Run COBYLA from a variant. Impure: tries variants.

    step: the first, relative to the box
    weight: of violations in the merit; None: search a feasible variant only, whatever its goal
    """
    from scipy.optimize import NonlinearConstraint, minimize

    worst_goal = trials.find_worst_value(trials.compute_scaled_goal)
    n, count = len(start.place), len(trials.task.constraints)

    def evaluate_goal(place: Array) -> float:
        """Return the scaled goal at a place; a bad one where it cannot be solved."""
        trial = trials.try_place(place)
        if weight is None and count:
            return 0.0
        return trials.compute_scaled_goal(trial) if trial is not None and trial.is_solved else worst_goal

    def evaluate_excesses(place: Array) -> list[float]:
        """Return by how much each limit is exceeded at a place, scaled."""
        trial = trials.try_place(place)
        return (
            trials.compute_scaled_excesses(trial) if trial is not None and trial.is_solved else [worst_excess] * count
        )

    worst_excess = trials.find_worst_value(lambda trial: max(trials.compute_scaled_excesses(trial), default=0.0))
    constraints = [NonlinearConstraint(evaluate_excesses, -np.inf, -CONSTRAINT_MARGIN)] if count else []
    max_trials = min(COBYLA_TRIALS * (n + 1), trials.remaining + n + 2)
    minimize(
        evaluate_goal, np.array(start.place), method="COBYLA", bounds=[(0.0, 1.0)] * n, constraints=constraints,
        options={"rhobeg": step, "tol": min(compute_last_step(trials.floor), step), "maxiter": max_trials},
    )  # fmt: skip


def compute_last_step(floor: float) -> float:
    """Return COBYLA's final step: over a longer one a smooth valley falls by the floor, over a shorter one nothing
    changes.
    """
    return max(FINAL_STEP_FACTOR * math.sqrt(floor), NOISE_FACTOR * floor)


def run_simplex(trials: Trials, start: Trial, step: float, weight: float | None, is_mirrored: bool) -> None:
    """Run Nelder-Mead from a variant. Impure: tries variants.

    step: distance of the first corners, relative to the box
    weight: of violations in the merit; None: search a feasible variant only, whatever its goal
    is_mirrored: the first simplex extends to the opposite sides; it may collapse along a kink, and does so less from
    there
    """
    from scipy.optimize import minimize

    worst_merit = trials.find_worst_value(lambda trial: trials.compute_merit(trial, weight))

    def evaluate_merit(place: Array) -> float:
        """Return the goal and the weighted excesses at a place as one number."""
        trial = trials.try_place(place)
        return trials.compute_merit(trial, weight) if trial is not None and trial.is_solved else worst_merit

    n = len(start.place)
    max_trials = min(SIMPLEX_TRIALS * (n + 1), trials.remaining + n + 2)
    minimize(
        evaluate_merit, np.array(start.place), method="Nelder-Mead", bounds=[(0.0, 1.0)] * n,
        options={
            "initial_simplex": make_simplex(np.array(start.place), -step if is_mirrored else step), "adaptive": n > 2,
            "xatol": SIMPLEX_TOLERANCE, "fatol": trials.floor, "maxfev": max_trials,
        },
    )  # fmt: skip


def make_simplex(place: Array, step: float) -> Array:
    """Return a place and its neighbours along each variable, all within bounds, (n + 1, n)."""
    corners = np.tile(place, (len(place) + 1, 1))
    for i, x in enumerate(place):
        corners[i + 1, i] = x + step if 0.0 <= x + step <= 1.0 else x - step
    return corners


EVALUATION_SHARE = 0.4  # share of all evaluations that the overview may use
MEMBERS_PER_VARIABLE, MIN_MEMBERS = 4, 8  # members of a generation per variable plus one; and the smallest number
FEWEST_PLACES = 5  # members that SciPy's differential evolution needs
MUTATION, RECOMBINATION = (0.4, 0.9), 0.8  # factors of the difference of two others; share of changed variables
CONVERGENCE = 1e-3  # spread of the ranks below which the descent takes over


def search_globally(trials: Trials) -> None:
    """Find the good regions of the box. Impure: tries variants."""
    from scipy import optimize  # imported only for tuning

    trials.phase = OVERVIEW_PHASE
    task = trials.task
    first = make_first_generation(trials)
    trials.try_places(list(first))
    trials.set_scales()
    goals = [trials.compute_scaled_goal(trial) for trial in trials.history if trial.is_solved]
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
    places: Array = sobol_points[: max(min(members, task.max_variants), FEWEST_PLACES)]
    spec_places = [variable.spec_place for variable in task.variables]
    if all(place is not None for place in spec_places):
        places[0] = np.array(spec_places, dtype=float)
    return places
