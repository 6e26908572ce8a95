"""Find the first instant at which closed chains and drives contradict each other, and which ones. Imported only for an
error.

A run notices a contradiction at the end of a step, when gaps have opened, or near the end of a range, where rates grow
without bound. The instant is found by halving between the last state that meets all conditions and there. A state
counts as good where its chains close, and its accelerations keep them closed within DRIVE_FOLLOWED, to the right of the
instant.

Where several drives move one loop, they may contradict each other within a step and agree at its end. In that case the
steps of a run are inspected again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.base.spelling import join_names
from heuncli.motion.integration.diagnosis.ambiguous_laws import find_fighting_drives
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import just_after, just_before
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.run.kernel_loop import REACHED, KernelLoop, LoopStart
from heuncli.motion.integration.run.request import ClosuresLost
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.islands import loop_bodies
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array

INSTANT_TOLERANCE = 1e-11  # relative to the run: tolerance of the instant
MOST_STEPS = 20  # of a piece between two instants one step apart
LOCAL_TOLERANCE = 1e-10  # tolerance of such a piece
SAMPLES_PER_STEP = 4  # per step, where several drives move one loop
LOOKAHEAD = 1e-6  # relative to the run: where a locking chain is inspected, past the end of its range


@record
class TimedState:
    """An instant and the state there."""

    t: float
    y: Array


def locate_contradiction(runner: Runner, error: ClosuresLost) -> SolveError:
    """Return the error of a run whose chains were lost, with instant, loop and drives if found; else the error it ended
    with.
    """
    problem = find_contradiction(runner, error.passed_states, error.failure_time, error.last)
    return error if problem is None else SolveError(problem)


def find_contradiction(
    runner: Runner, run_states: Sequence[tuple[float, Array]], failure_time: float, last: float
) -> Problem | None:
    """Find what cannot be held after which instant.

    Returns None if the last state met all conditions and the chains close after it too: there is another reason then.

    run_states: instants and states of the run, ascending
    failure_time: its end [s]
    """
    good, bad = find_bracket(runner, [TimedState(t, y) for t, y in run_states], failure_time, last)
    if good is None or bad is None:
        return None
    while bad - good.t > INSTANT_TOLERANCE * last:
        t = 0.5 * (good.t + bad)
        reached_state = advance_state(runner, good, t)
        if reached_state is None:
            bad = t
        else:
            good = reached_state
    return make_problem(runner, good, bad, last)


def find_contradiction_in_steps(runner: Runner, run: Trajectory) -> Problem | None:
    """Find where several drives of one loop contradict each other between or at the ends of a run's steps."""
    layout = runner.layout
    if not len(run.ends) or all(len(find_drives(layout, island)) < 2 for island in layout.islands):
        return None  # a run that a rope ends at its start has no steps
    marks = np.concatenate([[0.0], run.ends])
    inner = marks[:-1, None] + np.diff(marks)[:, None] * (np.arange(SAMPLES_PER_STEP) / SAMPLES_PER_STEP)
    times = np.minimum(np.append(inner.ravel(), run.ends[-1]), run.times[-1])
    evaluation = runner.evaluate_run(run, times)
    is_lost = (evaluation.gap > tolerances.KERNEL["closures_lost"] * runner.size) | (
        evaluation.residual > evaluation.allowed_residual
    )
    if not is_lost.any():
        return None
    first = max(int(np.argmax(is_lost)), 1)
    run_states = list(zip(times[:first].tolist(), evaluation.states[:first], strict=True))
    return find_contradiction(runner, run_states, float(times[first]), float(run.times[-1]))


def find_bracket(
    runner: Runner, run_states: Sequence[TimedState], failure_time: float, last: float
) -> tuple[TimedState | None, float | None]:
    """Return the last good state of a run and a later instant that is not good, as close as the run's own steps
    allow.
    """
    if not is_good_state(runner, run_states[0]):
        return None, None
    low, high = 0, len(run_states)  # passed[low] is good; passed[high], if there is one, is not
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if is_good_state(runner, run_states[middle]) else (low, middle)
    good = run_states[low]
    if high < len(run_states) and run_states[high].t > good.t:
        return good, run_states[high].t
    if failure_time > good.t:
        return good, failure_time
    later = good.t + LOOKAHEAD * last
    return good, later if advance_state(runner, good, later) is None else None


