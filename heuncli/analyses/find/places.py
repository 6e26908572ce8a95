"""The places at which a course meets its value, read from its samples, and how well they are known.

    |x - x0| <= E / |g'|            E: the error of the measure and what is left of g at the place [that of g]

with the slope g' from the neighbours that are well told from the value, less what it may be off by, and no more than
the chords to them; never further than the next neighbours that lie on one side for certain. Where the course bends at
the value, or its slope falls towards it as at an inflection, slopes of the neighbours tell nothing of the place itself:
the crossing is then enclosed, and the place is as far off as its enclosure reaches.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby

from heuncli.analyses.find.results import (
    CourseJump,
    Crossing,
    EdgeKind,
    Met,
    MetEdge,
    OpenBracket,
    Touch,
    UnsolvedStretch,
)
from heuncli.analyses.find.touches import least_distances, touch_at
from heuncli.analyses.variants.course import APART, MeasureCourse, Sample, slope
from heuncli.base.named_tuples import NamedTuple

CLEAR = 20.0  # times E: neighbours by which a slope is known to a tenth
SURE = 0.5  # of a slope: what it may be off by
BENT = 0.5  # of the steeper chord: where the other is less, the course bends
SAGS = 1.5  # power of the distance with which g grows on all sides: more than that is flat at the place
ENCLOSE = 2.0  # times E / chord: where a crossing is enclosed
ENCLOSED = 4.0  # times E / chord: an enclosure that is not flat


class KnownSlope(NamedTuple):
    """What is known of a course at a sample: the least that |g'| may be, and |g''|/2.

    chord: the least slope of the chords to the neighbours; sure: whether the slopes beside the sample hold up to it.
    """

    least: float
    bend: float
    chord: float
    sure: bool

    def tells(self, size: float) -> bool:
        """Whether it tells the place well, of an error of that size."""
        return self.sure and self.least > 0.0 and self.least**2 > 4.0 * self.bend * size / SURE

    def reach(self, size: float) -> float | None:
        """How far the place may be from the sample; None: the slope is too small to tell."""
        under = self.least * self.least - 4.0 * self.bend * size
        return 2.0 * size / (self.least + math.sqrt(under)) if self.least > 0.0 and under > 0.0 else None


class SideGroup(list[Sample]):
    """Neighbouring samples of one side."""

    @property
    def side(self) -> int | None:
        """Their side."""
        return self[0].side


def groups(course: MeasureCourse) -> list[SideGroup]:
    """The samples in groups of one side."""
    return [SideGroup(members) for _, members in groupby(course.samples, key=lambda sample: sample.side)]


def meetings(course: MeasureCourse) -> Iterator[Crossing | Touch | CourseJump | OpenBracket]:
    """Where the course meets its value, jumps across it, or passes it in a way that is not known."""
    found = groups(course)
    for _, middle, _ in least_distances(course):
        if (reached := touch_at(course, middle)) is not None:
            yield Touch(middle, *reached, middle.side or 0)
    for k, group in enumerate(found):
        before = found[k - 1].side if k else None
        after = found[k + 1].side if k + 1 < len(found) else None
        if group.side == 0:
            met = met_by(course, group, before, after)
            if isinstance(met, Touch) and met.side:  # it is between the next that are told from the value
                met = met._replace(low=found[k - 1][-1].x, high=found[k + 1][0].x)
            yield met
        elif group.side and before and before == -group.side:
            one, other = found[k - 1][-1], group[0]
            if (one.x, other.x) in course.jumps:
                yield CourseJump(one, other)
            elif (one.x, other.x) in course.steep:
                yield Crossing(min(one, other, key=_size), other.x - one.x, group.side)
            elif not course.parted(course.samples.index(one)):
                yield OpenBracket(one, other)


def met_by(course: MeasureCourse, group: SideGroup, before: int | None, after: int | None) -> Crossing | Touch:
    """What samples are that are not told from the value; before, after: the sides beside them."""
    best = min(group, key=_size)
    if before and before == after:
        return Touch(best, group[0].x, group[-1].x, before)
    if not before and not after:
        return Touch(best, group[0].x, group[-1].x, 0)
    error, flat = reach(course, group, best)
    return Crossing(best, error, after if before and after else 0, flat)


def reach(course: MeasureCourse, group: SideGroup, best: Sample) -> tuple[float, bool]:
    """How far the true place may be from a sample, and whether the slope there is too small to tell."""
    size = size_at(group, best)
    limit = max(abs((outer or end).x - best.x) for _, end, outer in enclosure(course, group))
    found = slope_at(course, group, best, size)
    if found is None:
        return limit, True
    if found.sure:
        told = found.reach(size)
        return (limit, True) if told is None else (min(limit, told), False)
    return limit, limit * found.chord > ENCLOSED * size


def size_at(group: SideGroup, best: Sample) -> float:
    """E: the error of the measure, and what is left of it."""
    return max(sample.error for sample in group) + _size(best)


def enclosure(course: MeasureCourse, group: SideGroup) -> Iterator[tuple[int, Sample, Sample | None]]:
    """Both ways the end of a group, and the next sample that lies on a side for certain, if there is one."""
    for way, end in ((-1, group[0]), (1, group[-1])):
        yield way, end, next(iter(neighbours(course, group, way, 0.0)), None)


def slope_at(course: MeasureCourse, group: SideGroup, best: Sample, size: float) -> KnownSlope | None:
    """What is known of the slope at a sample; None where that is too little."""
    left, right = (neighbours(course, group, way, CLEAR * size) for way in (-1, 1))
    whole = [*reversed(left), best, *right]
    if len(whole) < 3:
        return None
    # the parabola through the nearest, and the cubics with one more: by what they differ the slope may be off
    near = [*left[: 1 if right else 2], *right[: 1 if left else 2], best]
    wider = [sorted({*near, more}) for more in whole if more not in near]
    slopes = [slope(sorted(each), best.x) for each in (near, *wider)]
    noise = max((sample.error + best.error) / abs(sample.x - best.x) for sample in near if sample is not best)
    doubt = noise + max((abs(each - slopes[0]) for each in slopes[1:]), default=0.0)
    a, b, c = sorted(near)
    bend = ((_gap(c) - _gap(b)) / (c.x - b.x) - (_gap(b) - _gap(a)) / (b.x - a.x)) / (c.x - a.x)
    chords = [abs((_gap(side[0]) - _gap(best)) / (side[0].x - best.x)) for side in (left, right) if side]
    sure = bool(wider) and min(chords) >= BENT * max(*chords, abs(slopes[0])) and not sags(best, left, right)
    chord = min(chords) - noise
    return KnownSlope(min(abs(slopes[0]) - doubt, chord), abs(bend), chord, sure)


def sags(best: Sample, *sides: list[Sample]) -> bool:
    """Whether g grows on all sides faster than the distance: its slope falls towards the place."""
    powers = [
        math.log(_size(far) / _size(near)) / math.log((far.x - best.x) / (near.x - best.x))
        for near, far in (side for side in sides if len(side) == 2)
    ]
    return min(powers, default=0.0) > SAGS


def neighbours(course: MeasureCourse, group: SideGroup, way: int, clear: float) -> list[Sample]:
    """Up to two samples beside a group, the nearest first, of its stretch: off the value by more than `clear`."""
    samples = course.samples
    k = samples.index(group[0] if way < 0 else group[-1])
    found: list[Sample] = []
    while len(found) < 2 and 0 <= k + way < len(samples) and not course.parted(k + min(way, 0)):
        k += way
        sample = samples[k]
        apart = not found or abs(sample.x - found[0].x) >= APART * abs(found[0].x - group[0].x)
        if sample.side and _size(sample) >= clear and apart:
            found.append(sample)
    return found


def doubtful(course: MeasureCourse) -> Iterator[float]:
    """Where to ask beside crossings whose slope is not well known: by these a crossing is enclosed."""
    found = groups(course)
    for k, group in enumerate(found):
        before, after = (found[i].side if 0 <= i < len(found) else None for i in (k - 1, k + 1))
        if group.side != 0 or before == after or not (before or after):
            continue
        best = min(group, key=_size)
        size = size_at(group, best)
        known = slope_at(course, group, best, size)
        if known is not None and known.tells(size):
            continue
        near = ENCLOSE * size / known.chord if known is not None and known.chord > 0.0 else math.inf
        for way, end, outer in enclosure(course, group):
            if outer is None or abs(outer.x - best.x) * ENCLOSE <= near * ENCLOSED:
                continue
            half = 0.5 * (end.x + outer.x)
            there = best.x + way * near
            yield there if way * end.x < way * there < way * half else half


def unsolved(course: MeasureCourse) -> Iterator[UnsolvedStretch]:
    """Where there is no measure."""
    samples = course.samples
    for known, members in groupby(range(len(samples)), key=lambda i: samples[i].gap is not None):
        if known:
            continue
        places = list(members)
        low = samples[places[0] - 1].x if places[0] else course.low
        high = samples[places[-1] + 1].x if places[-1] + 1 < len(samples) else course.high
        reasons = [samples[i].why for i in places]
        code, reason = max(dict.fromkeys(reasons), key=lambda why: sum(each[0] == why[0] for each in reasons))
        apart = tuple(samples[i] for i in places if samples[i].withheld is not None)
        ends = samples[places[0]].x, samples[places[-1]].x
        yield UnsolvedStretch(low, high, code, reason, len(places), *ends, apart)


def met(course: MeasureCourse, wanted: int, *, equal: bool) -> Iterator[Met]:
    """The stretches in which the course lies on a side; equal: the value itself meets the condition, too."""
    found = groups(course)
    open_: MetEdge | None = None
    for k, group in enumerate(found):
        if group.side != wanted:
            continue
        before, after = (found[i] if 0 <= i < len(found) else None for i in (k - 1, k + 1))
        low, high = edge(course, group[0], before), edge(course, group[-1], after)
        start = open_ or low
        beyond = found[k + 2].side if k + 2 < len(found) else None
        open_ = start if equal and high.kind == "touch" and beyond == wanted else None
        if open_ is None:
            yield Met(start, high)


def edge(course: MeasureCourse, last: Sample, beside: SideGroup | None) -> MetEdge:
    """Where a stretch ends whose last sample that is."""
    if beside is None:
        return MetEdge(last.x, 0.0, "end")
    if beside.side is None:
        failed = beside[0] if beside[0].x > last.x else beside[-1]
        return MetEdge(last.x, abs(failed.x - last.x), "unsolved")
    if beside.side:
        pair = tuple(sorted((last.x, (beside[0] if beside[0].x > last.x else beside[-1]).x)))
        kind: EdgeKind = "crossing" if pair in course.steep else "jump" if pair in course.jumps else "bracket"
        return MetEdge(last.x, pair[1] - pair[0], kind)
    best = min(beside, key=_size)
    if at_end(course, beside):
        return MetEdge((beside[-1] if best.x > last.x else beside[0]).x, 0.0, "end")
    found = next(each for each in meetings(course) if isinstance(each, Crossing | Touch) and each.sample is best)
    if isinstance(found, Touch):
        return MetEdge(best.x, found.high - found.low, "touch")
    return MetEdge(best.x, found.error, "crossing")


def at_end(course: MeasureCourse, group: SideGroup) -> bool:
    """Whether what is not told from the value lies at an end of the interval, or of what is solved."""
    samples = course.samples
    first, last = samples.index(group[0]), samples.index(group[-1])
    return first == 0 or last == len(samples) - 1 or samples[first - 1].gap is None or samples[last + 1].gap is None


def _size(sample: Sample) -> float:
    return abs(_gap(sample))


def _gap(sample: Sample) -> float:
    return sample.gap or 0.0
