"""The request for a run, and the reasons to stop it before its end."""

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
    """A run from t = 0 over the requested instants.

    times (n_t,): ascending [s]; the run ends with the last of them
    local: tolerance of a step, or the step of a method of fixed step [s]
    discontinuities: instants at which a load or drive in time is not smooth [s]
    start (n,): a perturbed state of the scene, to see the effect of rounding; events are then late by rounding, too
    deadline: by time.monotonic()
    most_steps: number of steps after which it is stopped
    stores_polynomials: it will be asked for other instants, so store the polynomials of its steps
    """

    times: Sequence[float] | Array
    local: float
    method: Method = DOP853
    discontinuities: Sequence[float] = ()
    start: Array | None = None
    deadline: float | None = None
    most_steps: int = tolerances.MOST_STEPS
    stores_polynomials: bool = False

    @cached_property
    def instants(self) -> Array:
        """The requested instants, (n_t,)."""
        return np.ascontiguousarray(self.times, dtype=float)

    @property
    def last(self) -> float:
        """The last of them [s]."""
        return float(self.instants[-1]) if len(self.instants) else 0.0


@record
class StoppingRules:
    """The reasons to stop a run before its last instant.

    ending: the condition that ends it became true
    stiffness: an implicit method takes less work (run/stiffness.py)
    events: they end most of its steps or, with a method for this case, no longer do (run/event_frequency.py)
    """

    ending: bool = True
    stiffness: bool = False
    events: bool = False


DEFAULT_RULES = StoppingRules()
