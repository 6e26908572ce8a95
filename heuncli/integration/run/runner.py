"""Motion: the kernel's stepping loop from one discontinuity in time to the next, and the recovery at given instants.

Impure: a `Runner` keeps the kernel's work arrays; `trajectory` looks at the clock where a time limit is set.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heuncli import tolerances
from heuncli.errors import LimitError, Problem, SolveError
from heuncli.expressions.programs import Expression
from heuncli.integration.evaluator import Evaluator, Recovered, work_of
from heuncli.integration.integrated_scene import IntegratedScene, itself
from heuncli.integration.methods.dop853 import DOP853
from heuncli.integration.methods.method import Method
from heuncli.integration.run.errors import TROUBLE, ClosuresLost, Eventful, Stiff, time_up
from heuncli.integration.run.interruptions import Blows
from heuncli.integration.run.kernel_loop import (
    CHATTERING,
    EVENTS_AFTER,
    GOES_ON,
    HALF_TURN,
    LET_GO,
    MORE,
    REACHED,
    ROPE_SLACK,
    STIFF,
    STRUCK,
    TURNED,
    UNSOLVED,
    Integration,
    Start,
)
from heuncli.integration.run.pace import hopeless, in_words
from heuncli.integration.run.step_records import Growing, Steps
from heuncli.integration.segments import Segment, Segments, just_before, smooth_segments
from heuncli.integration.trajectory import Trajectory
from heuncli.records import record
from heuncli.results import Array
from heuncli.tree.layout import Layout
from heuncli.tree.prepare import PreparedScene, lacking_inertia

if TYPE_CHECKING:  # loaded where a condition ends the run
    from heuncli.integration.run.conditions import Until

CHUNK = 2_000  # body-steps between two looks at the clock
DENSE_CHUNK = 2_000_000  # the same by the squares of a state's numbers, whose cube the equations of a step take


def chunk_of(layout: Layout, method: Method) -> int:
    """Steps between two looks at the clock. Raises LimitError where a method would have to solve too many equations."""
    bodies, n = max(work_of(layout), 1), layout.n_state
    if not method.implicit:
        return max(1, CHUNK // bodies)
    if n > tolerances.MOST_SOLVED:
        message = f"{method.name} solves dense equations for all {n} numbers of the state; it takes up to"
        hint = "--method DOP853, which solves none; what is stiff then takes short steps"
        raise LimitError(Problem("too-many-states", f"{message} {tolerances.MOST_SOLVED}", hint=hint))
    return max(1, min(CHUNK // bodies, DENSE_CHUNK // max(n, 1) ** 2))


def chattering(t: float, expression: Expression, branch: int) -> Problem:
    """The problem of a branch that turns back as soon as it turned: the motion would have to stay between."""
    message = (
        f"at t = {t:.9g} s '{expression.held[branch]}' in '{expression.source.strip()}' chatters: "
        "it changes back as soon as it has changed, for on either side the motion is driven to the other"
    )
    hint = "what sticks needs a smooth law: tanh(rate/0.001) in place of sign(rate), or a force of type friction"
    return Problem("chattering", message, expression.location, hint)


@record
class Going:
    """A run under way: the kernel's loop, what is put down of it, its blows, its end; its limits.

    eventful: whether it is left where events end its steps (Eventful).
    """

    run: Integration
    steps: Steps
    blows: Blows
    last: float
    deadline: float | None
    most_steps: int
    until: Until | None
    eventful: bool
    begun: float  # time.monotonic()


class Ending(NamedTuple):
    """Where a run ends before its time, the last instant that is told: a rope would have to push, or a condition."""

    rope: str | None
    told: float


def until_of(layout: Layout) -> Until | None:
    """The condition that ends the runs of a scene, if there is one."""
    if not any(condition.ends for condition in layout.mechanism.conditions):
        return None
    from heuncli.integration.run.conditions import Until

    return Until(layout)


def cut_short(times: Array, run: Integration, last: float) -> tuple[Array, Array]:
    """The asked instants before the last one that is told, that one, and the states at all.

    States are those of what is integrated.
    """
    asked = times[: run.loop.sampled]
    ts = np.append(asked[asked <= last], last)
    states = np.vstack([run.states()[: len(ts) - 1], np.array(run.loop.state())])
    return (ts[:-1], states[:-1]) if len(ts) > 1 and ts[-1] == ts[-2] else (ts, states)


class Runner(Evaluator):
    """A laid-out scene with the kernel's work arrays; every call starts from what it is given.

    moving: what is integrated in the scene's place; else the scene itself.
    """

    def __init__(self, layout: Layout, moving: IntegratedScene | None = None) -> None:
        super().__init__(layout)
        self.moving = itself(self) if moving is None else moving

    def trajectory(
        self,
        times: Sequence[float] | Array,
        local: float,
        *,
        discontinuities: Sequence[float] = (),
        deadline: float | None = None,
        most_steps: int = tolerances.MOST_STEPS,
        method: Method = DOP853,
        start: Array | None = None,
        whole: bool = False,
        watched: bool = False,
        eventful: bool = False,
    ) -> Trajectory:
        """Integrate from the start at t = 0 over the asked instants, ascending.

        local: the tolerance of a step, or of a method of given steps their length. start: a state beside the scene's
        own, to see what rounding makes of a run; events are then late by rounding, too.

        Where a rope would have to push the run ends: the instants up to there, and that one. So it does where the
        condition that ends it becomes true, unless the whole of it is asked for.

        Raises SolveError where the motion cannot be continued, LimitError past the deadline (time.monotonic()); and if
        it is watched Stiff where an implicit method takes less (run/stiffness.py); Eventful, if that is looked at,
        where events end most steps, or those of a method for such no more (run/event_frequency.py).
        """
        begun = time.perf_counter()
        moving = self.moving
        ts = np.ascontiguousarray(times, dtype=float)
        if method.foreign:
            from heuncli.integration.run import scipy_loop as foreign

            return foreign.trajectory(
                self, ts, local, discontinuities=discontinuities, deadline=deadline, most_steps=most_steps,
                method=method, start=start,
            )  # fmt: skip
        last = float(ts[-1]) if len(ts) else 0.0
        # at rest under a load like t**4 all rates and accelerations vanish at first: this rate then sets the scale
        rate = tolerances.LEAST_RATE / last if last > 0.0 else 0.0
        begin = Start(
            moving.restrict(0.0, self.layout.y0 if start is None else start), local, rate,
            late=start is not None, watched=watched,
        )  # fmt: skip
        run = Integration(moving.layout, moving.workspace, method, ts, chunk_of(moving.layout, method), begin)
        steps = Steps(begin.state, run.width)
        blows, until = Blows(self, moving, run, steps, last), None if whole else until_of(moving.layout)
        segments = smooth_segments(last, discontinuities)
        eventful = eventful and (run.held > 0 or len(self.layout.contacts) > 0 or len(segments) > 1)
        going = Going(run, steps, blows, last, deadline, most_steps, until, eventful, time.monotonic())
        try:
            pieces, ending = self._pass(going, segments)
        except SolveError as error:
            error.reached = run.loop.t if error.reached is None else error.reached
            raise
        except Stiff as stiff:
            stiff.seconds = time.perf_counter() - begun
            raise
        except Eventful as left:
            left.reached, left.evaluations, left.local = run.loop.t, run.loop.evaluations, local
            left.seconds = time.perf_counter() - begun
            raise
        return self._trajectory(going, ts, pieces, ending, time.perf_counter() - begun)

    def _trajectory(
        self, going: Going, asked: Array, pieces: Growing, ending: Ending | None, seconds: float
    ) -> Trajectory:
        """What a run that came to its end, or to its ending, leaves."""
        run, steps, moving = going.run, going.steps, self.moving
        times, states = (asked, run.states()) if ending is None else cut_short(asked, run, ending.told)
        return Trajectory(
            times=times, states=moving.embed(times, states), ends=steps.column("ends"), steps=run.loop.steps,
            evaluations=run.loop.evaluations, gap=run.loop.gap, local=run.start.local, method=run.method,
            seconds=seconds, segments=Segments(pieces.rows), kept=steps.records(),
            pivots=steps.column("pivots"), settled=steps.column("settled"), branches=steps.held_branches(),
            turned=steps.column("turned"), undecided=run.loop.undecided,
            stopped=ending.rope if ending is not None else None, ended=ending is not None and ending.rope is None,
            behind=np.array(moving.layout.pack.expressions.branches()), blows=tuple(going.blows.done),
            holding=steps.holding(len(self.layout.contacts)), notes=going.blows.notes,
        )  # fmt: skip

    def _pass(self, going: Going, segments: Segments) -> tuple[Growing, Ending | None]:
        """One segment after the other, blows between them: its pieces; where it ends, if before its time.

        Pieces are rows as those of Segments. Where a rope is slack by a jump or a blow, what held before it is told.
        """
        pieces = Growing(3)
        reached = 0.0
        for segment in segments:
            stopped = going.blows.until(segment.begin, reached)
            if stopped is not None:
                return pieces, Ending(stopped, just_before(reached))
            going.blows.settle(segment.begin)
            code = self._piece(going, segment, pieces)
            if code != REACHED:
                t = going.run.loop.t
                if code == TURNED:
                    return pieces, Ending(None, t)
                rope = self.moving.rope(going.run.loop.contact)
                return pieces, Ending(rope, just_before(t) if t == pieces.rows[-1, 0] > 0.0 else t)
            reached = segment.end
        stopped = going.blows.until(going.last, reached)
        return pieces, None if stopped is None else Ending(stopped, just_before(reached))

    def _piece(self, going: Going, segment: Segment, pieces: Growing) -> int:
        """Steps to the end of a segment, from one event of contacts to the next: REACHED.

        ROPE_SLACK where a rope would push, TURNED where the condition that ends the run became true.
        """
        run, most = going.run, len(going.run.output["ends"])
        code, begin = MORE, segment.begin
        going.blows.begin(segment)
        while code in GOES_ON:
            few = most if not going.eventful else min(most, max(EVENTS_AFTER - going.steps.count, 1))
            code = run.loop.advance(few, True, going.until is not None)
            going.steps.add(run)
            if code == TURNED and going.until is not None and going.until.ends(run.loop.t, np.array(run.loop.state())):
                break
            if code == REACHED or code in GOES_ON:
                self._require_time(going)
            if code in GOES_ON:
                self._require_progress(going)
                if going.eventful and going.steps.count >= max(EVENTS_AFTER, 2 * going.steps.looked):
                    from heuncli.integration.run.event_frequency import require_as_before  # few scenes have so many

                    require_as_before(going.steps, run.method, pieces.count)
            if code == STIFF:
                from heuncli.integration.run.stiffness import require_easy  # few scenes are

                require_easy(self, going, segment)
            if code in (STRUCK, LET_GO):
                t = run.loop.t
                if t > begin:
                    pieces.add(np.array([[begin, segment.before_end, t]]))
                begin = t
                going.blows.settle(t, run.loop.contact)
                going.blows.begin(Segment(t, segment.before_end, segment.end))
        pieces.add(np.array([[begin, segment.before_end, segment.end]]))
        if code not in (REACHED, ROPE_SLACK, TURNED):
            raise self._failed(code, going)
        return code

    def _require_time(self, going: Going) -> None:
        """Raise LimitError past the deadline, with how far the run has come, and at which pace."""
        if going.deadline is not None and time.monotonic() > going.deadline:
            took = time.monotonic() - going.begun
            pace = in_words(going.steps.column("ends"), going.last, took)
            raise time_up(f"at t = {going.run.loop.t:.6g} s of {going.last:.6g} s{pace}")

    def _require_progress(self, going: Going) -> None:
        """Raise LimitError beyond the most steps, and where they become so short that the run cannot come to its end.

        Raises SolveError if that is because a value grows without bound.
        """
        run, steps, last = going.run, going.steps, going.last
        done = f"steps were done at t = {run.loop.t:.6g} s of {last:.6g} s"
        if steps.count > going.most_steps:
            hint = "a shorter duration, a coarser tolerance, or a stiff method: --method Radau9"
            raise LimitError(Problem("step-limit", f"{going.most_steps} {done}", hint=hint))
        projected = None
        if steps.doubled():
            projected = hopeless(steps.column("ends"), last, tolerances.MOST_STEPS, irregular=not run.method.determined)
        if projected is not None:
            from heuncli.integration.diagnosis.growth import growing, stalled  # only on the way to an error

            problems = growing(self, run.loop.t, self._state(run), self._passed(going))
            raise stalled(problems, f"{steps.count} {done}", projected)

    def _failed(self, code: int, going: Going) -> SolveError:
        """Why a run to `last` ends: an expression without a value there, else the meaning of the kernel's code."""
        run, last = going.run, going.last
        t, state = run.loop.t, self._state(run)
        if code == CHATTERING:
            return SolveError(chattering(t, *self.layout.pack.branches[run.loop.turning]))
        if code == HALF_TURN:
            from heuncli.integration.diagnosis.half_turns import half_turn  # only on the way to an error

            itself = self.moving.layout is self.layout
            return half_turn(self.moving, run.loop.half_turn, t, np.array(run.loop.state()), itself=itself)
        name, message, hint = TROUBLE[code]
        if name == "closure-lost":
            problem = Problem(name, f"at t = {t:.9g} s: {message}", hint=hint)
            return ClosuresLost(problem, passed=self._passed(going), failed=t, last=last)
        from heuncli.integration.diagnosis.domains import (  # only on the way to an error
            joint_coordinates,
            without_value,
        )
        from heuncli.integration.diagnosis.growth import growing, largest_load

        mechanism, recovered = self.layout.mechanism, self.recovered(np.array([t]), state[None, :])
        problems = without_value(mechanism, t, last, joint_coordinates(self.layout, recovered.freedoms[0]))
        problems = problems or growing(self, t, state, self._passed(going))
        if problems:
            return SolveError(*problems)
        hint = "; ".join(filter(None, [hint, largest_load(mechanism, recovered)]))
        hangs, bodies = self.layout.spanning.hangs, self.layout.mechanism.bodies
        light = sorted({f"bodies.{bodies[hangs[i].body].name}" for i in self.layout.tables["lents"]["body"]})
        if light and name == "step-collapsed":
            hint += f", as where closed loops cease to hold the turn of what has no inertia: {', '.join(light)}"
        return SolveError(Problem(name, f"at t = {t:.9g} s: {message}", hint=hint))

    def _state(self, run: Integration) -> Array:
        """The scene's state that a run has reached."""
        return self.moving.state(run.loop.t, np.array(run.loop.state()))

    def _passed(self, going: Going) -> list[tuple[float, Array]]:
        """Instants and the scene's states that a run has passed, ascending."""
        passed = going.steps.passed(going.run.n)
        times = [t for t, _ in passed]
        return list(zip(times, self.moving.embed(np.array(times), np.array([y for _, y in passed])), strict=True))

    def answers_at(self, run: Trajectory, times: Array) -> Recovered:
        """Accelerations and loads at instants of a run (ascending, within it), by what held there."""
        return self.recovered(times, self.resample(run, times), holding=run.holding_at(times))

    def resample(self, run: Trajectory, times: Array) -> Array:
        """States (n_t, n) of a run at other instants (ascending, within it), by replaying its own steps.

        To the last bit what the run would have given, had these instants been among those it was asked for; and what it
        gave, where they were. It takes no other steps than the run, so it costs at most as much and succeeds wherever
        the run did.
        """
        times = np.ascontiguousarray(times, dtype=float)
        if run.within is not None:
            return run.within(times)
        out = np.empty((len(times), self.layout.n_state))
        own = np.minimum(np.searchsorted(run.times, times), len(run.times) - 1)
        for blow in run.blows:  # its own instant shows the state behind it
            out[times == blow.time] = blow.after
        asked = run.times[own] == times
        out[asked] = run.states[own[asked]]
        others = np.flatnonzero(~(asked | np.isin(times, [blow.time for blow in run.blows])))
        step = np.searchsorted(run.ends, times[others])  # the step in which an instant lies
        base = np.searchsorted(run.kept.steps, step, side="right") - 1
        # consecutive steps are replayed together
        breaks = np.flatnonzero((np.diff(step) > 1) & (np.diff(base) > 0)) + 1
        for group in np.split(np.arange(len(others)), breaks):
            if len(group):
                first, record = int(run.kept.steps[base[group[0]]]), run.kept.records[base[group[0]]]
                to = others[group]
                states = self.replay(run, first, int(step[group[-1]]), record, times[to])
                out[to] = self.moving.embed(times[to], states)
        return out

    def replay(self, run: Trajectory, first: int, last: int, record: Array, times: Array) -> Array:
        """States at instants within the steps from `first`, which starts from a kept record, to `last`.

        States are those of what is integrated.
        """
        layout, workspace = self.moving.layout, self.moving.workspace
        given = Start(layout.y0, math.inf, following=True)
        replayed = Integration(layout, workspace, run.method, times, last - first + 1, given)
        loop, after = replayed.loop, run.after_blows
        loop.stand(record)
        t = float(run.ends[first - 1]) if first else 0.0
        while first <= last:
            begin, before_end, end = run.segments.at(t)
            to = min(last, int(np.searchsorted(run.ends, end)))  # a segment ends with a step
            steps = slice(first, to + 1)
            loop.follow(run.ends[steps], run.settled[steps], run.branches[steps])
            if first in after:
                loop.stand(after[first])
            workspace.hold(run.holding[first])
            if t <= begin:
                loop.begin(begin, before_end, end)
            else:
                loop.resume(t, before_end, end)
            if loop.advance(to + 1 - first, False, False) == UNSOLVED:
                code, message, hint = TROUBLE[UNSOLVED]
                raise SolveError(Problem(code, f"at t = {loop.t:.9g} s: {message}", hint=hint))
            t = loop.t
            first = to + 1
        return replayed.states()


def ready(scene: PreparedScene) -> tuple[PreparedScene, Runner]:
    """A scene to be run and its work arrays: inertia is lent where motions of its tree move no mass."""
    lacking = lacking_inertia(scene)
    if lacking:
        from heuncli.integration.diagnosis.massless_motions import lend  # few scenes need it

        scene = lend(scene, lacking)
    return scene, Runner(scene.layout)
