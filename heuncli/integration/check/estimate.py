"""Error estimate of a motion by further runs.

The estimate is 2 |A - B|: A is the run that is told, B a check run at 1/30 of A's local tolerance from a start moved by
rounding, both seen at the same instants (integration/check/comparison.py). Tried on free, open and closed chains,
|A - B| is 0.9 to 1.1 of the true error; a coarser check run would give 3 to 100 times it.

A method of given step has no tolerance: B goes in quarters of the step, |A - B| is then 1 - 4^-p of A's error, three
quarters at order 1, and A is not made again, for its step was asked for. Where a step is too long for what decays in
it, Gauss's methods keep that alive at any step: there B goes by Radau's (`Method.check`).

At small tolerances the error of A may be no larger than what the moved start has grown to in B, and cancel it. There a
further run M goes from the moved start as A goes from its own: |A - M| is what rounding grows to, and the largest
distance of any two counts, of the motion: what all make of rounding may lie to one side of the truth.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heuncli import tolerances
from heuncli.errors import LimitError, SolveError
from heuncli.integration.check.comparison import between_strikes, instants_of, interleaved, moved_start, passed_between
from heuncli.integration.check.distance import Marks, angle_error, motion_error
from heuncli.integration.contacts.blows import Jump
from heuncli.integration.evaluator import Recovered
from heuncli.integration.methods.dop853 import DOP853
from heuncli.integration.methods.method import Method
from heuncli.integration.run.loop import limits_of
from heuncli.integration.run.runner import ClosuresLost, Runner, Trajectory
from heuncli.records import record, replace
from heuncli.results import Array, Estimate, Mask

if TYPE_CHECKING:  # loaded where there are conditions
    from heuncli.integration.conditions import Changes

RATIO = 30.0  # local tolerance of A over that of B
FIRST = 1.0  # local tolerance of the first run over the tolerance asked
LEAST_RATIO = 4.0  # the same at least: errors are as the tolerances, 2 |A - B| is still 1.5 times that of A
LEAST_HALVING = 2.0  # of a given step: 2 |A - B| is at order 1 still the error of A
RERUNS = 2
COLLAPSED = ("step-collapsed", "closure-lost")  # how a run may end near a singular pose because of rounding
FUTILE = 20  # a finer run that takes more than so many times the steps of the coarser one is dominated by rounding
CHUNK = 2_000_000  # numbers compared at a time


class Loads(Protocol):
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
class Checked:
    """A run that was checked.

    recovered: accelerations and loads at the run's instants; motion: largest estimated error of any point over the
    whole run, relative to the size; loads: those of the other kinds; errors: all by kind and unit, before the horizon;
    horizon: where the motion's passes CLAIMED; kinetic: the largest kinetic energy [J]; beside: the blows of the check
    runs.
    """

    run: Trajectory
    recovered: Recovered
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


class Runs:
    """Runs of one motion, at several tolerances."""

    def __init__(
        self, runner: Runner, times: Array, jumps: Sequence[float], deadline: float | None, method: Method = DOP853,
        *, step: float | None = None, watched: bool = False,
    ) -> None:  # fmt: skip
        """step: of a method of given step. watched: the runs to be told are left where another takes less (Stiff)."""
        self.runner, self.times, self.jumps, self.step = runner, times, jumps, step
        self.deadline, self.method, self.watched = deadline, method, watched
        self.eventful = False  # whether the same runs are left where events end their steps, or cease to (Eventful)
        self.moved, self.marks = moved_start(runner.layout), Marks(runner.layout)

    def run(
        self, local: float, at: Array | None = None, start: Array | None = None,
        most_steps: int = tolerances.MOST_STEPS, by: Method | None = None,
    ) -> Trajectory:  # fmt: skip
        """A run from the start, or from one beside it, seen at the asked instants or at others; by: another method.

        At others: a check run, which goes as far as the run that it checks.
        """
        return self.runner.trajectory(
            self.times if at is None else at, local, discontinuities=self.jumps, deadline=self.deadline,
            most_steps=most_steps, method=by or self.method, start=start, whole=at is not None,
            watched=self.watched and at is None, eventful=self.eventful and at is None,
        )  # fmt: skip

    def first(self, tolerance: float) -> Trajectory:
        """The run asked for; where it collapses at a singular pose, a coarser one that passes it."""
        if self.step is not None:
            return self.given(self.step)
        local = max(tolerance * FIRST, tolerances.LEAST_TOLERANCE)
        try:
            return self.run(local)
        except SolveError as error:
            if self.method.determined:
                raise
            collapsed = self.runner.layout.rows and error.problems[0].code in COLLAPSED
            coarser = [local * RATIO**k for k in (1, 2, 3)] if collapsed else []
            for other in (x for x in coarser if x <= tolerances.COARSEST_RETRY):
                with contextlib.suppress(SolveError):
                    return self.run(other)
            if isinstance(error, ClosuresLost):
                from heuncli.integration.refusals.contradictions import located  # only on the way to an error

                lock = located(self.runner, error)
                lock.reached = error.reached
                raise lock from None
            raise

    def given(self, step: float) -> Trajectory:
        """The run in steps of a given length."""
        try:
            return self.run(step)
        except SolveError as error:
            from heuncli.integration.refusals.given_steps import of_given_steps  # only on the way to an error

            raise of_given_steps(self, error) from None

    def attempt(
        self, local: float, than: Trajectory, at: Array | None, start: Array | None, by: Method | None = None
    ) -> Trajectory | None:
        """A run of not many more steps than another; None where rounding lets it collapse, near a singular pose say."""
        try:
            return self.run(local, at, start, FUTILE * than.steps + 1000, by)
        except SolveError:
            return None
        except LimitError as limit:
            if limit.problems[0].code == "time-limit":
                raise
            return None

    def finer(self, a: Trajectory, by: float) -> Trajectory | None:
        """A run at a tolerance smaller by a factor; by that of check runs at least, and where it collapses."""
        for ratio in (by, RATIO) if by > RATIO else (RATIO,):
            run = self.attempt(max(a.local / ratio, tolerances.LEAST_TOLERANCE), a, None, None)
            if run is not None:
                return run
        return None

    def check(self, a: Trajectory, at: Array) -> tuple[Trajectory, ...]:
        """The check run of A; behind it one more that was made on the way to it.

        Where rounding stands against a finer run, one that is less so serves; without any a coarser one: the estimate
        is larger, never too small. A start moved by rounding may set what A holds exactly at rest trembling so fast
        that no run can follow: then the start stays.
        """
        most, least = (RATIO, LEAST_RATIO) if not a.method.fixed else (float(tolerances.CHECK_STEPS), LEAST_HALVING)
        tried = [(a.local / ratio, self.moved) for ratio in (most, least, 1.0 / most)]
        for local, start in (*tried, (a.local / most, None)):
            run = self.attempt(local, a, at, start, a.method.check)
            if run is not None:
                return self.apart(a, run, at, start)
        return (self.run(a.local * most, at, by=a.method.check),)

    def apart(self, a: Trajectory, b: Trajectory, at: Array, start: Array | None) -> tuple[Trajectory, ...]:
        """The check run, before it one as fine as there is where it takes steps that A took: there both err alike.

        So it does where what happens cuts steps and not the tolerance: the difference would show nothing. It counts as
        well: in a short pulse each run errs by the rounding of its own instants, and two may agree by chance.
        """
        if a.method.fixed or a.method.determined or not shared_steps(a.ends, b.ends):
            return (b,)
        if b.local <= tolerances.LEAST_TOLERANCE:
            return (b,)
        finest = self.attempt(tolerances.LEAST_TOLERANCE, a, at, start)
        return (b,) if finest is None else (finest, b)

    def beside(self, a: Trajectory, at: Array) -> Trajectory | None:
        """A run like A from the moved start, where rounding may matter; else None."""
        if a.method.determined or (not a.method.fixed and a.local >= tolerances.ROUNDING_MATTERS):
            return None
        return self.attempt(a.local, a, at, self.moved)


def shared_steps(a: Array, b: Array) -> bool:
    """Whether two runs, by the ends of their steps, have a step in common that counts among them: a long one."""
    if not len(b):
        return False  # it was ended at its start
    steps, others = (np.append(0.0, ends[:-1]) for ends in (a, b))
    long = a - steps > tolerances.SHARED_STEP * np.max(a - steps, initial=0.0)
    begin, end = steps[long], a[long]
    near = tolerances.SAME_STEP * (end - begin)
    k = np.minimum(np.searchsorted(others, begin - near), len(b) - 1)
    return bool(np.any((np.abs(others[k] - begin) <= near) & (np.abs(b[k] - end) <= near)))


@record
class Compared:
    """Runs seen at the same instants: A, and beside it B and, where it was made, M.

    states: of each run; error (n,): of A's motion there; horizon: where that passes CLAIMED. several: the answers, at
    each instant those of all runs, where they are few enough to be kept.
    """

    runs: tuple[Trajectory, ...]
    times: Array
    states: tuple[Array, ...]
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


def checked_run(runs: Runs, tolerance: float, loads: Loads) -> Checked:
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
    for part, several in answers_of(runs, best, kept, loads.by_cause):
        with np.errstate(over="ignore", invalid="ignore"):  # given steps that run away: errors without bound
            loads.add(several, asked[part], at[part] < (np.inf if best.horizon is None else best.horizon))
    recovered = told_of(runs, best, loads.by_cause)
    seconds = best.seconds + time.perf_counter() - begun
    told = best.motion, loads.estimate(), loads.errors(), best.horizon, loads.kinetic()
    beside = tuple(run.blows for run in best.runs[1:])
    return Checked(a, recovered, *told, beside, seconds, lost, changes_of_conditions(runs, best))


def changes_of_conditions(runs: Runs, best: Compared) -> tuple[Changes, ...]:
    """When the conditions change, up to the horizon."""
    if not runs.runner.layout.mechanism.conditions:
        return ()
    from heuncli.integration.conditions import changes_of  # few scenes have them

    return changes_of(runs.runner, best.runs, np.inf if best.horizon is None else best.horizon)


def answers_of(runs: Runs, best: Compared, kept: Mask, causes: bool) -> Iterator[tuple[slice, Recovered]]:
    """The answers at those of the instants that are kept, as `recovered_together` gives them; none is found twice."""
    if best.several is None or causes:
        yield from recovered_together(
            runs, best.runs[0], best.times[kept], [x[kept] for x in best.states], causes=causes
        )
    else:
        several = best.several if kept.all() else best.several.at(np.repeat(kept, len(best.runs)))
        yield slice(None), several


def told_of(runs: Runs, best: Compared, causes: bool) -> Recovered:
    """The answers at A's asked instants; where all of them were compared they are among those already."""
    a = best.runs[0]
    if best.several is None or causes or np.count_nonzero(best.asked) != len(a.times):
        return recovered_at(runs.runner, a, a.times, a.states, runs.jumps, causes=causes)
    return best.several.at(len(best.runs) * np.flatnonzero(best.asked))


