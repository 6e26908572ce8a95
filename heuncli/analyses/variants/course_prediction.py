"""Predict the course of a measure between two neighbouring samples, with an uncertainty.

Between two neighbours g is predicted by the cubic through them and one more on either side. Its uncertainty follows
from the parabolas that leave one of the four out, from the corner at which the lines through either two would meet (a
measure such as the largest of several bends there), and from how wrong earlier predictions were. Where the measure
spans several magnitudes, its logarithm or an inverse power of it is interpolated instead, if the parabolas agree better
with that.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from itertools import pairwise

import numpy as np

from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.samples import (
    LEFT,
    RIGHT,
    Sample,
    find_intersection,
    interpolate,
    interpolate_corner,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

PLACES = np.linspace(0.0, 1.0, 35)[1:-1]  # shares of an interval at which its course is predicted
NOISE = 8.0  # ratio to the errors of four samples of the difference that noise alone may cause between polynomials
MIN_UNCERTAINTY = 1e-3  # share of the range of the four samples by which the scan may miss a deviation from the cubic
MAX_DISTRUST = 16.0
LOG_RATIO = 4.0  # ratio of neighbouring magnitudes from which on their logarithms are interpolated
LARGEST_LOG = 690.0  # logarithm of a magnitude that does not overflow
POLE_POWERS = (1.0, 2.0)  # orders of poles towards which the measure may rise
TINY_INVERSE = 1e-3  # share of the least inverse measure of the samples: interpolated ones are no smaller


class CoursePrediction(NamedTuple):
    """The prediction at places between two neighbours: g (n,), its uncertainty (n,), and the noise.

    uncertainty: without the differences between polynomials that noise causes
    total_uncertainty (n,): with these, and the errors of the neighbours
    """

    places: Array
    gaps: Array
    uncertainty: Array
    noise: float
    total_uncertainty: Array


class Surroundings(NamedTuple):
    """The samples from which the course between two neighbours is predicted.

    samples: these two and up to two more, ascending
    parts: the same without the first, and without the last, where that leaves both neighbours
    is_two_sided: whether there is one more sample on either side
    """

    samples: list[Sample]
    parts: list[list[Sample]]
    is_two_sided: bool


class CourseModel(NamedTuple):
    """One way to interpolate the surroundings, each (n,): by all samples, by each part, and by a corner (or none)."""

    gaps: Array
    partial_gaps: list[Array]
    corners: list[Array]

    @property
    def disagreement(self) -> float:
        """The largest difference between the parts and the whole."""
        return float(np.max(np.abs(np.array(self.partial_gaps) - self.gaps)))

    @property
    def spread(self) -> Array:
        """The largest difference of parts and corner from the whole, at each place."""
        found: Array = np.max([np.abs(each - self.gaps) for each in (*self.partial_gaps, *self.corners)], axis=0)
        return found


def sample_and_learn(course: MeasureCourse, x: float) -> Sample:
    """Return the sample at a place between two neighbours, and raise the distrust if the prediction was too far off.

    Raises SampleLimitError.
    """
    i = bisect_left(course.samples, x, key=lambda sample: sample.x) - 1
    expected = predict_course(course, i, np.array([x]))
    new_sample = course.sample_at(x)
    if new_sample.gap is not None:
        gap, uncertainty = float(expected.gaps[0]), float(expected.uncertainty[0])
        excess = abs(new_sample.gap - gap) - new_sample.error - expected.noise
        if excess > uncertainty:
            course.distrust = min(
                2.0 * course.distrust * (excess / uncertainty if uncertainty else MAX_DISTRUST), MAX_DISTRUST
            )
    return new_sample


def predict_course(course: MeasureCourse, i: int, places: Array | None = None) -> CoursePrediction:
    """Predict the course between the i-th sample and the next; places: only there, otherwise at PLACES."""
    left, right = course.samples[i], course.samples[i + 1]
    surroundings = find_surroundings(course, i)
    x = left.x + PLACES * (right.x - left.x) if places is None else places
    if surroundings.is_two_sided and places is None:
        x = np.sort(np.append(x, find_intersection(*surroundings.samples)))
    noise = NOISE * max(sample.error for sample in surroundings.samples)
    if len(surroundings.samples) == 2:
        uncertainty = np.full(len(x), max(course.gap_range, left.distance, right.distance))
        return CoursePrediction(x, interpolate(surroundings.samples, x), uncertainty, noise, uncertainty)
    model = choose_model(course, surroundings, x)
    spread = model.spread
    known = [sample.gap_or_zero for sample in surroundings.samples]
    steps = (max(known) - min(known)) * (x - left.x) * (right.x - x) / course.spacing**2
    uncertainty, total = (
        course.distrust * np.maximum(each, MIN_UNCERTAINTY * steps)
        for each in (np.maximum(spread - noise, 0.0), spread)
    )
    return CoursePrediction(x, model.gaps, uncertainty, noise, total + max(left.error, right.error))


def find_surroundings(course: MeasureCourse, i: int) -> Surroundings:
    """Find the samples around the interval from the i-th sample to the next: one on either side, or two on one."""
    ends = course.samples[i], course.samples[i + 1]
    left, right = course.find_neighbours(i, LEFT), course.find_neighbours(i, RIGHT)
    samples = [*reversed(left[: 1 if right else 2]), *ends, *right[: 1 if left else 2]]
    parts = [part for part in (samples[:-1], samples[1:]) if ends[0] in part and ends[1] in part]
    return Surroundings(samples, parts, bool(left and right))


def choose_model(course: MeasureCourse, surroundings: Surroundings, x: Array) -> CourseModel:
    """Interpolate the surroundings in the way in which their parts agree best."""
    models = [interpolate_gaps(surroundings, x)]
    if spans_magnitudes(course, surroundings):
        models.append(interpolate_logarithms(course, surroundings, x))
        if course.value != 0.0:  # towards 0 the measure falls instead
            models.extend(interpolate_inverses(course, surroundings, x, power) for power in POLE_POWERS)
    return min(models, key=lambda model: model.disagreement)


def interpolate_gaps(surroundings: Surroundings, x: Array) -> CourseModel:
    """Interpolate g by polynomials."""
    gaps, *partial_gaps = (interpolate(part, x) for part in (surroundings.samples, *surroundings.parts))
    return CourseModel(gaps, partial_gaps, make_corners(surroundings, x, gaps))


def make_corners(surroundings: Surroundings, x: Array, gaps: Array) -> list[Array]:
    """Interpolate g by the lines through the two samples on either side; nothing without two there."""
    return (
        [interpolate_corner(surroundings.samples[:2], surroundings.samples[2:], x, gaps)]
        if surroundings.is_two_sided
        else []
    )


def spans_magnitudes(course: MeasureCourse, surroundings: Surroundings) -> bool:
    """Return whether the measure runs through several magnitudes, as towards a pole: then its logarithm is smoother.

    Not where it may touch a value at or beyond 0, which no logarithm reaches: towards a zero the logarithm falls
    ever faster, towards a pole it rises ever faster.
    """
    m = [course.get_measure(sample) for sample in surroundings.samples]
    if min(m) <= 0.0 <= max(m) or max(map(abs, m)) < LOG_RATIO * min(map(abs, m)):
        return False
    steps = [abs(b) - abs(a) for a, b in pairwise(m)]
    if course.value == 0.0 and not rises_convexly(surroundings.samples):
        return False
    return m[0] * course.value > 0.0 or (surroundings.is_two_sided and (min(steps) > 0.0 or max(steps) < 0.0))


def interpolate_logarithms(course: MeasureCourse, surroundings: Surroundings, x: Array) -> CourseModel:
    """Interpolate the logarithm of the measure by polynomials."""

    def interpolate_logarithm(samples: list[Sample]) -> Array:
        """Interpolate some samples; they have one sign."""
        sign = math.copysign(1.0, course.get_measure(samples[0]))
        logs = [sample._replace(gap=math.log(abs(course.get_measure(sample)))) for sample in samples]
        found: Array = sign * np.exp(np.minimum(interpolate(logs, x), LARGEST_LOG)) - course.value
        return found

    gaps, *partial_gaps = (interpolate_logarithm(part) for part in (surroundings.samples, *surroundings.parts))
    return CourseModel(gaps, partial_gaps, make_corners(surroundings, x, gaps))


def interpolate_inverses(course: MeasureCourse, surroundings: Surroundings, x: Array, power: float) -> CourseModel:
    """Interpolate |measure|^(-1/power) by polynomials, as near a pole of that order."""
    sign = math.copysign(1.0, course.get_measure(surroundings.samples[0]))
    inverses = {
        sample.x: sample._replace(gap=abs(course.get_measure(sample)) ** (-1.0 / power))
        for sample in surroundings.samples
    }
    least = TINY_INVERSE * min(inverse.gap_or_zero for inverse in inverses.values())

    def to_gaps(inverse: Array) -> Array:
        """Return g from the inverses."""
        found: Array = sign * np.maximum(inverse, least) ** -power - course.value
        return found

    samples, *parts = ([inverses[sample.x] for sample in part] for part in (surroundings.samples, *surroundings.parts))
    whole = interpolate(samples, x)
    corners = make_corners(Surroundings(samples, parts, surroundings.is_two_sided), x, whole)
    return CourseModel(
        to_gaps(whole), [to_gaps(interpolate(part, x)) for part in parts], [to_gaps(corner) for corner in corners]
    )


def rises_convexly(samples: list[Sample]) -> bool:
    """Return whether the slopes of the logarithm of |g| rise from sample to sample."""
    slopes = [(math.log(b.distance) - math.log(a.distance)) / (b.x - a.x) for a, b in pairwise(samples)]
    return all(before <= after for before, after in pairwise(slopes))
