"""Limit the time, steps and equations of a run. Impure: reads the clock."""

from __future__ import annotations

import time

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem
from heuncli.motion.integration.evaluator import estimate_work
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.pace import find_hopeless_steps, format_seconds_left
from heuncli.motion.integration.run.progress import RunProgress
from heuncli.multibody.tree.layout import Layout

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
        from heuncli.motion.integration.diagnosis.fast_body import explain_short_steps  # only on the way to an error
        from heuncli.motion.integration.diagnosis.growth import find_growing, stalled_error

        problems = find_growing(progress.scene, progress.t, progress.state, progress.passed_states)
        cause = "" if problems else explain_short_steps(progress.scene, progress.t, progress.state, *progress.pace)
        raise stalled_error(problems, f"{steps.count} {done_text}", projected, cause)
