"""When the conditions on a motion change, and how well that is known.

An instant found errs by as much as the motion by which it is found. The check run, or another beside it, is to show
the same change there but for an interval d of time: its course about the instant is known by rates and accelerations,

    q(t + d) = q + u d + a d^2 / 2,    u(t + d) = u + a d

and d is widened until the condition has its one value before it and its other behind. Where a margin only just passes
through zero that takes long: such an instant has few digits, or none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.shared_blows import matched
from heuncli.motion.integration.conditions import Conditions, Coordinates, coordinates_at
from heuncli.motion.integration.contacts.blows import Jump
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import Expression


@record
class Changes:
    """When a condition changes: begins, whether it is true at first; times (n,) ascending, to (n,): what it becomes.

    error (n,) [s]: of the instants; nan where a run beside this one does not show the change.
    """

    name: str
    begins: bool
    times: Array
    to: Mask
    error: Array

    def before(self, t: float) -> Changes:
        """The changes before an instant [s]."""
        return self.some(self.times < t)

    def known_by(self, t: float, last: float) -> Changes:
        """The changes up to an instant t [s] or, by their errors, perhaps so; late ones at `last`, where a run ends."""
        kept = self.some(self.times - np.nan_to_num(self.error) <= t)
        return replace(kept, times=np.where(kept.times < t, kept.times, last))

    def some(self, kept: Mask) -> Changes:
        """Some of the changes, kept (n,)."""
        return replace(self, times=self.times[kept], to=self.to[kept], error=self.error[kept])


def changes_of(runner: Runner, runs: Sequence[Trajectory], before: float) -> tuple[Changes, ...]:
    """When the conditions of a scene change in the first of some runs, before an instant; others tell the errors."""
    found = changes_in(runner, runs[0])
    return tuple(
        replace(own, error=errors(runner, runs, number, own))
        for number, own in enumerate(changes.before(before) for changes in found)
    )


def changes_in(runner: Runner, run: Trajectory) -> list[Changes]:
    """When the conditions change in a run, errors left out."""
    conditions = Conditions(runner.moving.layout)
    begins, inside, branches = stretches(run)
    coordinates = coordinates_at(runner, inside, runner.resample(run, inside))
    truths = np.array([
        conditions.held(t, row, there) for t, row, there in zip(inside.tolist(), branches, coordinates, strict=True)
    ])  # fmt: skip
    found = []
    for condition, truth in zip(conditions.conditions, truths.T, strict=True):
        if np.isnan(truth).any():
            raise no_value(condition.value, float(inside[np.isnan(truth)][0]))
        found.append(changes(condition.name, begins, truth > 0.5))
    return found


def stretches(run: Trajectory) -> tuple[Array, Array, Array]:
    """Stretches of a run in which no branch changes: where each begins, an instant within it, the branches held there.

    The last one is the end of the run, with the branches behind it.
    """
    bounds = np.concatenate([[0.0], run.ends])
    count = len(run.ends)
    rows = np.vstack([run.branches.reshape(count, -1), run.behind[None, :]])
    fresh = np.isin(bounds, run.segments.ends)
    fresh[1:] |= (rows[1:] != rows[:-1]).any(axis=1)
    fresh[0] = fresh[count] = True
    # a jump in time alone may end a run one double behind its last step, where the condition is true
    inside = np.append(0.5 * (bounds[:-1] + bounds[1:]), max(bounds[-1], run.times[-1]))
    return bounds[fresh], inside[fresh], rows[fresh]


def changes(name: str, begins: Array, truth: Mask) -> Changes:
    """The changes from stretch to stretch; what is taken back at the same instant is none."""
    last = np.append(begins[1:] != begins[:-1], True)  # of several at one instant what holds behind them
    begins, truth = begins[last], truth[last]
    changed = np.flatnonzero(truth[1:] != truth[:-1]) + 1
    return Changes(name, bool(truth[0]), begins[changed], truth[changed], np.zeros(len(changed)))


def errors(runner: Runner, runs: Sequence[Trajectory], number: int, own: Changes) -> Array:
    """The errors of the instants of a condition's changes, by the other runs, (n,)."""
    found = np.zeros(len(own.times))
    if not len(own.times):
        return found
    conditions, last = Conditions(runner.layout), float(runs[0].times[-1])
    for run in runs[1:]:
        at = np.minimum(own.times, run.reached)
        coordinates = coordinates_at(runner, at, runner.resample(run, at))
        struck = blows_apart(runs[0].blows, run.blows)
        for i, (t, to, there) in enumerate(zip(own.times.tolist(), own.to.tolist(), coordinates, strict=True)):
            apart = struck[t] if t in struck else apart_from(conditions, number, (t, to, last), there)
            found[i] = np.maximum(found[i], 2.0 * apart)
    return found


def blows_apart(own: Sequence[Jump], others: Sequence[Jump]) -> dict[float, float]:
    """Of each blow of a run by how much another run has it sooner or later; nan where that has none."""
    found = dict.fromkeys((blow.time for blow in own), UNKNOWN)
    for i, k in matched(own, others):
        t = own[i].time
        found[t] = max(abs(others[k].time - t), tolerances.EPS * t)
    return found


def apart_from(
    conditions: Conditions, number: int, change: tuple[float, bool, float], coordinates: Coordinates
) -> float:
    """Within which time of a change another run shows it, too; nan if not within a part of the run."""
    t, to, last = change
    d = tolerances.KERNEL["one_instant"] * max(t, 0.01 * last)
    while d <= tolerances.CLAIMED * last:
        sides = (conditions.free(number, t, side * d, coordinates) for side in (-1.0, 1.0))
        if tuple(sides) == ((0.0, 1.0) if to else (1.0, 0.0)):
            return d
        d *= 2.0
    return UNKNOWN


def no_value(value: Expression, t: float) -> SolveError:
    """The error of a condition that has no value."""
    hint = "keep it within the domain of its functions, as with max(x, 0) or 'a if c else b', or within its tables"
    message = f"'{value.source.strip()}' has no value at t = {t:.9g} s"
    return SolveError(Problem("no-value", message, value.location, hint))


UNKNOWN = math.nan  # an error of which nothing is known
