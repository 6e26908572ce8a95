"""The options of one command beside the spec: which values they may have, and how they override the spec."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem, SpecError, UsageError
from heuncli.base.method_rows import canonical_name, find_method
from heuncli.base.records import record
from heuncli.base.spelling import find_similar
from heuncli.results.results import Array
from heuncli.results.results_schema import REPORTS, add_shared_reports
from heuncli.scene.file_format.methods import find_tolerance_problem, iter_method_problems
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.memory import MemoryBudget
from heuncli.study.model.selection import EntryKeys, Selection

T = TypeVar("T")


def require_choice(option: str, value: str, choices: Sequence[str]) -> str:
    """Return the value if it is one of the choices. Raises UsageError that lists them."""
    if value not in choices:
        similar = find_similar(value, choices)
        hint = f"did you mean {similar}?" if similar else f"for example {option} {choices[0]}"
        raise UsageError(Problem("bad-option", f"{option} {value}: expected {', '.join(choices)}", hint=hint))
    return value


def require_positive(option: str, value: float | None) -> float | None:
    """Return the value if it is a positive number, or None. Raises UsageError."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        message = f"{option} {value}: expected a positive number"
        raise UsageError(Problem("bad-option", message, hint=f"for example {option} 0.001, in s"))
    return value


def require_tolerance(value: float | None, dashes: str = "--") -> float | None:
    """Return the tolerance. Raises UsageError if it is out of the range that specs accept."""
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


@record
class Options:
    """Options of one command; None leaves the choice to the spec.

    requested_reports: names of reports, None for all
    entries: single entries of reports, in place of whole ones
    axes: of joint loads
    """

    tolerance: float | None = None
    method: str | None = None
    step: float | None = None  # of a method of fixed step [s]
    requested_reports: frozenset[str] | None = None
    entries: frozenset[EntryKeys] = frozenset()
    axes: str = "world"
    time_limit: float | None = None
    least_norm: bool = False
    reduce: bool = True  # whether a smaller scene may be solved where the results are the same
    memory_budget: MemoryBudget | None = None  # for the results; None: no limit
    in_parts: bool = False  # whether results of many instants may be kept in a file; possible if they are only exported
    load_seconds: float = 0.0  # time for reading the spec, for the block `work`

    @property
    def reports(self) -> frozenset[str]:
        """The reports that are composed."""
        return frozenset(REPORTS) if self.requested_reports is None else add_shared_reports(self.requested_reports)

    @property
    def selection(self) -> Selection:
        """The part of the results that is requested."""
        return Selection(self.reports, self.entries, self.axes)


def apply_options(spec: Spec, options: Options) -> Spec:
    """Return the spec with the tolerance, method and step of the options. The spec's own step is kept only for methods
    of fixed step.

    Raises SpecError where they do not go together.
    """
    analysis = spec.analysis
    method = analysis.method if options.method is None else options.method
    row = find_method(method)
    is_fixed = row is not None and row.steps == "fixed"
    step = options.step if options.step is not None or not (is_fixed or options.method is None) else analysis.step
    problems = [
        Problem(one.code, one.message, hint=one.hint) for one in iter_method_problems(method, step, analysis.duration)
    ]
    if problems:
        raise SpecError(*problems)
    analysis = analysis._replace(method=canonical_name(method), step=step)
    if options.tolerance is not None:
        analysis = analysis._replace(tolerance=options.tolerance, tolerance_given=True)
    return spec._replace(analysis=analysis)
