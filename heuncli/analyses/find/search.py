"""Search where a measure may meet its value: a scan, and more places wherever the behaviour between two is uncertain.

A place is evaluated between neighbours on different sides (a crossing or a jump is enclosed), between neighbours on one
side where the measure may return to the value (an extreme that touches it, two close crossings), and at the ends of the
solvable range. The measure certainly does not return if the predicted values between the neighbours, reduced by their
error, stay on that side.
"""

from __future__ import annotations

import math
from bisect import bisect, bisect_left
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.analyses.find.narrowing import narrow_all
from heuncli.analyses.find.poles import find_possible_peak, has_pole, is_far_from_value
from heuncli.analyses.find.touches import (
    find_touch_range,
    follow_minimum,
    is_deep,
    iter_minima,
    leads_to_touch,
    step_towards_value,
)
from heuncli.analyses.variants.course import FIRST_DISTRUST, GOLDEN, MeasureCourse
from heuncli.analyses.variants.course_extremes import clip_inside
from heuncli.analyses.variants.course_prediction import MAX_DISTRUST, NOISE, predict_course, sample_and_learn
from heuncli.analyses.variants.samples import AT_VALUE, LEFT, RIGHT, Sample, interpolate
from heuncli.base import tolerances

FINE_GAP = 0.125  # share of the scan's spacing: before closer neighbours are divided, minima of |g| are followed
WIDE_GAP = 0.5  # share of the scan's spacing: neighbours farther apart count as an interval of the scan
CHECK_OFFSET = 0.1  # largest distance of a check from the middle, as a share of its interval: so no wave is hidden


def search(course: MeasureCourse) -> None:
    """Evaluate places until it is certain where the value is met. Raises SampleLimitError."""
    while True:
        narrow_all(course)
        i = find_widest_uncertain(course)
        if i is None:
            break
        left, right = course.samples[i], course.samples[i + 1]
        if right.x - left.x < FINE_GAP * course.spacing and follow_new_minimum(course):
            continue
        course.searched_pairs.add((left.x, right.x))
        if left.gap is None or right.gap is None:
            course.sample_at(0.5 * (left.x + right.x))
        elif (x := find_possible_peak(course, i)) is not None:
            sample_and_learn(course, x)
        else:
            sample_and_learn(course, choose_place(course, i))


def follow_new_minimum(course: MeasureCourse) -> bool:
    """Follow the first deep minimum of |g| that was not followed before; return whether there was one.

    Raises SampleLimitError.
    """
    for left, middle, right in iter_minima(course):
        if middle.x not in course.followed and is_deep(left, middle, right):
            course.followed.add(middle.x)
            follow_minimum(course, middle.x)
            return True
    return False


def find_widest_uncertain(course: MeasureCourse) -> int | None:
    """Return the index of the left one of the widest pair with uncertain behaviour between them; None without one."""
    ends = find_range_ends(course)
    widths = {
        i: right.x - left.x for i, left, right in course.iter_pairs() if (left.x, right.x) not in course.searched_pairs
    }
    for i in sorted(widths, key=lambda i: -widths[i]):  # of equally wide ones the first
        neighbours = course.samples[max(i - 2, 0) : i + 4]
        # What the decision depends on: the samples near by, the distrust, the number of range ends.
        surroundings = (*(sample.x for sample in neighbours), course.distrust, len(ends))
        if surroundings in course.certain:
            continue
        if is_uncertain(course, i, ends):
            return i
        course.certain.add(surroundings)
    return None


def is_uncertain(course: MeasureCourse, i: int, ends: list[tuple[float, float]]) -> bool:
    """Return whether a place between two neighbours must be evaluated.

    ends: result of `find_range_ends`
    """
    left, right = course.samples[i], course.samples[i + 1]
    width = right.x - left.x
    if left.gap is None or right.gap is None:
        return (left.gap is None) != (right.gap is None) and width > tolerances.EDGE_BRACKET * course.spacing
    if course.is_interrupted(i) or width <= 2.0 * course.finest:
        return False
    if find_possible_peak(course, i) is not None:
        return True
    if is_near_jump(course, left, right, ends) or is_far_from_value(course, left, right):
        return False
    if leads_to_touch(course, i):
        return False
    prediction = predict_course(course, i)
    side, error = left.side or right.side, max(left.error, right.error)
    if not side:  # both meet the value: do all places between?
        return bool((np.abs(prediction.gaps) + prediction.uncertainty > NOISE * error).any())
    nearest = side * prediction.gaps - prediction.uncertainty
    return bool((nearest <= (error if left.side == right.side else -NOISE * error)).any())


