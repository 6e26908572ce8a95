"""Touches of a value that errors do not reach: where a measure goes to 0, its stated error goes with it.

Such a measure touches its value at a place if it is told from it no better than the place itself is told: if it is
twice as far from the value the least distance beside that place. Towards the place it is followed as a power:

    |g| = a |x - c|^p        c from the neighbours on both sides, p such that the sample between them fits
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.variants.course import NOISE, MeasureCourse, Sample

POWERS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
PLAUSIBLE = 3.0  # times: what the power foretells of the sample in the middle, and what it is
FALLS = 0.5  # of |g|: a step that gains less ends the way, and a sample less below both neighbours is none
REACH = 3.0  # least distances: as far as |g| is to double on both sides of a touch
MOST = 60  # steps towards one touch
TWICE = 2.0


def find_touches(course: MeasureCourse) -> None:
    """Follow every least distance from the value that may be none. Raises SpentError."""
    for x in [middle.x for left, middle, right in least_distances(course) if is_deep(left, middle, right)]:
        follow(course, x)


def is_deep(left: Sample, middle: Sample, right: Sample) -> bool:
    """Whether |g| falls to a sample by far more than its error, which is far below what is left of it."""
    return NOISE * middle.error < size(middle) <= FALLS * max(size(left), size(right))


def least_distances(course: MeasureCourse) -> Iterator[tuple[Sample, Sample, Sample]]:
    """Three neighbours of one side of which the middle one is nearest to the value."""
    for i in range(1, len(course.samples) - 1):
        if course.parted(i - 1) or course.parted(i):
            continue
        left, middle, right = course.samples[i - 1 : i + 2]
        if middle.side and left.side == middle.side == right.side and size(middle) < min(size(left), size(right)):
            yield left, middle, right


def follow(course: MeasureCourse, x: float) -> None:
    """Go to where |g| is least about a place, as long as that may be a touch. Raises SpentError."""
    for _ in range(MOST):
        three = next((each for each in least_distances(course) if each[1].x == x), None)
        if three is None:
            return
        left, middle, right = three
        if is_narrow(course, left, middle, right):
            confirm(course, middle)
            return
        place = foretold(left, middle, right)
        if place is None:
            return
        found = course.at(min(max(place, left.x + 0.25 * course.finest), right.x - 0.25 * course.finest))
        if found.gap is None or found.side != middle.side:
            return
        if size(found) > FALLS * size(middle) and found is not middle:
            found = course.at(
                0.5 * (middle.x + (left.x if abs(left.x - middle.x) > abs(right.x - middle.x) else right.x))
            )
            if found.gap is None or found.side != middle.side:
                return
        x = min((left, middle, right, found), key=size).x


def is_narrow(course: MeasureCourse, left: Sample, middle: Sample, right: Sample) -> bool:
    """Whether |g| may double within the least distance, by the chords."""
    chord = max((size(left) - size(middle)) / (middle.x - left.x), (size(right) - size(middle)) / (right.x - middle.x))
    return chord * course.finest >= size(middle)


def confirm(course: MeasureCourse, middle: Sample) -> None:
    """Ask on both sides of a place, two least distances off. Raises SpentError."""
    for way in (-2.0, 2.0):
        x = middle.x + way * course.finest
        if course.low < x < course.high:
            course.look(x)


def touch_at(course: MeasureCourse, middle: Sample) -> tuple[float, float] | None:
    """From where to where a sample is told from a touch no better than places are; None where it is none.

    It is one if |g| doubles on both sides within some least distances.
    """
    i = course.samples.index(middle)
    found: list[float] = []
    for way in (-1, 1):
        k = i
        while 0 <= k + way < len(course.samples) and not course.parted(k + min(way, 0)):
            k += way
            one = course.samples[k]
            if abs(one.x - middle.x) > REACH * course.finest or one.side != middle.side:
                return None
            if size(one) >= TWICE * size(middle):
                found.append(one.x)
                break
    return (found[0], found[1]) if len(found) == 2 else None


def foretold(left: Sample, middle: Sample, right: Sample) -> float | None:
    """Where |g| would be none by the power that fits the three; None where no power does."""
    best, place = PLAUSIBLE, None
    for power in POWERS:
        a, b = size(left) ** (1.0 / power), size(right) ** (1.0 / power)
        x = (left.x * b + right.x * a) / (a + b)
        expected = ((a + b) * abs(middle.x - x) / (right.x - left.x)) ** power
        here = size(middle)
        ratio = max(expected / here, here / expected) if expected > 0.0 else float("inf")
        if ratio < best:
            best, place = ratio, x
    return place


def size(sample: Sample) -> float:
    """|g|."""
    return abs(sample.gap or 0.0)
