"""Notice where stability limits an explicit method, and restart with an implicit one.

Where stability has limited the steps for a while (kernel/stiffness.py), an implicit method is tried for some steps from
the state reached. If the whole motion, restarted with it, costs less than the rest of this run, the run stops:
`StiffRun`. The cost is measured, because fast oscillations that are worth following cost an implicit method as much. It
is counted in evaluations, not in seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import load_method_by_name
from heuncli.motion.integration.run.errors import StiffRun
from heuncli.motion.integration.run.kernel_loop import MORE, REACHED, KernelLoop, LoopStart
from heuncli.motion.integration.run.progress import RunProgress
from heuncli.motion.integration.segments import Segment
from heuncli.multibody.response import make_workspace

TRIAL_STEPS = (8, 8)  # steps of the implicit method: those to reach its pace, and those that are measured
MAX_TRIAL_SHARE = 0.125  # fraction of the remaining work that the trial may take
CORRECTIONS = 8  # iterations of the stages in a step, rarely more
START_COST = (
    4.0  # cost of the part done with the implicit method, over its explicit evaluations: that part was not stiff
)
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
            from heuncli.motion.integration.run.fastest_motion import describe_fastest_motion

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
