"""What is asked for beside a spec, judged: a word of the command line, or an argument in Python (`option` names it)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem, UsageError
from heuncli.base.nearest import did_you_mean
from heuncli.results.results import Array
from heuncli.scene.file_format.methods import unfit_tolerance

T = TypeVar("T")


def choice(option: str, value: str, known: Sequence[str]) -> str:
    """The value if it is one of the known ones, else a UsageError that lists them."""
    if value not in known:
        hint = did_you_mean(value, known, "values")
        raise UsageError(Problem("bad-option", f"{option} {value}: known: {', '.join(known)}", hint=hint))
    return value


def positive(option: str, value: float | None) -> float | None:
    """The value if it is a positive number or not given."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        message = f"{option} {value}: expected a positive number"
        raise UsageError(Problem("bad-option", message, hint=f"such as {option} 0.001, in s"))
    return value


def tolerance(value: float | None, dashes: str = "--") -> float | None:
    """The tolerance if it is one that can be met, as in a spec, or not given."""
    found = unfit_tolerance(value) if value is not None else None
    if found is not None:
        raise UsageError(Problem("bad-option", f"{dashes}{found.message}", hint=found.hint))
    return value


def within_run(option: str, asked: Sequence[float], times: Array) -> Array:
    """The instants asked for, which must lie within the run, (n,) ascending, as they are given.

    times (n_t,) ascending: those of the run. Raises UsageError.
    """
    slack = tolerances.SAME_INSTANT * float(np.ptp(times))
    for t in asked:
        if not times[0] - slack <= t <= times[-1] + slack:
            span = f"the run goes from {times[0]:.6g} to {times[-1]:.6g} s"
            message = span if len(times) > 1 else f"there is one instant, t = {times[0]:.6g} s"
            hint = f"leave {option} out" if len(times) == 1 else f"such as {option} {times[-1]:.6g}"
            hint += ", or a longer duration" if times[-1] < t < math.inf else ""
            raise UsageError(Problem("bad-option", f"{option} {t:.6g}: {message}", hint=hint))
    within: Array = np.clip(np.array(asked, dtype=np.float64), times[0], times[-1])
    return within


def all_or_errors(calls: Iterable[Callable[[], T]]) -> list[T]:
    """What all of them give. Raises what the first that fails raises, with the problems of all that do."""
    given: list[T] = []
    errors: list[HeunError] = []
    for call in calls:
        try:
            given.append(call())
        except HeunError as error:
            errors.append(error)
    if errors:
        errors[0].tell(*dict.fromkeys(problem for error in errors for problem in error.problems))
        raise errors[0]
    return given