def compared(runs: Runs, a: Trajectory) -> Compared:
    """A with its check run, and the run beside it."""
    begun = time.perf_counter()
    at = instants_of(runs.runner, a)
    m = runs.beside(a, at.times)
    others = [*runs.check(a, at.times), *([] if m is None else [m])]
    n = len(at.times)
    if any(run.stopped for run in (a, *others)):
        # the runs end at instants of their own; the last of A is judged by the one before it
        n = min(int(np.sum(at.times[: len(x.times)] == x.times[: len(at.times)])) for x in others)
    times, states = at.times[:n], (at.states[:n], *(x.states[:n] for x in others))
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


def errors(runs: Runs, a: Trajectory, times: Array, states: Sequence[Array]) -> tuple[Array, Recovered | None]:
    """Estimated errors of the motion at the instants, (n,), and the answers there, where one part holds them all.

    states: of A and of the other runs.
    """
    layout = runs.runner.layout
    places, angles, largest = np.zeros(len(times)), np.zeros(len(times)), 1.0
    several = None
    for part, several in recovered_together(runs, a, times, states):
        with np.errstate(over="ignore", invalid="ignore"):  # the same
            places[part] = motion_error(runs.marks, several, len(states), layout.size)
            angles[part], turned = angle_error(layout, several, len(states))
        largest = max(largest, turned)
    whole = several if several is not None and len(several.times) == len(states) * len(times) else None
    return np.maximum(places, angles / largest), whole


