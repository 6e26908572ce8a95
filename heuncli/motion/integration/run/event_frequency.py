"""Notice a run that events cut at nearly every step, so that a method of fewer stages can be tried.

A step that an event ends is taken about three times: past the event, to its estimated position, and to its position.
Each costs all stages of the method, and a high order gains nothing, because the event ends the step and not the error.
Where that happens, a method of half the stages repeats that part (check/fewer_stages.py). If it takes less work, it
continues; where events become rare, the run restarts with its first method. Work is counted in evaluations, not in
seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.run.errors import EventfulRun
from heuncli.motion.integration.run.progress import RunProgress

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
