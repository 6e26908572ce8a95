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

from heuncli.analyses.find.touches import (
    find_hidden_pole,
    find_touch_range,
    follow_minimum,
    has_pole,
    is_deep,
    is_far_from_value,
    iter_minima,
    leads_to_touch,
    step_towards_value,
)
from heuncli.analyses.variants.course import (
    FIRST_DISTRUST,
    GOLDEN,
    MAX_DISTRUST,
    NOISE,
    MeasureCourse,
    clip_inside,
)
from heuncli.analyses.variants.samples import Sample, interpolate
from heuncli.base import tolerances

FINE_GAP = 0.125  # of the scan's spacing: before neighbours closer than this are parted, minima of |g| are followed
MAX_REMAINING_GAP = 0.25  # of the gap: if interpolation leaves more than this, a halving follows
WIDE_BRACKET = 1000.0  # times the narrowest bracket: a wider one, across which a jump has the same size
MIN_BRACKET = 10.0  # times the narrowest bracket: a comparison bracket that is not wider proves no jump
WIDE_GAP = 0.5  # of the scan's spacing: neighbours farther apart count as an interval of the scan
CHECK_OFFSET = 0.1  # of a scan interval: offset from its middle, so that no wave is hidden by aliasing
FIRST_POLE_SHARE, MIN_POLE_SHARE = 0.05, 1e-6  # of a bracket: distance to both sides of the predicted pole
PEAK_GROWTH = 2.0  # times the predicted rise of a peak: its possible rise


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
            course.sample_and_learn(x)
        else:
            course.sample_and_learn(choose_place(course, i))


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


def narrow_all(course: MeasureCourse) -> None:
    """Enclose all crossings and jumps between neighbours on different sides. Raises SampleLimitError."""
    while (i := next(iter_unresolved_pairs(course), None)) is not None:
        narrow_pair(course, i)


def iter_unresolved_pairs(course: MeasureCourse) -> Iterator[int]:
    """Yield neighbours on different sides between which neither a crossing nor a jump is known yet."""
    for i, left, right in course.iter_pairs():
        is_known = (left.x, right.x) in course.steep or course.is_interrupted(i)
        if not is_known and left.side and right.side and left.side != right.side:
            yield i


def find_widest_uncertain(course: MeasureCourse) -> int | None:
    """Return the widest pair of neighbours with uncertain behaviour between them; None if there is none."""
    ends = find_range_ends(course)
    pairs = [
        (right.x - left.x, -i)
        for i, left, right in course.iter_pairs()
        if (left.x, right.x) not in course.searched_pairs
    ]
    for _, i in sorted(pairs, reverse=True):
        surroundings = (*(sample.x for sample in course.samples[max(-i - 2, 0) : 4 - i]), course.distrust, len(ends))
        if surroundings in course.certain:
            continue
        if is_uncertain(course, -i, ends):
            return -i
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
    prediction = course.predict(i)
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
        x = low + (high - low) * (0.5 + CHECK_OFFSET * (2.0 * (len(places) * GOLDEN % 1.0) - 1.0))
        prediction = course.predict(i, np.array([x]))
        evaluated = course.sample_and_learn(x)
        places.append(x)
        prediction_error = float(prediction.uncertainty[0]) * FIRST_DISTRUST / course.distrust
        if (
            evaluated.gap is not None
            and abs(evaluated.gap - float(prediction.gaps[0])) > prediction_error + prediction.noise + evaluated.error
        ):
            intervals += [(low, x), (x, high)]


def may_hide_wave(course: MeasureCourse, i: int) -> bool:
    """Return whether two neighbours may hide a wave that meets the value, with a prediction error MAX_DISTRUST times as
    large.

    They may if the curvature changes there, or if one of them is the last of its stretch: predictions are then
    one-sided, and agree by accident at times.
    """
    left, right = course.samples[i], course.samples[i + 1]
    if course.is_interrupted(i) or not left.side or left.side != right.side:
        return False
    if has_pole(course):  # then no value is far from any other
        return True
    is_one_sided = not (course.find_neighbours(i, -1) and course.find_neighbours(i, 1))
    if breaks_law(course, i) or (is_one_sided and course.distrust > FIRST_DISTRUST):
        return True
    if not (is_one_sided or changes_curvature(course, i)):
        return False
    prediction = course.predict(i)
    nearest = left.side * prediction.gaps - MAX_DISTRUST / course.distrust * prediction.uncertainty
    return bool((nearest <= max(left.error, right.error)).any())