def recovered_together(
    runs: Runs, a: Trajectory, times: Array, states: Sequence[Array], *, causes: bool = False
) -> Iterator[tuple[slice, Recovered]]:
    """The answers at the instants, at each those of all runs, in parts that fit the memory.

    All hold A's branches: of an event that the runs meet at instants a little apart, either would else show its own
    side of a jump, and the estimate the jump.
    """
    layout = runs.runner.layout
    numbers = (30 + 12 * (len(layout.mechanism.loads) + 3) * causes) * len(layout.place)
    many = max(1, CHUNK // (numbers * len(states) + 1))
    for i in range(0, len(times), many):
        part = slice(i, i + many)
        both = interleaved(times[part], [x[part] for x in states])
        yield part, recovered_at(runs.runner, a, *both, runs.jumps, causes=causes)


def recovered_at(
    runner: Runner, run: Trajectory, times: Array, states: Array, jumps: Sequence[float], *, causes: bool = False
) -> Recovered:
    """Accelerations and loads of states like those of a run; at a discontinuity the right limits."""
    before, after = limits_of(jumps)
    next_ = np.minimum(np.searchsorted(after, times, side="right"), len(after) - 1)
    later = np.where((times > before[next_]) & (times < after[next_]), after[next_], times) if len(after) else times
    branches = run.branches_at(times) if run.branches.size else None
    found = runner.recovered(later, states, branches=branches, causes=causes, holding=run.holding_at(times))
    return replace(found, times=times)