def is_good_state(runner: Runner, state: TimedState) -> bool:
    """Return whether a state closes the chains and has accelerations that keep them closed, to the right of its
    instant.
    """
    return meets_conditions(runner, evaluate_after(runner, state.t, state.y))


def evaluate_after(runner: Runner, t: float, y: Array) -> Evaluation:
    """Evaluate one state to the right of an instant."""
    return runner.evaluate(np.array([just_after(t)]), y[None, :])


def meets_conditions(runner: Runner, evaluation: Evaluation) -> bool:
    """Return whether an evaluated state has neither gaps nor unmet conditions."""
    closed = evaluation.gap[0] <= tolerances.DRIVE_FOLLOWED * runner.size
    return bool(closed and evaluation.residual[0] <= tolerances.DRIVE_FOLLOWED)


def advance_state(runner: Runner, good: TimedState, t: float) -> TimedState | None:
    """Return the state at a later instant if it is good: integrated, or at a lock moved there by closing the gaps
    alone.
    """
    begin, end = just_after(good.t), just_before(t)
    start = LoopStart(good.y, LOCAL_TOLERANCE, tolerances.LEAST_RATE / (t - good.t))
    piece = KernelLoop(runner.layout, runner.workspace, DOP853, np.array([t]), MOST_STEPS, start)
    if begin < end:
        piece.loop.begin(begin, end, t)
        reached = piece.loop.advance(MOST_STEPS, False, False) == REACHED
        y = piece.read_states()[0] if reached else np.array(piece.loop.state())
    else:
        y = good.y
    evaluation = evaluate_after(runner, t, y)
    return TimedState(t, evaluation.states[0]) if meets_conditions(runner, evaluation) else None


def make_problem(runner: Runner, good: TimedState, bad: float, last: float) -> Problem:
    """Make the problem, with the loop concerned and its drives."""
    layout = runner.layout
    drive_start = good.t if good.t > INSTANT_TOLERANCE * last else 0.0
    if (problem := find_fighting_drives(layout.mechanism, good.t + LOOKAHEAD * last, drive_start)) is not None:
        return problem
    gaps = evaluate_after(runner, max(bad, good.t + LOOKAHEAD * last), good.y).rows["gap"][0]
    worst = int(np.argmax(np.where(np.isfinite(gaps), np.abs(gaps), math.inf)))
    drives = find_drives(layout, next(island for island in layout.islands if worst in island.rows))
    owner = layout.mechanism.owner_path(layout.rows[worst])
    loop = f"the closed loop at {describe_owner(layout.mechanism, layout.rows[worst])}"
    message = f"at t = {bad:.9g} s: {loop} cannot be assembled after this instant"
    if not drives:
        hint = "the mechanism locks or reaches the end of its range of motion there"
    elif len(drives) == 1:
        hint = f"the drive {drives[0]} exceeds the range of the loop: keep it in range, or end the run earlier"
    else:
        hint = f"the drives {join_names(drives)} contradict each other there, or exceed the range of the loop"
    return Problem("closure-lost", message, hint=hint, entry_path=owner)


def describe_owner(mechanism: Mechanism, owner: int) -> str:
    """Describe what a closure row belongs to: "joint D (pin)"."""
    count = len(mechanism.joints)
    if owner < count:
        joint = mechanism.joints[owner]
        return f"joint {joint.name} ({joint.kind})"
    coupling = mechanism.couplings[owner - count]
    return f"coupling {coupling.name} ({coupling.entry.type})"


def find_drives(layout: Layout, island: Island) -> list[str]:
    """Return the names of the drives in the loops of an island."""
    cut = {layout.rows[row] for row in island.rows.tolist()}
    own = cut | {layout.spanning.links[body].joint for k in cut for body in loop_bodies(layout, k)}
    return [law.name for law in layout.mechanism.laws if law.owner in own]
