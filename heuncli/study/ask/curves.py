"""A measured curve against the run, at the curve's own instants (manual/format.md, "Expect").

Where the curve is told over another number than time, its instants are those at which the run has that number: found as
roots between the samples, not read off a line through them.
"""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.results.results_paths import find
from heuncli.scene.file_format.models import Curve, Expect
from heuncli.study.ask.measure import NOT_CLAIMED, report_of, stated_error
from heuncli.study.ask.study import Study
from heuncli.study.search.crossings import Bracket, roots
from heuncli.study.search.extremes import distinct, sides_of_jumps


class CurveFound(NamedTuple):
    """A curve held against the run: its points, how many lie outside, and the worst of them: expected and found there,
    its instant, its place on the curve and its line in the file."""

    points: int
    outside: int
    expected: float
    found: float
    at: float
    x: float
    file: str
    line: int
    failure: str | None


class NotComparable(HeunError):
    """A point of a curve for which the run has no number; expected: what stands there, or at no one point."""

    exit_code = 1

    def __init__(self, message: str, expected: float | None) -> None:
        super().__init__(Problem("curve-points", message, hint="leave that point out, or let the run go there"))
        self.expected = np.asarray([] if expected is None else expected)


def held_against(study: Study, item: Expect, tolerance: float) -> CurveFound:
    """A curve against the run, each point within the tolerance. Raises NotComparable."""
    curve = item.curve
    assert curve is not None
    x, expected = np.array(curve.x), np.array(curve.y)
    times = instants_of(study, curve, x)
    require_claimed(study, curve, times)
    found = numbers_at(study, item.of, times)
    require_known(study, curve, item.of, times, found)
    off = np.abs(found - expected)
    worst, outside = int(np.argmax(off)), int((~(off <= tolerance)).sum())
    t = float(times[worst])
    failure = None
    # the quotient of two whole numbers is the double that a share such as 0.95 is read as
    if (len(x) - outside) / len(x) < curve.within:
        failure = f"off by {off[worst]:.3g}, allowed {tolerance:.3g}; {outside} of {len(x)} points lie outside"
        failure += f" (within: {curve.within:g})" if curve.within < 1.0 else ""
    return CurveFound(
        len(x), outside, float(expected[worst]), float(found[worst]), t, float(x[worst]),
        curve.file, curve.lines[worst], failure,
    )  # fmt: skip


def numbers_at(study: Study, path: str, times: Array) -> Array:
    """The number at a path at any instants of the run, (n,); nan where it is open or not known."""
    return values_at(study, path, times).reshape(len(times))


def values_at(study: Study, path: str, times: Array) -> Array:
    """What stands at a path at any instants of the run, (n, ...); nan where it is open or not known."""
    instants, most = distinct(times), study.instants_at_once
    wanted = report_of(path)
    parts = (instants[i : i + most] for i in range(0, len(instants), most))
    values = np.concatenate([find(study.reports_at(t, wanted or frozenset()), path).values for t in parts])
    return np.asarray(values[np.searchsorted(instants, times)])


def instants_of(study: Study, curve: Curve, x: Array) -> Array:
    """The instants of the points, (n,). Raises NotComparable where the run has none."""
    run = study.results.time
    if curve.x_of is not None:
        return instants_where(study, curve, x)
    slack = tolerances.SAME_INSTANT * float(np.ptp(run))
    outside = (x < run[0] - slack) | (x > run[-1] + slack)
    if outside.any():
        i = int(outside.argmax())
        refuse(f"t = {x[i]:.6g} s is out of the run, which goes from {run[0]:.6g} to {run[-1]:.6g} s", curve, i)
    return np.clip(x, run[0], run[-1])