def breaks_law(course: MeasureCourse, i: int) -> bool:
    """Return whether four samples on one side of a gap lie on a parabola, to their errors, and the one beyond does not.

    Then the law changes in the gap, at a kink or a jump, and no prediction holds there.
    """
    for near, direction in ((i, -1), (i + 1, 1)):
        law = course.samples[max(near - 3, 0) : near + 1] if direction < 0 else course.samples[near : near + 4]
        is_whole = len(law) == 4 and not any(
            course.is_interrupted(k) for k in (range(near - 3, near) if direction < 0 else range(near, near + 3))
        )
        if is_whole and follows_parabola(law[1:], law[0]) and follows_parabola(law[:-1], law[-1]):
            nearest = law[1:] if direction < 0 else law[:-1]
            if not follows_parabola(nearest, course.samples[near - direction]):
                return True
    return False


def follows_parabola(samples: list[Sample], another: Sample) -> bool:
    """Return whether another sample lies on the parabola through three, to NOISE times their errors."""
    x = np.array([another.x])
    factors = [
        math.prod(abs((another.x - b.x) / (a.x - b.x)) for b in samples if b is not a) * a.error for a in samples
    ]
    deviation = abs(float(interpolate(samples, x)[0]) - (another.gap or 0.0))
    return deviation <= NOISE * (sum(factors) + another.error)


def changes_curvature(course: MeasureCourse, i: int) -> bool:
    """Return whether the four samples around two neighbours change the sign of their curvature.

    Curvature of one sign is followed by the polynomials, or by the logarithm.
    """
    left, right = course.find_neighbours(i, -1), course.find_neighbours(i, 1)
    samples = [
        *reversed(left[: 1 if right else 2]), course.samples[i], course.samples[i + 1], *right[: 1 if left else 2],
    ]  # fmt: skip
    slopes = [((b.gap or 0.0) - (a.gap or 0.0)) / (b.x - a.x) for a, b in pairwise(samples)]
    curvatures = [after - before for before, after in pairwise(slopes)]
    return len(curvatures) < 2 or curvatures[0] * curvatures[-1] < 0.0


