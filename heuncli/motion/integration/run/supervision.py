"""Watch over a run: limit its time and steps, announce that it is slow, notice stiffness and too many events.

Impure: reads the clock.

A step that an event ends is taken about three times: past the event, to its estimated position, and to its position.
Each costs all stages of the method, and a high order gains nothing, because the event ends the step and not the error.
Where that happens, a method of half the stages repeats that part (check/runs.py). If it takes less work, it
continues; where events become rare, the run restarts with its first method. Work is counted in evaluations, not in
seconds, so that a scene is always solved in the same way.

Where stability has limited the steps for a while (kernel/stages.py), an implicit method is tried for some steps from
the state reached. If the whole motion, restarted with it, costs less than the rest of this run, the run stops:
`StiffRun`. The cost is measured, because fast oscillations that are worth following cost an implicit method as much. It
is counted in evaluations, not in seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

import math
import time

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem
from heuncli.base.process import current_listener
from heuncli.motion.integration.evaluator import estimate_work
from heuncli.motion.integration.integrated_scene import Segment
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.kernel_loop import MORE, REACHED, KernelLoop, LoopStart
from heuncli.motion.integration.run.progress import (
    RunProgress,
    estimate_seconds_left,
    find_hopeless_steps,
    format_seconds_left,
)
from heuncli.motion.integration.run.request import EventfulRun, StiffRun
from heuncli.multibody.response import make_workspace
from heuncli.multibody.tree.layout import Layout

# Limits

CHUNK = 2_000  # body-steps between two looks at the clock
DENSE_CHUNK = 2_000_000  # likewise, in state numbers squared; the equations of an implicit step take their cube


def find_chunk_size(layout: Layout, method: Method) -> int:
    """Return the number of steps between two looks at the clock. Raises LimitError if a method would solve too many
    equations.
    """
    bodies, n = max(estimate_work(layout), 1), layout.n_state
    if not method.implicit:
        return max(1, CHUNK // bodies)
    if n > tolerances.MOST_SOLVED:
        message = f"{method.name} solves dense equations for all {n} state variables; the limit is"
        hint = "use --method DOP853, which solves none, but takes short steps if the model is stiff"
        raise LimitError(Problem("too-many-states", f"{message} {tolerances.MOST_SOLVED}", hint=hint))
    return max(1, min(CHUNK // bodies, DENSE_CHUNK // max(n, 1) ** 2))


def check_deadline(deadline: float | None, where: str) -> None:
    """Raise LimitError past the deadline (time.monotonic()); `where`: how far the work has come."""
    if deadline is not None and time.monotonic() > deadline:
        raise time_limit_error(where)


def time_limit_error(where: str) -> LimitError:
    """Make the error of a passed deadline; `where`: how far the work has come."""
    hint = "use a longer --time-limit, a coarser --tolerance, or a shorter duration"
    return LimitError(Problem("time-limit", f"the time limit was reached {where}", hint=hint))


def require_time(progress: RunProgress, deadline: float | None, start_time: float) -> None:
    """Raise LimitError past the deadline, with how far the run has come, and at which pace; start_time:
    time.monotonic().
    """
    if deadline is not None and time.monotonic() > deadline:
        seconds = time.monotonic() - start_time
        pace_text = format_seconds_left(progress.steps.copy_column("ends"), progress.last, seconds)
        raise time_limit_error(f"at t = {progress.t:.6g} s of {progress.last:.6g} s{pace_text}")


def require_progress(progress: RunProgress, most_steps: int) -> None:
    """Raise LimitError above the maximum number of steps, and where steps become too short for the run to reach its
    end.

    Raises SolveError if that is because a value grows without bound.
    """
    steps, last = progress.steps, progress.last
    done_text = f"steps were done at t = {progress.t:.6g} s of {last:.6g} s"
    if steps.count > most_steps:
        hint = "use a shorter duration, a coarser tolerance, or a method for stiff systems: --method Radau9"
        raise LimitError(Problem("step-limit", f"{most_steps} {done_text}", hint=hint))
    if not steps.has_doubled():
        return
    irregular = not progress.kernel.method.is_determined
    projected = find_hopeless_steps(steps.copy_column("ends"), last, tolerances.MOST_STEPS, irregular=irregular)
    if projected is not None:
        from heuncli.motion.integration.diagnosis.fast_motions import (
            explain_short_steps,  # only on the way to an error
            find_growing,
            make_stalled_error,
        )

        problems = find_growing(progress.scene, progress.t, progress.state, progress.passed_states)
        cause = "" if problems else explain_short_steps(progress.scene, progress.t, progress.state, *progress.pace)
        raise make_stalled_error(problems, f"{steps.count} {done_text}", projected, cause)


# Slow runs

PATIENCE = 4.0  # [s] of work before the first check
LONG_RUN = 20.0  # [s] remaining at this pace, above which the run is announced


class SlowRunWatch:
    """Watches whether a run is slow. The next look is when it has taken twice as long.

    start_time: time.monotonic() at the start
    """

    def __init__(self, start_time: float) -> None:
        self.start_time, self.next, self.is_reported = start_time, PATIENCE, False

    def check(self, progress: RunProgress) -> None:
        """Announce a run that will take long at the pace of its last steps."""
        if (
            self.is_reported
            or (seconds := time.monotonic() - self.start_time) < self.next
            or (report := current_listener()) is None
        ):
            return
        self.next = 2.0 * seconds
        remaining = estimate_seconds_left(progress.steps.copy_column("ends"), progress.last, seconds)
        if not remaining > LONG_RUN:
            return
        self.is_reported = True
        from heuncli.motion.integration.diagnosis.fast_motions import explain_short_steps  # few runs are slow

        done_text = (
            f"t = {progress.t:.3g} s of {progress.last:.6g} s after {seconds:.0f} s and {progress.steps.count} steps"
        )
        report("; ".join(filter(None, (
            f"long run: {done_text}, about {remaining:.1g} s more at this pace",
            explain_short_steps(progress.scene, progress.t, progress.state, *progress.pace),
            "--time-limit stops it",
        ))))  # fmt: skip


# Event frequency

FEW_STAGES = "DOPRI5"
FIRST_LOOK = 16  # steps; later at each doubling; fewer steps show no pattern


class EventWatch:
    """Stops a run when events end most of its steps or, with a method of few stages, when they no longer do.

    looked_at_step: number of steps at the last look
    cut_steps: how many of these an event had ended
    """

    def __init__(self, progress: RunProgress) -> None:
        self.progress, self.looked_at_step, self.cut_steps = progress, 0, 0

    def steps_until_look(self) -> int:
        """Return after how many steps to look first; later, each time."""
        return max(FIRST_LOOK - self.progress.steps.count, 1)

    def require_same_frequency(self, pieces: int) -> None:
        """Raise EventfulRun where events end most steps of a run or, with a method of few stages, when they no longer
        do.

        pieces: number of pieces into which contacts, impulses and jumps in time have cut the run so far
        """
        kernel, steps = self.progress.kernel, self.progress.steps
        if steps.count < max(FIRST_LOOK, 2 * self.looked_at_step):
            return
        previous_steps, previous_cut = self.looked_at_step, self.cut_steps
        self.looked_at_step, self.cut_steps = steps.count, pieces + int(np.count_nonzero(steps.copy_column("turned")))
        cut_share = (self.cut_steps - previous_cut) / (self.looked_at_step - previous_steps)
        if (
            cut_share <= tolerances.EVENTS_RARE
            if kernel.method.name == FEW_STAGES
            else cut_share >= tolerances.EVENTFUL
        ):
            raise EventfulRun(self.progress.t, steps.count, self.cut_steps, kernel.loop.evaluations, kernel.start.local)


# Stiffness

TRIAL_STEPS = (8, 8)  # steps of the implicit method: those to reach its pace, and those that are measured
MAX_TRIAL_SHARE = 0.125  # fraction of the remaining work that the trial may take
CORRECTIONS = 8  # iterations of the stages in a step, rarely more
# cost of the part done with the implicit method, over its explicit evaluations: that part was not stiff
START_COST = 4.0
RECENT_STEPS = 8  # steps of the run whose mean is its pace
FACTOR_COST = 0.02  # times n^2 per stage: cost of its factors, in evaluations of n numbers of state

COMPLETED_CODES = (REACHED, MORE)  # codes of a completed trial


def choose_implicit_method(local: float) -> Method:
    """Return the stiff method for a local tolerance."""
    return load_method_by_name("Radau5" if local > tolerances.RADAU5 else "Radau9")


class StiffnessWatch:
    """Watches whether a run should stop because it is stiff. Remembers the number of steps at the last look."""

    def __init__(self, progress: RunProgress) -> None:
        self.progress, self.looked_at_step = progress, 0

    def require_not_stiff(self, segment: Segment) -> None:
        """Raise StiffRun where another method takes less work than the rest of a stiff run.

        The next look is when the run has taken twice as many steps. segment: the present segment of the run.
        """
        progress, kernel, steps = self.progress, self.progress.kernel, self.progress.steps
        if steps.count < max(2 * self.looked_at_step, RECENT_STEPS + 1):
            return
        self.looked_at_step = steps.count
        method, t, n = choose_implicit_method(kernel.start.local), progress.t, progress.integrated_scene.layout.n_state
        ends = steps.copy_column("ends")
        h = float(ends[-1] - ends[-1 - RECENT_STEPS]) / RECENT_STEPS
        evaluations_done, time_left = kernel.loop.evaluations, progress.last - t
        explicit = evaluations_done / kernel.loop.steps * time_left / h
        # of a step: the tangent, counted as n evaluations, and its factors
        overhead = n + FACTOR_COST * n * n * (len(method.nodes) - 1)
        step_cost = overhead + CORRECTIONS * (len(method.nodes) - 1)
        if sum(TRIAL_STEPS) * step_cost > MAX_TRIAL_SHARE * explicit:
            return
        cost_per_second, trial = try_implicit_method(progress, segment, method, overhead)
        if START_COST * evaluations_done + cost_per_second * time_left < explicit:
            # only where a run is stopped
            from heuncli.motion.integration.diagnosis.fast_motions import describe_fastest_motion

            # at the trial's end, because coarse explicit steps may oscillate about the slow motion
            trial_state = progress.integrated_scene.embed_state(trial.loop.t, np.array(trial.loop.state()))
            raise StiffRun(method, describe_fastest_motion(progress.scene, trial.loop.t, trial_state, h))


def try_implicit_method(
    progress: RunProgress, segment: Segment, method: Method, overhead: float
) -> tuple[float, KernelLoop]:
    """Return the evaluations that an implicit method takes per second of motion, from the state reached, and the trial.

    overhead: cost of a step in addition to its stages
    """
    layout, kernel, t = progress.integrated_scene.layout, progress.kernel, progress.t
    workspace = make_workspace(layout)  # separate, so that the trial leaves the run unchanged
    if progress.steps.holdings:
        workspace.hold(progress.steps.holdings[-1][1])
    start = LoopStart(progress.integrated_state, kernel.start.local, kernel.start.rate)
    trial = KernelLoop(layout, workspace, method, np.zeros(0), sum(TRIAL_STEPS), start)
    trial.loop.begin(t, segment.before_end, segment.end)
    if trial.loop.advance(TRIAL_STEPS[0], False, False) not in COMPLETED_CODES:
        return math.inf, trial
    trial_begin, evaluations, steps = trial.loop.t, trial.loop.evaluations, trial.loop.steps
    if trial_begin == t:  # the segment ends here
        return math.inf, trial
    if trial_begin == segment.end:  # before it reaches its pace
        return float((evaluations + overhead * steps) / (trial_begin - t)), trial
    if trial.loop.advance(TRIAL_STEPS[1], False, False) not in COMPLETED_CODES:
        return math.inf, trial
    cost = trial.loop.evaluations - evaluations + overhead * (trial.loop.steps - steps)
    return float(cost / (trial.loop.t - trial_begin)), trial
