"""A run from its start to its end: the kernel's steps through one smooth segment of time after the other.

Between two segments, and where contacts close or open within one, the motion is interrupted (run/interruptions.py) and
goes on from the state behind. After each call of the kernel, of `chunk_of` (run/limits.py) steps at most, is looked at:
whether the condition that ends the run became true, the limits, whether events end most steps, whether the motion is
stiff.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.interruptions import Interruptions
from heuncli.motion.integration.run.kernel_loop import (
    CHATTERING,
    GOES_ON,
    LET_GO,
    MORE,
    REACHED,
    ROPE_SLACK,
    STIFF,
    STRUCK,
    TURNED,
    KernelLoop,
    Start,
)
from heuncli.motion.integration.run.limits import chunk_of, require_progress, require_time
from heuncli.motion.integration.run.progress import Progress
from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.motion.integration.run.slow_runs import SlowRunWatch
from heuncli.motion.integration.run.step_records import GrowingRows, Steps
from heuncli.motion.integration.segments import Segment, Segments, just_before, smooth_segments
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

if TYPE_CHECKING:  # loaded where they are watched
    from heuncli.motion.integration.run.ending import EndingCondition
    from heuncli.motion.integration.run.event_frequency import EventWatch
    from heuncli.motion.integration.run.stiffness import StiffnessWatch
    from heuncli.motion.integration.run.triggers import Due, Triggers


class Ending(NamedTuple):
    """Where a run ends before its last instant: the last one that is told [s].

    rope: the one that would have to push just behind it; None: the condition that ends the run became true.
    """

    told: float
    rope: str | None = None


def begun(scene: Evaluator, moving: IntegratedScene, request: MotionTask, rules: StoppingRules) -> Progress:
    """A run at its start. Raises LimitError where its method would have to solve too many equations."""
    last, start = request.last, request.start
    # at rest under a load like t**4 all rates and accelerations vanish at first: this rate then sets the scale
    rate = tolerances.LEAST_RATE / last if last > 0.0 else 0.0
    state = moving.restrict(0.0, scene.layout.y0 if start is None else start)
    begin = Start(state, request.local, rate, late=start is not None, watched=rules.stiffness)
    most = chunk_of(moving.layout, request.method)
    times, keeping = request.instants, request.keeping
    kernel = KernelLoop(moving.layout, moving.workspace, request.method, times, most, begin, keeping=keeping)
    return Progress(scene, moving, kernel, Steps(state, kernel.width), last)


class Stepper:
    """A run under way, with what interrupts it and what is looked at on its way. Changes with every step.

    pieces: the segments, cut where contacts close or open; rows as those of Segments.
    """

    def __init__(self, progress: Progress, request: MotionTask, rules: StoppingRules) -> None:
        self.progress, self.request = progress, request
        self.interruptions = Interruptions(progress)
        self.segments = smooth_segments(progress.last, request.discontinuities)
        self.pieces = GrowingRows(3)
        self.until = until_of(progress.moving.layout) if rules.ending else None
        self.triggers = triggers_of(progress.moving.layout, progress.last)
        self.fresh = False  # whether a piece is to begin
        self.events = event_watch(progress, self.segments) if rules.events else None
        self.stiffness: StiffnessWatch | None = None
        self.begun = time.monotonic()
        self.slow = SlowRunWatch(self.begun)

    def to_end(self) -> Ending | None:
        """One segment after the other; where the run ends before its last instant, if it does.

        Where a rope is slack by a jump or a blow, what held before it is told.

        Raises SolveError where the motion cannot be continued, LimitError past a limit, Stiff and Eventful where
        another method takes less.
        """
        reached = 0.0
        for segment in self.segments:
            if segment.begin > 0.0:
                self.leave()
            rope = self.interruptions.until(segment.begin, reached)
            if rope is not None:
                return Ending(just_before(reached), rope)
            self.interruptions.settle(segment.begin)
            ending = self.through(segment)
            if ending is not None:
                return ending
            reached = segment.end
        rope = self.interruptions.until(self.progress.last, reached)
        return None if rope is None else Ending(just_before(reached), rope)

    def through(self, segment: Segment) -> Ending | None:
        """Steps to the end of a segment, from one event of contacts to the next."""
        code, begin = MORE, segment.begin
        self.begin(segment)
        while code in GOES_ON:
            code = self.advance()
            if code == TURNED:
                ends, due = self.ends_here(), self.due()
                if due is not None:
                    begin, rope = self.strike(begin, segment, due)
                    if rope is not None:
                        return Ending(just_before(begin), rope)
                if ends:
                    if due is not None:
                        self.advance()  # to the branches behind the blow; no step is taken
                    break
            self.look(code, segment)
            if code in (STRUCK, LET_GO):
                begin = self.meet_contact(begin, segment)
        self.pieces.add(np.array([[begin, segment.before_end, segment.end]]))
        return None if code == REACHED else self.ended(code, begin)

    def advance(self) -> int:
        """Some steps of the kernel, put down; the code with which it stopped."""
        kernel, few = self.progress.kernel, self.progress.kernel.most
        if self.events is not None:
            few = min(few, self.events.due_in())
        code = kernel.loop.advance(few, True, self.until is not None or self.triggers is not None)
        self.progress.steps.add(kernel)
        if self.triggers is not None and self.fresh and code == TURNED:
            self.triggers.begin(self.progress.t, self.progress.integrated_state)
        self.fresh = False
        return code

    def begin(self, segment: Segment) -> None:
        """A piece begins in the state reached."""
        self.interruptions.begin(segment)
        self.fresh = True

    def leave(self) -> None:
        """A piece ends at the instant reached: what the triggers of blows say there is kept."""
        if self.triggers is not None:
            self.triggers.leave()

    def due(self) -> Due | None:
        """What conditions ask for at the instant reached, if they do."""
        if self.triggers is None:
            return None
        return self.triggers.due(self.progress.t, self.progress.integrated_state)

    def strike(self, begin: float, segment: Segment, due: Due) -> tuple[float, str | None]:
        """Blows and latches at the instant reached, which end a piece; where the next one begins.

        And the rope, if there is one, that would have to push in them.
        """
        t = self.progress.t
        if t > begin:
            self.pieces.add(np.array([[begin, segment.before_end, t]]))
        self.leave()
        rope = self.interruptions.strike(t, due.blows, due.said)
        if rope is None:
            self.begin(Segment(t, segment.before_end, segment.end))
        return t, rope

    def ends_here(self) -> bool:
        """Whether the condition that ends the run became true at the instant reached."""
        return self.until is not None and self.until.ends(self.progress.t, self.progress.integrated_state)

    def look(self, code: int, segment: Segment) -> None:
        """What is watched after each call of the kernel."""
        if code == REACHED or code in GOES_ON:
            require_time(self.progress, self.request.deadline, self.begun)
        if code in GOES_ON:
            require_progress(self.progress, self.request.most_steps)
            self.slow.look(self.progress)
            if self.events is not None:
                self.events.require_as_before(self.pieces.count)
        if code == STIFF:
            if self.stiffness is None:
                from heuncli.motion.integration.run.stiffness import StiffnessWatch  # few scenes are

                self.stiffness = StiffnessWatch(self.progress)
            self.stiffness.require_easy(segment)

    def meet_contact(self, begin: float, segment: Segment) -> float:
        """The contact that closed or opened at the instant reached, which ends a piece; where the next one begins."""
        t = self.progress.t
        if t > begin:
            self.pieces.add(np.array([[begin, segment.before_end, t]]))
        said = None if self.triggers is None else self.triggers.said_at_contact(t, self.progress.integrated_state)
        self.leave()
        self.interruptions.settle(t, self.progress.kernel.loop.contact, said)
        self.begin(Segment(t, segment.before_end, segment.end))
        return t

    def ended(self, code: int, begin: float) -> Ending:
        """Where the run ends, short of a segment's end; begin: of its last piece. Raises SolveError if it fails."""
        t = self.progress.t
        if code == TURNED:
            return Ending(t)
        if code == ROPE_SLACK:
            rope = self.progress.moving.rope(self.progress.kernel.loop.contact)
            return Ending(just_before(t) if t == begin > 0.0 else t, rope)
        if code == CHATTERING and self.triggers is not None and self.triggers.just_struck(t):
            raise self.triggers.endless(t)
        from heuncli.motion.integration.run.failure import failure  # only on the way to an error

        raise failure(self.progress, code)

    def trajectory(self, ending: Ending | None, seconds: float) -> Trajectory:
        """What the run leaves when it came to its end, or to its ending."""
        progress, kernel, steps = self.progress, self.progress.kernel, self.progress.steps
        asked = self.request.instants
        times, states = (asked, kernel.states()) if ending is None else cut_short(asked, kernel, ending.told)
        return Trajectory(
            times=times, states=progress.moving.embed(times, states), ends=steps.column("ends"),
            steps=kernel.loop.steps, evaluations=kernel.loop.evaluations, gap=kernel.loop.gap,
            local=kernel.start.local, method=kernel.method, seconds=seconds, segments=Segments(self.pieces.rows),
            kept=steps.records(), courses=steps.kept_courses(),
            pivots=steps.column("pivots"), settled=steps.column("settled"),
            branches=steps.held_branches(), turned=steps.column("turned"), undecided=kernel.loop.undecided,
            stopped=ending.rope if ending is not None else None, ended=ending is not None and ending.rope is None,
            behind=np.array(progress.moving.layout.pack.expressions.branches()),
            blows=tuple(self.interruptions.done), holding=steps.holding(len(progress.scene.layout.all_open)),
            notes=self.interruptions.notes + (self.triggers.notes if self.triggers is not None else ()),
        )  # fmt: skip


