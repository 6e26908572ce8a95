"""Find the least or the greatest value of a measure over an interval, by dividing it where a larger one is expected.

No polynomial follows a resonance or a pole. There 1/measure^2 is smooth: the parabola through its three values about a
largest magnitude shows how far that may grow between them, also without bounds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.course_prediction import NOISE, predict_course, sample_and_learn
from heuncli.analyses.variants.samples import Sample
from heuncli.base.named_tuples import NamedTuple

LEAST, GREATEST = -1, 1  # the extreme that is searched: the sign that makes it a maximum
EXTREME_TOLERANCE = 1e-5  # share of the range of the measure: accuracy of an extreme
NEAR_ENDS = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 1003)[1:-1])  # shares of an interval, dense near its ends
MAX_STEPS = 12  # towards one extreme
INWARD = 0.1  # share of an interval: a sample nearer to its end would add little
POLE_MARGIN = 0.5  # share of an interval by which a predicted pole may lie outside of it


class CoursePeak(NamedTuple):
    """Where the magnitude of the measure may be greatest between two neighbours, and how great (infinite at a pole)."""

    place: float
    size: float


def refine_extreme(
    course: MeasureCourse, direction: int, *, share: float = EXTREME_TOLERANCE, max_steps: int = MAX_STEPS
) -> float:
    """Sample where the extreme of the course may be exceeded, until little can be gained.

    direction: LEAST or GREATEST
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
            sample_and_learn(course, place)
    return gain


def find_extreme(course: MeasureCourse, direction: int) -> Sample | None:
    """Return the known sample with the LEAST or the GREATEST value; None if none is known."""
    known = [sample for sample in course.samples if sample.gap is not None]
    return max(known, key=lambda sample: direction * sample.gap_or_zero, default=None)


def iter_divisible(course: MeasureCourse) -> Iterator[int]:
    """Yield the neighbours between which the course continues and can be sampled more finely."""
    for i, left, right in course.iter_pairs():
        if not course.is_interrupted(i) and right.x - left.x > 2.0 * course.finest:
            yield i


def estimate_gain(course: MeasureCourse, i: int, best: Sample, direction: int) -> tuple[float, float]:
    """Return by how much g may exceed the best sample between the i-th sample and the next at most, and where."""
    left, right = course.samples[i], course.samples[i + 1]
    peak = find_peak(course, i)
    if peak is not None and (peak.size == math.inf or direction * course.get_measure(left) > 0.0):
        gain = peak.size - direction * course.get_measure(best)
        if gain > 0.0:
            return gain, clip_inside(left, right, peak.place)
    expected = predict_course(course, i, left.x + NEAR_ENDS * (right.x - left.x))
    bound = direction * expected.gaps + expected.uncertainty
    k = int(np.argmax(bound))
    return float(bound[k] - direction * best.gap_or_zero), float(expected.places[k])


def clip_inside(left: Sample, right: Sample, x: float) -> float:
    """Return a place between two neighbours, not so near to one of them that its sample would add little."""
    inward = INWARD * (right.x - left.x)
    return min(max(x, left.x + inward), right.x - inward)


def find_peak(course: MeasureCourse, i: int) -> CoursePeak | None:
    """Predict how far the magnitude of the measure may grow between a sample and the next; None: no sign of a
    peak.
    """
    if course.is_interrupted(i):
        return None
    left, right = course.samples[i], course.samples[i + 1]
    if course.get_measure_at(i) * course.get_measure_at(i + 1) < 0.0:
        place = find_pole(course, i)
        return None if place is None else CoursePeak(place, math.inf)
    peaks = [peak for k in (i, i + 1) if (peak := find_peak_at_sample(course, k)) is not None]
    inside = [peak for peak in peaks if left.x < peak.place < right.x]
    return max(inside, key=lambda peak: peak.size, default=None)


def find_peak_at_sample(course: MeasureCourse, k: int) -> CoursePeak | None:
    """Find the top of 1/measure^2 through a sample that is the largest of three."""
    if not 0 < k < len(course.samples) - 1 or course.is_interrupted(k - 1) or course.is_interrupted(k):
        return None
    x = [course.samples[j].x for j in (k - 1, k, k + 1)]
    m = [course.get_measure_at(j) for j in (k - 1, k, k + 1)]
    noise = NOISE * max(course.samples[j].error for j in (k - 1, k, k + 1))
    if m[0] * m[1] <= 0.0 or m[1] * m[2] <= 0.0 or abs(m[1]) - max(abs(m[0]), abs(m[2])) <= noise:
        return None
    y = [(m[1] / each) ** 2 for each in m]  # each relative to the middle one, so y[1] is 1
    before, after = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    bend = (after - before) / (x[2] - x[0])
    middle = before + bend * (x[1] - x[0])  # the slope at the sample
    place = x[1] - 0.5 * middle / bend
    minimum = 1.0 - 0.25 * middle * middle / bend
    return CoursePeak(place, abs(m[1]) / math.sqrt(minimum) if minimum > 0.0 else math.inf)


def find_pole(course: MeasureCourse, i: int) -> float | None:
    """Find where 1/measure passes 0 between two neighbours of different signs; None if neither side's rise predicts
    a pole.
    """
    left, right = course.samples[i], course.samples[i + 1]
    width = right.x - left.x
    a, b = course.get_measure_at(i), course.get_measure_at(i + 1)
    if not a * b < 0.0:
        return None
    a, b = 1.0 / a, 1.0 / b
    is_predicted = False
    for k, far in ((i, i - 1), (i + 1, i + 2)):
        if not 0 <= far < len(course.samples) or course.is_interrupted(min(k, far)):
            continue
        magnitude, outer_magnitude = course.get_measure_at(k), course.get_measure_at(far)
        if magnitude * outer_magnitude > 0.0 and abs(outer_magnitude) < abs(magnitude):
            fall = 1.0 / abs(outer_magnitude) - 1.0 / abs(magnitude)
            distance = abs(course.samples[k].x - course.samples[far].x) / abs(magnitude) / fall
            is_predicted = is_predicted or distance <= (1.0 + POLE_MARGIN) * width
    if not is_predicted:
        return None
    margin = 0.25 * course.finest
    return min(max(left.x + width * a / (a - b), left.x + margin), right.x - margin)
