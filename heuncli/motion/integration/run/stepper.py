"""A run from its start to its end: the kernel's steps through one smooth segment of time after the other.

Between two segments, and where contacts close or open within one, the motion is interrupted (run/interruptions.py) and
continues from the state after it. After each call of the kernel, which takes at most `find_chunk_size` steps, it is
checked (run/supervision.py) whether the condition that ends the run became true, the limits, whether events end most
steps, whether the motion is stiff.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import IntegratedScene, Segment, Segments, just_before, make_segments
from heuncli.motion.integration.run.interruptions import Interruptions
from heuncli.motion.integration.run.kernel_loop import (
    CHATTERING,
    CONTINUE_CODES,
    LET_GO,
    MORE,
    REACHED,
    ROPE_SLACK,
    STIFF,
    STRUCK,
    TURNED,
    KernelLoop,
    LoopStart,
)
from heuncli.motion.integration.run.progress import GrowingRows, RunProgress, StepRecorder
from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.motion.integration.run.supervision import SlowRunWatch, find_chunk_size, require_progress, require_time
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

if TYPE_CHECKING:  # loaded where they are watched
    from heuncli.motion.integration.conditions import EndingCondition
    from heuncli.motion.integration.run.supervision import EventWatch, StiffnessWatch
    from heuncli.motion.integration.run.triggers import DueTriggers, Triggers


class EarlyEnd(NamedTuple):
    """Where a run ends before its last instant.

    last_time: the last reported instant [s]
    rope: the rope that would have to push just after it; None if the condition that ends the run became true
    """

    last_time: float
    rope: str | None = None


def begin_run(
    scene: Evaluator, integrated_scene: IntegratedScene, request: MotionTask, rules: StoppingRules
) -> RunProgress:
    """Return a run at its start. Raises LimitError if its method would have to solve too many equations."""
    last, start = request.last, request.start
    # at rest under a load like t**4 all rates and accelerations vanish at first: this rate then sets the scale
    rate = tolerances.LEAST_RATE / last if last > 0.0 else 0.0
    state = integrated_scene.restrict(0.0, scene.layout.y0 if start is None else start)
    loop_start = LoopStart(state, request.local, rate, late=start is not None, watch_stiffness=rules.stiffness)
    max_steps = find_chunk_size(integrated_scene.layout, request.method)
    times, stores_polynomials = request.instants, request.stores_polynomials
    kernel = KernelLoop(
        integrated_scene.layout,
        integrated_scene.workspace,
        request.method,
        times,
        max_steps,
        loop_start,
        stores_polynomials=stores_polynomials,
    )
    return RunProgress(scene, integrated_scene, kernel, StepRecorder(state, kernel.record_width), last)


class Stepper:
    """A running integration with its interruptions and checks. Changes with every step.

    pieces: the segments, cut where contacts close or open; rows as those of Segments
    """

    def __init__(self, progress: RunProgress, request: MotionTask, rules: StoppingRules) -> None:
        self.progress, self.request = progress, request
        self.interruptions = Interruptions(progress)
        self.segments = make_segments(progress.last, request.discontinuities)
        self.pieces = GrowingRows(3)
        self.ending_condition = make_ending_condition(progress.integrated_scene.layout) if rules.ending else None
        self.triggers = make_triggers(progress.integrated_scene.layout, progress.last)
        self.begins_piece = False  # whether a piece has just begun
        self.events = make_event_watch(progress, self.segments) if rules.events else None
        self.stiffness: StiffnessWatch | None = None
        self.start_time = time.monotonic()
        self.slow_watch = SlowRunWatch(self.start_time)

    def run_to_end(self) -> EarlyEnd | None:
        """Take one segment after the other; return where the run ends before its last instant, if it does.

        Where a jump or an impulse makes a rope slack, the result ends just before it.

        Raises SolveError where the motion cannot be continued, LimitError past a limit, StiffRun and EventfulRun where
        another method takes less work.
        """
        reached_time = 0.0
        for segment in self.segments:
            if segment.begin > 0.0:
                self.end_piece()
            rope = self.interruptions.apply_until(segment.begin, reached_time)
            if rope is not None:
                return EarlyEnd(just_before(reached_time), rope)
            self.interruptions.handle_contacts(segment.begin)
            ending = self.run_segment(segment)
            if ending is not None:
                return ending
            reached_time = segment.end
        rope = self.interruptions.apply_until(self.progress.last, reached_time)
        return None if rope is None else EarlyEnd(just_before(reached_time), rope)

    def run_segment(self, segment: Segment) -> EarlyEnd | None:
        """Take the steps to the end of a segment, from one contact event to the next."""
        code, begin = MORE, segment.begin
        self.begin_piece(segment)
        while code in CONTINUE_CODES:
            code = self.advance()
            if code == TURNED:
                run_ends, due_triggers = self.has_ended(), self.find_due()
                if due_triggers is not None:
                    begin, rope = self.apply_due(begin, segment, due_triggers)
                    if rope is not None:
                        return EarlyEnd(just_before(begin), rope)
                if run_ends:
                    if due_triggers is not None:
                        self.advance()  # updates the branches after the impulse; takes no step
                    break
            self.check_run(code, segment)
            if code in (STRUCK, LET_GO):
                begin = self.handle_contact(begin, segment)
        self.pieces.add(np.array([[begin, segment.before_end, segment.end]]))
        return None if code == REACHED else self.find_early_end(code, begin)

    def advance(self) -> int:
        """Take some steps of the kernel and record them; return the code with which it stopped."""
        kernel, max_steps = self.progress.kernel, self.progress.kernel.max_steps
        if self.events is not None:
            max_steps = min(max_steps, self.events.steps_until_look())
        code = kernel.loop.advance(max_steps, True, self.ending_condition is not None or self.triggers is not None)
        self.progress.steps.add(kernel)
        if self.triggers is not None and self.begins_piece and code == TURNED:
            self.triggers.begin_piece(self.progress.t, self.progress.integrated_state)
        self.begins_piece = False
        return code

    def begin_piece(self, segment: Segment) -> None:
        """Begin a piece in the state reached."""
        self.interruptions.begin_segment(segment)
        self.begins_piece = True

    def end_piece(self) -> None:
        """End a piece at the instant reached, and record the branches of the triggers there."""
        if self.triggers is not None:
            self.triggers.end_piece()

    def find_due(self) -> DueTriggers | None:
        """Return what conditions trigger at the instant reached, if anything."""
        if self.triggers is None:
            return None
        return self.triggers.find_due(self.progress.t, self.progress.integrated_state)

    def apply_due(self, begin: float, segment: Segment, due_triggers: DueTriggers) -> tuple[float, str | None]:
        """Apply impulses and latches at the instant reached, which end a piece; return where the next one begins.

        Also returns the rope, if there is one, that would have to push in them.
        """
        t = self.progress.t
        if t > begin:
            self.pieces.add(np.array([[begin, segment.before_end, t]]))
        self.end_piece()
        rope = self.interruptions.apply_triggered(t, due_triggers.blows, due_triggers.latch_conditions)
        if rope is None:
            self.begin_piece(Segment(t, segment.before_end, segment.end))
        return t, rope

    def has_ended(self) -> bool:
        """Return whether the condition that ends the run became true at the instant reached."""
        return self.ending_condition is not None and self.ending_condition.has_become_true(
            self.progress.t, self.progress.integrated_state
        )

    def check_run(self, code: int, segment: Segment) -> None:
        """Check limits, events and stiffness after each call of the kernel."""
        if code == REACHED or code in CONTINUE_CODES:
            require_time(self.progress, self.request.deadline, self.start_time)
        if code in CONTINUE_CODES:
            require_progress(self.progress, self.request.most_steps)
            self.slow_watch.check(self.progress)
            if self.events is not None:
                self.events.require_same_frequency(self.pieces.count)
        if code == STIFF:
            if self.stiffness is None:
                from heuncli.motion.integration.run.supervision import StiffnessWatch  # few scenes are

                self.stiffness = StiffnessWatch(self.progress)
            self.stiffness.require_not_stiff(segment)

    def handle_contact(self, begin: float, segment: Segment) -> float:
        """Handle the contact that closed or opened at the instant reached, which ends a piece; return where the next
        one begins.
        """
        t = self.progress.t
        if t > begin:
            self.pieces.add(np.array([[begin, segment.before_end, t]]))
        latch_conditions = (
            None
            if self.triggers is None
            else self.triggers.evaluate_latches_at_contact(t, self.progress.integrated_state)
        )
        self.end_piece()
        self.interruptions.handle_contacts(t, self.progress.kernel.loop.contact, latch_conditions)
        self.begin_piece(Segment(t, segment.before_end, segment.end))
        return t

    def find_early_end(self, code: int, begin: float) -> EarlyEnd:
        """Return where the run ends before a segment's end; begin: of its last piece. Raises SolveError if it fails."""
        t = self.progress.t
        if code == TURNED:
            return EarlyEnd(t)
        if code == ROPE_SLACK:
            rope = self.progress.integrated_scene.find_rope(self.progress.kernel.loop.contact)
            return EarlyEnd(just_before(t) if t == begin > 0.0 else t, rope)
        if code == CHATTERING and self.triggers is not None and self.triggers.has_just_struck(t):
            raise self.triggers.make_endless_error(t)
        from heuncli.motion.integration.run.failure import make_failure_error  # only on the way to an error

        raise make_failure_error(self.progress, code)

    def make_trajectory(self, ending: EarlyEnd | None, seconds: float) -> Trajectory:
        """Return the result of the run when it came to its end, or to an early end."""
        progress, kernel, steps = self.progress, self.progress.kernel, self.progress.steps
        requested = self.request.instants
        times, states = (
            (requested, kernel.read_states())
            if ending is None
            else truncate_samples(requested, kernel, ending.last_time)
        )
        return Trajectory(
            times=times,
            states=progress.integrated_scene.embed_run(times, states),
            ends=steps.copy_column("ends"),
            steps=kernel.loop.steps,
            evaluations=kernel.loop.evaluations,
            gap=kernel.loop.gap,
            local=kernel.start.local,
            method=kernel.method,
            seconds=seconds,
            segments=Segments(self.pieces.rows),
            records=steps.list_records(),
            polynomials=steps.collect_polynomials(),
            pivots=steps.copy_column("pivots"),
            is_projected=steps.copy_column("settled"),
            branches=steps.read_branches(),
            branch_changed=steps.copy_column("turned"),
            uncertain_count=kernel.loop.undecided_count,
            pushing_rope=ending.rope if ending is not None else None,
            ended_by_condition=ending is not None and ending.rope is None,
            final_branches=np.array(progress.integrated_scene.layout.pack.expressions.branches()),
            impulse_events=tuple(self.interruptions.events),
            holding=steps.find_holding(len(progress.scene.layout.open_contacts)),
            notes=self.interruptions.notes + (self.triggers.notes if self.triggers is not None else ()),
        )