def check_scan(course: MeasureCourse) -> None:
    """Evaluate one more place in each interval of the scan that may hide a wave.

    A deviation from the prediction raises the distrust, with which the whole range is examined again; both parts of the
    interval are then tried in turn. Raises SampleLimitError.
    """
    places = [sample.x for sample in course.samples]
    # Intervals of the scan without a sample inside:
    intervals = [pair for pair in pairwise(course.scanned) if bisect(places, pair[0]) == bisect_left(places, pair[1])]
    intervals += [
        pair for pair in pairwise(places) if pair[1] - pair[0] >= WIDE_GAP * course.spacing and pair not in intervals
    ]
    while intervals:
        low, high = intervals.pop()
        i = next(i for i, one, _ in course.iter_pairs() if one.x == low)
        if (
            course.samples[i + 1].x != high
            or high - low <= tolerances.DOUBTED_NEAR_JUMP * course.spacing
            or not may_hide_wave(course, i)
        ):
            continue
        offset = CHECK_OFFSET * (2.0 * (len(places) * GOLDEN % 1.0) - 1.0)  # from the middle, another each time
        x = low + (high - low) * (0.5 + offset)
        prediction = predict_course(course, i, np.array([x]))
        evaluated = sample_and_learn(course, x)
        places.append(x)
        prediction_error = float(prediction.uncertainty[0]) * FIRST_DISTRUST / course.distrust
        if (
            evaluated.gap is not None
            and abs(evaluated.gap - float(prediction.gaps[0])) > prediction_error + prediction.noise + evaluated.error
        ):
            intervals += [(low, x), (x, high)]


def may_hide_wave(course: MeasureCourse, i: int) -> bool:
    """Return whether two neighbours may hide a wave that meets the value, by predictions of the greatest distrust.

    They may if the curvature changes there, or if one of them is the last of its stretch: predictions are then
    one-sided, and agree by accident at times.
    """
    left, right = course.samples[i], course.samples[i + 1]
    if course.is_interrupted(i) or not left.side or left.side != right.side:
        return False
    if has_pole(course):  # then no value is far from any other
        return True
    is_one_sided = not (course.find_neighbours(i, LEFT) and course.find_neighbours(i, RIGHT))
    if breaks_law(course, i) or (is_one_sided and course.distrust > FIRST_DISTRUST):
        return True
    if not (is_one_sided or changes_curvature(course, i)):
        return False
    prediction = predict_course(course, i)
    nearest = left.side * prediction.gaps - MAX_DISTRUST / course.distrust * prediction.uncertainty
    return bool((nearest <= max(left.error, right.error)).any())


def breaks_law(course: MeasureCourse, i: int) -> bool:
    """Return whether four samples on one side of an interval lie on a parabola, to their errors, and the next one does
    not.

    Then the law changes in the interval, at a kink or a jump, and no prediction holds there.
    """
    for first, tested in ((i - 3, i + 1), (i + 1, i)):  # first index of the four, index of the one to follow them
        if first < 0 or first + 4 > len(course.samples) or any(map(course.is_interrupted, range(first, first + 3))):
            continue
        law = course.samples[first : first + 4]
        if follows_parabola(law[1:], law[0]) and follows_parabola(law[:-1], law[-1]):
            nearest = law[1:] if tested > first else law[:-1]
            if not follows_parabola(nearest, course.samples[tested]):
                return True
    return False


def follows_parabola(samples: list[Sample], another: Sample) -> bool:
    """Return whether another sample lies on the parabola through three, to NOISE times their errors."""
    x = np.array([another.x])
    factors = [
        math.prod(abs((another.x - b.x) / (a.x - b.x)) for b in samples if b is not a) * a.error for a in samples
    ]
    deviation = abs(float(interpolate(samples, x)[0]) - another.gap_or_zero)
    return deviation <= NOISE * (sum(factors) + another.error)


