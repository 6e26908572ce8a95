"""Check values given beside a spec: an option of the command line, or an argument in Python (`option` is its name)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem, UsageError
from heuncli.base.spelling import suggest
from heuncli.results.results import Array
from heuncli.scene.file_format.methods import find_tolerance_problem

T = TypeVar("T")


def require_choice(option: str, value: str, choices: Sequence[str]) -> str:
    """Return the value if it is one of the choices. Raises UsageError that lists them."""
    if value not in choices:
        hint = suggest(value, choices, "values")
        raise UsageError(Problem("bad-option", f"{option} {value}: known: {', '.join(choices)}", hint=hint))
    return value


def require_positive(option: str, value: float | None) -> float | None:
    """Return the value if it is a positive number, or None. Raises UsageError."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        message = f"{option} {value}: expected a positive number"
        raise UsageError(Problem("bad-option", message, hint=f"for example {option} 0.001, in s"))
    return value


def require_tolerance(value: float | None, dashes: str = "--") -> float | None:
    """Return the tolerance if it is one that can be met, by the same rule as in a spec, or None. Raises UsageError."""
    problem = find_tolerance_problem(value) if value is not None else None
    if problem is not None:
        raise UsageError(Problem("bad-option", f"{dashes}{problem.message}", hint=problem.hint))
    return value


def require_within_run(option: str, instants: Sequence[float], times: Array) -> Array:
    """Return instants that must lie within the run, (n,), in the given order, clipped to its ends.

    times (n_t,) ascending: the instants of the run. Raises UsageError.
    """
    slack = tolerances.SAME_INSTANT * float(np.ptp(times))
    for t in instants:
        if not times[0] - slack <= t <= times[-1] + slack:
            span = f"the run goes from {times[0]:.6g} to {times[-1]:.6g} s"
            message = span if len(times) > 1 else f"there is one instant, t = {times[0]:.6g} s"
            hint = f"leave {option} out" if len(times) == 1 else f"for example {option} {times[-1]:.6g}"
            hint += ", or a longer duration" if times[-1] < t < math.inf else ""
            raise UsageError(Problem("bad-option", f"{option} {t:.6g}: {message}", hint=hint))
    within: Array = np.clip(np.array(instants, dtype=np.float64), times[0], times[-1])
    return within


def collect_results(calls: Iterable[Callable[[], T]]) -> list[T]:
    """Return the results of all calls. Raises the first error, with the problems of all calls that fail."""
    results: list[T] = []
    errors: list[HeunError] = []
    for call in calls:
        try:
            results.append(call())
        except HeunError as error:
            errors.append(error)
    if errors:
        errors[0].replace_problems(*dict.fromkeys(problem for error in errors for problem in error.problems))
        raise errors[0]
    return results
