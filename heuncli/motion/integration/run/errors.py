"""How a run is left before its end: errors, and the reasons to begin it anew by another method."""

from __future__ import annotations

from heuncli.base.errors import Problem, SolveError
from heuncli.kernel.choose import steps as kernel
from heuncli.motion.integration.methods.method import Method
from heuncli.results.results import Array

TROUBLE = {
    kernel.CODES["collapsed"]: (
        "step-collapsed",
        "the step length fell to the rounding error of the time",
        "a load or a rate grows without bound there",
    ),
    kernel.CODES["not a number"]: (
        "not-a-number",
        "no finite acceleration exists beyond this instant",
        "look at the expressions and tables, and at points that coincide",
    ),
    kernel.CODES["closures lost"]: (
        "closure-lost",
        "the closed chains cannot be held together beyond this instant",
        "the mechanism locks or reaches the end of its range there",
    ),
    kernel.CODES["unsolved"]: (
        "stages-unsolved",
        "the equations of an implicit step are not solved: Newton's iteration does not contract",
        "a shorter step, or --method Radau9, which finds its own",
    ),
}


class ClosuresLost(SolveError):
    """A run that ended where its closed chains could not be held; passed: instants and states, failed: where, last."""

    def __init__(self, problem: Problem, *, passed: list[tuple[float, Array]], failed: float, last: float) -> None:
        super().__init__(problem)
        self.passed, self.failed, self.last = passed, failed, last


class Stiff(Exception):
    """A run that was left, for another method takes less; told: why, in a sentence; seconds: that it took."""

    def __init__(self, method: Method, told: str) -> None:
        super().__init__(told)
        self.method, self.told, self.seconds = method, told, 0.0


class Eventful(Exception):
    """A run that was left, for so many of its steps end at events that another method may take less, or no more do.

    reached [s] in so many steps, of which events cut so many, and evaluations, at a local tolerance; seconds: that it
    took. told: why another method takes less, in a sentence.
    """

    def __init__(self, reached: float, steps: int, cut: int, evaluations: int, local: float) -> None:
        super().__init__(f"{cut} of {steps} steps end at events")
        self.reached, self.steps, self.cut, self.evaluations, self.local = reached, steps, cut, evaluations, local
        self.seconds, self.told = 0.0, ""
