"""Poles and narrow peaks that hide between two neighbours of one sign, and of which their flanks tell.

The inverse y = 1/|m| of a measure that rises to a peak, or to a pole of even order, is convex there, as for 1/x^2 or a
resonance. So it stays above the lines through two samples of y on either side, drawn on inwards. Where these lines stay
above 0 the measure is bounded; where they pass 0 between the neighbours a pole is not excluded, and one more place is
asked. At an end of the course there is one flank, which tells less: it is followed where the value is not met yet, so
that "met nowhere" stands, and where the sample at the end lags behind an exponential rise.

    y_l(x) = y_i + s_l (x - x_i),  s_l < 0        y_r(x) = y_j + s_r (x - x_j),  s_r > 0        x_i < x < x_j
"""

from __future__ import annotations

import math

from heuncli.analyses.variants.course import NOISE, MeasureCourse, Sample

LAGS = 0.5  # of an exponential rise: what is less at the end has passed a peak, or bends far more than 1/m does
FAR = 1e4  # times the value, and what is usual in the scan: a pole so far up is followed no farther


def place_of_hidden_pole(course: MeasureCourse, i: int) -> float | None:
    """Where between a sample and the next the measure may pass all bounds; None: it does not, or nothing tells of it.

    The flanks are read beyond the noise of their samples. Towards a value far beyond what is usual nothing is asked.
    """
    samples = course.samples
    if course.parted(i) or samples[i + 1].x - samples[i].x <= 2.0 * course.finest:
        return None
    one, other = samples[i], samples[i + 1]
    a, b = (sample.gap + course.value for sample in (one, other))  # type: ignore[operator]
    if a * b <= 0.0 or max(abs(a), abs(b)) > FAR * max(course.usual, abs(course.value)):
        return None
    left, right = fall_of_inverse(course, i, i - 1), fall_of_inverse(course, i + 1, i + 2)
    if left == right == 0.0 or left is None or right is None:
        return None
    width, ya, yb = other.x - one.x, 1.0 / abs(a), 1.0 / abs(b)
    if left == 0.0 or right == 0.0:
        if {-1, 1} <= {sample.side for sample in course.samples}:  # it is met elsewhere
            return None
        end, inner, outer = (i, i + 1, i + 2) if left == 0.0 else (i + 1, i, i - 1)
        if keeps_rising(course, end, inner, outer):
            return None
    if left == 0.0:
        return other.x - yb / right if yb < right * width else None
    if right == 0.0:
        return one.x + ya / left if ya < left * width else None
    ahead = (yb - ya - right * width) / -(left + right)  # from the first, where both lines meet
    if not 0.0 < ahead < width:
        return None
    return one.x + ahead if ya - left * ahead <= 0.0 else None


def fall_of_inverse(course: MeasureCourse, k: int, outer: int) -> float | None:
    """How fast 1/|m| falls from an outer sample to a sample, towards the inside; 0: there is none; None: it rises."""
    samples = course.samples
    if not 0 <= outer < len(samples) or course.parted(min(k, outer)):
        return 0.0
    own, far = (samples[j].gap + course.value for j in (k, outer))  # type: ignore[operator]
    rise = abs(own) - (abs(far) if own * far > 0.0 else -abs(far))
    if rise <= NOISE * max(samples[k].error, samples[outer].error):
        return None
    away = abs(samples[k].x - samples[outer].x)
    return float(rise / away / abs(own) / (abs(far) if own * far > 0.0 else abs(own)))


def keeps_rising(course: MeasureCourse, end: int, inner: int, outer: int) -> bool:
    """Whether the measure at an end of the course is what an exponential rise from two samples makes of it, to LAGS."""
    x = [course.samples[k].x for k in (end, inner, outer)]
    m = [(course.samples[k].gap or 0.0) + course.value for k in (end, inner, outer)]
    if m[1] * m[2] <= 0.0:  # it comes from 0: nothing tells of a pole
        return True
    power = abs(x[0] - x[1]) / abs(x[1] - x[2])
    return math.log(m[0] / m[1]) > math.log(m[1] / m[2]) * power + math.log(LAGS)


def is_far(course: MeasureCourse, one: Sample, other: Sample) -> bool:
    """Whether two neighbours lie so far off, beside a pole, that the course does not come back between them."""
    if not one.side or one.side != other.side:
        return False
    least = min(abs((sample.gap or 0.0) + course.value) for sample in (one, other))
    return least > FAR * max(course.usual, abs(course.value))