def make_ending_condition(layout: Layout) -> EndingCondition | None:
    """Return the condition that ends the runs of a scene, if there is one."""
    if not any(condition.ends for condition in layout.mechanism.conditions):
        return None
    from heuncli.motion.integration.conditions import EndingCondition  # few scenes have one

    return EndingCondition(layout)


def make_triggers(layout: Layout, last: float) -> Triggers | None:
    """Return the impulses and latches of a scene that depend on conditions, if there are any."""
    mechanism = layout.mechanism
    latches = (stop.latch for stop in mechanism.stops if stop.latch is not None)
    if all(blow.when is None for blow in mechanism.impulses) and not any(latch.conditions for latch in latches):
        return None
    from heuncli.motion.integration.run.triggers import Triggers  # few scenes have any

    return Triggers(layout, last)


def make_event_watch(progress: RunProgress, segments: Segments) -> EventWatch | None:
    """Return the watch that counts steps ended by events, if there may be any."""
    if not (progress.kernel.branch_count > 0 or len(progress.scene.layout.contacts) > 0 or len(segments) > 1):
        return None
    from heuncli.motion.integration.run.supervision import EventWatch  # few scenes have any

    return EventWatch(progress)


def truncate_samples(times: Array, kernel: KernelLoop, last: float) -> tuple[Array, Array]:
    """Return the requested instants before the last reported one, and that one, (n,), with the integrated states (n,
    n').
    """
    requested = times[: kernel.loop.sampled_count]
    sample_times = np.append(requested[requested <= last], last)
    states = np.vstack([kernel.read_states()[: len(sample_times) - 1], np.array(kernel.loop.state())])
    return (
        (sample_times[:-1], states[:-1])
        if len(sample_times) > 1 and sample_times[-1] == sample_times[-2]
        else (sample_times, states)
    )
