"""What an explicit method can only crawl through: noticed on the way, and begun anew with an implicit one.

Where stability has kept the steps short for a while (kernel/stiffness.py) an implicit method is tried beside the run,
for some steps from the state reached. If the whole motion, begun anew with it, costs less than what is left of this
run, the run ends: `Stiff`. Measured and not supposed, for what swings fast and is worth following costs an implicit
method as much. Counted in evaluations, not in seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli import tolerances
from heuncli.integration.loop import Integration, Segment
from heuncli.integration.methods.method import Method
from heuncli.integration.methods.registry import method_of
from heuncli.kernel.choose import steps as kernel
from heuncli.method_rows import row_of
from heuncli.response import workspace_of
from heuncli.results import Array

if TYPE_CHECKING:
    from heuncli.integration.runner import Going, Runner

TRIED = (12, 12)  # steps of the implicit method: those in which it comes to its pace, and those that are counted
STARTING = 4.0  # times the evaluations of the run so far: what the implicit method takes of them, which were not stiff
MOST_STATE = 300  # numbers: of larger tangents the factors alone take longer than short steps
RECENT = 8  # steps of the run whose mean tells its pace

GOES_ON = (kernel.CODES["reached"], kernel.CODES["more"])


def implicit_for(local: float) -> Method | None:
    """The stiff method for a local tolerance."""
    if row_of("Radau5") is None:
        return None
    return method_of("Radau5" if local > tolerances.RADAU5 else "Radau9")


def require_easy(runner: Runner, going: Going, segment: Segment) -> None:
    """Raise Stiff where another method takes less than what is left of a run that crawls.

    Looked at again when the run has taken twice as many steps.
    """
    steps, run = going.steps, going.run
    if steps.count < 2 * run.looked:
        return
    run.looked = steps.count
    method, t = implicit_for(run.local), run.loop.t
    if method is None or runner.moving.layout.n_state > MOST_STATE:
        return
    ends = steps.column("ends")
    h = float(ends[-1] - ends[-1 - RECENT]) / RECENT
    left = going.last - t
    a_second = tried(runner, going, segment, method)
    taken = run.loop.evaluations
    explicit, whole = taken / run.loop.steps * left / h, STARTING * taken + a_second * left
    if whole < explicit:
        from heuncli.integration.runner import Stiff
        from heuncli.integration.swift import swift

        raise Stiff(method, swift(runner, t, runner.moving.state(t, state_of(run)), h))


def state_of(run: Integration) -> Array:
    """The state that a run has reached."""
    return np.array(run.loop.state())


def tried(runner: Runner, going: Going, segment: Segment, method: Method) -> float:
    """Evaluations that an implicit method takes a second of motion, from the state that a run has reached."""
    layout, run, t = runner.moving.layout, going.run, going.run.loop.t
    workspace = workspace_of(layout)  # its own: the run goes on as if nothing had been tried
    if len(going.steps.holdings):
        workspace.hold(going.steps.holdings[-1][1])
    trial = Integration(
        layout, workspace, method, np.zeros(0),
        most=sum(TRIED), state=state_of(run), local=run.local, rate=run.rate, following=0, late=0,
    )  # fmt: skip
    trial.loop.begin(t, segment.before_end, segment.end)
    first = trial.loop.advance(TRIED[0], False, False)
    begun, before = trial.loop.t, trial.loop.evaluations
    code = trial.loop.advance(TRIED[1], False, False) if first in GOES_ON else first
    if code not in GOES_ON:
        return np.inf
    if trial.loop.t == begun:  # the first steps came to the end of the segment
        begun, before = t, 0
    return float((trial.loop.evaluations - before) / (trial.loop.t - begun))
