"""Runs of one motion at several tolerances: A, the one that is told, its check runs B, finer ones (estimate.py)."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from functools import cache

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, SolveError
from heuncli.motion.integration.check.distance import Marks
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.errors import ClosuresLost, Stiff
from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

RATIO = 30.0  # local tolerance of A over that of B
FIRST = 1.0  # local tolerance of the first run over the tolerance asked
LEAST_RATIO = 4.0  # the least such ratio: errors go as tolerances, 2 |A - B| is still 1.5 times that of A
LEAST_HALVING = 2.0  # of a given step: 2 |A - B| is at order 1 still the error of A
OWN_STEPS = 1e-6  # tolerance of a run that finds its own steps, where given ones fail
COLLAPSED = ("step-collapsed", "closure-lost")  # how a run may end near a singular pose because of rounding
FUTILE = 20  # a finer run that takes more than so many times the steps of the coarser one is dominated by rounding


class Runs:
    """Runs of one motion, at several tolerances. What is changed of it between two runs: method, eventful."""

    def __init__(
        self, runner: Runner, times: Array, jumps: Sequence[float], deadline: float | None, method: Method = DOP853,
        *, step: float | None = None, watched: bool = False,
    ) -> None:  # fmt: skip
        """times (n_t,), jumps: asked instants and discontinuities in time [s]; deadline: by time.monotonic().

        step [s]: of a method of given step. watched: runs at the asked instants are left where another method takes
        less (Stiff).
        """
        self.runner, self.times, self.jumps, self.step = runner, times, jumps, step
        self.deadline, self.method, self.watched = deadline, method, watched
        self.eventful = False  # whether these runs are left where events end their steps, or cease to (Eventful)
        self.moved, self.marks = moved_start(runner.layout), Marks(runner.layout)

    def run(
        self, local: float, at: Array | None = None, start: Array | None = None,
        most_steps: int = tolerances.MOST_STEPS, by: Method | None = None,
    ) -> Trajectory:  # fmt: skip
        """A run at a tolerance (or step) from the scene's start or another one (n,); by: another method.

        at: other instants than the asked ones, to which a check run goes: as far as the run that it checks, though the
        condition that ends the motion became true.
        """
        told, times = at is None, self.times if at is None else at
        method = by or self.method
        request = MotionTask(times, local, method, self.jumps, start, self.deadline, most_steps, keeping=told)
        rules = StoppingRules(ending=told, stiffness=told and self.watched, events=told and self.eventful)
        return self.runner.trajectory(request, rules)

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
                from heuncli.motion.integration.check.contradictions import located  # only on the way to an error

                lock = located(self.runner, error)
                lock.reached = error.reached
                raise lock from None
            raise

    def given(self, step: float) -> Trajectory:
        """The run in steps of a given length."""
        try:
            return self.run(step)
        except SolveError as error:
            from heuncli.motion.integration.check.given_steps import of_given_steps  # only on the way to an error

            raise of_given_steps(error, self.runner, self.method, step, self.in_own_steps) from None

    def in_own_steps(self) -> HeunError | None:
        """How the motion fails in steps that a method finds, as `auto` takes them; None where it comes to its end."""
        method, watched = DOP853, True
        while True:
            try:
                Runs(self.runner, self.times, self.jumps, self.deadline, method, watched=watched).first(OWN_STEPS)
            except Stiff as stiff:
                method, watched = stiff.method, False
            except HeunError as error:
                return error
            else:
                return None

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
        """The check run B of A; before it a finer one, where both would err alike.

        Where rounding stands against a finer run, one that is less so serves; without any a coarser one: the estimate
        is larger, never too small. A start moved by rounding may set what A holds exactly at rest trembling so fast
        that no run can follow: then the start stays.
        """
        most, least = (RATIO, LEAST_RATIO) if not a.method.fixed else (float(tolerances.CHECK_STEPS), LEAST_HALVING)
        tried = [(a.local / ratio, self.moved) for ratio in (most, least, 1.0 / most)]
        for local, start in (*tried, (a.local / most, None)):
            run = self.attempt(local, a, at, start, a.method.check)
            if run is not None:
                return self.with_finest(a, run, at, start)
        return (self.run(a.local * most, at, by=a.method.check),)

    def with_finest(self, a: Trajectory, b: Trajectory, at: Array, start: Array | None) -> tuple[Trajectory, ...]:
        """The check run B, and before it one as fine as there is where B takes steps that A took.

        In common steps both err alike, and their difference shows nothing: steps are in common where events cut them,
        and not the tolerance. B counts as well: in a short pulse each run errs by the rounding of its own instants, and
        two may agree by chance.
        """
        if a.method.fixed or a.method.determined or not shared_steps(a.ends, b.ends):
            return (b,)
        if b.local <= tolerances.LEAST_TOLERANCE:
            return (b,)
        finest = self.attempt(tolerances.LEAST_TOLERANCE, a, at, start)
        return (b,) if finest is None else (finest, b)

    def from_moved_start(self, a: Trajectory, at: Array) -> Trajectory | None:
        """The run M: like A from the moved start, where rounding may matter; else None."""
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


@cache
def without_symmetry(count: int) -> Array:
    """Numbers between a half and one of either sign, without a pattern, (count,)."""
    share = np.modf(0.6180339887498949 * np.arange(1, count + 1))[0]
    found = np.where(share < 0.5, -1.0, 1.0) * (0.5 + np.modf(2.0 * share)[0] / 2.0)
    found.flags.writeable = False
    return np.asarray(found)


def moved_start(layout: Layout) -> Array:
    """A start beside the given one by the rounding of its numbers; the closures are closed again by the run.

    What an unstable start makes of rounding is then seen: upright at 180 degrees, A stays there for ever. Rates move by
    the rounding of the body's largest, so that what rests stays at rest. The directions are those of no symmetry: an
    even spread of fractions of the golden section.
    """
    y = layout.y0.copy()
    direction = without_symmetry(len(y))
    for group in layout.tables["groups"]:
        coordinates, rates, end = group["coordinates"], group["rates"], group["end"]
        unit = 1.0 / layout.weights[coordinates:end]
        size = np.maximum(np.abs(y[coordinates:rates]), unit[: rates - coordinates])
        largest = (np.abs(y[rates:end]) / unit[rates - coordinates :]).max(initial=0.0)
        scale = np.concatenate([size, largest * unit[rates - coordinates :]])
        y[coordinates:end] += tolerances.START_ROUNDING * direction[coordinates:end] * scale
    return y
