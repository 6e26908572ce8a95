"""Error estimate of a motion by further runs.

The estimate is 2 |A - B|: A is the run that is told, B a check run at 1/30 of A's local tolerance from a start moved by
rounding, both seen at the same instants (motion/integration/check/instants.py). Tried on free, open and closed chains,
|A - B| is 0.9 to 1.1 of the true error; a coarser check run would give 3 to 100 times it.

A method of given step has no tolerance: B goes in quarters of the step, |A - B| is then 1 - 4^-p of A's error, three
quarters at order 1, and A is not made again, for its step was asked for. Where a step is too long for what decays in
it, Gauss's methods keep that alive at any step: there B goes by Radau's (`Method.check`).

At small tolerances the error of A may be no larger than what the moved start has grown to in B, and cancel it. There a
further run M goes from the moved start as A goes from its own: |A - M| is what rounding grows to, and the largest
distance of any two counts, of the motion: what all make of rounding may lie to one side of the truth.

This is the top of the package. From here down, each room imports those below it:
    check/      runs of one motion (runs.py), seen at the same instants (instants.py, distance.py); what else is looked
                for in a finished run: changes of conditions, singular poses, points that meet, drives that contradict
    run/        one run from its start to its end; runner.py says in which order to read it
    diagnosis/  why no motion or no acceleration exists, in sentences; mostly loaded on the way to an error
    contacts/   blows, and which contacts close, are struck and let go
    methods/    Runge-Kutta methods as tables of coefficients
trajectory.py is the record that a run leaves, evaluator.py the answer at a state, which all of them ask for;
integrated_scene.py is what is integrated in a scene's place, segments.py the stretches of time without discontinuities.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.distance import angle_error, bounded_motion_error
from heuncli.motion.integration.check.instants import OwnStates, instants_of, interleaved, passed_between
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.check.shared_blows import between_strikes
from heuncli.motion.integration.contacts.blows import Jump
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.segments import limits_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Estimate, Mask

if TYPE_CHECKING:  # loaded where there are conditions
    from heuncli.motion.integration.check.changes import Changes

RERUNS = 2
CHUNK = 2_000_000  # numbers compared at a time ...
LESS, MANY = 4, 1000  # ... or so much less where more than a part is compared, but of so many instants each
StatesThere: TypeAlias = Array | OwnStates  # of a run at the instants compared


class LoadDifferences(Protocol):
    """What collects the differences of loads and energy between the two runs (study/solve/load_errors.py)."""

    def add(self, several: Recovered, asked: Mask, before: Mask) -> None:
        """More instants, which are asked and which before the horizon; at each the answers of A, then of the others."""

    def estimate(self) -> Estimate:
        """The estimated error of each kind, relative to its own largest."""

    def errors(self) -> Mapping[tuple[str, str], float]:
        """The estimated errors by kind and unit, at instants before the horizon."""

    def kinetic(self) -> float:
        """The largest kinetic energy over the run [J]."""

    @property
    def by_cause(self) -> bool:
        """Whether loads are told by their causes."""


@record
class CheckedRun:
    """A run that was checked.

    answers: accelerations and loads, at some of its instants; motion: largest estimated error of any point over the
    whole run, relative to the size; loads: those of the other kinds; errors: all by kind and unit, before the horizon;
    horizon: where the motion's passes CLAIMED; kinetic: the largest kinetic energy [J]; beside: the blows of the check
    runs.
    """

    run: Trajectory
    answers: Callable[[slice], Recovered]
    motion: float
    loads: Estimate
    errors: Mapping[tuple[str, str], float]
    horizon: float | None
    kinetic: float
    beside: tuple[tuple[Jump, ...], ...]
    check_seconds: float
    lost_seconds: float  # of runs that missed the tolerance
    changes: tuple[Changes, ...] = ()  # of the conditions
    begun_anew: str | None = None  # why by another method than the one that was chosen


@record
class Compared:
    """Runs seen at the same instants: A, and beside it B and, where it was made, M.

    times (n,) [s]; states (n, n_state): of each run; asked (n,): which of them are told; error (n,): of A's motion
    there; horizon: where that passes CLAIMED [s], None: nowhere; seconds: that the other runs and the comparison took.
    several: the answers, at each instant those of all runs, where they are few enough to be kept.
    """

    runs: tuple[Trajectory, ...]
    times: Array
    states: tuple[StatesThere, ...]
    asked: Mask
    error: Array
    horizon: float | None
    seconds: float
    several: Recovered | None

    @property
    def motion(self) -> float:
        """The largest error."""
        return float(self.error.max(initial=0.0))

    def better(self, than: Compared) -> bool:
        """Whether A is claimed for longer than another run, or else to a smaller error."""
        mine, its = (np.inf if x.horizon is None else x.horizon for x in (self, than))
        return bool(mine > its or (mine == its and self.motion < than.motion))


def checked_run(runs: Runs, tolerance: float, loads: LoadDifferences) -> CheckedRun:
    """Integrate until the motion's estimated error is below `tolerance`, with at most two reruns; else the best run."""
    a = runs.first(tolerance)
    best, lost = None, 0.0
    for attempt in range(RERUNS + 1):
        found = compared(runs, a)
        best, worse = (best, found) if best is not None and not found.better(best) else (found, best)
        lost += worse.runs[0].seconds + worse.seconds if worse is not None else 0.0
        miss = found.motion / tolerance
        no_finer = a.local <= tolerances.LEAST_TOLERANCE or found.runs[1].local > a.local
        if miss <= 1.0 or attempt == RERUNS or no_finer or a.method.determined or a.method.fixed:
            break
        finer = runs.finer(a, 2.0 * miss)
        if finer is None:
            break
        a = finer
    assert best is not None
    begun = time.perf_counter()
    a = best.runs[0]
    kept = ~between_strikes(best.runs, best.times)
    at, asked = best.times[kept], best.asked[kept]
    for part, several in answers_of(runs, best, slice(None) if kept.all() else kept, loads.by_cause):
        with np.errstate(over="ignore", invalid="ignore"):  # given steps that run away: errors without bound
            loads.add(several, asked[part], at[part] < (np.inf if best.horizon is None else best.horizon))
    answers = told_of(runs, best, loads.by_cause)
    seconds = best.seconds + time.perf_counter() - begun
    told = best.motion, loads.estimate(), loads.errors(), best.horizon, loads.kinetic()
    beside = tuple(run.blows for run in best.runs[1:])
    return CheckedRun(a, answers, *told, beside, seconds, lost, changes_of_conditions(runs, best))


