"""What spreads of several numbers make of a measure together.

    worst case         sum over the numbers of the largest change within the spread of each
    root sum square    the root of the sum of their squares, of spreads that hang on nothing in common

Each number is set to both ends of its spread and to a place between on either side. Where these and the derivative lie
on one line, the largest change is at an end. Where they do not, the spread of the number is searched: the measure is
followed over it as `heun find` follows a course. Sums hold as far as numbers act on their own. So all numbers are set
together to where each of them lowers and raises the measure most, and of those that are not linear one after the other
is set anew, the others standing, until no variant shows more. The worst case is never less than what a variant showed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from heuncli.analyses.sensitivity.results import Contribution, NoisyDerivative, NoisyValue, SpreadSum
from heuncli.analyses.variants.course import MeasureCourse, Sample, SpentError
from heuncli.analyses.variants.course_extremes import extreme, refine_extreme
from heuncli.analyses.variants.written import WrittenNumber
from heuncli.base.named_tuples import NamedTuple

LINEAR = 0.05  # of what the derivative says
INSIDE = 0.61  # of a spread: the places between its ends and the value
SCAN, MOST = 9, 60  # variants over a spread that is searched: at first, and in all
WELL = 1e-3  # of the range over a spread: how well its extremes are known
STEPS = 30  # towards one of them
ROUNDS = 3  # through all numbers, each set anew


class NumberSpread(NamedTuple):
    """A number and how far it may lie from its value, each way, in its unit."""

    number: WrittenNumber
    size: float


class SpreadExtremes(NamedTuple):
    """What one number does within its spread: the distances at which the measure is least and greatest."""

    contribution: Contribution
    lowers: float
    raises: float


Ask = Callable[[Mapping[str, float]], NoisyValue]  # a measure, at distances of numbers from their values


def summed(ask: Ask, spreads: Sequence[NumberSpread], slopes: Mapping[str, NoisyDerivative]) -> SpreadSum:
    """What spreads make of a measure; slopes: dm/dp by name."""
    base = ask({})
    found = [extremes_of(ask, base, spread, slopes[spread.number.name]) for spread in spreads]
    each = tuple(one.contribution for one in found)
    lowest = {one.contribution.name: one.lowers for one in found}
    highest = {one.contribution.name: one.raises for one in found}
    corners = ask(lowest), ask(highest)
    largest = max((change for end in corners if (change := change_of(end, base))), key=_size, default=None)
    bent = [one for one in each if one.bent or one.why[0]]
    if bent and len(each) > 1:
        for way, start in ((-1.0, lowest), (1.0, highest)):
            other = climbed(ask, base, spreads, start, way)
            largest = max((one for one in (largest, other) if one is not None), key=_size, default=None)
    sizes = [(one.size, one.error) for one in each if one.size is not None]
    if len(sizes) < len(each):
        return SpreadSum(each, None, None, corners)
    worst = sum(size for size, _ in sizes), sum(error for _, error in sizes)
    by_variant = largest is not None and abs(largest[0]) > worst[0]
    if by_variant and largest is not None:
        worst = abs(largest[0]), largest[1] + worst[1] + abs(largest[0]) - worst[0]
    root = math.sqrt(sum(size * size for size, _ in sizes))
    error = sum(size * error for size, error in sizes) / root if root else worst[1]
    return SpreadSum(each, worst, (root, error), corners, by_variant, largest)


def extremes_of(ask: Ask, base: NoisyValue, spread: NumberSpread, slope: NoisyDerivative) -> SpreadExtremes:
    """What the spread of one number makes of a measure."""
    name, t = spread.number.name, spread.size
    linear = abs(slope.value) * t if slope.value is not None else None
    shown: dict[float, NoisyValue] = {x: ask({name: x}) for x in (-t, -INSIDE * t, INSIDE * t, t)}
    changes = {x: change for x, one in shown.items() if (change := change_of(one, base)) is not None}
    below, above = (changes[x][0] if x in changes else None for x in (-t, t))
    why = next((one.why for one in shown.values() if one.value is None), ("", ""))
    lead = name, t, spread.number.unit
    if (
        len(changes) == len(shown)
        and slope.value is not None
        and all(agrees(slope, x, change) for x, change in changes.items())
    ):
        size, error = max((abs(value), noise) for value, noise in changes.values())
        size, error = max((size, error), (linear or 0.0, slope.error * t))
        error += max(abs(value - slope.value * x) for x, (value, _) in changes.items())  # it may be more between them
        way = math.copysign(t, slope.value)
        return SpreadExtremes(Contribution(*lead, size, error, linear, below, above), -way, way)
    if base.value is None or not changes:
        return SpreadExtremes(Contribution(*lead, None, 0.0, linear, below, above, True, why=why), -t, t)
    low, high, left, runs = searched(ask, base, name, t)
    error = max(low.error, high.error) + base.error + left
    size = max(-(low.gap or 0.0), high.gap or 0.0)
    made = Contribution(
        *lead, size, error, linear, below, above, True, (low.x, low.gap or 0.0), (high.x, high.gap or 0.0), runs, why
    )
    return SpreadExtremes(made, low.x, high.x)


def searched(ask: Ask, base: NoisyValue, name: str, t: float) -> tuple[Sample, Sample, float, int]:
    """The least and the greatest change of a measure within a spread, what may be missing of them, and the variants."""

    def course_at(x: float) -> Sample:
        found = ask({name: x} if x else {})
        if found.value is None or base.value is None:
            return Sample(x, None, why=found.why)
        return Sample(x, found.value - base.value, found.error)

    course = MeasureCourse(course_at, -t, t, SCAN, MOST, base.value or 0.0)
    left = math.inf
    try:
        course.scan()
        for x in (0.0, -INSIDE * t, INSIDE * t):
            course.at(x)
        left = max(max(refine_extreme(course, way, share=WELL, most=STEPS), 0.0) for way in (-1, 1))
    except SpentError:
        pass
    low, high = extreme(course, -1), extreme(course, 1)
    assert low is not None and high is not None  # the value itself is solved
    return low, high, left, len(course.samples)


def climbed(
    ask: Ask, base: NoisyValue, spreads: Sequence[NumberSpread], start: Mapping[str, float], way: float
) -> tuple[float, float] | None:
    """The largest change one way that is met by setting one number after the other, from a corner on."""
    at = dict(start)
    best = change_of(ask(at), base)
    for _ in range(ROUNDS):
        before = best
        for spread in spreads:
            name, t = spread.number.name, spread.size
            for x in (-t, -INSIDE * t, 0.0, INSIDE * t, t):
                found = change_of(ask(at | {name: x}), base)
                if found is not None and (best is None or way * found[0] > way * best[0]):
                    best, at = found, at | {name: x}
        if best == before:
            break
    return best


def agrees(slope: NoisyDerivative, distance: float, change: tuple[float, float]) -> bool:
    """Whether what is found at a distance is what the derivative says."""
    said = (slope.value or 0.0) * distance
    return abs(change[0] - said) <= LINEAR * abs(said) + slope.error * abs(distance) + change[1]


def change_of(found: NoisyValue, base: NoisyValue) -> tuple[float, float] | None:
    """By how much a measure changes, and the error of that."""
    if found.value is None or base.value is None:
        return None
    return found.value - base.value, found.error + base.error


def _size(change: tuple[float, float]) -> float:
    return abs(change[0])
