"""Find the least or the greatest value of a measure over an interval, by dividing it where a larger one is expected."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.samples import Sample

EXTREME_TOLERANCE = 1e-5  # of the range: accuracy of an extreme
NEAR_ENDS = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 1003)[1:-1])  # places in an interval, close by its ends
MAX_STEPS = 12  # towards one extreme
INWARD = 0.1  # of an interval: a sample nearer to its end would add little


def refine_extreme(
    course: MeasureCourse, direction: int, *, share: float = EXTREME_TOLERANCE, max_steps: int = MAX_STEPS
) -> float:
    """Sample where the least (direction -1) or the greatest (1) value of the course may be exceeded, until little can
    be gained.

    share: of the range of the course; a smaller gain is not worth a variant
    max_steps: limit of the samples

    Returns the gain that remains possible. Raises SampleLimitError.
    """
    gain = 0.0
    for step in range(max_steps + 1):
        best = find_extreme(course, direction)
        if best is None:
            return 0.0
        gain, place = max(
            (estimate_gain(course, i, best, direction) for i in iter_divisible(course)), default=(0.0, 0.0)
        )
        if gain <= max(best.error, share * course.gap_range):
            break
        if step < max_steps:
            course.sample_and_learn(place)
    return gain


def find_extreme(course: MeasureCourse, direction: int) -> Sample | None:
    """Return the least or the greatest known sample."""
    known = [sample for sample in course.samples if sample.gap is not None]
    return max(known, key=lambda sample: direction * sample.gap_or_zero, default=None)


def iter_divisible(course: MeasureCourse) -> Iterator[int]:
    """Yield the neighbours between which the course continues and can be sampled more finely."""
    for i, one, other in course.iter_pairs():
        if not course.is_interrupted(i) and other.x - one.x > 2.0 * course.finest:
            yield i


def estimate_gain(course: MeasureCourse, i: int, best: Sample, direction: int) -> tuple[float, float]:
    """Return by how much g may exceed its best between two neighbours at most, and where."""
    one, other = course.samples[i], course.samples[i + 1]
    peak = course.find_peak(i)
    if peak is not None and (peak.size == math.inf or direction * course.get_measure(one) > 0.0):
        gain = peak.size - direction * course.get_measure(best)
        if gain > 0.0:
            return gain, clip_inside(one, other, peak.place)
    expected = course.predict(i, one.x + NEAR_ENDS * (other.x - one.x))
    bound = direction * expected.gaps + expected.uncertainty
    k = int(np.argmax(bound))
    return float(bound[k] - direction * best.gap_or_zero), float(expected.places[k])


def clip_inside(one: Sample, other: Sample, x: float) -> float:
    """Return a place between two neighbours, not so near to one of them that its sample would add little."""
    inward = INWARD * (other.x - one.x)
    return min(max(x, one.x + inward), other.x - inward)