def iter_possible_meetings(course: MeasureCourse) -> Iterator[tuple[Sample, Sample]]:
    """Yield stretches on one side where samples and their errors do not exclude that the value is met.

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
    prediction = course.predict(i)
    nearest = (left.side or 0) * prediction.gaps - prediction.total_uncertainty
    return bool((nearest <= 0.0).any()) or find_possible_peak(course, i) is not None


def leads_to_meeting(course: MeasureCourse, i: int) -> bool:
    """Return whether the measure falls between two neighbours towards an outer one that meets the value."""
    samples = course.samples
    for near, far, outer in ((i, i + 1, i - 1), (i + 1, i, i + 2)):
        is_met = 0 <= outer < len(samples) and samples[outer].side != samples[near].side
        if is_met and abs(samples[near].gap or 0.0) < abs(samples[far].gap or 0.0):
            return True
    return False


def find_range_ends(course: MeasureCourse) -> list[tuple[float, float]]:
    """Return the pairs of places between which the measure jumps, is vertical, ends, or touches the value where its
    error vanishes.
    """
    ends = [(a.x, b.x) for _, a, b in course.iter_pairs() if (a.gap is None) != (b.gap is None)]
    exact = [(sample.x, sample.x) for sample in course.samples if sample.side == 0 and sample.error == 0.0]
    touches = [find_touch_range(course, middle) for _, middle, _ in iter_minima(course)]
    return [*course.jumps, *course.steep, *ends, *exact, *(touch for touch in touches if touch)]


def is_near_jump(course: MeasureCourse, left: Sample, right: Sample, ends: list[tuple[float, float]]) -> bool:
    """Return whether the measure jumps or ends close to two neighbours; predictions towards a pole are never
    certain.
    """
    margin = tolerances.DOUBTED_NEAR_JUMP * course.spacing
    return any(low - margin <= left.x and right.x <= high + margin for low, high in ends)


def find_possible_peak(course: MeasureCourse, i: int) -> float | None:
    """Return where a peak or a pole between two neighbours may reach the value; None if nothing indicates one."""
    left, right = course.samples[i], course.samples[i + 1]
    if (pole := find_hidden_pole(course, i)) is not None:
        return clip_inside(left, right, pole)
    peak = course.find_peak(i)
    if peak is None or not left.side or left.side != right.side:
        return None
    if np.isinf(peak.size) and (left.gap + course.value) * (right.gap + course.value) < 0.0:  # type: ignore[operator]
        return clip_inside(left, right, step_to_pole(course, left, right, peak.place))
    largest = (
        max((sample.gap or 0.0) + course.value for sample in (left, right))
        if course.value > 0.0
        else min((sample.gap or 0.0) + course.value for sample in (left, right))
    )
    if largest * course.value <= 0.0 or abs(largest) >= abs(course.value):
        return None
    peak_height = abs(largest) + PEAK_GROWTH * (peak.size - abs(largest))
    return clip_inside(left, right, peak.place) if peak_height >= abs(course.value) else None


def step_to_pole(course: MeasureCourse, left: Sample, right: Sample, pole: float) -> float:
    """Return the place beside a pole at which the measure is twice the value, by the line through its inverse: at the
    pole itself it has no measure.
    """
    before, after = ((sample.gap or 0.0) + course.value for sample in (left, right))
    distance = 0.5 * (right.x - left.x) / abs(course.value * (1.0 / after - 1.0 / before))
    return pole - distance if before * course.value > 0.0 else pole + distance


def choose_place(course: MeasureCourse, i: int) -> float:
    """Choose where to evaluate between two neighbours: where the measure may come nearest to the value; beside a sample
    that meets it just off the value; else in the middle.
    """
    left, right, prediction = course.samples[i], course.samples[i + 1], course.predict(i)
    if not left.side or left.side != right.side:
        place = step_towards_value(course, i)
        return 0.5 * (left.x + right.x) if place is None else place
    return clip_inside(
        left, right, float(prediction.places[np.argmin(left.side * prediction.gaps - prediction.uncertainty)])
    )


def narrow_pair(course: MeasureCourse, i: int) -> None:
    """Narrow two neighbours on different sides down to a crossing or a jump.

    By Brent's rule: the root of the predicted measure, and the middle whenever that gained too little. At a pole both
    sides of the root of the inverse measure are tried, ever closer to it.
    """
    left, right = course.samples[i], course.samples[i + 1]
    failures, pole_share = 0, FIRST_POLE_SHARE
    while right.x - left.x > course.finest:
        if failures and (pole := course.find_pole(course.samples.index(left))) is not None:
            width = right.x - left.x
            left, right = narrow_pole(course, left, right, pole, pole_share)
            if left.gap is None or right.gap is None or not left.side or not right.side:
                return
            is_narrower = right.x - left.x < 2.5 * pole_share * width
            pole_share = max(pole_share * pole_share, MIN_POLE_SHARE) if is_narrower else FIRST_POLE_SHARE
            failures = 1 if right.x - left.x < 0.5 * width else 2
            if is_narrower or failures == 1:
                continue
        x = (
            0.5 * (left.x + right.x)
            if failures > 1
            else step_past_root(course, left, right)
            if failures
            else predict_root(course, left, right)
        )
        best = min(abs(left.gap or 0.0), abs(right.gap or 0.0))
        sample = course.sample_and_learn(x)
        if sample.gap is None or sample.side == 0:
            return
        failures = 0 if abs(sample.gap) < MAX_REMAINING_GAP * best else failures + 1
        left, right = (sample, right) if sample.side == left.side else (left, sample)
    is_jump = not is_steep(course, left, right) and is_jump_size(course, left, right)
    (course.jumps if is_jump else course.steep).add((left.x, right.x))


def narrow_pole(course: MeasureCourse, left: Sample, right: Sample, pole: float, share: float) -> tuple[Sample, Sample]:
    """Evaluate both sides of a predicted pole, at a share of the bracket, and return the narrower bracket."""
    distance = max(share * (right.x - left.x), 0.25 * course.finest)
    for x in (pole - distance, pole + distance):
        if left.x < x < right.x:
            sample = course.sample_at(x)
            if not sample.side:
                return left, sample
            left, right = (sample, right) if sample.side == left.side else (left, sample)
    return left, right


def step_past_root(course: MeasureCourse, left: Sample, right: Sample) -> float:
    """Return a place just past the root, where g slightly exceeds its error; else the middle."""
    nearer, farther = sorted((left, right), key=lambda sample: abs(sample.gap or 0.0))
    gap, noise = abs(nearer.gap or 0.0), NOISE * max(nearer.error, farther.error)
    fraction = (gap + noise) / abs((farther.gap or 0.0) - (nearer.gap or 0.0)) if gap <= noise else 0.5
    distance = max(min(fraction, 0.5) * abs(farther.x - nearer.x), course.finest)
    return nearer.x + distance if farther is right else nearer.x - distance


def is_steep(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether the slope outside suffices to pass from one side to the other within the narrowest bracket.

    Near a jump the slope outside is small, near a pole it grows. Only the change that exceeds both errors counts.
    """
    i = next(i for i, sample, _ in course.iter_pairs() if sample is left)
    outer_pairs = [(left, each) for each in course.find_neighbours(i, -1)[:1]] + [
        (right, each) for each in course.find_neighbours(i, 1)[:1]
    ]
    errors = 2.0 * (left.error + right.error)
    slope_inside = max(abs((right.gap or 0.0) - (left.gap or 0.0)) - errors, 0.0) / (right.x - left.x)
    slopes = [
        ((far.gap or 0.0) - (near.gap or 0.0)) / (far.x - near.x) * (right.side or 0) for near, far in outer_pairs
    ]
    return slope_inside == 0.0 or (
        bool(slopes) and min(slopes) > 0.0 and slope_inside <= tolerances.STEEPER_THAN_SLOPE * max(slopes)
    )