def changes_of_conditions(runs: Runs, best: Compared) -> tuple[Changes, ...]:
    """When the conditions change, and what latches hold, up to the horizon."""
    layout, before = runs.runner.layout, np.inf if best.horizon is None else best.horizon
    found: tuple[Changes, ...] = ()
    if layout.mechanism.conditions:
        from heuncli.motion.integration.check.changes import changes_of  # few scenes have them

        found = changes_of(runs.runner, best.runs, before)
    if layout.latches:
        from heuncli.motion.integration.check.latch_changes import latch_changes

        found += latch_changes(layout, best.runs, before)
    return found


def answers_of(runs: Runs, best: Compared, kept: Mask | slice, causes: bool) -> Iterator[tuple[slice, Recovered]]:
    """The answers at those of the instants that are kept, as `recovered_together` gives them; none is found twice."""
    if best.several is None or causes:
        yield from recovered_together(
            runs, best.runs[0], best.times[kept], [x[kept] for x in best.states], causes=causes
        )
    else:
        several = best.several
        yield slice(None), several if isinstance(kept, slice) else several.at(np.repeat(kept, len(best.runs)))


def told_of(runs: Runs, best: Compared, causes: bool) -> Callable[[slice], Recovered]:
    """The answers at some of A's asked instants.

    Where all of them were compared at once they are among those; else they are found when they are asked for, for they
    may be more than memory holds.
    """
    a, runner, jumps = best.runs[0], runs.runner, runs.jumps
    if best.several is None or causes or np.count_nonzero(best.asked) != len(a.times):
        return lambda part: recovered_at(runner, a, a.times[part], a.states[part], jumps, causes=causes)
    return best.several.at(len(best.runs) * np.flatnonzero(best.asked)).at


