"""Find the places where a measure meets its target value, from its samples, and the error of each place.

    |x - x0| <= E / |g'|            E: the error of the measure and the residual of g at the place, in the unit of g

The slope g' comes from neighbours clearly off the value, minus its own error, and is no more than the chords to them.
The place is never farther than the next neighbours that are certainly on one side. Where the measure bends at the
value, or its slope falls towards it as at an inflection, the neighbours' slopes do not describe the place itself: the
crossing is then enclosed, and the enclosure is its error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby
from operator import attrgetter

from heuncli.analyses.find.results import (
    AT_END,
    Crossing,
    EdgeKind,
    MeasureJump,
    MetEdge,
    MetStretch,
    Touch,
    UnresolvedBracket,
    UnsolvedStretch,
)
from heuncli.analyses.find.touches import find_touch_range, iter_minima
from heuncli.analyses.variants.course import MIN_DISTANCE, MeasureCourse
from heuncli.analyses.variants.samples import AT_VALUE, LEFT, RIGHT, Sample, interpolate_slope
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple

CLEAR_FACTOR = 20.0  # |g| / E of neighbours that give a slope to a tenth
MAX_SLOPE_ERROR = 0.5  # permitted relative error of a slope
MIN_CHORD_RATIO = 0.5  # smallest ratio of the flatter chord to the steeper one at which the measure does not bend
ENCLOSURE_FACTOR = 2.0  # distance at which a crossing is enclosed, in E / chord
FLAT_FACTOR = 4.0  # half width of an enclosure above which the crossing counts as flat, in E / chord


class SlopeEstimate(NamedTuple):
    """Bounds of the slope at a sample.

    least: the smallest possible |g'|
    bend: |g''|/2
    chord: the smallest slope of the chords to the neighbours
    is_reliable: whether the slopes between the neighbours also hold at the sample
    """

    least: float
    bend: float
    chord: float
    is_reliable: bool

    def is_sufficient(self, error: float) -> bool:
        """Return whether the estimate locates the place well for an error of this size."""
        return self.is_reliable and self.least > 0.0 and self.least**2 > 4.0 * self.bend * error / MAX_SLOPE_ERROR

    def compute_distance(self, error: float) -> float | None:
        """Return how far the place may be from the sample; None if the slope is too small."""
        discriminant = self.least * self.least - 4.0 * self.bend * error
        return 2.0 * error / (self.least + math.sqrt(discriminant)) if self.least > 0.0 and discriminant > 0.0 else None


class SideGroup(list[Sample]):
    """Adjacent samples on one side of the value."""

    @property
    def side(self) -> int | None:
        """The side on which the samples lie."""
        return self[0].side


def group_by_side(course: MeasureCourse) -> list[SideGroup]:
    """Return the samples in groups on one side of the value."""
    return [SideGroup(samples) for _, samples in groupby(course.samples, key=lambda sample: sample.side)]


def iter_meetings(course: MeasureCourse) -> Iterator[Crossing | Touch | MeasureJump | UnresolvedBracket]:
    """Yield where the measure meets its value, jumps across it, or passes it in an unknown way."""
    found = group_by_side(course)
    for _, middle, _ in iter_minima(course):
        if (ends := find_touch_range(course, middle)) is not None:
            yield Touch(middle, *ends, middle.side or AT_VALUE)
    for k, group in enumerate(found):
        before = found[k - 1].side if k else None
        after = found[k + 1].side if k + 1 < len(found) else None
        if group.side == AT_VALUE:
            meeting = classify_group(course, group, before, after)
            if isinstance(meeting, Touch) and meeting.side:
                # its ends are the next samples that differ from the value
                meeting = meeting._replace(low=found[k - 1][-1].x, high=found[k + 1][0].x)
            yield meeting
        elif group.side and before and before == -group.side:
            left, right = found[k - 1][-1], group[0]
            if (left.x, right.x) in course.jumps:
                yield MeasureJump(left, right)
            elif (left.x, right.x) in course.steep:
                yield Crossing(min(left, right, key=attrgetter("distance")), right.x - left.x, group.side)
            elif not course.is_interrupted(course.samples.index(left)):
                yield UnresolvedBracket(left, right)


def classify_group(
    course: MeasureCourse, group: SideGroup, previous_side: int | None, next_side: int | None
) -> Crossing | Touch:
    """Classify samples that cannot be distinguished from the value, by the sides of the adjacent groups."""
    best = min(group, key=attrgetter("distance"))
    if previous_side and previous_side == next_side:
        return Touch(best, group[0].x, group[-1].x, previous_side)
    if not previous_side and not next_side:
        return Touch(best, group[0].x, group[-1].x, AT_VALUE)
    error, is_flat = estimate_place_error(course, group, best)
    return Crossing(best, error, next_side if previous_side and next_side else AT_END, is_flat)


def estimate_place_error(course: MeasureCourse, group: SideGroup, best: Sample) -> tuple[float, bool]:
    """Return how far the true place may be from a sample, and whether the slope there is too small to determine it."""
    value_error = compute_value_error(group, best)
    limit = max(abs((outer or end).x - best.x) for _, end, outer in iter_enclosure(course, group))
    slope_estimate = estimate_slope(course, group, best, value_error)
    if slope_estimate is None:
        return limit, True
    if slope_estimate.is_reliable:
        distance = slope_estimate.compute_distance(value_error)
        return (limit, True) if distance is None else (min(limit, distance), False)
    return limit, limit * slope_estimate.chord > FLAT_FACTOR * value_error


def compute_value_error(group: SideGroup, best: Sample) -> float:
    """Return E: the error of the measure plus its residual."""
    return max(sample.error for sample in group) + best.distance


def iter_enclosure(course: MeasureCourse, group: SideGroup) -> Iterator[tuple[int, Sample, Sample | None]]:
    """Yield for both directions the end of a group and the next sample that is certainly on one side, or None."""
    for direction, end in ((LEFT, group[0]), (RIGHT, group[-1])):
        yield direction, end, next(iter(find_clear_neighbours(course, group, direction, 0.0)), None)


def estimate_slope(course: MeasureCourse, group: SideGroup, best: Sample, value_error: float) -> SlopeEstimate | None:
    """Estimate the slope at a sample; None if there are too few neighbours."""
    left, right = (
        find_clear_neighbours(course, group, direction, CLEAR_FACTOR * value_error) for direction in (LEFT, RIGHT)
    )
    all_samples = [*reversed(left), best, *right]
    if len(all_samples) < 3:
        return None
    # the parabola through the nearest gives the slope; cubics with one more sample differ from it by its error
    nearest = [*left[: 1 if right else 2], *right[: 1 if left else 2], best]
    larger_sets = [sorted({*nearest, extra}) for extra in all_samples if extra not in nearest]
    slopes = [interpolate_slope(sorted(points), best.x) for points in (nearest, *larger_sets)]
    noise = max((sample.error + best.error) / abs(sample.x - best.x) for sample in nearest if sample is not best)
    slope_error = noise + max((abs(points - slopes[0]) for points in slopes[1:]), default=0.0)
    a, b, c = sorted(nearest)
    bend = ((c.gap_or_zero - b.gap_or_zero) / (c.x - b.x) - (b.gap_or_zero - a.gap_or_zero) / (b.x - a.x)) / (c.x - a.x)
    chords = [abs((side[0].gap_or_zero - best.gap_or_zero) / (side[0].x - best.x)) for side in (left, right) if side]
    is_reliable = (
        bool(larger_sets)
        and min(chords) >= MIN_CHORD_RATIO * max(*chords, abs(slopes[0]))
        and not is_flattening(best, left, right)
    )
    chord = min(chords) - noise
    return SlopeEstimate(min(abs(slopes[0]) - slope_error, chord), abs(bend), chord, is_reliable)


def is_flattening(best: Sample, *sides: list[Sample]) -> bool:
    """Return whether g grows faster than the distance on all sides, so that its slope falls towards the place."""
    powers = [
        math.log(far.distance / near.distance) / math.log((far.x - best.x) / (near.x - best.x))
        for near, far in (side for side in sides if len(side) == 2)
    ]
    return min(powers, default=0.0) > tolerances.FLATTENS


def find_clear_neighbours(course: MeasureCourse, group: SideGroup, direction: int, min_size: float) -> list[Sample]:
    """Find up to two samples next to a group, nearest first, that differ from the value by `min_size` or more."""
    k = course.samples.index(group[0] if direction == LEFT else group[-1])
    found: list[Sample] = []
    for sample in course.iter_outward(k, direction):
        is_separate = not found or abs(sample.x - found[0].x) >= MIN_DISTANCE * abs(found[0].x - group[0].x)
        if sample.side and sample.distance >= min_size and is_separate:
            found.append(sample)
            if len(found) == 2:
                break
    return found


def iter_enclosing_places(course: MeasureCourse) -> Iterator[float]:
    """Yield places to evaluate near crossings with an uncertain slope, to enclose them."""
    found = group_by_side(course)
    for k, group in enumerate(found):
        previous_side, next_side = (found[i].side if 0 <= i < len(found) else None for i in (k - 1, k + 1))
        if group.side != AT_VALUE or previous_side == next_side or not (previous_side or next_side):
            continue
        best = min(group, key=attrgetter("distance"))
        value_error = compute_value_error(group, best)
        slope_estimate = estimate_slope(course, group, best, value_error)
        if slope_estimate is not None and slope_estimate.is_sufficient(value_error):
            continue
        distance = (
            ENCLOSURE_FACTOR * value_error / slope_estimate.chord
            if slope_estimate is not None and slope_estimate.chord > 0.0
            else math.inf
        )
        for direction, end, outer in iter_enclosure(course, group):
            if outer is None or abs(outer.x - best.x) * ENCLOSURE_FACTOR <= distance * FLAT_FACTOR:
                continue
            half = 0.5 * (end.x + outer.x)
            place = best.x + direction * distance
            yield place if direction * end.x < direction * place < direction * half else half


def iter_unsolved(course: MeasureCourse) -> Iterator[UnsolvedStretch]:
    """Yield the stretches without a measure."""
    samples = course.samples
    for is_solved, group in groupby(range(len(samples)), key=lambda i: samples[i].gap is not None):
        if is_solved:
            continue
        indices = list(group)
        low = samples[indices[0] - 1].x if indices[0] else course.low
        high = samples[indices[-1] + 1].x if indices[-1] + 1 < len(samples) else course.high
        reasons = [samples[i].why for i in indices]
        code, reason = max(dict.fromkeys(reasons), key=lambda why: sum(each[0] == why[0] for each in reasons))
        withheld = tuple(samples[i] for i in indices if samples[i].withheld_gap is not None)
        ends = samples[indices[0]].x, samples[indices[-1]].x
        yield UnsolvedStretch(low, high, code, reason, len(indices), *ends, withheld)


def iter_met_stretches(course: MeasureCourse, side: int, *, includes_value: bool) -> Iterator[MetStretch]:
    """Yield the stretches where the measure lies on a given side.

    includes_value: whether the value itself meets the condition
    """
    found = group_by_side(course)
    start_edge: MetEdge | None = None
    for k, group in enumerate(found):
        if group.side != side:
            continue
        previous, following = (found[i] if 0 <= i < len(found) else None for i in (k - 1, k + 1))
        low, high = make_edge(course, group[0], previous), make_edge(course, group[-1], following)
        start = start_edge or low
        far_side = found[k + 2].side if k + 2 < len(found) else None
        start_edge = start if includes_value and high.kind == "touch" and far_side == side else None
        if start_edge is None:
            yield MetStretch(start, high)


def make_edge(course: MeasureCourse, sample: Sample, neighbour_group: SideGroup | None) -> MetEdge:
    """Return the end of a stretch whose last sample is given."""
    if neighbour_group is None:
        return MetEdge(sample.x, 0.0, "end")
    if neighbour_group.side is None:
        unsolved = neighbour_group[0] if neighbour_group[0].x > sample.x else neighbour_group[-1]
        return MetEdge(sample.x, abs(unsolved.x - sample.x), "unsolved")
    if neighbour_group.side:
        pair = tuple(
            sorted((sample.x, (neighbour_group[0] if neighbour_group[0].x > sample.x else neighbour_group[-1]).x))
        )
        kind: EdgeKind = "crossing" if pair in course.steep else "jump" if pair in course.jumps else "bracket"
        return MetEdge(sample.x, pair[1] - pair[0], kind)
    best = min(neighbour_group, key=attrgetter("distance"))
    if is_at_end(course, neighbour_group):
        return MetEdge((neighbour_group[-1] if best.x > sample.x else neighbour_group[0]).x, 0.0, "end")
    meeting = next(each for each in iter_meetings(course) if isinstance(each, Crossing | Touch) and each.sample is best)
    if isinstance(meeting, Touch):
        return MetEdge(best.x, meeting.high - meeting.low, "touch")
    return MetEdge(best.x, meeting.error, "crossing")


def is_at_end(course: MeasureCourse, group: SideGroup) -> bool:
    """Return whether a group lies at an end of the interval, or of the solvable range."""
    samples = course.samples
    first_index, last_index = samples.index(group[0]), samples.index(group[-1])
    return (
        first_index == 0
        or last_index == len(samples) - 1
        or samples[first_index - 1].gap is None
        or samples[last_index + 1].gap is None
    )
