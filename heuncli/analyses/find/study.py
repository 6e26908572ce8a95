"""Find where a function of one number meets a value: all crossings in an interval that its samples reveal.

At an edge of the solvable range, between the last variant that fails and the first that is solved, the middle is
evaluated, or the place where extrapolation predicts the end. Where a loop stops closing, the place x is quadratic in
the measure, or in its inverse:
    x = a + b u + c u^2      u: the measure, or 1/measure; the edge is where x is extreme
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from heuncli.analyses.find.meetings import (
    SideGroup,
    group_by_side,
    iter_enclosing_places,
    iter_meetings,
    iter_met_stretches,
    iter_unsolved,
)
from heuncli.analyses.find.results import (
    Crossing,
    IntervalFindings,
    MeasureJump,
    PossibleMeeting,
    Touch,
    UnresolvedBracket,
)
from heuncli.analyses.find.search import check_scan, iter_possible_meetings, narrow_all, search
from heuncli.analyses.find.touches import compute_distance, find_touches, step_towards_value
from heuncli.analyses.variants.course import MeasureCourse, SampleLimitError, find_extreme, refine_extreme
from heuncli.analyses.variants.measures import SIDES, Relation
from heuncli.analyses.variants.samples import Sample, withhold
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


CROSSING_HALVINGS = 8  # towards a crossing with an uncertain slope: down to a 250th of the neighbour's distance
TOUCH_HALVINGS = 12  # towards each end of a touch: flat ones end at a 4,000th of the neighbour's distance
CLOSE_TO_VALUE = 4.0  # times the error: |g| at the ends that enclose a touch


def find_meetings(
    evaluate: Callable[[float], Sample],
    low: float,
    high: float,
    relation: Relation,
    *,
    scan_count: int,
    max_evaluations: int,
    value: float = 0.0,
) -> IntervalFindings:
    """Return the findings between low and high.

    scan_count: places of the scan
    max_evaluations: limit of all evaluations
    value: the measure minus its gap
    """
    course = MeasureCourse(evaluate, low, high, scan_count, max_evaluations, value)
    is_complete, is_refined = True, False
    try:
        course.scan()
        sample_count, enclosed_count = 0, -1
        refined_at: dict[int, Sample | None] = {}  # the extremes after their refinement
        while len(course.samples) > sample_count:  # new samples are examined like those of the scan
            sample_count = len(course.samples)
            course.withhold_isolated()
            search(course)
            check_scan(course)
            if (
                meeting_count := sum(1 for _ in iter_meetings(course))
            ) != enclosed_count:  # more meetings than enclosed before
                enclose_crossings(course)
                enclosed_count = meeting_count
            find_touches(course)
            enclose_touches(course)
            if not any(iter_meetings(course)) and find_extreme(course, 1) is not None:
                is_refined = True
                for sign in (-1, 1):
                    if sign not in refined_at or find_extreme(course, sign) != refined_at[sign]:  # new or changed
                        refine_extreme(course, sign)
                        refined_at[sign] = find_extreme(course, sign)
            if len(course.samples) == sample_count:
                close_edges(course)
    except SampleLimitError:
        is_complete = False
    course.withhold_isolated()
    return collect_findings(course, relation, is_refined=is_refined, is_complete=is_complete)


def collect_findings(
    course: MeasureCourse, relation: Relation, *, is_refined: bool, is_complete: bool
) -> IntervalFindings:
    """Collect the findings from the samples.

    is_complete: whether the search ended before its limit of evaluations
    """
    found_meetings = list(iter_meetings(course))
    return IntervalFindings(
        crossings=tuple(meeting for meeting in found_meetings if isinstance(meeting, Crossing)),
        touches=tuple(meeting for meeting in found_meetings if isinstance(meeting, Touch)),
        jumps=tuple(meeting for meeting in found_meetings if isinstance(meeting, MeasureJump)),
        brackets=tuple(meeting for meeting in found_meetings if isinstance(meeting, UnresolvedBracket)),
        not_excluded=tuple(
            PossibleMeeting(*pair)
            for pair in iter_possible_meetings(course)
            if not any(
                isinstance(touch, Touch) and touch.low <= pair[0].x and pair[1].x <= touch.high
                for touch in found_meetings
            )
        ),
        unsolved_stretches=tuple(iter_unsolved(course)),
        met_stretches=tuple(iter_met_stretches(course, SIDES[relation], includes_value="=" in relation))
        if SIDES[relation]
        else (),
        least=find_extreme(course, -1),
        greatest=find_extreme(course, 1),
        is_refined=is_refined,
        samples=tuple(course.samples),
        spacing=course.spacing,
        is_complete=is_complete,
    )


def enclose_crossings(course: MeasureCourse) -> None:
    """Enclose crossings whose slope is uncertain. Raises SampleLimitError."""
    for _ in range(CROSSING_HALVINGS):
        for place in list(iter_enclosing_places(course)):
            course.sample_at(place)
        narrow_all(course)  # a group may have split


def enclose_touches(course: MeasureCourse) -> None:
    """Enclose touches from both sides.

    Each end is moved towards the touch, by its power or by halves, until |g| is only a few errors. Raises
    SampleLimitError.
    """
    for group in find_touching_groups(course):
        for end, direction in ((group[0], -1), (group[-1], 1)):
            for _ in range(TOUCH_HALVINGS):
                k = course.samples.index(end)
                if not 0 <= k + direction < len(course.samples) or course.is_interrupted(min(k, k + direction)):
                    break
                outer = course.samples[k + direction]
                if compute_distance(outer) <= CLOSE_TO_VALUE * end.error or abs(outer.x - end.x) <= course.finest:
                    break
                place = step_towards_value(course, min(k, k + direction))
                sample = course.sample_at(0.5 * (end.x + outer.x) if place is None else place)
                if sample.gap is None:
                    break
                if sample.side == 0:
                    end = sample


def find_touching_groups(course: MeasureCourse) -> list[SideGroup]:
    """Return the groups of samples that meet the value, with neighbours on the same side of it at both ends."""
    side_groups = group_by_side(course)
    return [
        group
        for previous, group, following in zip(side_groups, side_groups[1:], side_groups[2:], strict=False)
        if group.side == 0 and previous.side and previous.side == following.side
    ]
