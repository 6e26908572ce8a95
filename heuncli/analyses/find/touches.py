"""Find touches of the value, which the samples of a measure may hide.

Where g and its error both go to 0, |g| may stay above its error, so that no sample meets the value. A sample counts as
a touch if |g| doubles on both sides within a few smallest distances of places. Towards it |g| is followed as a power:
    |g| = a |x - c|^p        c from the neighbours on both sides, p such that the sample between them fits
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from operator import attrgetter

from heuncli.analyses.variants.course import FIRST_DISTRUST, MeasureCourse
from heuncli.analyses.variants.course_prediction import NOISE, sample_and_learn
from heuncli.analyses.variants.samples import AT_VALUE, LEFT, RIGHT, Sample
from heuncli.base import tolerances

POWERS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)  # values of p that are tried
MAX_MISFIT = 3.0  # largest ratio between the middle sample and its prediction by the power
MIN_GAIN = 0.5  # largest ratio of |g| after a useful step to |g| before, and of a minimum to its neighbours
MAX_STEPS = 60  # steps towards one touch
TOUCH_RISE = 2.0  # ratio by which |g| rises on both sides of a touch
CLEAR_OF_VALUE = 2.0 * NOISE  # ratio of |g| to its error at a sample next to one that meets the value
MAX_POWER_CHANGE = 0.1  # relative change of the power outside of two samples that is permitted at the first distrust
MIN_END_DISTANCE = 0.25  # smallest distance of a place from the end of its interval, in finest distances


def find_touches(course: MeasureCourse) -> None:
    """Follow every local minimum of the distance from the value that may be zero. Raises SampleLimitError."""
    for x in [middle.x for left, middle, right in iter_minima(course) if is_deep(left, middle, right)]:
        follow_minimum(course, x)


def is_deep(left: Sample, middle: Sample, right: Sample) -> bool:
    """Return whether |g| falls at the middle sample by far more than its error, which is itself far below |g|."""
    return NOISE * middle.error < middle.distance <= MIN_GAIN * max(left.distance, right.distance)


def iter_minima(course: MeasureCourse) -> Iterator[tuple[Sample, Sample, Sample]]:
    """Yield each three adjacent samples, all on the same side of the value, whose middle one is nearest to it."""
    for i in range(1, len(course.samples) - 1):
        if course.is_interrupted(i - 1) or course.is_interrupted(i):
            continue
        left, middle, right = course.samples[i - 1 : i + 2]
        if (
            middle.side
            and left.side == middle.side == right.side
            and middle.distance < min(left.distance, right.distance)
        ):
            yield left, middle, right


def follow_minimum(course: MeasureCourse, x: float) -> None:
    """Move to the place where |g| is smallest, as long as it may be a touch. Raises SampleLimitError."""
    for _ in range(MAX_STEPS):
        minimum = next((each for each in iter_minima(course) if each[1].x == x), None)
        if minimum is None:
            return
        left, middle, right = minimum
        predicted = predict_minimum(left, middle, right)
        is_there = predicted is None or abs(predicted - middle.x) <= tolerances.TOUCH_DOUBLES * course.finest
        if is_there and is_narrow(course, left, middle, right):
            confirm_touch(course, middle)
            return
        if predicted is None:
            return
        margin = MIN_END_DISTANCE * course.finest
        sample = course.sample_at(min(max(predicted, left.x + margin), right.x - margin))
        if sample.gap is None or sample.side != middle.side:
            return
        # A known place gives the same sample again.
        if sample.distance > MIN_GAIN * middle.distance and sample is not middle:  # then halve the wider interval
            is_left_wider = abs(left.x - middle.x) > abs(right.x - middle.x)
            sample = course.sample_at(0.5 * (middle.x + (left.x if is_left_wider else right.x)))
            if sample.gap is None or sample.side != middle.side:
                return
        x = min((left, middle, right, sample), key=attrgetter("distance")).x


def is_narrow(course: MeasureCourse, left: Sample, middle: Sample, right: Sample) -> bool:
    """Return whether |g| may double within the smallest distance of places, by the chords."""
    chord = max(
        (left.distance - middle.distance) / (middle.x - left.x),
        (right.distance - middle.distance) / (right.x - middle.x),
    )
    return chord * course.finest >= middle.distance


def confirm_touch(course: MeasureCourse, middle: Sample) -> None:
    """Evaluate both sides of a place, at twice the smallest distance. Raises SampleLimitError."""
    for offset in (-2.0, 2.0):
        x = middle.x + offset * course.finest
        if course.low < x < course.high:
            sample_and_learn(course, x)


def find_touch_range(course: MeasureCourse, middle: Sample) -> tuple[float, float] | None:
    """Return the range in which a sample is a touch; None if it is none.

    It is a touch if |g| doubles on both sides within a few smallest distances.
    """
    i = course.samples.index(middle)
    ends: list[float] = []
    for direction in (LEFT, RIGHT):
        for sample in course.iter_outward(i, direction):
            if abs(sample.x - middle.x) > tolerances.TOUCH_DOUBLES * course.finest or sample.side != middle.side:
                return None
            if sample.distance >= TOUCH_RISE * middle.distance:
                ends.append(sample.x)
                break
    return (ends[0], ends[1]) if len(ends) == 2 else None


def predict_minimum(left: Sample, middle: Sample, right: Sample) -> float | None:
    """Return where |g| would vanish by the power that fits the three samples; None if no power fits."""
    best_misfit, best_place = MAX_MISFIT, None
    for power in POWERS:
        a, b = left.distance ** (1.0 / power), right.distance ** (1.0 / power)
        x = (left.x * b + right.x * a) / (a + b)
        expected = ((a + b) * abs(middle.x - x) / (right.x - left.x)) ** power
        distance = middle.distance
        ratio = max(expected / distance, distance / expected) if expected > 0.0 else float("inf")
        if ratio < best_misfit:
            best_misfit, best_place = ratio, x
    return best_place


def find_power(touch: Sample, inner: Sample, outer: Sample) -> float | None:
    """Return p of |g| = a |x - x_touch|^p through two samples on one side of a touch; None if |g| does not grow.

    inner, outer: the nearer and the farther of the two
    """
    size = inner.distance
    if not inner.side or inner.side != outer.side or not size < outer.distance:
        return None
    return math.log(outer.distance / size) / math.log((outer.x - touch.x) / (inner.x - touch.x))


def step_towards_value(course: MeasureCourse, i: int) -> float | None:
    """Return where |g| is a few errors between the i-th sample and the next, exactly one of which meets the value.

    None if the sample next to that one meets the value, too, or if |g| does not grow as a power of the distance.
    """
    left, right = course.samples[i], course.samples[i + 1]
    outer, met_sample, direction = (left, right, LEFT) if right.side == AT_VALUE else (right, left, RIGHT)
    beyond = next(iter(course.find_neighbours(i, direction)), None)
    # The sample next to the one that meets the value, on its other side:
    behind_met = course.samples[i + 2 : i + 3] if met_sample is right else course.samples[max(i - 1, 0) : i]
    if (
        met_sample.side != AT_VALUE
        or any(sample.side == AT_VALUE for sample in behind_met)
        or beyond is None
        or (power := find_power(met_sample, outer, beyond)) is None
    ):
        return None
    small = CLEAR_OF_VALUE * max(outer.error, met_sample.error)
    share = (small / outer.distance) ** (1.0 / power)
    distance = max(share * abs(outer.x - met_sample.x), course.finest)
    if not distance < 0.5 * abs(outer.x - met_sample.x):
        return None
    return met_sample.x + math.copysign(distance, outer.x - met_sample.x)


def leads_to_touch(course: MeasureCourse, i: int) -> bool:
    """Return whether |g| falls between the i-th sample and the next towards one that meets the value, by one power.

    It must be the power of the distance by which |g| falls outside of the two, too.
    """
    samples, allowed = course.samples, MAX_POWER_CHANGE * FIRST_DISTRUST / course.distrust
    # Order along x: the sample that meets the value, near, far, beyond; or mirrored.
    for near, direction in ((i, LEFT), (i + 1, RIGHT)):
        far = i + 1 if near == i else i
        beyond = next(iter(course.find_neighbours(i, -direction)), None)
        met = find_met_sample(course, near, direction)
        if met is None or beyond is None or samples[near].distance < NOISE * samples[near].error:
            continue
        inside = find_power(met, samples[near], samples[far])
        outside = find_power(met, samples[far], beyond)
        if inside is not None and outside is not None and abs(inside - outside) <= allowed * outside:
            return True
    return False


def find_met_sample(course: MeasureCourse, k: int, direction: int) -> Sample | None:
    """Find the first sample that meets the value, or is a touch, in a direction from the k-th.

    |g| must fall towards it, on one side of the value; None otherwise.
    """
    previous = course.samples[k]
    for sample in course.iter_outward(k, direction):
        is_lower = sample.distance < previous.distance
        if sample.side == AT_VALUE or (is_lower and find_touch_range(course, sample) is not None):
            return sample
        if not is_lower or sample.side != previous.side:
            return None
        previous = sample
    return None