def changes_curvature(course: MeasureCourse, i: int) -> bool:
    """Return whether the four samples around two neighbours change the sign of their curvature.

    Curvature of one sign is followed by the polynomials, or by the logarithm.
    """
    left, right = course.find_neighbours(i, LEFT), course.find_neighbours(i, RIGHT)
    samples = [
        *reversed(left[: 1 if right else 2]), course.samples[i], course.samples[i + 1], *right[: 1 if left else 2],
    ]  # fmt: skip
    slopes = [(b.gap_or_zero - a.gap_or_zero) / (b.x - a.x) for a, b in pairwise(samples)]
    curvatures = [after - before for before, after in pairwise(slopes)]
    return len(curvatures) < 2 or curvatures[0] * curvatures[-1] < 0.0


def iter_possible_meetings(course: MeasureCourse) -> Iterator[tuple[Sample, Sample]]:
    """Yield stretches on one side of the value where samples and their errors do not exclude that the value is met.

    Unlike in `is_uncertain`, differences between polynomials within the noise count: more evaluations would not help,
    and yet the measure may reach the value. Ends that lead to a reported crossing or touch are left out.
    """
    ends = find_range_ends(course)
    stretch: tuple[Sample, Sample] | None = None
    for i, left, right in course.iter_pairs():
        if not (
            left.side and left.side == right.side and not course.is_interrupted(i) and may_meet_value(course, i, ends)
        ):
            if stretch is not None:
                yield stretch
            stretch = None
        else:
            stretch = (stretch[0] if stretch is not None else left, right)
    if stretch is not None:
        yield stretch


def may_meet_value(course: MeasureCourse, i: int, ends: list[tuple[float, float]]) -> bool:
    """Return whether the measure may meet its value between two neighbours on one side.

    ends: result of `find_range_ends`
    """
    left, right = course.samples[i], course.samples[i + 1]
    if is_far_from_value(course, left, right) or is_near_jump(course, left, right, ends) or leads_to_meeting(course, i):
        return False
    if leads_to_touch(course, i):
        return False
    prediction = predict_course(course, i)
    nearest = (left.side or 0) * prediction.gaps - prediction.total_uncertainty
    return bool((nearest <= 0.0).any()) or find_possible_peak(course, i) is not None


def leads_to_meeting(course: MeasureCourse, i: int) -> bool:
    """Return whether the measure falls between two neighbours towards an outer one that meets the value."""
    samples = course.samples
    for near, far, outer in ((i, i + 1, i - 1), (i + 1, i, i + 2)):
        is_met = 0 <= outer < len(samples) and samples[outer].side != samples[near].side
        if is_met and samples[near].distance < samples[far].distance:
            return True
    return False


def find_range_ends(course: MeasureCourse) -> list[tuple[float, float]]:
    """Return the pairs of places between which the course ends.

    There the measure jumps, is vertical, does not exist on one side, or meets the value without an error.
    """
    ends = [(a.x, b.x) for _, a, b in course.iter_pairs() if (a.gap is None) != (b.gap is None)]
    exact = [(sample.x, sample.x) for sample in course.samples if sample.side == AT_VALUE and sample.error == 0.0]
    touches = [find_touch_range(course, middle) for _, middle, _ in iter_minima(course)]
    return [*course.jumps, *course.steep, *ends, *exact, *(touch for touch in touches if touch)]


def is_near_jump(course: MeasureCourse, left: Sample, right: Sample, ends: list[tuple[float, float]]) -> bool:
    """Return whether the measure jumps or ends close to two neighbours, where no prediction is certain."""
    margin = tolerances.DOUBTED_NEAR_JUMP * course.spacing
    return any(low - margin <= left.x and right.x <= high + margin for low, high in ends)


def choose_place(course: MeasureCourse, i: int) -> float:
    """Choose the place to evaluate between the i-th sample and the next.

    Between two on one side it is where the measure may come nearest to the value; next to a sample that meets the value
    it is where |g| is a few errors; else it is the middle.
    """
    left, right, prediction = course.samples[i], course.samples[i + 1], predict_course(course, i)
    if not left.side or left.side != right.side:
        place = step_towards_value(course, i)
        return 0.5 * (left.x + right.x) if place is None else place
    return clip_inside(
        left, right, float(prediction.places[np.argmin(left.side * prediction.gaps - prediction.uncertainty)])
    )
