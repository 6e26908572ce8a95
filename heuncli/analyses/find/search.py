"""Where a course may meet its value: a scan, and more places wherever what lies between two is not yet certain.

A place is asked where the neighbours lie on different sides (a crossing or a jump is closed in on), where the course
between neighbours of one side may come back to the value (an extreme that touches it, two crossings near each other),
and where what can be solved ends. That the course does not come back is certain if what is expected between the
neighbours, less what that may be off by, stays on their side.
"""

from __future__ import annotations

from bisect import bisect, bisect_left
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.analyses.find.poles import is_far, place_of_hidden_pole
from heuncli.analyses.variants.course import (
    DISTRUST,
    GOLDEN,
    MOST_DISTRUST,
    NOISE,
    Between,
    MeasureCourse,
    Sample,
    polynomial,
)
from heuncli.analyses.variants.course_extremes import place_inside

END_OF_SOLVED = 1.0 / 32.0  # of the scan's spacing: nearer to where variants begin to fail edges.py looks
NEAR_JUMP = 1.0 / 256.0  # of the scan's spacing: nearer to a jump or an edge the course is never certain
LESS = 0.25  # of the gap that is left: an interpolation that gains less than that is followed by a halving
STEEP = 10.0  # times what the slope outside leads to expect: more than that across the narrowest bracket is a jump
WIDER = 1000.0  # times the narrowest bracket: another one, across which a jump is as large
PROVES = 10.0  # times the narrowest bracket: what is no wider proves no jump
KEPT = 0.8  # of what the course changes by across that: less across the narrowest one is no jump
CHECKED_OFF = 0.1  # of an interval of the scan: so far off its middle it is tried, so that no wave hides in their beat
GROWTH = 2.0  # times what a peak is expected to rise by: as far it may


def search(course: MeasureCourse) -> None:
    """Ask until it is certain where the value is met. Raises SpentError."""
    while True:
        close_all(course)
        i = widest(course)
        if i is None:
            break
        one, other = course.samples[i], course.samples[i + 1]
        course.given_up.add((one.x, other.x))
        if one.gap is None or other.gap is None:
            course.at(0.5 * (one.x + other.x))
        elif (x := place_of_peak(course, i)) is not None:
            course.look(x)
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


def widest(course: MeasureCourse) -> int | None:
    """The widest two neighbours between which it is not certain what happens; None: there are none."""
    ends = ends_of_course(course)
    pairs = [(other.x - one.x, -i) for i, one, other in course.pairs() if (one.x, other.x) not in course.given_up]
    for _, i in sorted(pairs, reverse=True):
        around = (*(sample.x for sample in course.samples[max(-i - 2, 0) : 4 - i]), course.distrust, len(ends))
        if around in course.certain:
            continue
        if unsure(course, -i, ends):
            return -i
        course.certain.add(around)
    return None


def unsure(course: MeasureCourse, i: int, ends: list[tuple[float, float]]) -> bool:
    """Whether a place between two neighbours is to be asked; ends: ends_of_course."""
    one, other = course.samples[i], course.samples[i + 1]
    width = other.x - one.x
    if one.gap is None or other.gap is None:
        return (one.gap is None) != (other.gap is None) and width > END_OF_SOLVED * course.spacing
    if course.parted(i) or width <= 2.0 * course.finest:
        return False
    if place_of_peak(course, i) is not None:
        return True
    if near_jump(course, one, other, ends) or is_far(course, one, other):
        return False
    expected = course.between(i)
    side, error = one.side or other.side, max(one.error, other.error)
    if not side:  # both meet it: does all between them?
        return bool((np.abs(expected.gaps) + expected.off > NOISE * error).any())
    nearest = side * expected.gaps - expected.off
    return bool((nearest <= (error if one.side == other.side else -NOISE * error)).any())


def check_scan(course: MeasureCourse) -> None:
    """Ask once more in each interval of the scan that is worth a try.

    What differs from what was expected raises the distrust, with which the whole course is looked at again; and both
    parts of that interval are tried in turn. Raises SpentError.
    """
    known = [sample.x for sample in course.samples]
    intervals = [pair for pair in pairwise(course.scanned) if bisect(known, pair[0]) == bisect_left(known, pair[1])]
    while intervals:
        low, high = intervals.pop()
        i = next(i for i, one, _ in course.pairs() if one.x == low)
        if course.samples[i + 1].x != high or high - low <= NEAR_JUMP * course.spacing or not is_worth_a_try(course, i):
            continue
        x = low + (high - low) * (0.5 + CHECKED_OFF * (2.0 * (len(known) * GOLDEN % 1.0) - 1.0))
        expected = course.between(i, np.array([x]))
        found = course.look(x)
        known.append(x)
        off = float(expected.off[0]) * DISTRUST / course.distrust
        if found.gap is not None and abs(found.gap - float(expected.gaps[0])) > off + expected.noise + found.error:
            intervals += [(low, x), (x, high)]


def is_worth_a_try(course: MeasureCourse, i: int) -> bool:
    """Whether two neighbours may hide a wave that meets the value, were it off by MOST_DISTRUST times as much."""
    one, other = course.samples[i], course.samples[i + 1]
    if course.parted(i) or not one.side or one.side != other.side:
        return False
    if not bends_both_ways(course, i):
        return False
    expected = course.between(i)
    nearest = one.side * expected.gaps - MOST_DISTRUST / course.distrust * expected.off
    return bool((nearest <= max(one.error, other.error)).any())


