"""Motion: the kernel's stepping loop from one discontinuity in time to the next, and the recovery at given instants.

Impure: a `Runner` keeps the kernel's work arrays; `trajectory` looks at the clock where a time limit is set.
"""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli import tolerances
from heuncli.errors import LimitError, Problem, SolveError
from heuncli.expressions.discontinuities import discontinuities, one_sided_limits
from heuncli.expressions.programs import Expression
from heuncli.integration.methods import DOP853, Method
from heuncli.integration.pace import FIRST_LOOK, hopeless
from heuncli.kernel.choose import integration
from heuncli.kernel.choose import steps as kernel
from heuncli.mechanism.model import Mechanism
from heuncli.records import fields, record
from heuncli.response import Columns, Workspace, columns_of, workspace_of
from heuncli.results import Array, Indices, Mask
from heuncli.tree.layout import Layout
from heuncli.tree.tables import BODY_ANSWER, CLOSURE_ANSWER, FREEDOM_ANSWER, LOAD_ANSWER, STATE_ANSWER, Table, parts

CHUNK = 2_000  # body-steps between two looks at the clock
KEPT = 20_000_000  # numbers in the states kept for replays, at the ends of all steps or of every second, fourth, ...
MOST_STEPS = 20_000_000

REACHED, MORE, ROPE_SLACK, CHATTERING = (
    kernel.CODES[name] for name in ("reached", "more", "rope slack", "chattering")
)
TROUBLE = {
    kernel.CODES["collapsed"]: (
        "step-collapsed",
        "the step length fell to the rounding error of the time",
        "a load or a rate grows without bound there",
    ),
    kernel.CODES["not a number"]: (
        "not-a-number",
        "no finite acceleration exists beyond this instant",
        "look at the expressions and tables, and at points that coincide",
    ),
    kernel.CODES["closures lost"]: (
        "closure-lost",
        "the closed chains cannot be held together beyond this instant",
        "the mechanism locks or reaches the end of its range there",
    ),
}
CAUSES = ("motion", "drives", "gravity")  # beside the loads: velocity terms, what is prescribed, weight
PER_STEP = ("ends", "settled", "pivots", "turned")  # what is put down of each step


@record
class Trajectory:
    """The state at the asked instants.

    times (n_t,) [s]; states (n_t, n_state); ends: instants of the accepted steps; gap: largest closure gap left [m].
    branches (n_steps, n): those of the expressions that a step held; turned: of each step whether they change at its
    end; undecided: of how many steps bounds could not tell what loads do between the stages.
    """

    times: Array
    states: Array
    ends: Array
    steps: int
    evaluations: int
    gap: float
    tolerance: float  # local, of this run
    method: Method
    seconds: float
    segments: tuple[tuple[float, float], ...] = ()  # first and last instant of each segment without discontinuities
    kept: tuple[tuple[int, Array], ...] = ()  # of the first and some other steps: number, record of where it starts
    pivots: Array = np.zeros(0)  # least pivot of the closures in each step
    settled: Array = np.zeros(0)  # of each step whether its stages were settled on the closures
    branches: Array = np.zeros((0, 0))
    turned: Array = np.zeros(0)
    undecided: int = 0
    stopped: str | None = None  # the rope that would have to push just after the last instant

    @property
    def events(self) -> tuple[float, ...]:
        """The instants at which branches change that hang on coordinates."""
        return tuple(self.ends[self.turned > 0.0].tolist())

    def branches_at(self, times: Array) -> Array:
        """The branches that hold at instants, (n_t, n); at an event those behind it."""
        step = np.searchsorted(self.ends, times, side="right")
        return self.branches[np.minimum(step, max(len(self.branches) - 1, 0))] if self.branches.size else self.branches


def discontinuities_of(mechanism: Mechanism, t0: float, t1: float) -> list[float]:
    """Instants in (t0, t1) at which some load or drive, or a derivative of it, is discontinuous."""
    expressions = set(mechanism.expressions())
    return sorted({t for e in expressions if e.time_dependent for t in discontinuities(e, t0, t1)})


def just_before(t: float) -> float:
    """The last instant before t: at a jump, the left limit is taken there."""
    return math.nextafter(t, -math.inf)


def just_after(t: float) -> float:
    """The first instant after t."""
    return math.nextafter(t, math.inf)


