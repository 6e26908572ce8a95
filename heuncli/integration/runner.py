"""Motion: the kernel's stepping loop driven from one stopping point to the next, and what it knows at given instants.

Impure: a `Runner` keeps the kernel's work arrays; `trajectory` looks at the clock where a time limit is set.
"""

from __future__ import annotations

import math
import time
from array import array
from bisect import bisect_right
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from heuncli.errors import LimitError, Problem, SolveError
from heuncli.expressions.programs import discontinuities, one_sided_limits
from heuncli.integration.tableaus import DOP853, Tableau
from heuncli.kernel.choose import step
from heuncli.mechanism.model import Mechanism
from heuncli.records import record
from heuncli.results import Array
from heuncli.tree.layout import Layout

CHUNK = 2_000  # body-steps between two looks at the clock
KEPT = 20_000_000  # numbers of states kept for going back to, at the ends of all steps or every second, fourth ...
MOST_STEPS = 20_000_000
LEAST_RATE = 1e-5  # of a radian or of the scene's size in the time asked for: slower ones are judged as if that fast

ROPE = 5  # the kernel's code where a rope would push
TROUBLE = {
    2: (
        "step-collapsed",
        "the step length fell to the rounding error of the time",
        "a load or a rate grows without bound there",
    ),
    3: (
        "not-a-number",
        "no finite acceleration exists beyond this instant",
        "look at the expressions and tables, and at points that coincide",
    ),
    4: (
        "closure-lost",
        "the closed chains cannot be held together beyond this instant",
        "the mechanism locks or reaches the end of its range there",
    ),
}


@record
class Trajectory:
    """The state at the asked instants.

    times (n_t,) [s]; states (n_t, n_state); ends: instants of the accepted steps; gap: largest closure gap left [m].
    """

    times: Array
    states: Array
    ends: Array
    steps: int
    evaluations: int
    gap: float
    tolerance: float  # local, of this run
    seconds: float
    pieces: tuple[tuple[float, float], ...] = ()  # first and last instant of each stretch without jumps
    kept: tuple[tuple[int, Array], ...] = ()  # number of a step, the state before it; the first one and others
    pivots: Array = np.zeros(0)  # least of the closures in each step
    stopped: str | None = None  # the joint of the rope that would push just after the last instant


def stops(mechanism: Mechanism, t0: float, t1: float) -> list[float]:
    """Instants in (t0, t1) at which some load or drive jumps or bends."""
    expressions = set(mechanism.expressions())
    return sorted({t for e in expressions if e.time_dependent for t in discontinuities(e, t0, t1)})


@cache
def method_arrays(tableau: Tableau) -> tuple[array[int], array[float]]:
    """A tableau as the kernel's MI and T (layout: kernel/step.py)."""
    rows = [(), *tableau.stages, tableau.solution, *tableau.extra, tableau.error3, tableau.error5, *tableau.dense]
    first = 40
    starts = [first]
    for row in rows:
        starts.append(starts[-1] + len(row))
    ints = [len(tableau.stages) + 1, len(tableau.extra), len(tableau.dense), 0, 0, 0, 0, 0, *starts]
    ints += [0] * (first - len(ints)) + [stage for row in rows for stage, _ in row]
    floats = [*tableau.nodes, *([0.0] * (first - len(tableau.nodes))), *(c for row in rows for _, c in row)]
    return array("i", ints), array("d", floats)


def door(data: Any) -> Any:
    """What the kernel takes: the array itself compiled, a list (twice as fast) in plain Python."""
    if step.COMPILED:
        if len(data):
            return data
        return np.zeros(1, dtype=np.intc if isinstance(data, array) and data.typecode == "i" else np.float64)
    return list(data) if len(data) else [0.0]


def left(t: float) -> float:
    """The last instant before t: at a jump, that of the value before it."""
    return math.nextafter(t, -math.inf)


def right(t: float) -> float:
    """The first instant after t."""
    return math.nextafter(t, math.inf)


def in_time(deadline: float | None, where: str) -> None:
    """Raise LimitError past the deadline (time.monotonic()); `where` says how far the work has come."""
    if deadline is not None and time.monotonic() > deadline:
        hint = "a longer --time-limit, a coarser --tolerance, or a shorter duration"
        raise LimitError(Problem("time-limit", f"the time limit was reached {where}", hint=hint))


