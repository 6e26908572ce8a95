"""Error estimate of a motion by a second run.

The estimate is 2 |A - B|, B a second run at 1/30 of A's local tolerance, over all points and asked instants.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.errors import LimitError, SolveError
from heuncli.expressions.programs import one_sided_limits
from heuncli.integration.methods import DOP853, Method
from heuncli.integration.runner import MOST_STEPS, Recovered, Runner, Trajectory
from heuncli.mechanism.size import marks
from heuncli.records import record, replace
from heuncli.results import Array
from heuncli.tree.layout import Layout
from heuncli.tree.tables import Table

RATIO = 30.0  # local tolerance of A over that of B
FIRST = 1.0  # local tolerance of the first run over the tolerance asked
RERUNS = 2
COLLAPSED = ("step-collapsed", "closure-lost")  # how a run may end near a singular pose because of rounding
FUTILE = 20  # a finer run that takes more than so many times the steps of the coarser one is dominated by rounding
CHUNK = 2_000_000  # numbers compared at a time


@record
class Checked:
    """A run that was checked.

    recovered: accelerations and loads at the run's instants; motion (n_t,): estimated error of any point, relative to
    the size; reactions: see `compare`.
    """

    run: Trajectory
    recovered: Recovered
    motion: Array
    reactions: float
    horizon: float | None
    check_seconds: float
    lost_seconds: float  # of runs that missed the tolerance


def checked_run(
    runner: Runner,
    times: Array,
    tolerance: float,
    jumps: Sequence[float],
    deadline: float | None,
    method: Method = DOP853,
) -> Checked:
    """Integrate until the motion's estimated error is below `tolerance`, with at most two reruns; else the best run."""

    def run(local: float, most_steps: int = MOST_STEPS) -> Trajectory:
        return runner.trajectory(
            times, local, discontinuities=jumps, deadline=deadline, most_steps=most_steps, method=method
        )

    def finer(local: float, than: Trajectory) -> Trajectory | None:
        """A run at a smaller tolerance; None where rounding (near a singular pose, say) makes it collapse."""
        try:
            return run(local, FUTILE * than.steps + 1000)
        except SolveError:
            return None
        except LimitError:
            if deadline is not None and time.monotonic() > deadline:
                raise
            return None

    def first(local: float) -> Trajectory:
        """The run asked for; where it collapses at a singular pose, a coarser one that passes it."""
        try:
            return run(local)
        except SolveError as error:
            collapsed = runner.layout.rows and error.problems[0].code in COLLAPSED
            coarser = [local * RATIO**k for k in (1, 2, 3)] if collapsed else []
            for other in (x for x in coarser if x <= tolerances.COARSEST_RETRY):
                with contextlib.suppress(SolveError):
                    return run(other)
            raise

    a = first(max(tolerance * FIRST, tolerances.LEAST_TOLERANCE))
    lost, best = 0.0, None
    for attempt in range(RERUNS + 1):
        b = finer(a.tolerance / RATIO, a)
        # without a finer run a coarser one serves for the comparison: the estimate is larger, never too small
        check = b if b is not None else run(a.tolerance * RATIO)
        recovered = recovered_at(runner, a.times, a.states, jumps)
        motion, reactions = compare(runner, a, recovered, check, jumps)
        seconds = check.seconds
        if best is not None and motion.max(initial=0.0) >= best.motion.max(initial=0.0):
            return replace(best, lost_seconds=best.lost_seconds + a.seconds + seconds)
        late = np.flatnonzero(motion > tolerances.CLAIMED)
        best = Checked(a, recovered, motion, reactions, float(a.times[late[0]]) if len(late) else None, seconds, lost)
        miss = float(motion.max(initial=0.0)) / tolerance
        if miss <= 1.0 or attempt == RERUNS or a.tolerance <= tolerances.LEAST_TOLERANCE or b is None:
            break
        lost += a.seconds
        if miss > RATIO / 2.0:
            lost += seconds
            other = finer(max(a.tolerance / (2.0 * miss), tolerances.LEAST_TOLERANCE), a)
            if other is None:
                break
            b = other
        a = b
    assert best is not None
    return best


def recovered_at(runner: Runner, times: Array, states: Array, jumps: Sequence[float]) -> Recovered:
    """Accelerations and loads; at a discontinuity the right limits."""
    later = times.copy()
    for before, after in one_sided_limits(jumps):
        later[(times > before) & (times < after)] = after
    return replace(runner.recovered(later, states), times=times)


def compare(
    runner: Runner, a: Trajectory, recovered: Recovered, b: Trajectory, jumps: Sequence[float]
) -> tuple[Array, float]:
    """2 |A - B|: of any point, (n_t,), relative to the scene's size; of joint loads, relative to the largest."""
    layout = runner.layout
    step = max(1, CHUNK // (30 * len(layout.place) + 1))
    n = len(a.times)
    if a.stopped or b.stopped:
        # the two runs end at instants of their own; the last of A is judged by the one before it
        n = int(np.sum(a.times[: len(b.times)] == b.times[: len(a.times)]))
    motion, worst, largest, inertia = np.zeros(len(a.times)), 0.0, 0.0, 0.0
    masses = np.array([layout.mechanism.bodies[h.body].mass for h in layout.spanning.hangs])[:, None]
    for i in range(0, n, step):
        chunk = slice(i, min(i + step, n))
        B = recovered_at(runner, a.times[chunk], b.states[chunk], jumps)
        bodies, rows = recovered.bodies[chunk], recovered.rows[chunk]
        motion[chunk] = distance(layout, bodies, B.bodies) / layout.size
        for x, y, arm in (
            (bodies["joint_force"], B.bodies["joint_force"], 1.0),
            (bodies["joint_moment"], B.bodies["joint_moment"], layout.size),
            (rows["multiplier"], B.rows["multiplier"], 1.0),
        ):
            worst = max(worst, float(np.abs(x - y).max(initial=0.0)) / arm)
            largest = max(largest, float(np.abs(x).max(initial=0.0)) / arm)
        inertia = max(inertia, float(np.abs(bodies["a"] * masses).max(initial=0.0)))
    motion[n:] = motion[n - 1] if n else 0.0
    # a free body has no reactions: what the sweep leaves at its six freedoms is rounding
    some = largest > tolerances.NO_LOAD * inertia
    reactions = (2.0 * worst + tolerances.PLACE_ROUNDING * largest) / largest if some else 0.0
    return 2.0 * motion + tolerances.PLACE_ROUNDING, reactions


def distance(layout: Layout, a: Table, b: Table) -> Array:
    """Largest distance of any named point or centre of mass between two sets of `Recovered.bodies`, (n_t,) [m]."""
    dR, dr = b["R"] - a["R"], b["r"] - a["r"]
    owner, arms = [], []
    for i, body in enumerate(layout.mechanism.bodies):
        k = layout.place[i]
        for p in marks(body):
            owner.append(k)
            arms.append(p - layout.reference[k])
    d = dr[:, owner] + np.einsum("tnij,nj->tni", dR[:, owner], np.array(arms))
    return np.asarray(np.sqrt(np.max(np.sum(d * d, axis=2), axis=1)))
