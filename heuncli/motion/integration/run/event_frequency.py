"""What is cut by events at nearly every step: noticed on the way, so that a method of fewer stages can be tried.

A step that an event ends is taken some three times, over the event, up to where it seems to be, and up to where it is.
Each costs all stages of the method, and its order gains nothing: the event, and not the error, ends the step. Where
that becomes so, a method of half the stages does the part that is done once more (check/fewer_stages.py). If it takes
less for it, it goes on; and where events become rare the run is begun anew as it was at first. Counted in evaluations,
not in seconds, so that a scene is always solved in the same way.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.run.errors import Eventful
from heuncli.motion.integration.run.progress import Progress

FEW_STAGES = "DOPRI5"
LOOK_AFTER = 16  # steps; then each time that they have doubled: fewer are no pattern


class EventWatch:
    """Whether a run is left because events end most of its steps, or those of a method of few stages no more.

    looked: steps when that was looked at last; cut: how many of these an event had ended.
    """

    def __init__(self, progress: Progress) -> None:
        self.progress, self.looked, self.cut = progress, 0, 0

    def due_in(self) -> int:
        """After how many steps it is looked at first; from there on after each."""
        return max(LOOK_AFTER - self.progress.steps.count, 1)

    def require_as_before(self, pieces: int) -> None:
        """Raise Eventful where events end most steps of a run, or those of a method of few stages no more.

        pieces: into which contacts, blows and jumps in time have cut the run so far.
        """
        kernel, steps = self.progress.kernel, self.progress.steps
        if steps.count < max(LOOK_AFTER, 2 * self.looked):
            return
        since, before = self.looked, self.cut
        self.looked, self.cut = steps.count, pieces + int(np.count_nonzero(steps.column("turned")))
        cut = (self.cut - before) / (self.looked - since)
        if cut <= tolerances.EVENTS_RARE if kernel.method.name == FEW_STAGES else cut >= tolerances.EVENTFUL:
            raise Eventful(self.progress.t, steps.count, self.cut, kernel.loop.evaluations, kernel.start.local)
