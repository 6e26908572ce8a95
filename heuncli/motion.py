"""Motion: the kernel's stepping loop driven from one stopping point to the next, and what it knows at given instants.

Impure: a `Runner` keeps the kernel's work arrays; `trajectory` looks at the clock where a time limit is set.
"""

from __future__ import annotations

import math
import time
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.errors import LimitError, Problem, SolveError
from heuncli.kernel.choose import step
from heuncli.mechanism.layout import Layout
from heuncli.mechanism.model import Mechanism, PointLoad
from heuncli.results import Array
from heuncli.spec.expression import Expression, breakpoints
from heuncli.tableaus import DOP853, Tableau

CHUNK = 20_000  # body-steps between two looks at the clock
MOST_STEPS = 20_000_000

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


@dataclass(frozen=True, eq=False)
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
    stopped: str | None = None  # the joint of the rope that would push just after the last instant


def stops(mechanism: Mechanism, t0: float, t1: float) -> list[float]:
    """Instants in (t0, t1) at which some load or drive jumps or bends."""
    expressions: set[Expression] = set()
    for load in mechanism.loads:
        expressions.update(load.vector if isinstance(load, PointLoad) else [] if load.value is None else [load.value])
    expressions.update(j.drive.value for j in mechanism.joints if j.drive is not None)
    return sorted({t for e in expressions if e.time_dependent for t in breakpoints(e, t0, t1)})


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
        y0: Array | None = None,
        t0: float = 0.0,
        halts: Sequence[float] = (),
        deadline: float | None = None,
        most_steps: int = MOST_STEPS,
        ropes: bool = True,
        tableau: Tableau = DOP853,
    ) -> Trajectory:
        """Integrate from y0 at t0 over the asked instants (ascending, >= t0); `tolerance` is the local one.

        Where a rope would have to push the run ends: the instants up to there, and that one; not with ropes False.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline (time.monotonic()).
        """
        begun = time.perf_counter()
        layout, n = self.layout, self.layout.n_state
        ts = np.ascontiguousarray(times, dtype=float)
        MI, T = (door(x) for x in method_arrays(tableau))
        y = door(np.array(layout.y0 if y0 is None else y0, dtype=float))
        stages = len(tableau.nodes)
        most = max(1, CHUNK // max(len(layout.mechanism.bodies), 1))
        K, z = door(np.zeros(stages * n)), door(np.zeros(3 * n))
        F = door(np.zeros((3 + len(tableau.dense)) * n + 2 * n))
        out, ends = door(np.zeros(max(len(ts), 1) * n)), door(np.zeros(most))
        Z = door(np.zeros(16))
        G = door(np.concatenate([layout.weights, np.zeros(2 * layout.groups[1])]))
        D, asked = door(layout.groups[:]), door(ts)
        Z[0], Z[8] = t0, tolerance
        self.scene[0][40] = int(ropes and any(j.tension_only for j in layout.mechanism.joints))
        passed: list[float] = []
        last = float(ts[-1]) if len(ts) else t0
        marks = [t0, *(h for h in halts if t0 < h < last), last]
        for begin, end in pairwise(marks):
            Z[9] = math.nextafter(end, -math.inf) if end > begin else end  # up to a jump, the value before it
            Z[10], Z[14], code = end, 1.0, 1
            if begin == end:
                Z[10] = begin
            while code == 1:
                before = Z[4]
                code = step.advance(*self.scene, MI, T, D, Z, G, y, K, z, F, asked, len(ts), out, ends, most)
                passed += list(ends[: int(Z[4] - before)])
                if code == 1 and deadline is not None and time.monotonic() > deadline:
                    message = f"the time limit was reached at t = {Z[0]:.6g} s of {last:.6g} s"
                    raise LimitError(Problem("time-limit", message))
                if code == 1 and Z[4] > most_steps:
                    message = f"{most_steps} steps were done at t = {Z[0]:.6g} s of {last:.6g} s"
                    raise LimitError(Problem("step-limit", message))
            if code == ROPE:
                break
            if code > 1:
                name, message, hint = TROUBLE[code]
                raise SolveError(Problem(name, f"at t = {Z[0]:.9g} s: {message}", hint=hint))
        states = np.array(out, dtype=float)[: len(ts) * n].reshape(len(ts), n)
        stopped = None
        if code == ROPE:
            stopped = layout.mechanism.joints[layout.rows[int(Z[2]) - 1]].name
            ts, states = np.append(ts[: D[2]], Z[0]), np.vstack([states[: D[2]], np.array(y, dtype=float)])
            if len(ts) > 1 and ts[-1] == ts[-2]:
                ts, states = ts[:-1], states[:-1]
        return Trajectory(
            times=ts, states=states, ends=np.array(passed), steps=int(Z[4]), evaluations=int(Z[5]), gap=float(Z[7]),
            tolerance=tolerance, seconds=time.perf_counter() - begun, stopped=stopped,
        )  # fmt: skip

    def recovered(self, times: Array, states: Array, *, choose: bool = False) -> Recovered:
        """Everything the sweep knows at the given states (brought onto the closures first).

        choose: pick the independent closure rows at every instant anew, for poses that do not follow one another.
        """
        layout, n = self.layout, self.layout.n_state
        n_b, n_f, n_l, n_r = len(layout.place), len(layout.freedoms), layout.I[3], len(layout.rows)
        width = 30 * n_b + 4 * n_f + 16 * n_l + 2 * n_r + 2
        Y = np.array(states, dtype=float).reshape(len(times), n)
        flat, out = door(Y.ravel()), door(np.zeros(len(times) * width))
        self.scene[0][38] = int(choose)
        at = door(np.asarray(times, dtype=float))
        step.states(*self.scene, n, len(times), at, flat, door(np.zeros(n)), out, width)
        if choose:
            self.scene[0][38] = self.scene[0][29] = 0  # the next call chooses at its own pose
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
        )


@dataclass(frozen=True, eq=False)
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
