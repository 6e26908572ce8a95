"""Compare the results with what the spec expects of them: values, curves and bounds (manual/format.md, "Expect").

A vector counts by its magnitude, a series of cuts over its whole length, as with `--measure`. A value equal to a bound
is neither below nor above it; an indeterminate or unknown value meets no bound.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.results.results import Array, CutPosition, Results
from heuncli.results.results_paths import PathValues, find_values
from heuncli.results.results_schema import IMPULSES
from heuncli.scene.file_format.models import Expect
from heuncli.study.queries.measure import (
    NOT_CLAIMED,
    MeasureRequest,
    Peak,
    find_exceeded_horizon,
    find_peak,
    measure_value,
)
from heuncli.study.queries.study import Study

if TYPE_CHECKING:
    from heuncli.study.queries.curves import CurveComparison


@record
class Case:
    """One comparison of an expected with a found value.

    expected_values, found_values: nan is indeterminate; for a measured curve they are those of its worst point
    failure: why they differ too much, or None
    extreme: of an expectation `below` or `above`, the extreme that comes nearest to the bound
    curve: of a measured curve, the comparison of all its points
    """

    location: SourceLocation
    path: str
    when: str
    expected_values: Array
    found_values: Array | None
    tolerance: float
    failure: str | None
    upper_bound: float | None = None
    lower_bound: float | None = None
    extreme: Peak | None = None
    curve: CurveComparison | None = None

    @property
    def is_met(self) -> bool:
        """Whether the expectation holds."""
        return self.failure is None

    @property
    def worst_point(self) -> dict[str, Any]:
        """The worst point of a measured curve, and how many points lie outside; empty for other expectations."""
        keys = ("points", "outside", "at", "x", "file", "line")
        values = self.curve._asdict() if self.curve is not None else {}
        return {f"curve_{key}" if key in ("file", "line") else key: values[key] for key in keys if key in values}


def compare(study: Study, item: Expect) -> Case:
    """Compare one expectation with the study."""
    expected = np.asarray(np.nan if item.is_ is None else _null_to_nan(item.is_), dtype=np.float64)
    if item.curve is not None:
        expected = np.array(item.curve.y)
    when = f"{item.peak} over the run" if item.peak else f"t = {item.at:.6g} s" if item.at is not None else ""
    when = when if item.curve is None else "curve"
    tolerance = _compute_tolerance(expected, item.rel, item.abs)
    case = Case(item.location, item.of, when, expected, None, tolerance, None, item.below, item.above)
    try:
        horizon = _find_exceeded_horizon(study, item) if item.curve is None else None  # a curve may end before it
        if horizon is not None:
            return replace(case, failure=NOT_CLAIMED.format(horizon))
        if item.curve is not None:
            return _compare_curve(case, study, item)
        if item.below is not None or item.above is not None:
            return _compare_bounds(case, study, item)
        found = _find_values(study, item)
    except HeunError as error:
        problem = error.problems[0]  # a number that cannot be computed between the samples may have several
        return replace(case, failure=problem.message + (f" ({problem.hint})" if problem.hint else ""))
    return replace(case, found_values=found, failure=_describe_failure(expected, found, tolerance))


def _compare_bounds(case: Case, study: Study, item: Expect) -> Case:
    """Compare a number that is expected to stay below or above a bound."""

    extreme, failure = check_bounds(study, item)
    return replace(case, found_values=np.asarray(extreme.value), failure=failure, extreme=extreme)


def _compare_curve(case: Case, study: Study, item: Expect) -> Case:
    """Compare a number that is expected to follow a measured curve."""
    from heuncli.study.queries.curves import NotComparable, compare_curve  # as for bounds

    try:
        comparison = compare_curve(study, item, case.tolerance)
    except NotComparable as error:
        return replace(case, expected_values=error.expected_values, failure=error.problems[0].message)
    when = f"t = {comparison.at:.6g} s ({comparison.file}:{comparison.line})"
    expected, found = np.asarray(comparison.expected_value), np.asarray(comparison.found_value)
    return replace(
        case, when=when, expected_values=expected, found_values=found, failure=comparison.failure, curve=comparison
    )


def _find_values(study: Study, item: Expect) -> Array:
    """Return the values that an expectation is about, at its instant."""
    results: Results = study.results
    if item.peak:
        return np.asarray(find_peak(study, item.of, item.peak).value)
    found = find_values(results, item.of)
    if not found.is_timed:
        return found.values
    if item.at is not None:
        return np.asarray(found.values[find_instant_index(results.time, item.at)])
    return found.values[0] if len(results.time) == 1 else found.values


def _find_exceeded_horizon(study: Study, item: Expect) -> float | None:
    """Return the horizon if the expected number lies beyond it, so that no expectation is met by chance; otherwise
    None.
    """
    how: Literal["abs", "at", ""] = "abs" if item.peak else "at" if item.at is not None else ""
    return find_exceeded_horizon(MeasureRequest(how, item.of, item.at), study)


def find_instant_index(times: Array, time: float) -> int:
    """Return the index of an instant of the output. Raises HeunError [no-such-instant]."""
    location = int(np.argmin(np.abs(times - time)))
    if abs(times[location] - time) > tolerances.SAME_INSTANT * max(float(np.ptp(times)), abs(time)):
        message = f"t = {time:.6g} s is not an output time; the nearest is {times[location]:.6g} s"
        raise HeunError(
            Problem("no-such-instant", message, hint="the run ended before it, or other times are requested")
        )
    return location


def _describe_failure(expected_values: Array, found_values: Array, tolerance: float) -> str | None:
    """Describe what differs by more than the tolerance; None if nothing does."""
    if found_values.shape != expected_values.shape:
        if expected_values.ndim == 0 and np.isnan(expected_values):
            if not found_values.size:
                return "expected open, there is no value"
            expected_values = np.full(found_values.shape, np.nan)
        else:
            return (
                f"{_describe_size(expected_values)} expected, {_describe_size(found_values)} found (give "
                "at, peak, or a component)"
            )
    open_expected, open_found = np.isnan(expected_values), np.isnan(found_values)
    if (open_expected & ~open_found).any():
        known = int((open_expected & ~open_found).sum())
        hint = "is: null means all of them; in a list null means one"
        return (
            "expected open, found a number"
            if found_values.size == 1
            else f"{known} of {found_values.size} are not open ({hint})"
        )
    if (open_found & ~open_expected).any():
        return "open"
    if not open_expected.all():
        deviation = float(np.max(np.abs(found_values - expected_values)[~open_expected]))
        if not deviation <= tolerance:
            return f"off by {deviation:.3g}, allowed {tolerance:.3g}"
    return None


def _compute_tolerance(expected_values: Array, rel: float | None, absolute: float | None) -> float:
    """Return the absolute tolerance; `rel` is relative to the largest expected number."""
    scale = float(np.fmax.reduce(np.abs(expected_values), axis=None, initial=0.0))  # nan: expected to be open
    if rel is None and absolute is None:
        rel, absolute = tolerances.EXPECTED_RELATIVE, tolerances.EXPECTED_ABSOLUTE
    return max((rel or 0.0) * scale, absolute or 0.0)


def _null_to_nan(value: Any) -> Any:
    """Return nested lists with nan in place of None."""
    if isinstance(value, (list, tuple)):
        return [_null_to_nan(member) for member in value]
    return np.nan if value is None else value


def _describe_size(values: Array) -> str:
    """Describe how many numbers there are."""
    return "one number" if values.ndim == 0 else f"a list of {len(values)}"


How = Literal["max", "min", "abs"]


class BoundCheck(NamedTuple):
    """The extreme that decides whether a number stays within its bounds, and the reason if it does not."""

    extreme: Peak
    failure: str | None


def check_bounds(study: Study, item: Expect) -> BoundCheck:
    """Check one expectation of bounds against the study. If both bounds are missed, the result is that of `below`."""
    sides: list[tuple[How, float, float]] = []
    if item.below is not None:
        sides.append(("max", 1.0, item.below))
    if item.above is not None:
        sides.append(("min", -1.0, item.above))
    checks = [check_bound(study, item, *side) for side in sides]
    return next((one for one in checks if one.failure is not None), checks[0])


def check_bound(study: Study, item: Expect, how: How, sign: float, limit: float) -> BoundCheck:
    """Check against one limit: the number has to stay below it (sign 1), or above it (-1)."""
    numbers = find_values(study.results, item.of)
    found = find_extreme(study, item, how)
    word = "below" if sign > 0.0 else "above"
    if (missing := find_missing_reason(study, numbers, found)) is not None:
        return BoundCheck(found._replace(value=math.nan), missing)
    if sign * found.value < sign * limit:
        return BoundCheck(found, None)
    extreme_text = (
        f"{describe_extreme(item, how)}{found.value:.9g}{format_instant(found.time)}{format_place(found.place)}"
    )
    return BoundCheck(found, f"{extreme_text}, is not {word} {limit:.9g}")


def find_missing_reason(study: Study, numbers: PathValues, extreme: Peak) -> str | None:
    """Say why there is no number to compare with a limit; None if there is one.

    At some instant it is indeterminate, or too close to a singular pose.
    """
    if not numbers.values.size:
        return "there is no value"
    time = extreme.time if math.isnan(extreme.value) else extreme.open_at
    if numbers.is_timed and time is None:
        gaps = np.flatnonzero(np.isnan(numbers.values.reshape(len(numbers.values), -1)).any(axis=1))
        time = float(study.results.time[gaps[0]]) if len(gaps) else None
    if time is None and not math.isnan(extreme.value):
        return None
    return (
        f"not known{format_instant(time)}, near a singular position"
        if time in study.unknown
        else f"open{format_instant(time)}"
    )


def find_extreme(study: Study, item: Expect, how: How) -> Peak:
    """Find the value that comes nearest to the bound: over the run, at the instant, or of results without instants."""
    numbers = find_values(study.results, item.of)
    if numbers.keys[0] == IMPULSES:
        return measure_value(MeasureRequest("" if numbers.values.size == 1 else item.peak or how, item.of), study)
    if not numbers.is_timed:
        values = np.linalg.norm(numbers.values, axis=-1) if numbers.is_vector else numbers.values
        if not values.size:
            return Peak(math.nan, None)
        return Peak(float(values.max() if how == "max" else values.min()), None)
    if item.at is None:
        return find_peak(study, item.of, item.peak or how)
    return find_peak(study, item.of, how, times=np.array([find_nearest_instant(study, item.at)]))


def find_nearest_instant(study: Study, time: float) -> float:
    """Return the instant of the output that is nearest to a time."""
    times = study.results.time
    return float(times[np.argmin(np.abs(times - time))])


def describe_extreme(item: Expect, how: How) -> str:
    """Say which extreme is compared, in words."""
    if item.at is not None:
        return ""
    return {"max": "the largest, ", "min": "the smallest, ", "abs": "the largest magnitude, "}[item.peak or how]


def format_instant(time: float | None) -> str:
    """Format an instant as the end of a phrase; empty for None."""
    return "" if time is None else f" at t = {time:.6g} s"


def format_place(place: CutPosition | None) -> str:
    """Format a place along a series of cuts as the end of a phrase; empty for None."""
    if place is None:
        return ""
    return f", s = {place.s:.6g} m" + (f" ({place.side})" if place.side else "")
