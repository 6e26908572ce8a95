"""Curves over a run: choose the instants of one, find its lowest and highest values, compare it with a measured one.

The chosen instants bracket every summit. About a sample that is higher than its neighbours, the curve is approximated
by the parabola through the three samples. For a sine of amplitude 1 it adds up to c = step² / 8 to the sample, with an
error of 3/2 c². If it adds too much, more instants are needed.

A measured curve is compared at its own instants (manual/format.md, "Expect"). One over another number than time has the
instants at which the run has that number: they are found as roots between the samples, not interpolated.
"""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.models import Curve, Expect
from heuncli.study.queries.measure import NOT_CLAIMED, find_reports
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.crossings import Bracket, find_roots
from heuncli.study.search.grid import find_jump_sides, sort_distinct

MIN_CURVE_INSTANTS = 400  # instants of a curve: nearly two a pixel
MAX_SEARCH_INSTANTS = 4000  # largest number of the search's instants that a curve uses
# share of the largest value that a parabola adds between instants at most: its error is then 1.4e-3, a fifth of a pixel
MAX_ADDED = 0.03


def choose_curve_instants(study: Study, max_search_instants: int = MAX_SEARCH_INSTANTS) -> Array:
    """Choose the instants of curves, (n,) ascending, up to the horizon.

    max_search_instants: how many instants of the search for extremes are used at most
    """
    results = study.results
    times = results.time
    if study.has_one_instant:
        return times
    search_times = study.search_times
    if len(search_times) > max_search_instants:
        jumps = np.flatnonzero(find_jump_sides(search_times))
        selected = np.linspace(0, len(search_times) - 1, max_search_instants).round().astype(np.intp)
        search_times = search_times[sort_distinct(np.concatenate([selected, jumps, jumps + 1]))]
    even = np.linspace(times[0], times[-1], MIN_CURVE_INSTANTS)
    curve_times = sort_distinct(np.concatenate([times, search_times, even]))
    horizon = results.horizon
    return np.asarray(curve_times if horizon is None else curve_times[curve_times < horizon])


class CurveBounds(NamedTuple):
    """The lowest and highest value of curves, (k,) each.

    is_fine: whether the instants were close enough
    """

    low: Array
    high: Array
    is_fine: bool


def find_bounds(times: Array, values: Array, smooth: Mask, error: float) -> CurveBounds:
    """Return the bounds of curves (n_t, k) with a stated error; nan is unknown.

    smooth (n_t - 1, k): where neighbours are not the two sides of a jump
    """
    low, high = (side * _find_highest(times, side * values, smooth) for side in (-1.0, 1.0))
    all_unknown = np.isnan(values).all(axis=0)
    sampled = [np.where(all_unknown, np.nan, f(np.where(np.isnan(values), -side * np.inf, values), axis=0))
               for side, f in ((-1.0, np.min), (1.0, np.max))]  # fmt: skip
    added = np.fmax(sampled[0] - low, high - sampled[1])
    size = np.abs(np.where(np.isnan(values), 0.0, values)).max(initial=0.0)
    return CurveBounds(low, high, not bool((added > max(MAX_ADDED * size, error)).any()))


def _find_highest(times: Array, heights: Array, smooth: Mask) -> Array:
    """Return the highest value of each curve, including the summits of parabolas, (k,)."""
    known = np.where(np.isnan(heights), -np.inf, heights)
    top = known.max(axis=0)
    if len(times) > 2:
        left, right = (np.diff(times)[:-1, None], np.diff(times)[1:, None])
        with np.errstate(invalid="ignore", divide="ignore"):
            rises = np.diff(heights, axis=0) / np.diff(times)[:, None]
            up, down = rises[:-1], rises[1:]
            slope, bend = (up * right + down * left) / (left + right), (down - up) / (left + right)
            tops = heights[1:-1] - slope * slope / (4.0 * bend)
        summit = (up >= 0.0) & (down <= 0.0) & (bend < 0.0) & smooth[:-1] & smooth[1:]
        top = np.maximum(top, np.where(summit, tops, -np.inf).max(axis=0))
    return np.where(np.isneginf(top), np.nan, top)


