"""Find touches of a value where the stated error of the measure vanishes together with its distance from the value.

Such a measure touches its value where the distance cannot be resolved better than the place itself: if |g| doubles
within the smallest distance of places. Towards the place it is followed as a power:
    |g| = a |x - c|^p        c from the neighbours on both sides, p such that the sample between them fits
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.variants.course import NOISE, MeasureCourse, Sample
from heuncli.base import tolerances

POWERS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
MAX_MISFIT = 3.0  # largest ratio between the middle sample and its prediction by the power
MIN_GAIN = 0.5  # of |g|: largest ratio after a useful step, and of a minimum to its neighbours
MAX_STEPS = 60  # steps towards one touch
DOUBLING = 2.0


def find_touches(course: MeasureCourse) -> None:
    """Follow every local minimum of the distance from the value that may be zero. Raises SampleLimitError."""
    for x in [middle.x for left, middle, right in iter_minima(course) if is_deep(left, middle, right)]:
        follow_minimum(course, x)


def is_deep(left: Sample, middle: Sample, right: Sample) -> bool:
    """Return whether |g| falls at the middle sample by far more than its error, which is itself far below |g|."""
    return (
        NOISE * middle.error
        < compute_distance(middle)
        <= MIN_GAIN * max(compute_distance(left), compute_distance(right))
    )


def iter_minima(course: MeasureCourse) -> Iterator[tuple[Sample, Sample, Sample]]:
    """Yield three adjacent samples on one side of which the middle one is nearest to the value."""
    for i in range(1, len(course.samples) - 1):
        if course.is_interrupted(i - 1) or course.is_interrupted(i):
            continue
        left, middle, right = course.samples[i - 1 : i + 2]
        if (
            middle.side
            and left.side == middle.side == right.side
            and compute_distance(middle) < min(compute_distance(left), compute_distance(right))
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
        sample = course.sample_at(min(max(predicted, left.x + 0.25 * course.finest), right.x - 0.25 * course.finest))
        if sample.gap is None or sample.side != middle.side:
            return
        if compute_distance(sample) > MIN_GAIN * compute_distance(middle) and sample is not middle:
            sample = course.sample_at(
                0.5 * (middle.x + (left.x if abs(left.x - middle.x) > abs(right.x - middle.x) else right.x))
            )
            if sample.gap is None or sample.side != middle.side:
                return
        x = min((left, middle, right, sample), key=compute_distance).x


def is_narrow(course: MeasureCourse, left: Sample, middle: Sample, right: Sample) -> bool:
    """Return whether |g| may double within the smallest distance of places, by the chords."""
    chord = max(
        (compute_distance(left) - compute_distance(middle)) / (middle.x - left.x),
        (compute_distance(right) - compute_distance(middle)) / (right.x - middle.x),
    )
    return chord * course.finest >= compute_distance(middle)


def confirm_touch(course: MeasureCourse, middle: Sample) -> None:
    """Evaluate both sides of a place, at twice the smallest distance. Raises SampleLimitError."""
    for offset in (-2.0, 2.0):
        x = middle.x + offset * course.finest
        if course.low < x < course.high:
            course.sample_and_learn(x)


def find_touch_range(course: MeasureCourse, middle: Sample) -> tuple[float, float] | None:
    """Return the range in which a sample is a touch; None if it is none.

    It is a touch if |g| doubles on both sides within a few smallest distances.
    """
    i = course.samples.index(middle)
    ends: list[float] = []
    for direction in (-1, 1):
        k = i
        while 0 <= k + direction < len(course.samples) and not course.is_interrupted(k + min(direction, 0)):
            k += direction
            sample = course.samples[k]
            if abs(sample.x - middle.x) > tolerances.TOUCH_DOUBLES * course.finest or sample.side != middle.side:
                return None
            if compute_distance(sample) >= DOUBLING * compute_distance(middle):
                ends.append(sample.x)
                break
    return (ends[0], ends[1]) if len(ends) == 2 else None


def predict_minimum(left: Sample, middle: Sample, right: Sample) -> float | None:
    """Return where |g| would vanish by the power that fits the three samples; None if no power fits."""
    best_misfit, best_place = MAX_MISFIT, None
    for power in POWERS:
        a, b = compute_distance(left) ** (1.0 / power), compute_distance(right) ** (1.0 / power)
        x = (left.x * b + right.x * a) / (a + b)
        expected = ((a + b) * abs(middle.x - x) / (right.x - left.x)) ** power
        distance = compute_distance(middle)
        ratio = max(expected / distance, distance / expected) if expected > 0.0 else float("inf")
        if ratio < best_misfit:
            best_misfit, best_place = ratio, x
    return best_place


def compute_distance(sample: Sample) -> float:
    """Return |g|."""
    return abs(sample.gap or 0.0)
