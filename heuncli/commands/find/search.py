"""Where a course may meet its value: a scan, and more places wherever what lies between two is not yet certain.

A place is asked where the neighbours lie on different sides (a crossing or a jump is closed in on), where the course
between neighbours of one side may come back to the value (an extreme that touches it, two crossings near each other),
and where what can be solved ends. That the course does not come back is certain if what is expected between the
neighbours, less what that may be off by, stays on their side.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.commands.find.course import NOISE, Between, MeasureCourse, Sample, polynomial

INWARD = 0.1  # of an interval: a place nearer to its end than that would tell little
END_OF_SOLVED = 1.0 / 32.0  # of the scan's spacing: how well it is told where variants begin to fail
LESS = 0.25  # of the gap that is left: an interpolation that gains less than that is followed by a halving
EXTREME = 1e-5  # of the range: how well an extreme is told
NEAR_ENDS = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 1003)[1:-1])  # places in an interval, close by its ends
MOST_STEPS = 12  # towards one extreme
STEEP = 10.0  # times what the slope outside leads to expect: more than that across the narrowest bracket is a jump


def search(course: MeasureCourse) -> None:
    """Ask until it is certain where the value is met. Raises SpentError."""
    course.scan()
    given_up: set[tuple[float, float]] = set()
    while True:
        close_all(course)
        i = widest(course, given_up)
        if i is None:
            break
        one, other = course.samples[i], course.samples[i + 1]
        given_up.add((one.x, other.x))
        if one.gap is None or other.gap is None:
            course.at(0.5 * (one.x + other.x))
        else:
            course.look(place_between(one, other, course.between(i)))


def close_all(course: MeasureCourse) -> None:
    """Close in on all crossings and jumps that neighbours on different sides tell of. Raises SpentError."""
    while (i := next(crossed(course), None)) is not None:
        close_in(course, i)


def crossed(course: MeasureCourse) -> Iterator[int]:
    """Neighbours on different sides, between which neither a crossing nor a jump is known."""
    for i, one, other in course.pairs():
        known = (one.x, other.x) in course.steep or course.parted(i)
        if not known and one.side and other.side and one.side != other.side:
            yield i


def widest(course: MeasureCourse, given_up: set[tuple[float, float]]) -> int | None:
    """The widest two neighbours between which it is not certain what happens; None: there are none."""
    found = [
        (other.x - one.x, -i)
        for i, one, other in course.pairs()
        if (one.x, other.x) not in given_up and unsure(course, i)
    ]
    return -max(found)[1] if found else None


def unsure(course: MeasureCourse, i: int) -> bool:
    """Whether a place between two neighbours is to be asked."""
    one, other = course.samples[i], course.samples[i + 1]
    width = other.x - one.x
    if one.gap is None or other.gap is None:
        return (one.gap is None) != (other.gap is None) and width > END_OF_SOLVED * course.spacing
    if course.parted(i) or width <= 2.0 * course.finest or near_jump(course, one, other):
        return False
    expected = course.between(i)
    side, error = one.side or other.side, max(one.error, other.error)
    if not side:  # both meet it: does all between them?
        return bool((np.abs(expected.gaps) + expected.off > NOISE * error).any())
    nearest = side * expected.gaps - expected.off
    return bool((nearest <= (error if one.side == other.side else -NOISE * error)).any())


def near_jump(course: MeasureCourse, one: Sample, other: Sample) -> bool:
    """Whether the course jumps right beside two neighbours: towards a pole it is never certain."""
    margin = END_OF_SOLVED * course.spacing
    return any(low - margin <= one.x and other.x <= high + margin for low, high in course.jumps)


def place_between(one: Sample, other: Sample, expected: Between) -> float:
    """Where to ask between two neighbours: where the course may come nearest to the value, else in the middle."""
    if not one.side or one.side != other.side:
        return 0.5 * (one.x + other.x)
    x = float(expected.places[np.argmin(one.side * expected.gaps - expected.off)])
    inward = INWARD * (other.x - one.x)
    return min(max(x, one.x + inward), other.x - inward)


def close_in(course: MeasureCourse, i: int) -> None:
    """Narrow two neighbours of different sides down to a crossing, or to a jump.

    By Brent's rule: the root of the course as it is expected, and the middle wherever that has gained too little.
    """
    one, other = course.samples[i], course.samples[i + 1]
    failed = 0
    while other.x - one.x > course.finest:
        x = (
            0.5 * (one.x + other.x)
            if failed > 1
            else beyond(course, one, other)
            if failed
            else root(course, one, other)
        )
        best = min(abs(one.gap or 0.0), abs(other.gap or 0.0))
        found = course.look(x)
        if found.gap is None or found.side == 0:
            return
        failed = 0 if abs(found.gap) < LESS * best else failed + 1
        one, other = (found, other) if found.side == one.side else (one, found)
    (course.steep if is_steep(course, one, other) else course.jumps).add((one.x, other.x))


def beyond(course: MeasureCourse, one: Sample, other: Sample) -> float:
    """Just beyond the root, where g is hardly more than its error on this side of it; else the middle."""
    near, far = sorted((one, other), key=lambda sample: abs(sample.gap or 0.0))
    size, noise = abs(near.gap or 0.0), NOISE * max(near.error, far.error)
    share = (size + noise) / abs((far.gap or 0.0) - (near.gap or 0.0)) if size <= noise else 0.5
    way = max(min(share, 0.5) * abs(far.x - near.x), course.finest)
    return near.x + way if far is other else near.x - way


def is_steep(course: MeasureCourse, one: Sample, other: Sample) -> bool:
    """Whether the course outside is so steep that it goes from one side to the other in the narrowest bracket.

    Towards a jump it is level, towards a pole it grows. Across the bracket counts what is beyond the errors of both.
    """
    i = next(i for i, sample, _ in course.pairs() if sample is one)
    outside = [(one, each) for each in course.beside(i, -1)[:1]] + [(other, each) for each in course.beside(i, 1)[:1]]
    errors = 2.0 * (one.error + other.error)
    through = max(abs((other.gap or 0.0) - (one.gap or 0.0)) - errors, 0.0) / (other.x - one.x)
    slopes = [((far.gap or 0.0) - (near.gap or 0.0)) / (far.x - near.x) * (other.side or 0) for near, far in outside]
    return through == 0.0 or (bool(slopes) and min(slopes) > 0.0 and through <= STEEP * max(slopes))


def root(course: MeasureCourse, one: Sample, other: Sample) -> float:
    """Where the course is expected to cross between two neighbours of different sides."""
    near = min((one, other), key=lambda sample: abs(sample.gap or 0.0))
    stretch = stretch_of(course, one)
    others = sorted((each for each in stretch if each not in (one, other)), key=lambda each: abs(each.x - near.x))
    samples = [one, other, *others[:2]]
    low, high = one.x, other.x
    for _ in range(60):  # halvings, which cost nothing here
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        above = float(polynomial(samples, np.array([middle]))[0]) * (one.side or 0) > 0.0
        low, high = (middle, high) if above else (low, middle)
    margin = 0.25 * course.finest
    return min(max(0.5 * (low + high), one.x + margin), other.x - margin)


def stretch_of(course: MeasureCourse, one: Sample) -> list[Sample]:
    """The samples of the stretch in which one stands."""
    found: list[Sample] = []
    for i, sample in enumerate(course.samples):
        if found and course.parted(i - 1):
            if one in found:
                return found
            found = []
        found.append(sample)
    return found


def refine_extreme(course: MeasureCourse, way: int) -> None:
    """Ask where the least (way -1) or the greatest (1) of the course may be, until no more is to be expected."""
    for _ in range(MOST_STEPS):
        known = [sample for sample in course.samples if sample.gap is not None]
        best = max(known, key=lambda sample: way * (sample.gap or 0.0))
        gain, place = max((expected_gain(course, i, best, way) for i in beside(course, best)), default=(0.0, 0.0))
        if gain <= max(best.error, EXTREME * course.range):
            return
        course.look(place)


def beside(course: MeasureCourse, best: Sample) -> Iterator[int]:
    """The neighbours of which a sample is one, where the course goes on between them."""
    for i, one, other in course.pairs():
        if best in (one, other) and not course.parted(i) and other.x - one.x > 2.0 * course.finest:
            yield i


def expected_gain(course: MeasureCourse, i: int, best: Sample, way: int) -> tuple[float, float]:
    """By how much g may pass its best between two neighbours at most, and where."""
    one, other = course.samples[i], course.samples[i + 1]
    expected = course.between(i, one.x + NEAR_ENDS * (other.x - one.x))
    most = way * expected.gaps + expected.off
    k = int(np.argmax(most))
    return float(most[k] - way * (best.gap or 0.0)), float(expected.places[k])
