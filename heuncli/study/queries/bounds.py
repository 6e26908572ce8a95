"""Check the bounds that a spec expects of its results: `below` and `above`, over all instants, also between the
samples, unless it names one.

A vector counts by its magnitude, a series of cuts over its whole length, as with `--measure`. A value equal to a bound
is neither below nor above it; an indeterminate or unknown value meets no bound.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import CutPosition
from heuncli.results.results_paths import PathValues, find_values
from heuncli.results.results_schema import IMPULSES
from heuncli.scene.file_format.models import Expect
from heuncli.study.queries.measure import MeasureRequest, Peak, find_peak, measure_value
from heuncli.study.queries.study import Study

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
    """Say why there is no number to compare with a limit: at some instant it is indeterminate, or too close to a
    singular pose. None if there is one.
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