def check_deadline(deadline: float | None, where: str) -> None:
    """Raise LimitError past the deadline (time.monotonic()); `where`: how far the work has come."""
    if deadline is not None and time.monotonic() > deadline:
        hint = "a longer --time-limit, a coarser --tolerance, or a shorter duration"
        raise LimitError(Problem("time-limit", f"the time limit was reached {where}", hint=hint))


def chattering(t: float, expression: Expression, branch: int) -> Problem:
    """The problem of a branch that turns back as soon as it turned: the motion would have to stay between."""
    message = (
        f"at t = {t:.9g} s '{expression.held[branch]}' in '{expression.source.strip()}' chatters: "
        "it changes back as soon as it has changed, for on either side the motion is driven to the other"
    )
    hint = "what sticks needs a smooth law: tanh(rate/0.001) in place of sign(rate), or a force of type friction"
    return Problem("chattering", message, expression.location, hint)


class ClosuresLost(SolveError):
    """A run that ended where its closed chains could not be held; passed: instants and states, failed: where, last."""

    def __init__(self, problem: Problem, *, passed: list[tuple[float, Array]], failed: float, last: float) -> None:
        super().__init__(problem)
        self.passed, self.failed, self.last = passed, failed, last


class Integration:
    """The kernel's loop over the asked instants, at most `most` steps at a time, with the arrays it writes to."""

    def __init__(self, layout: Layout, workspace: Workspace, method: Method, times: Array, **given: Any) -> None:
        n = self.n = layout.n_state
        most = given.pop("most")
        self.width = integration.record_width(workspace, n)
        self.output = {name: np.zeros(most) for name in PER_STEP}
        self.held = layout.pack.held
        self.branches = np.zeros(most * self.held)
        self.passed = np.zeros(0 if given["following"] else most * self.width)
        self.count = len(times)
        self.samples = np.zeros(self.count * n)
        start = {"groups": layout.tables["groups"], "energy_group": layout.energy_group, "weights": layout.weights}
        output = self.output | {"times": times, "samples": self.samples, "passed": self.passed}
        output["branches"] = self.branches
        self.loop = integration.Integration(workspace, method.arrays, start | given, output)

    def records(self, every: int, offset: int) -> Array:
        """What the steps after those just done start from: of every so many, (count, width); a copy."""
        done = self.loop.done
        return self.passed[: done * self.width].reshape(done, self.width)[offset::every].copy()

    def held_branches(self) -> Array:
        """The branches that the steps just done held, (count, n); a copy."""
        return self.branches[: self.loop.done * self.held].reshape(-1, self.held).copy()

    def states(self) -> Array:
        """The states at the asked instants, (n_t, n)."""
        self.loop.fetch()
        return self.samples.reshape(self.count, self.n)


