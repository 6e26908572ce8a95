"""Find poles and narrow peaks, which the samples of a measure may hide.

The inverse y = 1/|m| of a measure that rises to a peak, or to a pole of even order, is convex there, as for 1/x^2 or a
resonance. So it stays above the lines through two samples of y on either side, extended inwards. Where these lines stay
above 0 the measure is bounded; where they pass 0 between the neighbours a pole is possible, and one more place is
evaluated. At an end of the range there is only one flank: it is followed if the value is not met yet, to make sure of
"met nowhere", and if the sample at the end is lower than an exponential rise predicts.
    y_l(x) = y_i + s_l (x - x_i),  s_l < 0        y_r(x) = y_j + s_r (x - x_j),  s_r > 0        x_i < x < x_j
"""

from __future__ import annotations

import math

from heuncli.analyses.variants.course import NOISE, MeasureCourse
from heuncli.analyses.variants.samples import Sample
from heuncli.base import tolerances


def find_hidden_pole(course: MeasureCourse, i: int) -> float | None:
    """Return where between a sample and the next the measure may be unbounded; None if it is bounded or nothing
    indicates a pole.

    The flanks must exceed the noise of their samples. Values far above the usual size are not followed.
    """
    samples = course.samples
    if course.is_interrupted(i) or samples[i + 1].x - samples[i].x <= 2.0 * course.finest:
        return None
    left_sample, right_sample = samples[i], samples[i + 1]
    a, b = (course.get_measure(sample) for sample in (left_sample, right_sample))
    if a * b <= 0.0 or max(abs(a), abs(b)) > tolerances.FAR_FROM_VALUE * max(course.usual, abs(course.value)):
        return None
    left, right = compute_inverse_fall(course, i, i - 1), compute_inverse_fall(course, i + 1, i + 2)
    if left == right == 0.0 or left is None or right is None:
        return None
    width, ya, yb = right_sample.x - left_sample.x, 1.0 / abs(a), 1.0 / abs(b)
    if left == 0.0 or right == 0.0:
        if {-1, 1} <= {sample.side for sample in course.samples}:  # it is met elsewhere
            return None
        end, inner, outer = (i, i + 1, i + 2) if left == 0.0 else (i + 1, i, i - 1)
        if is_rising_exponentially(course, end, inner, outer):
            return None
    if left == 0.0:
        return right_sample.x - yb / right if yb < right * width else None
    if right == 0.0:
        return left_sample.x + ya / left if ya < left * width else None
    distance = (yb - ya - right * width) / -(left + right)  # from the first, where both lines meet
    if not 0.0 < distance < width:
        return None
    return left_sample.x + distance if ya - left * distance <= 0.0 else None


def compute_inverse_fall(course: MeasureCourse, k: int, outer: int) -> float | None:
    """Return how fast 1/|m| falls inwards from an outer sample to a sample; 0 if there is no outer sample, None if it
    rises.
    """
    samples = course.samples
    if not 0 <= outer < len(samples) or course.is_interrupted(min(k, outer)):
        return 0.0
    value, outer_value = (course.get_measure(samples[j]) for j in (k, outer))
    rise = abs(value) - (abs(outer_value) if value * outer_value > 0.0 else -abs(outer_value))
    if rise <= NOISE * max(samples[k].error, samples[outer].error):
        return None
    distance = abs(samples[k].x - samples[outer].x)
    return float(rise / distance / abs(value) / (abs(outer_value) if value * outer_value > 0.0 else abs(value)))


def is_rising_exponentially(course: MeasureCourse, end: int, inner: int, outer: int) -> bool:
    """Return whether the measure at an end of the range is at least RISES_TO_END of an exponential rise from two
    samples.
    """
    x = [course.samples[k].x for k in (end, inner, outer)]
    m = [course.get_measure(course.samples[k]) for k in (end, inner, outer)]
    if m[1] * m[2] <= 0.0:  # it comes from 0: nothing indicates a pole
        return True
    power = abs(x[0] - x[1]) / abs(x[1] - x[2])
    return math.log(m[0] / m[1]) > math.log(m[1] / m[2]) * power + math.log(tolerances.RISES_TO_END)


def is_far_from_value(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether two neighbours on one side are so far from the value, as near a pole, that g does not return to it
    between them.
    """
    if not left.side or left.side != right.side:
        return False
    smallest = min(abs(course.get_measure(sample)) for sample in (left, right))
    return smallest > tolerances.FAR_FROM_VALUE * max(course.usual, abs(course.value))


def has_pole(course: MeasureCourse) -> bool:
    """Return whether the measure jumps somewhere between values beyond all usual ones, from one sign to the other."""
    ends = {x for pair in course.jumps for x in pair}
    sizes = {sample.x: course.get_measure(sample) for sample in course.samples if sample.x in ends}
    least = tolerances.FAR_FROM_VALUE * max(course.usual, abs(course.value))
    return any(
        sizes[low] * sizes[high] < 0.0 and min(abs(sizes[low]), abs(sizes[high])) > least for low, high in course.jumps
    )