class Desk:
    """The kernel's work arrays for one integration over the asked instants ts, at most `most` steps at a time."""

    def __init__(self, layout: Layout, tableau: Tableau, ts: Array, most: int) -> None:
        n = layout.n_state
        self.n, self.n_t = n, len(ts)
        self.MI, self.T = (door(x) for x in method_arrays(tableau))
        self.D, self.Z = door(layout.groups[:]), door(np.zeros(16))
        self.G = door(np.concatenate([layout.weights, np.zeros(2 * layout.groups[1])]))
        self.y, self.z, self.K = door(np.zeros(n)), door(np.zeros(3 * n)), door(np.zeros(len(tableau.nodes) * n))
        self.F = door(np.zeros((3 + len(tableau.dense)) * n + 2 * n))
        self.asked, self.out = door(ts), door(np.zeros(len(ts) * n))
        self.ends, self.passed = door(np.zeros(most)), door(np.zeros(most * (n + 1)))

    def advance(self, scene: tuple[Any, ...], most: int) -> int:
        """Up to `most` steps; the kernel's code."""
        code: int = step.advance(
            *scene, self.MI, self.T, self.D, self.Z, self.G, self.y, self.K, self.z, self.F,
            self.asked, self.n_t, self.out, self.ends, self.passed, most,
        )  # fmt: skip
        return code

    def reached(self, count: int) -> Array:
        """The states at the ends of the steps just done, and how near to singular the steps came, (count, n + 1)."""
        return np.array(self.passed[: count * (self.n + 1)], dtype=float).reshape(count, self.n + 1)

    def states(self) -> Array:
        """The states at the asked instants, (n_t, n)."""
        return np.array(self.out, dtype=float)[: self.n_t * self.n].reshape(self.n_t, self.n)


