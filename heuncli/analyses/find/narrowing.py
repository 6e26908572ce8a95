"""Narrow two samples down: to a crossing or a jump of the measure, or to an edge of the solvable range.

At an edge, between the last variant that fails and the first that is solved, the middle is evaluated, or the place
where extrapolation predicts the end. Where a loop stops closing, the place x is quadratic in the measure, or in its
inverse:
    x = a + b u + c u^2      u: the measure, or 1/measure; the edge is where x is extreme
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import IntEnum
from operator import attrgetter

import numpy as np

from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.course_extremes import find_pole
from heuncli.analyses.variants.course_prediction import NOISE, sample_and_learn
from heuncli.analyses.variants.samples import AT_VALUE, LEFT, RIGHT, Sample, interpolate, withhold
from heuncli.base import tolerances

MAX_REMAINING_GAP = 0.25  # share of the gap that interpolation may leave; if it leaves more, a halving follows
WIDE_BRACKET = 1000.0  # width of a bracket across which a jump still has the same size, in narrowest brackets
SUFFICIENT_REDUCTION = 0.5  # share of a bracket that two places at a pole leave: if less, the middle is not next
# Two places at a share s of the bracket on both sides of a predicted pole or edge enclose it in 2 s; with some slack:
ENCLOSED_SHARES = 2.5
MIN_BRACKET = 10.0  # width of a bracket that can prove a jump by comparison, in narrowest brackets
FIRST_SHARE, MIN_SHARE = 0.05, 1e-6  # share s of the bracket: at first, and the smallest
HALVINGS = 60  # halvings to the root of a polynomial: down to the last bit


class PlaceRule(IntEnum):
    """Rules for the next place between two neighbours, in the order in which they follow when one gains too little."""

    PREDICTED_ROOT = 0
    PAST_ROOT = 1
    MIDDLE = 2


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


def narrow_pair(course: MeasureCourse, i: int) -> None:
    """Narrow two neighbours on different sides down to a crossing or a jump.

    By Brent's rule: the root of the predicted measure, and the middle whenever that gained too little. At a pole both
    sides of the root of the inverse measure are tried, ever closer to it.
    """
    left, right = course.samples[i], course.samples[i + 1]
    rule, pole_share = PlaceRule.PREDICTED_ROOT, FIRST_SHARE
    while right.x - left.x > course.finest:
        if rule != PlaceRule.PREDICTED_ROOT and (pole := find_pole(course, course.samples.index(left))) is not None:
            width = right.x - left.x
            left, right = narrow_pole(course, left, right, pole, pole_share)
            if left.gap is None or right.gap is None or not left.side or not right.side:
                return
            is_enclosed = right.x - left.x < ENCLOSED_SHARES * pole_share * width
            pole_share = max(pole_share * pole_share, MIN_SHARE) if is_enclosed else FIRST_SHARE
            is_reduced = right.x - left.x < SUFFICIENT_REDUCTION * width
            rule = PlaceRule.PAST_ROOT if is_reduced else PlaceRule.MIDDLE
            if is_reduced:
                continue
        best = min(left.distance, right.distance)
        sample = sample_and_learn(course, choose_root_place(course, left, right, rule))
        if sample.gap is None or sample.side == AT_VALUE:
            return
        is_closer = abs(sample.gap) < MAX_REMAINING_GAP * best
        rule = PlaceRule.PREDICTED_ROOT if is_closer else PlaceRule(min(rule + 1, PlaceRule.MIDDLE))
        left, right = (sample, right) if sample.side == left.side else (left, sample)
    is_jump = not is_steep(course, left, right) and is_jump_size(course, left, right)
    (course.jumps if is_jump else course.steep).add((left.x, right.x))


def choose_root_place(course: MeasureCourse, left: Sample, right: Sample, rule: PlaceRule) -> float:
    """Return the next place to evaluate between two neighbours on different sides, by a rule."""
    if rule == PlaceRule.PREDICTED_ROOT:
        return predict_root(course, left, right)
    return step_past_root(course, left, right) if rule == PlaceRule.PAST_ROOT else 0.5 * (left.x + right.x)


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
    nearer, farther = sorted((left, right), key=attrgetter("distance"))
    gap, noise = nearer.distance, NOISE * max(nearer.error, farther.error)
    fraction = (gap + noise) / abs(farther.gap_or_zero - nearer.gap_or_zero) if gap <= noise else 0.5
    distance = max(min(fraction, 0.5) * abs(farther.x - nearer.x), course.finest)
    return nearer.x + distance if farther is right else nearer.x - distance


def is_steep(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether the slope outside suffices to pass from one side to the other within the narrowest bracket.

    Near a jump the slope outside is small, near a pole it grows. Only a change beyond twice the sum of the errors
    counts.
    """
    i = next(i for i, sample, _ in course.iter_pairs() if sample is left)
    outer_pairs = [(left, each) for each in course.find_neighbours(i, LEFT)[:1]] + [
        (right, each) for each in course.find_neighbours(i, RIGHT)[:1]
    ]
    errors = 2.0 * (left.error + right.error)
    slope_inside = max(abs(right.gap_or_zero - left.gap_or_zero) - errors, 0.0) / (right.x - left.x)
    slopes = [(far.gap_or_zero - near.gap_or_zero) / (far.x - near.x) * (right.side or 0) for near, far in outer_pairs]
    return slope_inside == 0.0 or (
        bool(slopes) and min(slopes) > 0.0 and slope_inside <= tolerances.STEEPER_THAN_SLOPE * max(slopes)
    )


