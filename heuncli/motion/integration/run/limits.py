"""How much a run may take: time, steps, equations. Impure: looks at the clock."""

from __future__ import annotations

import time

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem
from heuncli.motion.integration.evaluator import work_of
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.pace import hopeless, in_words
from heuncli.motion.integration.run.progress import Progress
from heuncli.multibody.tree.layout import Layout

CHUNK = 2_000  # body-steps between two looks at the clock
DENSE_CHUNK = 2_000_000  # likewise of a state's numbers squared, whose cube the equations of an implicit step take


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


def check_deadline(deadline: float | None, where: str) -> None:
    """Raise LimitError past the deadline (time.monotonic()); `where`: how far the work has come."""
    if deadline is not None and time.monotonic() > deadline:
        raise time_up(where)


def time_up(where: str) -> LimitError:
    """The error of a deadline that is past; `where`: how far the work has come."""
    hint = "a longer --time-limit, a coarser --tolerance, or a shorter duration"
    return LimitError(Problem("time-limit", f"the time limit was reached {where}", hint=hint))


def require_time(progress: Progress, deadline: float | None, begun: float) -> None:
    """Raise LimitError past the deadline, with how far the run has come, and at which pace; begun: time.monotonic()."""
    if deadline is not None and time.monotonic() > deadline:
        took = time.monotonic() - begun
        pace = in_words(progress.steps.column("ends"), progress.last, took)
        raise time_up(f"at t = {progress.t:.6g} s of {progress.last:.6g} s{pace}")


def require_progress(progress: Progress, most_steps: int) -> None:
    """Raise LimitError beyond the most steps, and where they become so short that the run cannot come to its end.

    Raises SolveError if that is because a value grows without bound.
    """
    steps, last = progress.steps, progress.last
    done = f"steps were done at t = {progress.t:.6g} s of {last:.6g} s"
    if steps.count > most_steps:
        hint = "a shorter duration, a coarser tolerance, or a stiff method: --method Radau9"
        raise LimitError(Problem("step-limit", f"{most_steps} {done}", hint=hint))
    if not steps.doubled():
        return
    irregular = not progress.kernel.method.determined
    projected = hopeless(steps.column("ends"), last, tolerances.MOST_STEPS, irregular=irregular)
    if projected is not None:
        from heuncli.motion.integration.diagnosis.fast_body import why_steps_are_short  # only on the way to an error
        from heuncli.motion.integration.diagnosis.growth import growing, stalled

        problems = growing(progress.scene, progress.t, progress.state, progress.passed)
        cause = "" if problems else why_steps_are_short(progress.scene, progress.t, progress.state, *progress.pace)
        raise stalled(problems, f"{steps.count} {done}", projected, cause)