def instants_where(study: Study, curve: Curve, x: Array) -> Array:
    """The instants at which the number that x is of has its values, (n,), where it rises or falls all the time."""
    path = curve.x_of
    assert path is not None
    horizon, times = study.results.horizon, study.search_times
    times = times if horizon is None else times[times < horizon]
    q = numbers_at(study, path, times)
    require_known(study, curve, path, times, q)
    sign = 1.0 if q[-1] >= q[0] else -1.0
    h = sign * q
    highest = np.maximum.accumulate(h)
    error = error_of(study, path, q)
    turned = highest - h > 2.0 * error
    if turned.any():
        refuse(
            f"{path} turns back by t = {times[int(turned.argmax())]:.6g} s: a curve over it has no one instant",
            curve,
            None,
        )
    wanted, slack = sign * x, max(error, tolerances.SAME_INSTANT * float(highest[-1] - highest[0]))
    outside = (wanted < highest[0] - slack) | (wanted > highest[-1] + slack)
    if outside.any():
        i = int(outside.argmax())
        what = NOT_CLAIMED.format(horizon) + ", and before " if horizon is not None else ""
        refuse(f"{what}{path} goes from {q[0]:.6g} to {q[-1]:.6g}, and is never {x[i]:.6g}", curve, i)
    require_one_instant(curve, path, times, highest, wanted, error)
    k = np.searchsorted(highest, wanted, side="right")
    at = np.where(k == 0, times[0], times[-1])
    inside = (k > 0) & (k < len(times))
    right = k[inside]
    left = right - 1
    jumps = sides_of_jumps(times)[left]
    if jumps.any():
        j = int(np.flatnonzero(inside)[jumps.argmax()])
        refuse(f"{path} jumps past {x[j]:.6g} at t = {times[k[j]]:.6g} s", curve, j)
    bracket = Bracket(times[left], times[right], h[left], h[right])
    at[inside] = roots(lambda t: sign * numbers_at(study, path, t), bracket, wanted[inside])
    return np.asarray(at)


def error_of(study: Study, path: str, values: Array) -> float:
    """The error of a number of the results, as tables state it; of what is solved exactly its roundings."""
    stated = float(np.nan_to_num(stated_error(study, find(study.results, path).keys)))
    return max(stated, tolerances.WRITTEN * float(np.max(np.abs(values))))


def require_one_instant(curve: Curve, path: str, times: Array, highest: Array, wanted: Array, error: float) -> None:
    """Refuse what stands still where it has the value of a point. Raises NotComparable."""
    first = np.searchsorted(highest, wanted - error, side="left")
    last = np.searchsorted(highest, wanted + error, side="right") - 1
    both = last > first
    stands = times[np.where(both, last, 0)] - times[np.where(both, first, 0)]
    stands_long = stands > tolerances.CLAIMED * float(np.ptp(times))
    if stands_long.any():
        i = int(stands_long.argmax())
        refuse(f"{path} stands still at {curve.x[i]:.6g} from t = {times[first[i]]:.6g} s on", curve, i)


def require_claimed(study: Study, curve: Curve, times: Array) -> None:
    """Refuse points beyond the horizon. Raises NotComparable."""
    horizon = study.results.horizon
    if horizon is not None and (times >= horizon).any():
        refuse(NOT_CLAIMED.format(horizon), curve, int((times >= horizon).argmax()))


def require_known(study: Study, curve: Curve, path: str, times: Array, values: Array) -> None:
    """Refuse instants at which a number is open, or beside a singular pose. Raises NotComparable."""
    gaps: Mask = np.isnan(values)
    if gaps.any():
        i = int(gaps.argmax())
        why = f"{path} is open at t = {times[i]:.6g} s"
        if np.isin(times[i], study.resample(times[i : i + 1]).accuracy.get("unknown", [])):
            why = f"{path} is not known at t = {times[i]:.6g} s, beside a singular pose"
        refuse(why, curve, i if len(times) == len(curve.x) and path != curve.x_of else None)


def refuse(message: str, curve: Curve, i: int | None) -> NoReturn:
    """Tell why a curve cannot be compared, and at which of its points if it is one. Raises NotComparable."""
    if i is None:
        raise NotComparable(f"{message} ({curve.file})", None)
    raise NotComparable(f"{message} ({place(curve, i)})", curve.y[i])


def place(curve: Curve, i: int) -> str:
    """A point of a curve by its line."""
    return f"{curve.file}:{curve.lines[i]}"
