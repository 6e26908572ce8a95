"""The request for a run, and how a run stops before its end: errors, and reasons to restart with another method."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.kernel.choose import steps as kernel
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import Method
from heuncli.results.results import Array

# Request


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
    stiffness: an implicit method takes less work (run/supervision.py)
    events: they end most of its steps or, with a method for this case, no longer do (run/supervision.py)
    """

    ending: bool = True
    stiffness: bool = False
    events: bool = False


DEFAULT_RULES = StoppingRules()


# Errors

KERNEL_ERRORS = {
    kernel.CODES["collapsed"]: (
        "step-collapsed",
        "the step size fell to the rounding error of the time",
        "a load or a rate grows without bound there",
    ),
    kernel.CODES["not a number"]: (
        "not-a-number",
        "no finite acceleration exists after this instant",
        "check expressions and tables, and points that coincide",
    ),
    kernel.CODES["closures lost"]: (
        "closure-lost",
        "closed loops cannot be assembled after this instant",
        "the mechanism locks or reaches the end of its range of motion there",
    ),
    kernel.CODES["unsolved"]: (
        "stages-unsolved",
        "the equations of an implicit step cannot be solved: Newton's iteration does not converge",
        "use a shorter step, or --method Radau9, which chooses its own",
    ),
}


class ClosuresLost(SolveError):
    """A run ended where its closed chains could not be held.

    passed_states: instants and states before
    failure_time, last: instant of failure, and intended end [s]
    """

    def __init__(
        self, problem: Problem, *, passed_states: list[tuple[float, Array]], failure_time: float, last: float
    ) -> None:
        super().__init__(problem)
        self.passed_states, self.failure_time, self.last = passed_states, failure_time, last


class StiffRun(Exception):
    """A run was stopped because another method takes less work.

    reason: why, in a sentence
    seconds: time that the run took
    """

    def __init__(self, method: Method, reason: str) -> None:
        super().__init__(reason)
        self.method, self.reason, self.seconds = method, reason, 0.0


class EventfulRun(Exception):
    """A run was stopped because so many of its steps end at events that another method may take less, or because few do
    now.

    end_time [s] in so many steps, of which events cut `cut`, and evaluations, at a local tolerance; seconds: time that
    it took. reason: why another method takes less, in a sentence.
    """

    def __init__(self, end_time: float, steps: int, cut: int, evaluations: int, local: float) -> None:
        super().__init__(f"{cut} of {steps} steps end at events")
        self.end_time, self.steps, self.cut, self.evaluations, self.local = end_time, steps, cut, evaluations, local
        self.seconds, self.reason = 0.0, ""
