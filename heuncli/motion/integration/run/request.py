"""What a run is asked for, and for what it may be left before its end."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import Method
from heuncli.results.results import Array


@record
class MotionTask:
    """A run from t = 0 over the asked instants.

    times (n_t,) ascending [s]: it ends with the last of them; local: the tolerance of a step, or of a method of given
    steps their length [s]; discontinuities: instants [s] at which a load or drive in time is not smooth; start (n,): a
    state of the scene beside its own, to see what rounding makes of a run: events are then late by rounding, too;
    deadline: by time.monotonic(); most_steps: after which it is given up; keeping: it will be asked for other
    instants, and keeps what its steps know of these.
    """

    times: Sequence[float] | Array
    local: float
    method: Method = DOP853
    discontinuities: Sequence[float] = ()
    start: Array | None = None
    deadline: float | None = None
    most_steps: int = tolerances.MOST_STEPS
    keeping: bool = False

    @cached_property
    def instants(self) -> Array:
        """The asked instants, (n_t,)."""
        return np.ascontiguousarray(self.times, dtype=float)

    @property
    def last(self) -> float:
        """The last of them [s]."""
        return float(self.instants[-1]) if len(self.instants) else 0.0


@record
class StoppingRules:
    """What a run may be left for before its last instant.

    ending: the condition that ends it became true; stiffness: an implicit method takes less (run/stiffness.py);
    events: they end most of its steps, or those of a method for such no more (run/event_frequency.py).
    """

    ending: bool = True
    stiffness: bool = False
    events: bool = False


FOR_ITS_ENDING = StoppingRules()
