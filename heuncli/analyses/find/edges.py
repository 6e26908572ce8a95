"""Locate the ends of the solvable range to the last bit of the unknown: loads grow without bound towards such an end.

Between the last variant that fails and the first that is solved, the middle is evaluated, or the place where
extrapolation predicts the end. Where a loop stops closing, the place x is quadratic in the measure, or in its inverse:
    x = a + b u + c u^2      u: the measure, or 1/measure; the edge is where x is extreme
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.analyses.variants.course import MeasureCourse, Sample, withhold
from heuncli.base import tolerances

FIRST_FRACTION = 0.05  # of the bracket: first distance to both sides of the predicted edge
MIN_FRACTION = 1e-6


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


def close_edge(course: MeasureCourse, solved: Sample, unsolved: Sample) -> None:
    """Narrow one edge down. Raises SampleLimitError."""
    fraction, is_trusted = FIRST_FRACTION, True
    while not is_closed(course, solved, unsolved):
        middle = solved.x + 0.5 * (unsolved.x - solved.x)
        width = unsolved.x - solved.x
        predicted = (
            predict_edge(course, solved, width)
            if is_trusted and abs(width) < tolerances.EDGE_BRACKET * course.spacing
            else None
        )
        if predicted is None:
            solved, unsolved = evaluate_between(course, solved, unsolved, middle)
            is_trusted = True
            continue
        old_width = abs(width)
        for x in (predicted - fraction * width, predicted + fraction * width):
            if min(solved.x, unsolved.x) < x < max(solved.x, unsolved.x):
                solved, unsolved = evaluate_between(course, solved, unsolved, x)
        is_trusted = abs(unsolved.x - solved.x) < 2.5 * fraction * old_width
        fraction = max(fraction * fraction, MIN_FRACTION) if is_trusted else FIRST_FRACTION


def evaluate_between(course: MeasureCourse, solved: Sample, unsolved: Sample, x: float) -> tuple[Sample, Sample]:
    """Evaluate one more place and return the two samples between which the edge lies."""
    sample = course.sample_at(x)
    if unsolved.withheld_gap is not None and sample.singular:
        sample = withhold(sample)
    return (solved, sample) if sample.gap is None else (sample, unsolved)


def predict_edge(course: MeasureCourse, solved: Sample, width: float) -> float | None:
    """Return the edge that the solved samples predict within the bracket; None if they predict none."""
    samples = course.samples
    k, direction = samples.index(solved), -1 if width > 0.0 else 1
    nearest = [samples[k + direction * j] for j in range(3) if 0 <= k + direction * j < len(samples)]
    if len(nearest) < 3 or any(sample.gap is None for sample in nearest):
        return None
    m = [(sample.gap or 0.0) + course.value for sample in nearest]
    if abs(m[0]) > abs(m[1]) > abs(m[2]) > 0.0:
        m = [1.0 / value for value in m]
    if not (m[0] < m[1] < m[2] or m[0] > m[1] > m[2]):
        return None
    x = [sample.x - solved.x for sample in nearest]
    chord = (x[1] - x[0]) / (m[1] - m[0])
    bend = ((x[2] - x[1]) / (m[2] - m[1]) - chord) / (m[2] - m[0])
    if bend == 0.0 or not math.isfinite(bend):
        return None
    slope = chord - bend * (m[1] - m[0])  # of x over u, at the solved sample
    distance = -0.25 * slope * slope / bend
    return solved.x + distance if 0.0 < distance / width < 1.0 else None