class Steps:
    """The steps done: of each its end, its least pivot, whether its stages were settled; for replays some records."""

    def __init__(self, start: Array, width: int) -> None:
        self.rows: dict[str, list[Array]] = {name: [np.zeros(0)] for name in PER_STEP}
        self.branches: list[Array] = []
        self.count = 0
        # number of a step, and what it starts from; the first is a segment's, of which the state alone counts
        self.kept: list[tuple[int, Array]] = [(0, np.concatenate([start, np.zeros(width - len(start))]))]
        self.every, self.room = 1, max(2, KEPT // max(width, 1))
        self.look = FIRST_LOOK

    def add(self, run: Integration) -> None:
        """Add the steps of the last call; while there are too many records, every second of them is dropped."""
        for name, arrays in self.rows.items():
            arrays.append(run.output[name][: run.loop.done].copy())
        if run.held:
            self.branches.append(run.held_branches())
        first = self.count // self.every * self.every + self.every  # the next number of which one is kept
        self.kept += enumerate_by(first, self.every, run.records(self.every, first - self.count - 1))
        self.count += run.loop.done
        while len(self.kept) > self.room:
            self.every *= 2
            self.kept = [(k, record.copy()) for k, record in self.kept if k % self.every == 0]

    def doubled(self) -> bool:
        """Whether there are twice as many as when this was last so."""
        if self.count < self.look:
            return False
        self.look = 2 * self.count
        return True

    def passed(self, n: int) -> list[tuple[float, Array]]:
        """Instants and states (n,) of which records were kept, ascending."""
        ends = self.column("ends")
        return [(float(ends[k - 1]) if k else 0.0, record[:n]) for k, record in self.kept]

    def column(self, name: str) -> Array:
        """Ends, least pivots, or which were settled, (n_steps,)."""
        return np.concatenate(self.rows[name])

    def held_branches(self) -> Array:
        """The branches that the steps held, (n_steps, n)."""
        return np.concatenate(self.branches) if self.branches else np.zeros((0, 0))


def enumerate_by(first: int, step: int, rows: Array) -> list[tuple[int, Array]]:
    """Rows numbered from the first on."""
    return [(first + step * k, row) for k, row in enumerate(rows)]


def smooth_segments(last: float, jumps: Sequence[float]) -> list[tuple[float, float]]:
    """First and last instant of each segment of (0, last) without discontinuities, which are at `jumps`."""
    limits = one_sided_limits([t for t in jumps if 0.0 < t < last])
    segments = list(zip([0.0, *(t for _, t in limits)], [*(t for t, _ in limits), just_before(last)], strict=True))
    # a discontinuity at t = 0 makes a first segment without length
    return [segment for segment in segments if segment[1] > segment[0]] or segments[-1:]


def cut_short(times: Array, run: Integration, last: float) -> tuple[Array, Array]:
    """The asked instants before the last at which no rope would have to push, that one, and the states at all."""
    asked = times[: run.loop.sampled]
    ts = np.append(asked[asked <= last], last)
    states = np.vstack([run.states()[: len(ts) - 1], np.array(run.loop.state())])
    return (ts[:-1], states[:-1]) if len(ts) > 1 and ts[-1] == ts[-2] else (ts, states)


class Runner:
    """A laid-out scene with the kernel's work arrays; every call starts from what it is given."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.workspace = workspace_of(layout)
        self.size = layout.size

    def trajectory(
        self,
        times: Sequence[float] | Array,
        tolerance: float,
        *,
        discontinuities: Sequence[float] = (),
        deadline: float | None = None,
        most_steps: int = MOST_STEPS,
        method: Method = DOP853,
        start: Array | None = None,
    ) -> Trajectory:
        """Integrate from the start at t = 0 over the asked instants (ascending); `tolerance` is the local one.

        start: a state to start from instead of the scene's own.

        Where a rope would have to push the run ends: the instants up to there, and that one.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline (time.monotonic()).
        """
        begun = time.perf_counter()
        layout = self.layout
        ts = np.ascontiguousarray(times, dtype=float)
        last = float(ts[-1]) if len(ts) else 0.0
        # at rest under a load like t**4 all rates and accelerations vanish at first: this rate then sets the scale
        rate = tolerances.LEAST_RATE / last if last > 0.0 else 0.0
        most = max(1, CHUNK // max(len(layout.mechanism.bodies), 1))
        # what begins beside the scene's start is to show what rounding makes of a run, that of its events, too
        late = int(start is not None)
        start = layout.y0 if start is None else start
        run = Integration(
            layout, self.workspace, method, ts,
            most=most, state=start, tolerance=tolerance, rate=rate, following=0, late=late,
        )  # fmt: skip
        steps = Steps(start, run.width)
        roped = any(j.tension_only for j in layout.mechanism.joints)
        check_deadline(deadline, f"before the run of {last:.6g} s began")
        segments = smooth_segments(last, discontinuities)
        for begin, before_end in segments:
            # a segment ends with the left limits of what jumps, the next one begins with the right limits
            run.loop.begin(begin, before_end, just_after(before_end))
            code = MORE
            while code == MORE:
                code = run.loop.advance(most, roped)
                steps.add(run)
                if code in (REACHED, MORE):
                    check_deadline(deadline, f"at t = {run.loop.t:.6g} s of {last:.6g} s")
                if code == MORE:
                    self._require_progress(run, steps, last, most_steps)
            if code == ROPE_SLACK:
                break
            if code != REACHED:
                raise self._failed(code, run, steps, last)
        # slack by a jump: what is told last is what held before it
        told = just_before(run.loop.t) if run.loop.t == begin > 0.0 else run.loop.t
        ts, states = (ts, run.states()) if code == REACHED else cut_short(ts, run, told)
        return Trajectory(
            times=ts, states=states, ends=steps.column("ends"), steps=run.loop.steps,
            evaluations=run.loop.evaluations, gap=run.loop.gap, tolerance=tolerance, method=method,
            seconds=time.perf_counter() - begun, segments=tuple(segments), kept=tuple(steps.kept),
            pivots=steps.column("pivots"), settled=steps.column("settled"), branches=steps.held_branches(),
            turned=steps.column("turned"), undecided=run.loop.undecided,
            stopped=None if code == REACHED else layout.mechanism.joints[layout.rows[run.loop.rope]].name,
        )  # fmt: skip

    def _require_progress(self, run: Integration, steps: Steps, last: float, most_steps: int) -> None:
        """Raise LimitError beyond the most steps, and where they become so short that the run cannot come to its end.

        Raises SolveError if that is because a value grows without bound.
        """
        done = f"steps were done at t = {run.loop.t:.6g} s of {last:.6g} s"
        if steps.count > most_steps:
            raise LimitError(Problem("step-limit", f"{most_steps} {done}"))
        projected = hopeless(steps.column("ends"), last, MOST_STEPS) if steps.doubled() else None
        if projected is not None:
            from heuncli.integration.growth import growing, stalled  # only on the way to an error

            problems = growing(self, run.loop.t, run.loop.state(), steps.passed(run.n))
            raise stalled(problems, f"{steps.count} {done}", projected)

    def _failed(self, code: int, run: Integration, steps: Steps, last: float) -> SolveError:
        """Why a run to `last` ends: an expression without a value there, else the meaning of the kernel's code."""
        t, state = run.loop.t, np.array(run.loop.state())
        if code == CHATTERING:
            return SolveError(chattering(t, *self.layout.pack.branches[run.loop.turning]))
        name, message, hint = TROUBLE[code]
        if name == "closure-lost":
            problem = Problem(name, f"at t = {t:.9g} s: {message}", hint=hint)
            return ClosuresLost(problem, passed=steps.passed(run.n), failed=t, last=last)
        from heuncli.integration.domains import joint_coordinates, without_value  # only on the way to an error
        from heuncli.integration.growth import growing, largest_load

        mechanism, recovered = self.layout.mechanism, self.recovered(np.array([t]), state[None, :])
        problems = without_value(mechanism, t, last, joint_coordinates(self.layout, recovered.freedoms[0]))
        problems = problems or growing(self, t, run.loop.state(), steps.passed(run.n))
        if problems:
            return SolveError(*problems)
        hint = "; ".join(filter(None, [hint, largest_load(mechanism, recovered)]))
        hangs, bodies = self.layout.spanning.hangs, self.layout.mechanism.bodies
        light = sorted({f"bodies.{bodies[hangs[i].body].name}" for i in self.layout.tables["lents"]["body"]})
        if light and name == "step-collapsed":
            hint += f", as where closed loops cease to hold the turn of what has no inertia: {', '.join(light)}"
        return SolveError(Problem(name, f"at t = {t:.9g} s: {message}", hint=hint))

    def resample(self, run: Trajectory, times: Array) -> Array:
        """States (n_t, n) of a run at other instants (ascending, within it), by replaying its own steps.

        To the last bit what the run would have given, had these instants been among those it was asked for; and what it
        gave, where they were. It takes no other steps than the run, so it costs at most as much and succeeds wherever
        the run did.
        """
        times = np.ascontiguousarray(times, dtype=float)
        out = np.empty((len(times), self.layout.n_state))
        own = np.minimum(np.searchsorted(run.times, times), len(run.times) - 1)
        is_own = run.times[own] == times
        out[is_own] = run.states[own[is_own]]
        others = np.flatnonzero(~is_own)
        asked = np.searchsorted(run.ends, times[others])  # the step in which an instant lies
        starts = np.array([k for k, _ in run.kept])
        base = np.searchsorted(starts, asked, side="right") - 1
        # consecutive steps are replayed together
        breaks = np.flatnonzero((np.diff(asked) > 1) & (np.diff(base) > 0)) + 1
        for group in np.split(np.arange(len(others)), breaks):
            if len(group):
                first, record = run.kept[base[group[0]]]
                to = others[group]
                out[to] = self.replay(run, first, int(asked[group[-1]]), record, times[to])
        return out

    def replay(self, run: Trajectory, first: int, last: int, record: Array, times: Array) -> Array:
        """States at instants within the steps from `first`, which starts from a kept record, to `last`."""
        replayed = Integration(
            self.layout, self.workspace, run.method, times,
            most=last - first + 1, state=self.layout.y0, tolerance=math.inf, rate=0.0, following=1, late=0,
        )  # fmt: skip
        loop = replayed.loop
        loop.stand(record)
        t = float(run.ends[first - 1]) if first else 0.0
        while first <= last:
            begin, before_end = run.segments[bisect_right(run.segments, t, key=lambda segment: segment[1])]
            end = just_after(before_end)
            to = min(last, int(np.searchsorted(run.ends, end)))  # a segment ends with a step
            steps = slice(first, to + 1)
            loop.follow(run.ends[steps], run.settled[steps], run.branches[steps])
            if t <= begin:
                loop.begin(begin, before_end, end)
            else:
                loop.resume(t, before_end, end)
            loop.advance(to + 1 - first, False)
            t = loop.t
            first = to + 1
        return replayed.states()

    def may_stay(self, gap: Array) -> Array:
        """What accelerations may leave unmet of rows that depend on others, at gaps (n_t,), of the rows' terms."""
        length = min((island.length for island in self.layout.islands), default=self.size)
        return tolerances.UNMET * (self.workspace.least_row + tolerances.RANK_OF_GAP * gap / length)

    def recovered(
        self,
        times: Array,
        states: Array,
        *,
        branches: Array | None = None,
        hold_rows: bool = False,
        causes: bool = False,
    ) -> Recovered:
        """Accelerations and loads at the given states, which are projected onto the closures first.

        Each state by itself, whatever others are asked with it: its independent closure rows are chosen anew.
        branches (n_t, n): those that the expressions hold; without them branches are as the states say.
        hold_rows: those of the first serve the others too, as long as they can, for pivots that are comparable.
        causes: with a column a cause.
        """
        layout, n_t = self.layout, len(times)
        sizes = [
            (BODY_ANSWER, len(layout.place)),
            (FREEDOM_ANSWER, len(layout.freedoms)),
            (LOAD_ANSWER, len(layout.tables["loads"])),
            (CLOSURE_ANSWER, len(layout.rows)),
            (STATE_ANSWER, 1),
        ]
        own = sum(kind.itemsize // 8 * count for kind, count in sizes)
        n_c = len(layout.tables["loads"]) + len(CAUSES) if causes else 0
        width = own + n_c * self.workspace.column_width
        at = np.ascontiguousarray(times, dtype=float)
        settled = np.array(states, dtype=float).reshape(n_t, layout.n_state)
        flat, out = settled.ravel(), np.zeros(n_t * width)
        held = np.zeros(0) if branches is None else np.ascontiguousarray(branches, dtype=float).ravel()
        self.workspace.recover(at, flat, held, out, width, not hold_rows, causes)
        bodies, freedoms, loads, rows, whole = parts(out.reshape(n_t, width), sizes)
        columns = out.reshape(n_t, width)[:, own:].reshape(n_t, n_c, -1) if causes else None
        return Recovered(
            times=at, states=flat.reshape(settled.shape), bodies=bodies, freedoms=freedoms, loads=loads, rows=rows,
            gap=whole["gap"][:, 0], idle=whole["idle"][:, 0], pivot=whole["pivot"][:, 0],
            residual=whole["residual"][:, 0], may_stay=self.may_stay(whole["gap"][:, 0]),
            causes=columns_of(columns, len(layout.place), len(layout.freedoms)) if columns is not None else None,
        )  # fmt: skip


@record
class Recovered:
    """The kernel's answers at the instants, tables (n_t, n) in tree order; their fields: tree/tables.py."""

    times: Array
    states: Array
    bodies: Table
    freedoms: Table
    loads: Table
    rows: Table
    gap: Array
    idle: Array
    pivot: Array  # square of the least pivot of the independent closure rows; 1: far from singular
    residual: Array  # of all rows, J Vdot + gamma at the accelerations found, of the terms it is the sum of
    may_stay: Array  # what of it rows may keep that were left out as dependent
    causes: Columns | None = None  # (n_t, n_c): each row of the table of loads alone, then CAUSES; their sum is all

    def at(self, which: Mask | Indices) -> Recovered:
        """At some of the instants."""
        own = fields(self)
        causes = own.pop("causes")
        return Recovered(**{name: values[which] for name, values in own.items()}, causes=causes and causes.at(which))