def until_of(layout: Layout) -> EndingCondition | None:
    """The condition that ends the runs of a scene, if there is one."""
    if not any(condition.ends for condition in layout.mechanism.conditions):
        return None
    from heuncli.motion.integration.run.ending import EndingCondition  # few scenes have one

    return EndingCondition(layout)


def triggers_of(layout: Layout, last: float) -> Triggers | None:
    """The blows and latches of a scene that hang on conditions, where there are any."""
    mechanism = layout.mechanism
    latches = (stop.latch for stop in mechanism.stops if stop.latch is not None)
    if all(blow.when is None for blow in mechanism.blows) and not any(latch.conditions for latch in latches):
        return None
    from heuncli.motion.integration.run.triggers import Triggers  # few scenes have any

    return Triggers(layout, last)


def event_watch(progress: Progress, segments: Segments) -> EventWatch | None:
    """What counts the steps that events end, where there may be any."""
    if not (progress.kernel.held > 0 or len(progress.scene.layout.contacts) > 0 or len(segments) > 1):
        return None
    from heuncli.motion.integration.run.event_frequency import EventWatch  # few scenes have any

    return EventWatch(progress)


def cut_short(times: Array, kernel: KernelLoop, last: float) -> tuple[Array, Array]:
    """The asked instants before the last one that is told, and that one, (n,); the states there (n, n').

    States are those of what is integrated.
    """
    asked = times[: kernel.loop.sampled]
    ts = np.append(asked[asked <= last], last)
    states = np.vstack([kernel.states()[: len(ts) - 1], np.array(kernel.loop.state())])
    return (ts[:-1], states[:-1]) if len(ts) > 1 and ts[-1] == ts[-2] else (ts, states)
