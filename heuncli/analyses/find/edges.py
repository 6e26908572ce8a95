"""Where what can be solved ends: to the last bit of the unknown, for loads grow without bounds towards such an edge.

Between the last variant that fails and the first that is solved the middle is asked for, or where the course outside
says that it ends. Where a loop stops closing, the place x goes with the square of what is measured, or of its inverse:

    x = a + b u + c u^2      u: the measure, or 1/measure; the edge is where x is extreme
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.analyses.find.search import END_OF_SOLVED
from heuncli.analyses.variants.course import MeasureCourse, Sample, withheld

FIRST_SHARE = 0.05  # of the bracket: so far to both sides of where the course says that it ends is asked first
LEAST_SHARE = 1e-6
NEAR_SINGULAR = 1e-6  # of the scan's spacing: so near to singular poses their neighbours are looked at


def close_edges(course: MeasureCourse) -> None:
    """Narrow all ends of what is solved down to neighbouring numbers. Raises SpentError."""
    while (pair := next(edges(course), None)) is not None:
        close_edge(course, *pair)


def edges(course: MeasureCourse) -> Iterator[tuple[Sample, Sample]]:
    """A solved sample and its neighbour that is not, between which there is another number."""
    for _, one, other in course.pairs():
        if (one.gap is None) != (other.gap is None) and not is_closed(course, one, other):
            yield (one, other) if one.gap is not None else (other, one)


def is_closed(course: MeasureCourse, one: Sample, other: Sample) -> bool:
    """Whether the ends are as near to each other as is looked at; one of both is not solved, or withheld."""
    withheld = one.withheld is not None or other.withheld is not None
    return abs(other.x - one.x) <= NEAR_SINGULAR * course.spacing if withheld else between(one.x, other.x) is None


def between(one: float, other: float) -> float | None:
    """The middle of two numbers; None where there is no number between them."""
    middle = one + 0.5 * (other - one)
    return middle if min(one, other) < middle < max(one, other) else None


def close_edge(course: MeasureCourse, solved: Sample, failed: Sample) -> None:
    """Narrow one end down. Raises SpentError."""
    share, trusted = FIRST_SHARE, True
    while not is_closed(course, solved, failed):
        middle = solved.x + 0.5 * (failed.x - solved.x)
        width = failed.x - solved.x
        place = foretold(course, solved, width) if trusted and abs(width) < END_OF_SOLVED * course.spacing else None
        if place is None:
            solved, failed = asked(course, solved, failed, middle)
            trusted = True
            continue
        was = abs(width)
        for x in (place - share * width, place + share * width):
            if min(solved.x, failed.x) < x < max(solved.x, failed.x):
                solved, failed = asked(course, solved, failed, x)
        trusted = abs(failed.x - solved.x) < 2.5 * share * was
        share = max(share * share, LEAST_SHARE) if trusted else FIRST_SHARE


def asked(course: MeasureCourse, solved: Sample, failed: Sample, x: float) -> tuple[Sample, Sample]:
    """The two between which the edge lies, after one more place."""
    found = course.at(x)
    if failed.withheld is not None and found.singular:
        found = withheld(found)
    return (solved, found) if found.gap is None else (found, failed)


def foretold(course: MeasureCourse, solved: Sample, width: float) -> float | None:
    """Where the course says that it ends, within the bracket; None where it tells nothing of that."""
    samples = course.samples
    k, way = samples.index(solved), -1 if width > 0.0 else 1
    three = [samples[k + way * j] for j in range(3) if 0 <= k + way * j < len(samples)]
    if len(three) < 3 or any(sample.gap is None for sample in three):
        return None
    m = [(sample.gap or 0.0) + course.value for sample in three]
    if abs(m[0]) > abs(m[1]) > abs(m[2]) > 0.0:
        m = [1.0 / each for each in m]
    if not (m[0] < m[1] < m[2] or m[0] > m[1] > m[2]):
        return None
    x = [sample.x - solved.x for sample in three]
    first = (x[1] - x[0]) / (m[1] - m[0])
    bend = ((x[2] - x[1]) / (m[2] - m[1]) - first) / (m[2] - m[0])
    if bend == 0.0 or not math.isfinite(bend):
        return None
    slope = first - bend * (m[1] - m[0])  # of x over u, at the solved sample
    ahead = -0.25 * slope * slope / bend
    return solved.x + ahead if 0.0 < ahead / width < 1.0 else None