def halve_steps(times: Array, jumps: Mask) -> Array:
    """Add the instants in the middle between neighbours, except between the two sides of a jump (n_t - 1,)."""
    return np.sort(np.concatenate([times, (0.5 * (times[1:] + times[:-1]))[~jumps]]))


class CurveComparison(NamedTuple):
    """A curve compared with the run, and its worst point.

    points, outside: number of points, and of those outside the tolerance
    expected_value, found_value: at the worst point
    at: its instant [s]
    x: its place on the curve
    file, line: where it stands in the file
    """

    points: int
    outside: int
    expected_value: float
    found_value: float
    at: float
    x: float
    file: str
    line: int
    failure: str | None


class NotComparable(HeunError):
    """The run has no number for a point of a curve; expected: the curve's value there, empty if no single point is at
    fault.
    """

    exit_code = 1

    def __init__(self, message: str, expected_value: float | None) -> None:
        super().__init__(Problem("curve-points", message, hint="leave out that point, or extend the run"))
        self.expected_values = np.asarray([] if expected_value is None else expected_value)


def compare_curve(study: Study, item: Expect, tolerance: float) -> CurveComparison:
    """Compare a curve with the run, each point within the tolerance. Raises NotComparable."""
    curve = item.curve
    assert curve is not None
    x, expected = np.array(curve.x), np.array(curve.y)
    times = find_curve_instants(study, curve, x)
    require_claimed(study, curve, times)
    found = sample_numbers(study, item.of, times)
    require_known(study, curve, item.of, times, found)
    deviation = np.abs(found - expected)
    worst, outside = int(np.argmax(deviation)), int((~(deviation <= tolerance)).sum())
    t = float(times[worst])
    failure = None
    # the quotient of two integers is the same double as a share such as 0.95 in a spec
    if (len(x) - outside) / len(x) < curve.within:
        failure = f"off by {deviation[worst]:.3g}, allowed {tolerance:.3g}; {outside} of {len(x)} points lie outside"
        failure += f" (within: {curve.within:g})" if curve.within < 1.0 else ""
    return CurveComparison(
        len(x), outside, float(expected[worst]), float(found[worst]), t, float(x[worst]),
        curve.file, curve.lines[worst], failure,
    )  # fmt: skip


def sample_numbers(study: Study, path: str, times: Array) -> Array:
    """Return the number at a path at any instants of the run, (n,); nan where it is indeterminate or unknown."""
    return sample_values(study, path, times).reshape(len(times))


def sample_values(study: Study, path: str, times: Array) -> Array:
    """Return the values at a path at any instants of the run, (n, ...); nan where they are indeterminate or unknown."""
    instants, most = sort_distinct(times), study.chunk_size
    reports = find_reports(path)
    parts = (instants[i : i + most] for i in range(0, len(instants), most))
    values = np.concatenate([find_values(study.compute_reports(t, reports or frozenset()), path).values for t in parts])
    return np.asarray(values[np.searchsorted(instants, times)])


def find_curve_instants(study: Study, curve: Curve, x: Array) -> Array:
    """Return the instants of the points, (n,). Raises NotComparable where the run has none."""
    run = study.results.time
    if curve.x_of is not None:
        return find_instants_of_values(study, curve, x)
    slack = tolerances.SAME_INSTANT * float(np.ptp(run))
    outside = (x < run[0] - slack) | (x > run[-1] + slack)
    if outside.any():
        i = int(outside.argmax())
        refuse(f"t = {x[i]:.6g} s is outside the run, which goes from {run[0]:.6g} to {run[-1]:.6g} s", curve, i)
    return np.clip(x, run[0], run[-1])