class Runner:
    """A laid-out scene with the kernel's work arrays; every call starts from what it is given."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        pack = layout.pack
        depth = max(pack.depth, 1)
        self.scene = tuple(door(x) for x in (layout.I, layout.P, layout.W, pack.code, pack.constants))
        self.scene += (door(np.zeros(max(len(pack.variables), 1) + 3)), door(np.zeros(3 * depth + 8)))
        self.size = layout.size

    def trajectory(
        self,
        times: Sequence[float] | Array,
        tolerance: float,
        *,
        halts: Sequence[float] = (),
        deadline: float | None = None,
        most_steps: int = MOST_STEPS,
        tableau: Tableau = DOP853,
    ) -> Trajectory:
        """Integrate from the start at t = 0 over the asked instants (ascending); `tolerance` is the local one.

        Where a rope would have to push the run ends: the instants up to there, and that one.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline (time.monotonic()).
        """
        begun = time.perf_counter()
        layout, n = self.layout, self.layout.n_state
        ts = np.ascontiguousarray(times, dtype=float)
        most = max(1, CHUNK // max(len(layout.mechanism.bodies), 1))
        desk = Desk(layout, tableau, ts, most)
        Z, y = desk.Z, desk.y
        y[:n] = layout.y0 if step.COMPILED else layout.y0.tolist()
        Z[8] = tolerance
        # where nothing moves or pulls yet (a load like t**4), there is still a rate that matters in the time asked for
        Z[13] = LEAST_RATE / float(ts[-1]) if len(ts) and ts[-1] > 0.0 else 0.0
        self.scene[0][40] = int(any(j.tension_only for j in layout.mechanism.joints))
        ends: list[float] = []
        pivots: list[Array] = []
        kept = [(0, layout.y0)]
        every, room = 1, max(2, KEPT // n)
        last = float(ts[-1]) if len(ts) else 0.0
        in_time(deadline, f"before the run of {last:.6g} s began")
        stops = one_sided_limits([h for h in halts if 0.0 < h < last])
        pieces = list(zip([0.0, *(t for _, t in stops)], [*(t for t, _ in stops), left(last)], strict=True))
        pieces = [piece for piece in pieces if piece[1] > piece[0]] or pieces[-1:]  # not what is at t = 0 alone
        for begin, before_end in pieces:
            # up to a jump with the value before it, from there with the one after
            Z[0], Z[9], Z[10], Z[14], code = begin, before_end, right(before_end), 1.0, 1
            while code == 1:
                before = int(Z[4])
                code = desk.advance(self.scene, most)
                done = int(Z[4]) - before
                ends += list(desk.ends[:done])
                reached = desk.reached(done)
                pivots.append(reached[:, n])
                kept += [(k, row[:n]) for k, row in enumerate(reached, before + 1) if k % every == 0]
                while len(kept) > room:
                    every *= 2
                    kept = [(k, state) for k, state in kept if k % every == 0]
                if code in (0, 1):
                    in_time(deadline, f"at t = {Z[0]:.6g} s of {last:.6g} s")
                if code == 1 and Z[4] > most_steps:
                    message = f"{most_steps} steps were done at t = {Z[0]:.6g} s of {last:.6g} s"
                    raise LimitError(Problem("step-limit", message))
            if code == ROPE:
                break
            if code > 1:
                raise self._failed(code, float(Z[0]), np.array(y[:n], dtype=float), last)
        states = desk.states()
        stopped = None
        if code == ROPE:
            stopped = layout.mechanism.joints[layout.rows[int(Z[2]) - 1]].name
            ts = np.append(ts[: desk.D[2]], Z[0])
            states = np.vstack([states[: len(ts) - 1], np.array(y[:n], dtype=float)])
            if len(ts) > 1 and ts[-1] == ts[-2]:
                ts, states = ts[:-1], states[:-1]
        return Trajectory(
            times=ts, states=states, ends=np.array(ends), steps=int(Z[4]), evaluations=int(Z[5]), gap=float(Z[7]),
            tolerance=tolerance, seconds=time.perf_counter() - begun, pieces=tuple(pieces), kept=tuple(kept),
            pivots=np.concatenate(pivots) if pivots else np.zeros(0),
            stopped=stopped,
        )  # fmt: skip

    def _failed(self, code: int, t: float, state: Array, last: float) -> SolveError:
        """Why a run to `last` ends at t: an expression without a value there, else what the kernel's code says."""
        name, message, hint = TROUBLE[code]
        if name != "closure-lost":
            from heuncli.integration.domains import moving, without_value  # only on the way to an error

            found = self.recovered(np.array([t]), state[None, :])
            problems = without_value(self.layout.mechanism, t, last, moving(self.layout, found.freedoms[0]))
            if problems:
                return SolveError(*problems)
        return SolveError(Problem(name, f"at t = {t:.9g} s: {message}", hint=hint))

    def within(self, run: Trajectory, times: Array) -> Array:
        """States (n_t, n) of a run at other instants (ascending, none after its end): its own steps are done again.

        Never more work than the run, and no step of its own making: what the run came through, this does.
        """
        n = self.layout.n_state
        times = np.ascontiguousarray(times, dtype=float)
        out = np.empty((len(times), n))
        asked = np.minimum(np.searchsorted(run.ends, times), len(run.ends) - 1)  # which step an instant lies in
        if not len(run.ends):
            out[:] = run.kept[0][1]
            return out
        starts = np.array([k for k, _ in run.kept])
        base = np.searchsorted(starts, asked, side="right") - 1
        # steps in a row are done in one go
        breaks = np.flatnonzero((np.diff(asked) > 1) & (np.diff(base) > 0)) + 1
        for group in np.split(np.arange(len(times)), breaks):
            if len(group):
                first, state = run.kept[base[group[0]]]
                out[group] = self._again(run, first, int(asked[group[-1]]), state, times[group])
        return out

    def _again(self, run: Trajectory, first: int, last: int, state: Array, times: Array) -> Array:
        n = self.layout.n_state
        desk = Desk(self.layout, DOP853, times, last - first + 1)
        Z, y = desk.Z, desk.y
        y[:n] = state if step.COMPILED else state.tolist()
        desk.D[4] = 1
        Z[0], Z[8] = run.ends[first - 1] if first else 0.0, math.inf
        self.scene[0][40] = 0
        while first <= last:
            begin, before_end = run.pieces[bisect_right(run.pieces, Z[0], key=lambda piece: piece[1])]
            end = right(before_end)
            to = min(last, int(np.searchsorted(run.ends, end)))  # a piece ends with a step
            steps = run.ends[first : to + 1]
            desk.ends[: len(steps)] = steps if step.COMPILED else steps.tolist()
            Z[0], Z[9], Z[10], Z[14] = max(Z[0], begin), before_end, end, 1.0
            desk.advance(self.scene, len(steps))
            first = to + 1
        return desk.states()

    def recovered(self, times: Array, states: Array, *, choose: bool = False) -> Recovered:
        """Everything the sweep knows at the given states (brought onto the closures first).

        choose: pick the independent closure rows at every instant anew, for poses that do not follow one another.
        """
        layout, n = self.layout, self.layout.n_state
        n_b, n_f, n_l, n_r = len(layout.place), len(layout.freedoms), layout.I[3], len(layout.rows)
        width = 30 * n_b + 4 * n_f + 16 * n_l + 2 * n_r + 3
        Y = np.array(states, dtype=float).reshape(len(times), n)
        flat, out = door(Y.ravel()), door(np.zeros(len(times) * width))
        self.scene[0][38] = int(choose)
        at = door(np.ascontiguousarray(times, dtype=float))
        step.states(*self.scene, n, len(times), at, flat, door(np.zeros(n)), out, width)
        if choose:
            self.scene[0][38] = 0
        data = np.array(out, dtype=float).reshape(len(times), width)
        cuts = np.cumsum([30 * n_b, 4 * n_f, 16 * n_l, 2 * n_r])
        bodies, freedoms, loads, rows, rest = np.split(data, cuts, axis=1)
        return Recovered(
            times=np.asarray(times, dtype=float),
            states=np.array(flat, dtype=float)[: Y.size].reshape(Y.shape),
            bodies=bodies.reshape(len(times), n_b, 30),
            freedoms=freedoms.reshape(len(times), n_f, 4),
            loads=loads.reshape(len(times), n_l, 16),
            rows=rows.reshape(len(times), n_r, 2),
            gap=rest[:, 0],
            idle=rest[:, 1],
            pivot=rest[:, 2],
        )


@record
class Recovered:
    """The kernel's answers at the instants, sweep order; layouts: kernel/step.py `recover`."""

    times: Array
    states: Array
    bodies: Array
    freedoms: Array
    loads: Array
    rows: Array
    gap: Array
    idle: Array
    pivot: Array  # least pivot of the closures chosen at the first instant, 1: far from singular