def is_jump_size(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether the measure changes as much across the narrowest bracket as across one a thousand times wider.

    A jump does, and a pole changes by more; a vertical tangent, as of a root of x - c, changes by less.
    """
    distance = 0.5 * WIDE_BRACKET * (right.x - left.x)
    outer_left, outer_right = sample_outside(course, left, -1, distance), sample_outside(course, right, 1, distance)
    if outer_right.x - outer_left.x < MIN_BRACKET * (right.x - left.x):
        return False
    inner_change = abs((right.gap or 0.0) - (left.gap or 0.0)) + left.error + right.error
    return inner_change >= tolerances.JUMP_KEEPS * abs((outer_right.gap or 0.0) - (outer_left.gap or 0.0))


def sample_outside(course: MeasureCourse, end: Sample, direction: int, distance: float) -> Sample:
    """Return a sample about this distance outside of another one, as far as the range extends.

    Raises SampleLimitError.
    """
    k, best = course.samples.index(end), end
    while 0 <= k + direction < len(course.samples) and not course.is_interrupted(k + min(direction, 0)):
        k += direction
        if abs(course.samples[k].x - end.x) > distance:
            sample = course.sample_at(end.x + direction * distance)
            return sample if sample.gap is not None else best
        best = course.samples[k]
        if abs(best.x - end.x) >= 0.5 * distance:
            return best
    return best


def predict_root(course: MeasureCourse, left: Sample, right: Sample) -> float:
    """Return where the measure is predicted to cross its value between two neighbours on different sides."""
    near = min((left, right), key=lambda sample: abs(sample.gap or 0.0))
    stretch = find_stretch(course, left)
    others = sorted((each for each in stretch if each not in (left, right)), key=lambda each: abs(each.x - near.x))
    samples = _straighten_pole(course, [left, right, *others[:2]])
    low, high = left.x, right.x
    for _ in range(60):  # halvings of a polynomial, which cost nothing
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        is_before_root = float(interpolate(samples, np.array([middle]))[0]) * (left.side or 0) > 0.0
        low, high = (middle, high) if is_before_root else (low, middle)
    margin = 0.25 * course.finest
    return min(max(0.5 * (low + high), left.x + margin), right.x - margin)


def _straighten_pole(course: MeasureCourse, samples: list[Sample]) -> list[Sample]:
    """Return samples of 1/value - 1/measure, which has the same root, where it is followed better by a polynomial, as
    towards a pole; else the same samples. The nearest to the root is predicted from the others.
    """
    m = [(sample.gap or 0.0) + course.value for sample in samples]
    if len(samples) < 4 or min(x * course.value for x in m) <= 0.0:
        return samples
    near, others = samples[k := int(np.argmin([abs(sample.gap or 0.0) for sample in samples]))], [*samples]
    del others[k]
    inverses = [sample._replace(gap=1.0 / course.value - 1.0 / x) for sample, x in zip(samples, m, strict=True)]
    expected, inverse = (
        float(interpolate(part, np.array([near.x]))[0]) for part in (others, inverses[:k] + inverses[k + 1 :])
    )
    inverse_error = abs((inverse - (inverses[k].gap or 0.0)) * m[k] * course.value)
    return inverses if inverse_error < abs(expected - (near.gap or 0.0)) else samples


def find_stretch(course: MeasureCourse, one: Sample) -> list[Sample]:
    """Return the samples of the stretch that contains a sample."""
    stretch: list[Sample] = []
    for i, sample in enumerate(course.samples):
        if stretch and course.is_interrupted(i - 1):
            if one in stretch:
                return stretch
            stretch = []
        stretch.append(sample)
    return stretch
