"""What a spec expects to stay below or above a number: at all instants, also between the samples, unless it says which.

A vector counts by its magnitude, a run of cuts over its whole stretch, as with `--measure`. What stands at a bound is
neither below nor above it; what is open or not known meets none.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Place
from heuncli.results.results_paths import Numbers, find
from heuncli.results.results_schema import BLOWS
from heuncli.scene.file_format.models import Expect
from heuncli.study.ask.measure import MeasureRequest, Peak, peak, value
from heuncli.study.ask.study import Study

How = Literal["max", "min", "abs"]


class Bounded(NamedTuple):
    """The extreme that decides whether something stays within its bounds, and why it does not."""

    extreme: Peak
    failure: str | None


def bounded(study: Study, item: Expect) -> Bounded:
    """One expectation of bounds against the study; of two that are missed the first is told."""
    sides: list[tuple[How, float, float]] = []
    if item.below is not None:
        sides.append(("max", 1.0, item.below))
    if item.above is not None:
        sides.append(("min", -1.0, item.above))
    checked = [against(study, item, *side) for side in sides]
    return next((one for one in checked if one.failure is not None), checked[0])


def against(study: Study, item: Expect, how: How, sign: float, bound: float) -> Bounded:
    """Against one bound: what is to stay below it (sign 1), or above it (-1)."""
    there = find(study.results, item.of)
    found = extreme_of(study, item, how)
    word = "below" if sign > 0.0 else "above"
    if (missing := not_a_number(study, there, found)) is not None:
        return Bounded(found._replace(value=math.nan), missing)
    if sign * found.value < sign * bound:
        return Bounded(found, None)
    told = f"{name_of(item, how)}{found.value:.9g}{instant(found.at)}{located(found.place)}"
    return Bounded(found, f"{told}, is not {word} {bound:.9g}")


def not_a_number(study: Study, there: Numbers, found: Peak) -> str | None:
    """Why there is no number to hold against a bound: open, or beside a singular pose, at an instant at least."""
    if not there.values.size:
        return "there is none"
    at = found.at if math.isnan(found.value) else found.open_at
    if there.timed and at is None:
        gaps = np.flatnonzero(np.isnan(there.values.reshape(len(there.values), -1)).any(axis=1))
        at = float(study.results.time[gaps[0]]) if len(gaps) else None
    if at is None and not math.isnan(found.value):
        return None
    return f"not known{instant(at)}, beside a singular pose" if at in study.unknown else f"open{instant(at)}"


def extreme_of(study: Study, item: Expect, how: How) -> Peak:
    """The number that comes nearest to the bound: over the run, at the instant, or of what has no instants."""
    there = find(study.results, item.of)
    if there.keys[0] == BLOWS:
        return value(MeasureRequest("" if there.values.size == 1 else item.peak or how, item.of), study)
    if not there.timed:
        values = np.linalg.norm(there.values, axis=-1) if there.of_vectors else there.values
        if not values.size:
            return Peak(math.nan, None)
        return Peak(float(values.max() if how == "max" else values.min()), None)
    if item.at is None:
        return peak(study, item.of, item.peak or how)
    return peak(study, item.of, how, times=np.array([instant_near(study, item.at)]))


def instant_near(study: Study, at: float) -> float:
    """The instant of the output that is meant."""
    times = study.results.time
    return float(times[np.argmin(np.abs(times - at))])


def name_of(item: Expect, how: How) -> str:
    """Which extreme is told, in words."""
    if item.at is not None:
        return ""
    return {"max": "the largest, ", "min": "the least, ", "abs": "the largest magnitude, "}[item.peak or how]


def instant(at: float | None) -> str:
    """When, in words; nothing of what has no instant."""
    return "" if at is None else f" at t = {at:.6g} s"


def located(place: Place | None) -> str:
    """Where along a run of cuts, in words; nothing of what is not of one."""
    if place is None:
        return ""
    return f", s = {place.s:.6g} m" + (f" ({place.side})" if place.side else "")