def find_instants_of_values(study: Study, curve: Curve, x: Array) -> Array:
    """Find the instants at which the curve's own x number has the values x, (n,).

    Raises NotComparable if that number does not only rise or only fall.
    """
    path = curve.x_of
    assert path is not None
    horizon, times = study.results.horizon, study.search_times
    times = times if horizon is None else times[times < horizon]
    q = sample_numbers(study, path, times)
    require_known(study, curve, path, times, q)
    sign = 1.0 if q[-1] >= q[0] else -1.0
    h = sign * q
    highest = np.maximum.accumulate(h)
    error = estimate_error(study, path, q)
    turned = highest - h > 2.0 * error
    if turned.any():
        refuse(
            f"{path} reverses by t = {times[int(turned.argmax())]:.6g} s: a curve over it is ambiguous in time",
            curve,
            None,
        )
    targets, slack = sign * x, max(error, tolerances.SAME_INSTANT * float(highest[-1] - highest[0]))
    outside = (targets < highest[0] - slack) | (targets > highest[-1] + slack)
    if outside.any():
        i = int(outside.argmax())
        what = NOT_CLAIMED.format(horizon) + ", and before " if horizon is not None else ""
        refuse(f"{what}{path} goes from {q[0]:.6g} to {q[-1]:.6g}, and never reaches {x[i]:.6g}", curve, i)
    require_one_instant(curve, path, times, highest, targets, error)
    k = np.searchsorted(highest, targets, side="right")
    crossing_times = np.where(k == 0, times[0], times[-1])
    inside = (k > 0) & (k < len(times))
    right = k[inside]
    left = right - 1
    jumps = find_jump_sides(times)[left]
    if jumps.any():
        j = int(np.flatnonzero(inside)[jumps.argmax()])
        refuse(f"{path} jumps past {x[j]:.6g} at t = {times[k[j]]:.6g} s", curve, j)
    bracket = Bracket(times[left], times[right], h[left], h[right])
    crossing_times[inside] = find_roots(lambda t: sign * sample_numbers(study, path, t), bracket, targets[inside])
    return np.asarray(crossing_times)


def estimate_error(study: Study, path: str, values: Array) -> float:
    """Return the error of a number of the results as tables state it; at least its rounding."""
    stated = float(np.nan_to_num(find_search_error(study, find_values(study.results, path).keys)))
    return max(stated, tolerances.WRITTEN * float(np.max(np.abs(values))))


def require_one_instant(curve: Curve, path: str, times: Array, highest: Array, targets: Array, error: float) -> None:
    """Refuse a number that rests at the value of a point. Raises NotComparable."""
    first = np.searchsorted(highest, targets - error, side="left")
    last = np.searchsorted(highest, targets + error, side="right") - 1
    is_interval = last > first
    duration = times[np.where(is_interval, last, 0)] - times[np.where(is_interval, first, 0)]
    is_long = duration > tolerances.CLAIMED * float(np.ptp(times))
    if is_long.any():
        i = int(is_long.argmax())
        refuse(f"{path} stays at {curve.x[i]:.6g} from t = {times[first[i]]:.6g} s on", curve, i)


def require_claimed(study: Study, curve: Curve, times: Array) -> None:
    """Refuse points beyond the horizon. Raises NotComparable."""
    horizon = study.results.horizon
    if horizon is not None and (times >= horizon).any():
        refuse(NOT_CLAIMED.format(horizon), curve, int((times >= horizon).argmax()))


def require_known(study: Study, curve: Curve, path: str, times: Array, values: Array) -> None:
    """Refuse instants at which a number is indeterminate, or too close to a singular pose. Raises NotComparable."""
    gaps: Mask = np.isnan(values)
    if gaps.any():
        i = int(gaps.argmax())
        why = f"{path} is open at t = {times[i]:.6g} s"
        if np.isin(times[i], study.resample(times[i : i + 1]).accuracy.get("unknown", [])):
            why = f"{path} is not known at t = {times[i]:.6g} s, near a singular position"
        refuse(why, curve, i if len(times) == len(curve.x) and path != curve.x_of else None)


def refuse(message: str, curve: Curve, i: int | None) -> NoReturn:
    """Raise NotComparable with the reason why a curve cannot be compared, and the point at fault if it is a single
    one.
    """
    if i is None:
        raise NotComparable(f"{message} ({curve.file})", None)
    raise NotComparable(f"{message} ({format_point(curve, i)})", curve.y[i])


def format_point(curve: Curve, i: int) -> str:
    """Format a point of a curve as file and line."""
    return f"{curve.file}:{curve.lines[i]}"