def is_jump_size(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether the measure changes as much across the narrowest bracket as across one a thousand times wider.

    A jump does, and a pole changes by more; a vertical tangent, as of a root of x - c, changes by less.
    """
    distance = 0.5 * WIDE_BRACKET * (right.x - left.x)
    outer_left, outer_right = (
        sample_outside(course, left, LEFT, distance),
        sample_outside(course, right, RIGHT, distance),
    )
    if outer_right.x - outer_left.x < MIN_BRACKET * (right.x - left.x):
        return False
    inner_change = abs(right.gap_or_zero - left.gap_or_zero) + left.error + right.error
    return inner_change >= tolerances.JUMP_KEEPS * abs(outer_right.gap_or_zero - outer_left.gap_or_zero)


def sample_outside(course: MeasureCourse, end: Sample, direction: int, distance: float) -> Sample:
    """Return a sample about this distance outside of another one, as far as the range extends.

    Raises SampleLimitError.
    """
    best = end
    for sample in course.iter_outward(course.samples.index(end), direction):
        if abs(sample.x - end.x) > distance:
            new_sample = course.sample_at(end.x + direction * distance)
            return new_sample if new_sample.gap is not None else best
        best = sample
        if abs(best.x - end.x) >= 0.5 * distance:
            return best
    return best


def predict_root(course: MeasureCourse, left: Sample, right: Sample) -> float:
    """Return where the measure is predicted to cross its value between two neighbours on different sides."""
    near = min((left, right), key=attrgetter("distance"))
    stretch = find_stretch(course, left)
    others = sorted((each for each in stretch if each not in (left, right)), key=lambda each: abs(each.x - near.x))
    samples = _straighten_pole(course, [left, right, *others[:2]])
    low, high = left.x, right.x
    for _ in range(HALVINGS):  # they cost nothing: no variant is solved
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        is_before_root = float(interpolate(samples, np.array([middle]))[0]) * (left.side or 0) > 0.0
        low, high = (middle, high) if is_before_root else (low, middle)
    margin = 0.25 * course.finest
    return min(max(0.5 * (low + high), left.x + margin), right.x - margin)


def _straighten_pole(course: MeasureCourse, samples: list[Sample]) -> list[Sample]:
    """Return samples of 1/value - 1/measure, if a polynomial follows that better, as towards a pole; else the same.

    It has the same root. What a polynomial follows better is judged by the sample nearest to the root, which is
    predicted from the others.
    """
    m = [course.get_measure(sample) for sample in samples]
    if len(samples) < 4 or min(x * course.value for x in m) <= 0.0:
        return samples
    near, others = samples[k := int(np.argmin([sample.distance for sample in samples]))], [*samples]
    del others[k]
    inverses = [sample._replace(gap=1.0 / course.value - 1.0 / x) for sample, x in zip(samples, m, strict=True)]
    expected, inverse = (
        float(interpolate(part, np.array([near.x]))[0]) for part in (others, inverses[:k] + inverses[k + 1 :])
    )
    inverse_error = abs((inverse - inverses[k].gap_or_zero) * m[k] * course.value)
    return inverses if inverse_error < abs(expected - near.gap_or_zero) else samples


def find_stretch(course: MeasureCourse, member: Sample) -> list[Sample]:
    """Return the stretch that contains a sample: successive samples without an interruption."""
    stretch: list[Sample] = []
    for i, sample in enumerate(course.samples):
        if stretch and course.is_interrupted(i - 1):
            if member in stretch:
                return stretch
            stretch = []
        stretch.append(sample)
    return stretch


def close_edges(course: MeasureCourse) -> None:
    """Narrow all ends of the solvable range down to adjacent numbers. Raises SampleLimitError."""
    while (pair := next(iter_edges(course), None)) is not None:
        close_edge(course, *pair)


def iter_edges(course: MeasureCourse) -> Iterator[tuple[Sample, Sample]]:
    """Yield pairs of a solved sample and its failed neighbour with another number between them."""
    for _, left, right in course.iter_pairs():
        if (left.gap is None) != (right.gap is None) and not is_closed(course, left, right):
            yield (left, right) if left.gap is not None else (right, left)


def is_closed(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether an edge is narrow enough; one of the two samples is not solved, or withheld."""
    withheld = left.withheld_gap is not None or right.withheld_gap is not None
    return (
        abs(right.x - left.x) <= tolerances.NEAR_SINGULAR_RUN * course.spacing
        if withheld
        else find_middle(left.x, right.x) is None
    )


def find_middle(low: float, high: float) -> float | None:
    """Return the middle of two numbers; None if there is no number between them."""
    middle = low + 0.5 * (high - low)
    return middle if min(low, high) < middle < max(low, high) else None


def close_edge(course: MeasureCourse, solved_sample: Sample, failed_sample: Sample) -> None:
    """Narrow one edge down. Raises SampleLimitError."""
    share, is_trusted = FIRST_SHARE, True
    while not is_closed(course, solved_sample, failed_sample):
        width = failed_sample.x - solved_sample.x
        predicted = (
            predict_edge(course, solved_sample, width)
            if is_trusted and abs(width) < tolerances.EDGE_BRACKET * course.spacing
            else None
        )
        if predicted is None:
            middle = solved_sample.x + 0.5 * (failed_sample.x - solved_sample.x)
            solved_sample, failed_sample = evaluate_between(course, solved_sample, failed_sample, middle)
            is_trusted = True
            continue
        old_width = abs(width)
        for x in (predicted - share * width, predicted + share * width):
            if min(solved_sample.x, failed_sample.x) < x < max(solved_sample.x, failed_sample.x):
                solved_sample, failed_sample = evaluate_between(course, solved_sample, failed_sample, x)
        is_trusted = abs(failed_sample.x - solved_sample.x) < ENCLOSED_SHARES * share * old_width
        share = max(share * share, MIN_SHARE) if is_trusted else FIRST_SHARE


def evaluate_between(
    course: MeasureCourse, solved_sample: Sample, failed_sample: Sample, x: float
) -> tuple[Sample, Sample]:
    """Evaluate one more place and return the two samples between which the edge lies."""
    sample = course.sample_at(x)
    if failed_sample.withheld_gap is not None and sample.singular:
        sample = withhold(sample)
    return (solved_sample, sample) if sample.gap is None else (sample, failed_sample)


def predict_edge(course: MeasureCourse, solved_sample: Sample, width: float) -> float | None:
    """Return the edge that the solved samples predict within the bracket; None if they predict none."""
    samples = course.samples
    k, direction = samples.index(solved_sample), LEFT if width > 0.0 else RIGHT
    nearest = [samples[k + direction * j] for j in range(3) if 0 <= k + direction * j < len(samples)]
    if len(nearest) < 3 or any(sample.gap is None for sample in nearest):
        return None
    m = [course.get_measure(sample) for sample in nearest]
    if abs(m[0]) > abs(m[1]) > abs(m[2]) > 0.0:  # it grows towards the edge: the inverse is smoother
        m = [1.0 / value for value in m]
    if not (m[0] < m[1] < m[2] or m[0] > m[1] > m[2]):
        return None
    x = [sample.x - solved_sample.x for sample in nearest]
    chord = (x[1] - x[0]) / (m[1] - m[0])
    bend = ((x[2] - x[1]) / (m[2] - m[1]) - chord) / (m[2] - m[0])
    if bend == 0.0 or not math.isfinite(bend):
        return None
    slope = chord - bend * (m[1] - m[0])  # dx/du at the solved sample
    distance = -0.25 * slope * slope / bend
    return solved_sample.x + distance if 0.0 < distance / width < 1.0 else None
