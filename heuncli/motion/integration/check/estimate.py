"""Estimate the error of a motion by further runs.

The estimate is 2 |A - B|. A is the run whose results are reported. B is a check run at 1/30 of A's local tolerance from
a start moved by rounding. Both are compared at the same instants (check/run_comparison.py). In tests on free, open
and closed chains, |A - B| is 0.9 to 1.1 times the true error; a coarser check run would give 3 to 100 times it.

A method of fixed step has no tolerance: B runs with a quarter of the step, so |A - B| is 1 - 4^-p of A's error, three
quarters at order 1. A is not repeated, because its step was requested. Where a step is too long for a decaying motion,
Gauss's methods keep it alive at any step: there B runs with Radau's method (`Method.check`).

At small tolerances A's error may be no larger than what the moved start has grown to in B, and cancel it. Then a
further run M starts from the moved start and runs as A does: |A - M| is what rounding grows to. The largest distance of
any two runs counts, because rounding may put all of them on one side of the truth. Where A replaces a run that missed
the tolerance, that run's B took the very steps of M, so M is read from B's polynomials.

This module is the top of the package. Each package imports those below it:

    check/      runs of one motion (runs.py), compared at the same instants (run_comparison.py); what else is
                searched in a finished run: changes of conditions, singular poses, conflicting drives
    run/        one run from its start to its end; runner.py says in which order to read it
    diagnosis/  sentences on why no motion or no acceleration exists; mostly loaded on the way to an error
    contacts/   impulses, and which contacts close, are struck and released
    methods/    Runge-Kutta methods as tables of coefficients

trajectory.py is the result of a run, evaluator.py evaluates states for all of them; integrated_scene.py is the scene
that is integrated in place of the given one, and the intervals of time without discontinuities.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.run_comparison import (
    JoinedStates,
    bound_motion_error,
    choose_instants,
    find_angle_error,
    find_ends_between,
    interleave,
    is_between_impulses,
)
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import find_one_sided_limits
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, ErrorEstimate, Mask

if TYPE_CHECKING:  # loaded where there are conditions
    from heuncli.motion.integration.check.changes import ConditionChanges

RERUNS = 2
MAX_NUMBERS = 2_000_000  # numbers compared at a time ...
# ... or up to so much less where there are several parts, but at least so many instants each
MAX_REDUCTION, MIN_BATCH = (4, 1000)
ComparedStates: TypeAlias = Array | JoinedStates  # of a run at the instants compared


class LoadDifferences(Protocol):
    """Collects the differences of loads and energy between runs (study/solve/load_errors.py)."""

    def add(self, evaluation: Evaluation, is_requested: Mask, before_horizon: Mask) -> None:
        """Add instants: which of them are requested, which lie before the horizon; the results hold A, then the other
        runs.
        """

    def estimate(self) -> ErrorEstimate:
        """Return the estimated error of each kind, relative to its own largest value."""

    def errors(self) -> Mapping[tuple[str, str], float]:
        """Return the estimated errors by kind and unit, at instants before the horizon."""

    def find_largest_kinetic_energy(self) -> float:
        """Return the largest kinetic energy over the run [J]."""

    @property
    def by_cause(self) -> bool:
        """Whether loads are reported by their causes."""


@record
class CheckedRun:
    """A run whose error was estimated.

    evaluate: returns accelerations and loads at a slice of its instants
    motion: largest estimated error of any point over the whole run, relative to the size
    loads: errors of the other kinds
    errors: all errors by kind and unit, before the horizon
    horizon: instant at which the motion's error exceeds CLAIMED [s], or None
    kinetic: largest kinetic energy [J]
    check_impulses: the impulses of each check run
    """

    run: Trajectory
    evaluate: Callable[[slice], Evaluation]
    motion: float
    loads: ErrorEstimate
    errors: Mapping[tuple[str, str], float]
    horizon: float | None
    kinetic: float
    check_impulses: tuple[tuple[ImpulseEvent, ...], ...]
    check_seconds: float
    discarded_seconds: float  # time of runs that missed the tolerance
    changes: tuple[ConditionChanges, ...] = ()  # of the conditions
    restart_reason: str | None = None  # why another method than the chosen one was used


@record
class RunComparison:
    """Runs at the same instants: A, and with it B and, where it was made, M.

    times (n,): instants [s]
    states: states (n, n_state) of each run
    is_requested (n,): which of the instants are reported
    error (n,): error of A's motion at each instant
    horizon: where the error exceeds CLAIMED [s]; None if nowhere
    seconds: time that the other runs and the comparison took
    evaluation: results of all runs at each instant, if they are few enough to be stored
    """

    runs: tuple[Trajectory, ...]
    times: Array
    states: tuple[ComparedStates, ...]
    is_requested: Mask
    error: Array
    horizon: float | None
    seconds: float
    evaluation: Evaluation | None

    @property
    def motion(self) -> float:
        """The largest error."""
        return float(self.error.max(initial=0.0))

    def is_better(self, other: RunComparison) -> bool:
        """Return whether A is valid for longer than another run or, for the same time, has a smaller error."""
        own_horizon, other_horizon = (np.inf if x.horizon is None else x.horizon for x in (self, other))
        return bool(own_horizon > other_horizon or (own_horizon == other_horizon and self.motion < other.motion))


def make_checked_run(runs: Runs, tolerance: float, loads: LoadDifferences) -> CheckedRun:
    """Integrate until the motion's estimated error is below `tolerance`, with at most two reruns; else return the best
    run.
    """
    a = runs.run_first(tolerance)
    best, discarded_seconds = None, 0.0
    for attempt in range(RERUNS + 1):
        comparison = compare_runs(runs, a)
        best, discarded = (
            (best, comparison) if best is not None and not comparison.is_better(best) else (comparison, best)
        )
        discarded_seconds += discarded.runs[0].seconds + discarded.seconds if discarded is not None else 0.0
        error_ratio = comparison.motion / tolerance
        no_finer = a.local <= tolerances.LEAST_TOLERANCE or comparison.runs[1].local > a.local
        if error_ratio <= 1.0 or attempt == RERUNS or no_finer or a.method.is_determined or a.method.has_fixed_step:
            break
        finer = runs.run_finer(a, 2.0 * error_ratio)
        if finer is None:
            break
        a = finer
    assert best is not None
    clock_start = time.perf_counter()
    a = best.runs[0]
    is_used = ~is_between_impulses(best.runs, best.times)
    used_times, is_requested = best.times[is_used], best.is_requested[is_used]
    for part, several in iter_evaluations(runs, best, slice(None) if is_used.all() else is_used, loads.by_cause):
        with np.errstate(over="ignore", invalid="ignore"):  # fixed steps that diverge: unbounded errors
            loads.add(
                several, is_requested[part], used_times[part] < (np.inf if best.horizon is None else best.horizon)
            )
    evaluate = make_evaluate(runs, best, loads.by_cause)
    seconds = best.seconds + time.perf_counter() - clock_start
    error_results = best.motion, loads.estimate(), loads.errors(), best.horizon, loads.find_largest_kinetic_energy()
    check_impulses = tuple(run.impulse_events for run in best.runs[1:])
    return CheckedRun(
        a, evaluate, *error_results, check_impulses, seconds, discarded_seconds, find_condition_changes(runs, best)
    )


def find_condition_changes(runs: Runs, best: RunComparison) -> tuple[ConditionChanges, ...]:
    """Find when the conditions change, and when latches and frictions hold, up to the horizon."""
    layout, before_time = runs.runner.layout, np.inf if best.horizon is None else best.horizon
    found: tuple[ConditionChanges, ...] = ()
    if layout.mechanism.conditions:
        from heuncli.motion.integration.check.changes import find_changes  # few scenes have them

        found = find_changes(runs.runner, best.runs, before_time)
    if layout.latches or layout.friction_contacts:
        from heuncli.motion.integration.check.changes import find_held_changes

        found += find_held_changes(layout, best.runs, before_time)
    return found


def iter_evaluations(
    runs: Runs, best: RunComparison, is_used: Mask | slice, causes: bool
) -> Iterator[tuple[slice, Evaluation]]:
    """Yield the results at the selected instants, as `evaluate_together` gives them; none is evaluated twice."""
    if best.evaluation is None or causes:
        states = [x.select(is_used) if isinstance(x, JoinedStates) else x[is_used] for x in best.states]
        yield from evaluate_together(runs, best.runs[0], best.times[is_used], states, causes=causes)
    else:
        several = best.evaluation
        yield slice(None), several if isinstance(is_used, slice) else several.select(np.repeat(is_used, len(best.runs)))


def make_evaluate(runs: Runs, best: RunComparison, causes: bool) -> Callable[[slice], Evaluation]:
    """Make the function that returns the results at some of A's requested instants.

    If all of them were evaluated at once for the comparison, it selects among those. Else it evaluates on demand,
    because memory may not hold them all.
    """
    a, runner, jumps = best.runs[0], runs.runner, runs.jumps
    if best.evaluation is None or causes or np.count_nonzero(best.is_requested) != len(a.times):
        return lambda part: evaluate_run(runner, a, a.times[part], a.states[part], jumps, causes=causes)
    return best.evaluation.select(len(best.runs) * np.flatnonzero(best.is_requested)).select


def compare_runs(runs: Runs, a: Trajectory) -> RunComparison:
    """Compare A with its check run and, where it is made, the run from the moved start."""
    clock_start = time.perf_counter()
    instants = choose_instants(runs.runner, a)
    check_times = extend_past_last_impulse(runs, a, instants.times)
    moved_run = runs.run_from_moved_start(a, check_times)
    others = [*runs.run_checks(a, check_times), *([] if moved_run is None else [moved_run])]
    n = len(instants.times)
    if any(run.pushing_rope for run in (a, *others)):
        # the runs end at different instants; the last of A is judged by the previous one
        n = min(int(np.sum(instants.times[: len(x.times)] == x.times[: len(instants.times)])) for x in others)
    times = instants.times[:n]
    states: tuple[ComparedStates, ...] = (instants.states.select(slice(n)), *(x.states[:n] for x in others))
    error, several = estimate_errors(runs, a, times, states)
    above_limit = np.flatnonzero(error > tolerances.CLAIMED)
    horizon = None
    if len(above_limit):
        horizon = float(times[above_limit[0]])
        ends, states_between = find_ends_between(
            runs.runner, (a, *others), float(times[max(above_limit[0] - 1, 0)]), horizon
        )
        earlier = ends[estimate_errors(runs, a, ends, states_between)[0] > tolerances.CLAIMED]
        horizon = float(earlier[0]) if len(earlier) else horizon
    seconds = time.perf_counter() - clock_start
    return RunComparison((a, *others), times, states, instants.is_requested[:n], error, horizon, seconds, several)


def extend_past_last_impulse(runs: Runs, a: Trajectory, times: Array) -> Array:
    """Return the instants for the check runs: one more where an impulse ends A, because they reach it earlier or
    later.
    """
    if not (a.ended_by_condition and a.impulse_events and a.impulse_events[-1].time >= a.times[-1]):
        return times
    return np.append(times, a.end_time + tolerances.CLAIMED * (float(runs.times[-1]) - a.end_time))


def estimate_errors(
    runs: Runs, a: Trajectory, times: Array, states: Sequence[ComparedStates]
) -> tuple[Array, Evaluation | None]:
    """Estimate the errors of the motion at the instants, (n,), and return the results there if one part holds them all.

    states: of A and of the other runs
    """
    layout = runs.runner.layout
    point_errors, angle_errors, largest = np.zeros(len(times)), np.zeros(len(times)), 1.0
    several = None
    for part, several in evaluate_together(runs, a, times, states):
        with np.errstate(over="ignore", invalid="ignore"):  # given steps that run away: errors without bound
            point_errors[part] = bound_motion_error(runs.motion_points, several, len(states), layout.size)
            angle_errors[part], largest_angle = find_angle_error(layout, several, len(states))
        largest = max(largest, largest_angle)
    whole = several if several is not None and len(several.times) == len(states) * len(times) else None
    return np.maximum(point_errors, angle_errors / largest), whole


def evaluate_together(
    runs: Runs, a: Trajectory, times: Array, states: Sequence[ComparedStates], *, causes: bool = False
) -> Iterator[tuple[slice, Evaluation]]:
    """Yield the results of all runs at each instant, in parts that fit into memory.

    All runs hold A's branches. Else, where runs reach an event at slightly different instants, each would show its own
    side of a jump, and the estimate would contain the jump.
    """
    layout = runs.runner.layout
    numbers_per_state = (30 + 12 * (len(layout.mechanism.loads) + 3) * causes) * len(layout.place)
    batch_size = max(1, MAX_NUMBERS // (numbers_per_state * len(states) + 1))
    if batch_size < len(times):
        batch_size = max(batch_size // MAX_REDUCTION, min(batch_size, MIN_BATCH))
    for i in range(0, len(times), batch_size):
        part = slice(i, i + batch_size)
        interleaved_states = interleave(times[part], [x[part] for x in states])
        yield part, evaluate_run(runs.runner, a, *interleaved_states, runs.jumps, causes=causes)


def evaluate_run(
    runner: Runner, run: Trajectory, times: Array, states: Array, jumps: Sequence[float], *, causes: bool = False
) -> Evaluation:
    """Evaluate accelerations and loads of states like those of a run; at a discontinuity, the right limits."""
    later = times
    if len(jumps):
        before, after = find_one_sided_limits(jumps)
        next_ = np.minimum(np.searchsorted(after, times, side="right"), len(after) - 1)
        later = np.where((times > before[next_]) & (times < after[next_]), after[next_], times)
    branches = run.find_branches(times) if run.branches.size else None
    holding = run.find_holding(times) if runner.layout.contacts else None
    evaluation = runner.evaluate(later, states, branches=branches, causes=causes, holding=holding)
    return evaluation if later is times else replace(evaluation, times=times)
