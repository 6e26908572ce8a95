"""What a spec expects of its own results, compared (manual/format.md, "Expect")."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem, SourceLocation
from heuncli.base.records import record, replace
from heuncli.results.results import Array, Results
from heuncli.results.results_paths import find
from heuncli.scene.file_format.models import Expect
from heuncli.study.ask.measure import NOT_CLAIMED, MeasureRequest, Peak, lost_from, peak
from heuncli.study.ask.study import Study

if TYPE_CHECKING:
    from heuncli.study.ask.curves import CurveFound


@record
class Case:
    """One comparison: what was expected where, what was found (nan is open), and if they differ why that fails.

    extreme: of what is expected to stay below or above something, that which comes nearest to it. curve: of a measured
    curve its worst point, which expected and found are of.
    """

    location: SourceLocation
    of: str
    when: str
    expected: Array
    found: Array | None
    tolerance: float
    failure: str | None
    below: float | None = None
    above: float | None = None
    extreme: Peak | None = None
    curve: CurveFound | None = None

    @property
    def passed(self) -> bool:
        """Whether the expectation holds."""
        return self.failure is None

    @property
    def worst_point(self) -> dict[str, Any]:
        """Of a measured curve how many points lie outside, and where the worst of all stands."""
        keys = ("points", "outside", "at", "x", "file", "line")
        of = self.curve._asdict() if self.curve is not None else {}
        return {f"curve_{key}" if key in ("file", "line") else key: of[key] for key in keys if key in of}


def compare(study: Study, item: Expect) -> Case:
    """One expectation against the study."""
    expected = np.asarray(np.nan if item.is_ is None else _with_nan(item.is_), dtype=np.float64)
    if item.curve is not None:
        expected = np.array(item.curve.y)
    when = f"{item.peak} over the run" if item.peak else f"t = {item.at:.6g} s" if item.at is not None else ""
    when = when if item.curve is None else "curve"
    tolerance = _tolerance(expected, item.rel, item.abs)
    case = Case(item.location, item.of, when, expected, None, tolerance, None, item.below, item.above)
    try:
        horizon = _lost_from(study, item) if item.curve is None else None  # a curve may end before it
        if horizon is not None:
            return replace(case, failure=NOT_CLAIMED.format(horizon))
        if item.curve is not None:
            return _followed(case, study, item)
        if item.below is not None or item.above is not None:
            return _bounded(case, study, item)
        found = _found(study, item)
    except HeunError as error:
        problem = error.problems[0]  # what cannot be computed between the samples may have several
        return replace(case, failure=problem.message + (f" ({problem.hint})" if problem.hint else ""))
    return replace(case, found=found, failure=_failure(expected, found, tolerance))


def _bounded(case: Case, study: Study, item: Expect) -> Case:
    """The comparison of a number that is expected to stay below or above a bound."""
    from heuncli.study.ask.bounds import bounded  # that few specs have

    extreme, failure = bounded(study, item)
    return replace(case, found=np.asarray(extreme.value), failure=failure, extreme=extreme)


def _followed(case: Case, study: Study, item: Expect) -> Case:
    """The comparison of a number that is expected to follow a measured curve."""
    from heuncli.study.ask.curves import NotComparable, held_against  # as for bounds

    try:
        own = held_against(study, item, case.tolerance)
    except NotComparable as error:
        return replace(case, expected=error.expected, failure=error.problems[0].message)
    when = f"t = {own.at:.6g} s ({own.file}:{own.line})"
    expected, found = np.asarray(own.expected), np.asarray(own.found)
    return replace(case, when=when, expected=expected, found=found, failure=own.failure, curve=own)


def _found(study: Study, item: Expect) -> Array:
    results: Results = study.results
    if item.peak:
        return np.asarray(peak(study, item.of, item.peak).value)
    found = find(results, item.of)
    if not found.timed:
        return found.values
    if item.at is not None:
        return np.asarray(found.values[instant_among(results.time, item.at)])
    return found.values[0] if len(results.time) == 1 else found.values


def _lost_from(study: Study, item: Expect) -> float | None:
    """The horizon, where what is expected lies beyond it: nothing is told there, and no expectation met by luck."""
    how: Literal["abs", "at", ""] = "abs" if item.peak else "at" if item.at is not None else ""
    return lost_from(MeasureRequest(how, item.of, item.at), study)


def instant_among(times: Array, at: float) -> int:
    """The number of an instant of the output. Raises HeunError [no-such-instant]."""
    location = int(np.argmin(np.abs(times - at)))
    if abs(times[location] - at) > tolerances.SAME_INSTANT * max(float(np.ptp(times)), abs(at)):
        message = f"t = {at:.6g} s is not an instant of the output; the nearest is {times[location]:.6g} s"
        raise HeunError(Problem("no-such-instant", message, hint="the run ended before it, or others are asked for"))
    return location


def _failure(expected: Array, found: Array, tolerance: float) -> str | None:
    if found.shape != expected.shape:
        if expected.ndim == 0 and np.isnan(expected):
            if not found.size:
                return "expected open, there is none"
            expected = np.full(found.shape, np.nan)
        else:
            return f"{_size(expected)} expected, {_size(found)} found (give at, peak, or a component)"
    open_expected, open_found = np.isnan(expected), np.isnan(found)
    if (open_expected & ~open_found).any():
        known = int((open_expected & ~open_found).sum())
        hint = "is: null is all of it; in a list null is one place"
        return "expected open, found a number" if found.size == 1 else f"{known} of {found.size} are not open ({hint})"
    if (open_found & ~open_expected).any():
        return "open"
    if not open_expected.all():
        off = float(np.max(np.abs(found - expected)[~open_expected]))
        if not off <= tolerance:
            return f"off by {off:.3g}, allowed {tolerance:.3g}"
    return None


def _tolerance(expected: Array, rel: float | None, absolute: float | None) -> float:
    """rel is of the largest number expected."""
    scale = float(np.fmax.reduce(np.abs(expected), axis=None, initial=0.0))  # nan: expected to be open
    if rel is None and absolute is None:
        rel, absolute = tolerances.EXPECTED_RELATIVE, tolerances.EXPECTED_ABSOLUTE
    return max((rel or 0.0) * scale, absolute or 0.0)


def _with_nan(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_with_nan(member) for member in value]
    return np.nan if value is None else value


def _size(values: Array) -> str:
    return "one number" if values.ndim == 0 else f"a list of {len(values)}"