def compared(runs: Runs, a: Trajectory) -> Compared:
    """A with its check run, and the run beside it."""
    begun = time.perf_counter()
    at = instants_of(runs.runner, a)
    to = with_last_blow(runs, a, at.times)
    m = runs.from_moved_start(a, to)
    others = [*runs.check(a, to), *([] if m is None else [m])]
    n = len(at.times)
    if any(run.stopped for run in (a, *others)):
        # the runs end at instants of their own; the last of A is judged by the one before it
        n = min(int(np.sum(at.times[: len(x.times)] == x.times[: len(at.times)])) for x in others)
    times = at.times[:n]
    states: tuple[StatesThere, ...] = (at.states.first(n), *(x.states[:n] for x in others))
    error, several = errors(runs, a, times, states)
    late = np.flatnonzero(error > tolerances.CLAIMED)
    horizon = None
    if len(late):
        horizon = float(times[late[0]])
        ends, between = passed_between(runs.runner, (a, *others), float(times[max(late[0] - 1, 0)]), horizon)
        sooner = ends[errors(runs, a, ends, between)[0] > tolerances.CLAIMED]
        horizon = float(sooner[0]) if len(sooner) else horizon
    seconds = time.perf_counter() - begun
    return Compared((a, *others), times, states, at.asked[:n], error, horizon, seconds, several)


def with_last_blow(runs: Runs, a: Trajectory, times: Array) -> Array:
    """The instants for the runs beside A: a moment more where a blow ends A, which others meet sooner or later."""
    if not (a.ended and a.blows and a.blows[-1].time >= a.times[-1]):
        return times
    return np.append(times, a.reached + tolerances.CLAIMED * (float(runs.times[-1]) - a.reached))


def errors(runs: Runs, a: Trajectory, times: Array, states: Sequence[StatesThere]) -> tuple[Array, Recovered | None]:
    """Estimated errors of the motion at the instants, (n,), and the answers there, where one part holds them all.

    states: of A and of the other runs.
    """
    layout = runs.runner.layout
    places, angles, largest = np.zeros(len(times)), np.zeros(len(times)), 1.0
    several = None
    for part, several in recovered_together(runs, a, times, states):
        with np.errstate(over="ignore", invalid="ignore"):  # given steps that run away: errors without bound
            places[part] = bounded_motion_error(runs.marks, several, len(states), layout.size)
            angles[part], turned = angle_error(layout, several, len(states))
        largest = max(largest, turned)
    whole = several if several is not None and len(several.times) == len(states) * len(times) else None
    return np.maximum(places, angles / largest), whole


def recovered_together(
    runs: Runs, a: Trajectory, times: Array, states: Sequence[StatesThere], *, causes: bool = False
) -> Iterator[tuple[slice, Recovered]]:
    """The answers at the instants, at each those of all runs, in parts that fit the memory.

    All hold A's branches: of an event that the runs meet at instants a little apart, either would else show its own
    side of a jump, and the estimate the jump.
    """
    layout = runs.runner.layout
    numbers = (30 + 12 * (len(layout.mechanism.loads) + 3) * causes) * len(layout.place)
    many = max(1, CHUNK // (numbers * len(states) + 1))
    if many < len(times):
        many = max(many // LESS, min(many, MANY))
    for i in range(0, len(times), many):
        part = slice(i, i + many)
        both = interleaved(times[part], [x[part] for x in states])
        yield part, recovered_at(runs.runner, a, *both, runs.jumps, causes=causes)


def recovered_at(
    runner: Runner, run: Trajectory, times: Array, states: Array, jumps: Sequence[float], *, causes: bool = False
) -> Recovered:
    """Accelerations and loads of states like those of a run; at a discontinuity the right limits."""
    later = times
    if len(jumps):
        before, after = limits_of(jumps)
        next_ = np.minimum(np.searchsorted(after, times, side="right"), len(after) - 1)
        later = np.where((times > before[next_]) & (times < after[next_]), after[next_], times)
    branches = run.branches_at(times) if run.branches.size else None
    holding = run.holding_at(times) if runner.layout.contacts else None
    found = runner.recovered(later, states, branches=branches, causes=causes, holding=holding)
    return found if later is times else replace(found, times=times)
