"""The least and the greatest of a course: more places where one of them may be passed between two neighbours."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.analyses.variants.course import MeasureCourse, Sample

EXTREME = 1e-5  # of the range: how well an extreme is told
NEAR_ENDS = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 1003)[1:-1])  # places in an interval, close by its ends
MOST_STEPS = 12  # towards one extreme
INWARD = 0.1  # of an interval: a place nearer to its end than that would tell little


def refine_extreme(course: MeasureCourse, way: int, *, share: float = EXTREME, most: int = MOST_STEPS) -> float:
    """Ask where the least (way -1) or the greatest (1) of the course may be, until no more is to be expected.

    share: of the range, what is not worth a variant; most: places that are asked for. Returns what may still be gained.
    Raises SpentError.
    """
    gain = 0.0
    for _ in range(most + 1):
        best = extreme(course, way)
        if best is None:
            return 0.0
        gain, place = max((expected_gain(course, i, best, way) for i in goes_on(course)), default=(0.0, 0.0))
        if gain <= max(best.error, share * course.range):
            break
        if _ < most:
            course.look(place)
    return gain


def extreme(course: MeasureCourse, way: int) -> Sample | None:
    """The least or the greatest sample that is known."""
    known = [sample for sample in course.samples if sample.gap is not None]
    return max(known, key=lambda sample: way * (sample.gap or 0.0), default=None)


def goes_on(course: MeasureCourse) -> Iterator[int]:
    """The neighbours between which the course goes on, and is not yet told as finely as places are."""
    for i, one, other in course.pairs():
        if not course.parted(i) and other.x - one.x > 2.0 * course.finest:
            yield i


def expected_gain(course: MeasureCourse, i: int, best: Sample, way: int) -> tuple[float, float]:
    """By how much g may pass its best between two neighbours at most, and where."""
    one, other = course.samples[i], course.samples[i + 1]
    peak = course.peak(i)
    if peak is not None and (peak.size == math.inf or way * ((one.gap or 0.0) + course.value) > 0.0):
        gain = peak.size - way * ((best.gap or 0.0) + course.value)
        if gain > 0.0:
            return gain, place_inside(one, other, peak.place)
    expected = course.between(i, one.x + NEAR_ENDS * (other.x - one.x))
    most = way * expected.gaps + expected.off
    k = int(np.argmax(most))
    return float(most[k] - way * (best.gap or 0.0)), float(expected.places[k])


def place_inside(one: Sample, other: Sample, x: float) -> float:
    """A place between two neighbours, not so near to one of them that it would tell little."""
    inward = INWARD * (other.x - one.x)
    return min(max(x, one.x + inward), other.x - inward)
