"""What is cut by events at nearly every step: noticed on the way, and tried by a method of fewer stages.

A step that an event ends is taken some three times, over the event, up to where it seems to be, and up to where it is.
Each costs all stages of the method, and its order gains nothing: the event, and not the error, ends the step. Where
that becomes so, a method of half the stages does the part that is done once more. If it takes less for it, it goes on;
and where events become rare the run is begun anew as it was at first. Counted in evaluations, not in seconds, so that a
scene is always solved in the same way.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.integration.methods.method import Method
from heuncli.integration.run.errors import Eventful
from heuncli.integration.run.step_records import Steps

FEW_STAGES = "DOPRI5"


def require_as_before(steps: Steps, method: Method, pieces: int) -> None:
    """Raise Eventful where events end most steps of a run, or those of a method of few stages no more.

    pieces: into which contacts, blows and jumps in time have cut the run so far.
    """
    since = steps.looked
    steps.looked, steps.cut_before, before = steps.count, cut_steps(steps, pieces), steps.cut_before
    cut = (steps.cut_before - before) / (steps.looked - since)
    if cut <= tolerances.EVENTS_RARE if method.name == FEW_STAGES else cut >= tolerances.EVENTFUL:
        raise Eventful(steps.count, steps.cut_before)


def cut_steps(steps: Steps, pieces: int) -> int:
    """How many of the steps done an event ended."""
    return pieces + int(np.count_nonzero(steps.column("turned")))