def bends_both_ways(course: MeasureCourse, i: int) -> bool:
    """Whether the four samples about two neighbours bend to one side and then to the other: a wave hides there, or not.

    What bends one way throughout is followed by its polynomials, or by its logarithm.
    """
    left, right = course.beside(i, -1), course.beside(i, 1)
    four = [
        *reversed(left[: 1 if right else 2]), course.samples[i], course.samples[i + 1], *right[: 1 if left else 2],
    ]  # fmt: skip
    slopes = [((b.gap or 0.0) - (a.gap or 0.0)) / (b.x - a.x) for a, b in pairwise(four)]
    bends = [after - before for before, after in pairwise(slopes)]
    return len(bends) < 2 or bends[0] * bends[-1] < 0.0


def not_excluded(course: MeasureCourse) -> Iterator[tuple[Sample, Sample]]:
    """Stretches of one side in which the samples and their errors leave it open whether the value is met.

    Unlike in `unsure`, what polynomials differ by within the noise counts: the search gains nothing by asking there,
    and yet the course may come to the value. Ends that lead to a crossing or a touch that is told are left out.
    """
    ends = ends_of_course(course)
    open_: tuple[Sample, Sample] | None = None
    for i, one, other in course.pairs():
        if not (one.side and one.side == other.side and not course.parted(i) and is_open(course, i, ends)):
            if open_ is not None:
                yield open_
            open_ = None
        else:
            open_ = (open_[0] if open_ is not None else one, other)
    if open_ is not None:
        yield open_


def is_open(course: MeasureCourse, i: int, ends: list[tuple[float, float]]) -> bool:
    """Whether the course may meet the value between two neighbours of one side; ends: ends_of_course."""
    one, other = course.samples[i], course.samples[i + 1]
    if is_far(course, one, other) or near_jump(course, one, other, ends) or leads_to_a_meeting(course, i):
        return False
    expected = course.between(i)
    nearest = (one.side or 0) * expected.gaps - expected.most_off
    return bool((nearest <= 0.0).any()) or place_of_peak(course, i) is not None


def leads_to_a_meeting(course: MeasureCourse, i: int) -> bool:
    """Whether the course falls between two neighbours towards one beside them that is not told from the value."""
    samples = course.samples
    for near, far, beside in ((i, i + 1, i - 1), (i + 1, i, i + 2)):
        is_met = 0 <= beside < len(samples) and samples[beside].side != samples[near].side
        if is_met and abs(samples[near].gap or 0.0) < abs(samples[far].gap or 0.0):
            return True
    return False


def ends_of_course(course: MeasureCourse) -> list[tuple[float, float]]:
    """The neighbours between which the course jumps, is upright, or ends."""
    ends = [(a.x, b.x) for _, a, b in course.pairs() if (a.gap is None) != (b.gap is None)]
    return [*course.jumps, *course.steep, *ends]


def near_jump(course: MeasureCourse, one: Sample, other: Sample, ends: list[tuple[float, float]]) -> bool:
    """Whether the course jumps or ends right beside two neighbours: towards a pole it is never certain."""
    margin = NEAR_JUMP * course.spacing
    return any(low - margin <= one.x and other.x <= high + margin for low, high in ends)


def place_of_peak(course: MeasureCourse, i: int) -> float | None:
    """Where a peak or a pole between two neighbours may reach the value; None: nothing tells of one that does."""
    one, other = course.samples[i], course.samples[i + 1]
    if (pole := place_of_hidden_pole(course, i)) is not None:
        return place_inside(one, other, pole)
    peak = course.peak(i)
    if peak is None or not one.side or one.side != other.side:
        return None
    if np.isinf(peak.size) and (one.gap + course.value) * (other.gap + course.value) < 0.0:  # type: ignore[operator]
        return place_inside(one, other, peak.place)
    largest = (
        max((sample.gap or 0.0) + course.value for sample in (one, other))
        if course.value > 0.0
        else min((sample.gap or 0.0) + course.value for sample in (one, other))
    )
    if largest * course.value <= 0.0 or abs(largest) >= abs(course.value):
        return None
    reached = abs(largest) + GROWTH * (peak.size - abs(largest))
    return place_inside(one, other, peak.place) if reached >= abs(course.value) else None


def place_between(one: Sample, other: Sample, expected: Between) -> float:
    """Where to ask between two neighbours: where the course may come nearest to the value, else in the middle."""
    if not one.side or one.side != other.side:
        return 0.5 * (one.x + other.x)
    return place_inside(one, other, float(expected.places[np.argmin(one.side * expected.gaps - expected.off)]))


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
    is_jump = not is_steep(course, one, other) and keeps_its_size(course, one, other)
    (course.jumps if is_jump else course.steep).add((one.x, other.x))


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


def keeps_its_size(course: MeasureCourse, one: Sample, other: Sample) -> bool:
    """Whether the course changes as much across the narrowest bracket as across one a thousand times wider.

    A jump does, and a pole changes by more; what is only upright there, as a root of x - c, changes by less.
    """
    reach = 0.5 * WIDER * (other.x - one.x)
    before, behind = outside(course, one, -1, reach), outside(course, other, 1, reach)
    if behind.x - before.x < PROVES * (other.x - one.x):
        return False
    across = abs((other.gap or 0.0) - (one.gap or 0.0)) + one.error + other.error
    return across >= KEPT * abs((behind.gap or 0.0) - (before.gap or 0.0))


def outside(course: MeasureCourse, end: Sample, way: int, reach: float) -> Sample:
    """A sample about so far outside of another one, as far as the course goes on there. Raises SpentError."""
    k, best = course.samples.index(end), end
    while 0 <= k + way < len(course.samples) and not course.parted(k + min(way, 0)):
        k += way
        if abs(course.samples[k].x - end.x) > reach:
            found = course.at(end.x + way * reach)
            return found if found.gap is not None else best
        best = course.samples[k]
        if abs(best.x - end.x) >= 0.5 * reach:
            return best
    return best


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
