"""What an explicit method can only crawl through: noticed on the way, and begun anew with an implicit one.

Where stability has kept the steps short for a while (kernel/stiffness.py) an implicit method is tried beside the run,
for some steps from the state reached. If the whole motion, begun anew with it, costs less than what is left of this
run, the run ends: `Stiff`. Measured and not supposed, for what swings fast and is worth following costs an implicit
method as much. Counted in evaluations, not in seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.errors import Stiff
from heuncli.motion.integration.run.kernel_loop import MORE, REACHED, KernelLoop, Start
from heuncli.motion.integration.run.progress import Progress
from heuncli.motion.integration.segments import Segment
from heuncli.multibody.response import workspace_of

TRIED = (8, 8)  # steps of the implicit method: those in which it comes to its pace, and those that are counted
MOST_TRIED = 0.125  # of what is left of the run: what the trial may take of it
CORRECTIONS = 8  # of the stages in a step, seldom more
STARTING = 4.0  # times the evaluations of the run so far: what the implicit method takes of them, which were not stiff
RECENT = 8  # steps of the run whose mean tells its pace
FACTORS = 0.02  # n^2 of a stage: what its factors take, in evaluations of n numbers of state

NOT_STOPPED = (REACHED, MORE)  # codes of a trial that came as far as it was asked to


def implicit_for(local: float) -> Method:
    """The stiff method for a local tolerance."""
    return method_of("Radau5" if local > tolerances.RADAU5 else "Radau9")


class StiffnessWatch:
    """Whether a run is left because it crawls. Remembers after how many steps that was looked at last."""

    def __init__(self, progress: Progress) -> None:
        self.progress, self.looked = progress, 0

    def require_easy(self, segment: Segment) -> None:
        """Raise Stiff where another method takes less than what is left of a run that crawls.

        Looked at again when the run has taken twice as many steps. segment: in which the run is.
        """
        progress, kernel, steps = self.progress, self.progress.kernel, self.progress.steps
        if steps.count < max(2 * self.looked, RECENT + 1):
            return
        self.looked = steps.count
        method, t, n = implicit_for(kernel.start.local), progress.t, progress.moving.layout.n_state
        ends = steps.column("ends")
        h = float(ends[-1] - ends[-1 - RECENT]) / RECENT
        taken, left = kernel.loop.evaluations, progress.last - t
        explicit = taken / kernel.loop.steps * left / h
        # of a step: the tangent, counted as n evaluations, and its factors
        beside = n + FACTORS * n * n * (len(method.nodes) - 1)
        one = beside + CORRECTIONS * (len(method.nodes) - 1)
        if sum(TRIED) * one > MOST_TRIED * explicit:
            return
        a_second, trial = tried(progress, segment, method, beside)
        if STARTING * taken + a_second * left < explicit:
            from heuncli.motion.integration.run.fastest_motion import fastest  # only where a run is left

            # where the trial is: coarse explicit steps may be driven to and fro beside the slow motion
            beyond = progress.moving.state(trial.loop.t, np.array(trial.loop.state()))
            raise Stiff(method, fastest(progress.scene, trial.loop.t, beyond, h))


def tried(progress: Progress, segment: Segment, method: Method, beside: float) -> tuple[float, KernelLoop]:
    """Evaluations that an implicit method takes a second of motion, from the state that a run has reached; the trial.

    beside: what a step takes beside those of its stages.
    """
    layout, kernel, t = progress.moving.layout, progress.kernel, progress.t
    workspace = workspace_of(layout)  # its own: the run goes on as if nothing had been tried
    if progress.steps.holdings:
        workspace.hold(progress.steps.holdings[-1][1])
    start = Start(progress.integrated_state, kernel.start.local, kernel.start.rate)
    trial = KernelLoop(layout, workspace, method, np.zeros(0), sum(TRIED), start)
    trial.loop.begin(t, segment.before_end, segment.end)
    if trial.loop.advance(TRIED[0], False, False) not in NOT_STOPPED:
        return math.inf, trial
    begun, evaluations, steps = trial.loop.t, trial.loop.evaluations, trial.loop.steps
    if begun == t:  # the segment ends here
        return math.inf, trial
    if begun == segment.end:  # sooner than it comes to its pace
        return float((evaluations + beside * steps) / (begun - t)), trial
    if trial.loop.advance(TRIED[1], False, False) not in NOT_STOPPED:
        return math.inf, trial
    took = trial.loop.evaluations - evaluations + beside * (trial.loop.steps - steps)
    return float(took / (trial.loop.t - begun)), trial
