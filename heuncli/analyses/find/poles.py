"""Find poles and narrow peaks, which the samples of a measure may hide, and where they may reach the value.

The inverse y = 1/|m| of a measure that rises to a peak, or to a pole of even order, is convex there, as for 1/x^2 or a
resonance. So it stays above the lines through two samples of y on either side, extended inwards. Where these lines stay
above 0 the measure is bounded; where they pass 0 between the neighbours a pole is possible, and one more place is
evaluated. At an end of the range there is only one flank: it is followed if the value is not met yet, to make sure of
"met nowhere", and if the sample at the end is lower than an exponential rise predicts.
    y_l(x) = y_i + s_l (x - x_i),  s_l < 0        y_r(x) = y_j + s_r (x - x_j),  s_r > 0        x_i < x < x_j
"""

from __future__ import annotations

import math

from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.course_extremes import clip_inside, find_peak
from heuncli.analyses.variants.course_prediction import NOISE
from heuncli.analyses.variants.samples import ABOVE, BELOW, Sample
from heuncli.base import tolerances

PEAK_GROWTH = 2.0  # possible rise of a peak, relative to the predicted one


def find_hidden_pole(course: MeasureCourse, i: int) -> float | None:
    """Return where between the i-th sample and the next the measure may be unbounded; None if nothing indicates that.

    The flanks must exceed the noise of their samples. Values far above the usual size are not followed.
    """
    samples = course.samples
    if course.is_interrupted(i) or samples[i + 1].x - samples[i].x <= 2.0 * course.finest:
        return None
    left, right = samples[i], samples[i + 1]
    a, b = course.get_measure_at(i), course.get_measure_at(i + 1)
    if a * b <= 0.0 or max(abs(a), abs(b)) > tolerances.FAR_FROM_VALUE * max(
        course.median_magnitude, abs(course.value)
    ):
        return None
    left_fall, right_fall = compute_inverse_fall(course, i, i - 1), compute_inverse_fall(course, i + 1, i + 2)
    if left_fall == right_fall == 0.0 or left_fall is None or right_fall is None:
        return None
    width, ya, yb = right.x - left.x, 1.0 / abs(a), 1.0 / abs(b)
    if left_fall == 0.0 or right_fall == 0.0:  # one of the two is an end of the range
        if {BELOW, ABOVE} <= {sample.side for sample in course.samples}:  # the value is met anyway
            return None
        end, inner, outer = (i, i + 1, i + 2) if left_fall == 0.0 else (i + 1, i, i - 1)
        if is_rising_exponentially(course, end, inner, outer):
            return None
    if left_fall == 0.0:
        return right.x - yb / right_fall if yb < right_fall * width else None
    if right_fall == 0.0:
        return left.x + ya / left_fall if ya < left_fall * width else None
    distance = (yb - ya - right_fall * width) / -(left_fall + right_fall)  # from the left one, where both lines meet
    if not 0.0 < distance < width:
        return None
    return left.x + distance if ya - left_fall * distance <= 0.0 else None


def compute_inverse_fall(course: MeasureCourse, k: int, outer: int) -> float | None:
    """Return how fast 1/|m| falls from an outer sample to the k-th; 0 without an outer sample, None if it rises."""
    samples = course.samples
    if not 0 <= outer < len(samples) or course.is_interrupted(min(k, outer)):
        return 0.0
    value, outer_value = course.get_measure_at(k), course.get_measure_at(outer)
    rise = abs(value) - (abs(outer_value) if value * outer_value > 0.0 else -abs(outer_value))
    if rise <= NOISE * max(samples[k].error, samples[outer].error):
        return None
    distance = abs(samples[k].x - samples[outer].x)
    return float(rise / distance / abs(value) / (abs(outer_value) if value * outer_value > 0.0 else abs(value)))


def is_rising_exponentially(course: MeasureCourse, end: int, inner: int, outer: int) -> bool:
    """Return whether the measure at an end of the range continues an exponential rise from two samples, or nearly so.

    end, inner, outer: indices of the sample at the end and of the next two
    """
    x = [course.samples[k].x for k in (end, inner, outer)]
    m = [course.get_measure_at(k) for k in (end, inner, outer)]
    if m[1] * m[2] <= 0.0:  # it comes from 0: nothing indicates a pole
        return True
    power = abs(x[0] - x[1]) / abs(x[1] - x[2])
    return math.log(m[0] / m[1]) > math.log(m[1] / m[2]) * power + math.log(tolerances.RISES_TO_END)


def is_far_from_value(course: MeasureCourse, left: Sample, right: Sample) -> bool:
    """Return whether two neighbours on one side are so far from the value that g does not return to it between them.

    So it is near a pole.
    """
    if not left.side or left.side != right.side:
        return False
    smallest = min(abs(course.get_measure(sample)) for sample in (left, right))
    return smallest > tolerances.FAR_FROM_VALUE * max(course.median_magnitude, abs(course.value))


def has_pole(course: MeasureCourse) -> bool:
    """Return whether the measure jumps somewhere between values beyond all usual ones, from one sign to the other."""
    ends = {x for pair in course.jumps for x in pair}
    sizes = {sample.x: course.get_measure(sample) for sample in course.samples if sample.x in ends}
    least = tolerances.FAR_FROM_VALUE * max(course.median_magnitude, abs(course.value))
    return any(
        sizes[low] * sizes[high] < 0.0 and min(abs(sizes[low]), abs(sizes[high])) > least for low, high in course.jumps
    )


def find_possible_peak(course: MeasureCourse, i: int) -> float | None:
    """Return where a peak or a pole between the i-th sample and the next may reach the value; None if nothing indicates
    one.
    """
    left, right = course.samples[i], course.samples[i + 1]
    if (pole := find_hidden_pole(course, i)) is not None:
        return clip_inside(left, right, pole)
    peak = find_peak(course, i)
    if peak is None or not left.side or left.side != right.side:
        return None
    if math.isinf(peak.size) and course.get_measure(left) * course.get_measure(right) < 0.0:
        return clip_inside(left, right, step_to_pole(course, left, right, peak.place))
    largest = (max if course.value > 0.0 else min)(course.get_measure_at(i), course.get_measure_at(i + 1))
    if largest * course.value <= 0.0 or abs(largest) >= abs(course.value):
        return None
    peak_height = abs(largest) + PEAK_GROWTH * (peak.size - abs(largest))
    return clip_inside(left, right, peak.place) if peak_height >= abs(course.value) else None


def step_to_pole(course: MeasureCourse, left: Sample, right: Sample, pole: float) -> float:
    """Return the place next to a pole at which the measure is twice the value, by the line through its inverse.

    At the pole itself there is no measure.
    """
    before, after = (course.get_measure(sample) for sample in (left, right))
    distance = 0.5 * (right.x - left.x) / abs(course.value * (1.0 / after - 1.0 / before))
    return pole - distance if before * course.value > 0.0 else pole + distance
