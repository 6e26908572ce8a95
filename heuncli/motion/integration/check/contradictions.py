"""The first instant at which closed chains and drives contradict each other, and which. Imported only for an error.

A run notices at the end of a step, when gaps have opened, or beside the end of a range, where rates grow without bound.
Between the last state that meets all conditions and there the instant is found by halving: a state counts as good where
its chains close, and its accelerations keep them closed, but for SHUT, on the right of the instant.

Where several drives move one loop, they may contradict each other within a step, and agree at its end: there the steps
of a run are looked at again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.diagnosis.fighting_drives import fighting
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.run.errors import ClosuresLost
from heuncli.motion.integration.run.kernel_loop import REACHED, KernelLoop, Start
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.segments import just_after, just_before
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.islands import loop_of
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array

CLOSE = 1e-11  # of the run: so near the instant is found
MOST_STEPS = 20  # of a piece between two instants that were a step apart
LOCAL = 1e-10  # tolerance of such a piece
LOOKS = 4  # of each step, where several drives move one loop
AHEAD = 1e-6  # of the run: so far behind the end of its range a chain that locks is looked at


@record
class State:
    """An instant and the state there."""

    t: float
    y: Array


def located(runner: Runner, lost: ClosuresLost) -> SolveError:
    """The error of a run whose chains were lost: with the instant, loop and drives, or the one it ended with."""
    problem = contradiction(runner, lost.passed, lost.failed, lost.last)
    return lost if problem is None else SolveError(problem)


def contradiction(runner: Runner, passed: Sequence[tuple[float, Array]], failed: float, last: float) -> Problem | None:
    """What cannot be held beyond which instant; passed: instants and states of the run, ascending; failed: its end.

    None where the last state met all conditions and the chains close behind it too: the reason is another one.
    """
    good, bad = bracket(runner, [State(t, y) for t, y in passed], failed, last)
    if good is None or bad is None:
        return None
    while bad - good.t > CLOSE * last:
        t = 0.5 * (good.t + bad)
        reached = forward(runner, good, t)
        if reached is None:
            bad = t
        else:
            good = reached
    return told(runner, good, bad, last)


def unfollowed(runner: Runner, run: Trajectory) -> Problem | None:
    """Where several drives of one loop contradict each other between or at the ends of a run's steps."""
    layout = runner.layout
    if not len(run.ends) or all(len(drives_of(layout, island)) < 2 for island in layout.islands):
        return None  # a run that a rope ends at its start has no steps
    marks = np.concatenate([[0.0], run.ends])
    inner = marks[:-1, None] + np.diff(marks)[:, None] * (np.arange(LOOKS) / LOOKS)
    times = np.minimum(np.append(inner.ravel(), run.ends[-1]), run.times[-1])
    answer = runner.answers_at(run, times)
    lost = (answer.gap > tolerances.KERNEL["lost"] * runner.size) | (answer.residual > answer.may_stay)
    if not lost.any():
        return None
    first = max(int(np.argmax(lost)), 1)
    passed = list(zip(times[:first].tolist(), answer.states[:first], strict=True))
    return contradiction(runner, passed, float(times[first]), float(run.times[-1]))


def bracket(runner: Runner, passed: Sequence[State], failed: float, last: float) -> tuple[State | None, float | None]:
    """The last good state of a run, and an instant behind it that is none, as near as the run's own steps tell."""
    if not holds(runner, passed[0]):
        return None, None
    low, high = 0, len(passed)  # passed[low] is good; passed[high], if there is one, is not
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if holds(runner, passed[middle]) else (low, middle)
    good = passed[low]
    if high < len(passed) and passed[high].t > good.t:
        return good, passed[high].t
    if failed > good.t:
        return good, failed
    beyond = good.t + AHEAD * last
    return good, beyond if forward(runner, good, beyond) is None else None


def holds(runner: Runner, state: State) -> bool:
    """Whether a state closes the chains and has accelerations that keep them closed, on the right of its instant."""
    return met(runner, recovered(runner, state.t, state.y))


def recovered(runner: Runner, t: float, y: Array) -> Recovered:
    """The kernel's answer to one state, on the right of an instant."""
    return runner.recovered(np.array([just_after(t)]), y[None, :])


def met(runner: Runner, answer: Recovered) -> bool:
    """Whether one answer leaves neither gaps nor conditions unmet."""
    closed = answer.gap[0] <= tolerances.SHUT * runner.size
    return bool(closed and answer.residual[0] <= tolerances.SHUT)


def forward(runner: Runner, good: State, t: float) -> State | None:
    """The state at a later instant if it is good: integrated, or at a lock brought there by its gaps alone."""
    begin, end = just_after(good.t), just_before(t)
    start = Start(good.y, LOCAL, tolerances.LEAST_RATE / (t - good.t))
    piece = KernelLoop(runner.layout, runner.workspace, DOP853, np.array([t]), MOST_STEPS, start)
    if begin < end:
        piece.loop.begin(begin, end, t)
        reached = piece.loop.advance(MOST_STEPS, False, False) == REACHED
        y = piece.states()[0] if reached else np.array(piece.loop.state())
    else:
        y = good.y
    answer = recovered(runner, t, y)
    return State(t, answer.states[0]) if met(runner, answer) else None


def told(runner: Runner, good: State, bad: float, last: float) -> Problem:
    """The problem, with the loop concerned and its drives."""
    layout = runner.layout
    begun = good.t if good.t > CLOSE * last else 0.0
    if (problem := fighting(layout.mechanism, good.t + AHEAD * last, begun)) is not None:
        return problem
    gaps = recovered(runner, max(bad, good.t + AHEAD * last), good.y).rows["gap"][0]
    worst = int(np.argmax(np.where(np.isfinite(gaps), np.abs(gaps), math.inf)))
    drives = drives_of(layout, next(island for island in layout.islands if worst in island.rows))
    owner = layout.mechanism.owner(layout.rows[worst])
    at = f"at t = {bad:.9g} s: the closed chains cannot be held together beyond this instant"
    message = f"{at}, in the loop at {told_as(layout.mechanism, layout.rows[worst])}"
    if not drives:
        hint = "the mechanism locks or reaches the end of its range there"
    elif len(drives) == 1:
        hint = f"the drive {drives[0]} asks for more than the loop can do: keep it in range, or end the run before"
    else:
        names = f"{', '.join(drives[:-1])} and {drives[-1]}"
        hint = f"the drives {names} ask there for what does not go together, or for more than the loop can do"
    return Problem("closure-lost", message, hint=hint, about=owner)


def told_as(mechanism: Mechanism, owner: int) -> str:
    """What a closure row belongs to, in words: "joint D (pin)"."""
    count = len(mechanism.joints)
    if owner < count:
        joint = mechanism.joints[owner]
        return f"joint {joint.name} ({joint.kind})"
    coupling = mechanism.couplings[owner - count]
    return f"coupling {coupling.name} ({coupling.given.type})"


def drives_of(layout: Layout, island: Island) -> list[str]:
    """The drives in the loops of an island, by name."""
    cut = {layout.rows[row] for row in island.rows.tolist()}
    own = cut | {layout.spanning.hangs[body].joint for k in cut for body in loop_of(layout, k)}
    return [law.name for law in layout.mechanism.laws if law.owner in own]
