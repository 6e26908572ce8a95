"""Find where a measure meets a value: all crossings and touches in an interval that its samples reveal.

search.py samples where the behaviour is uncertain, narrowing.py encloses crossings and jumps, touches.py and poles.py
find what samples hide, meetings.py classifies what was found and states its error.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.analyses.find.meetings import (
    SideGroup,
    group_by_side,
    iter_enclosing_places,
    iter_meetings,
    iter_met_stretches,
    iter_unsolved,
)
from heuncli.analyses.find.narrowing import close_edges, narrow_all
from heuncli.analyses.find.results import (
    Crossing,
    IntervalFindings,
    MeasureJump,
    PossibleMeeting,
    Touch,
    UnresolvedBracket,
)
from heuncli.analyses.find.search import check_scan, iter_possible_meetings, search
from heuncli.analyses.find.touches import find_touches, step_towards_value
from heuncli.analyses.variants.conditions import SIDES, Relation
from heuncli.analyses.variants.course import MeasureCourse, SampleLimitError
from heuncli.analyses.variants.course_extremes import GREATEST, LEAST, find_extreme, refine_extreme
from heuncli.analyses.variants.samples import AT_VALUE, LEFT, RIGHT, Sample

CROSSING_HALVINGS = 8  # halvings towards a crossing with an uncertain slope: to a 250th of the neighbour's distance
TOUCH_HALVINGS = 12  # halvings towards each end of a touch: flat ones end at a 4,000th of the neighbour's distance
CLOSE_TO_VALUE = 4.0  # ratio of |g| to its error at the ends that enclose a touch


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

    evaluate: returns the sample at a place, whose gap is the measure minus the value
    scan_count: places of the scan
    max_evaluations: limit of all evaluations
    value: what the measure is compared with
    """
    course = MeasureCourse(evaluate, low, high, scan_count, max_evaluations, value)
    is_complete, is_refined = True, False
    try:
        course.scan()
        sample_count, enclosed_count = 0, -1
        refined: dict[int, Sample | None] = {}
        while len(course.samples) > sample_count:  # new samples are examined like those of the scan
            sample_count = len(course.samples)
            course.withhold_isolated()
            search(course)
            check_scan(course)
            meeting_count = sum(1 for _ in iter_meetings(course))
            if meeting_count != enclosed_count:  # more meetings than enclosed before
                enclose_crossings(course)
                enclosed_count = meeting_count
            find_touches(course)
            enclose_touches(course)
            if not any(iter_meetings(course)) and find_extreme(course, GREATEST) is not None:
                is_refined = True
                refine_new_extremes(course, refined)
            if len(course.samples) == sample_count:
                close_edges(course)
    except SampleLimitError:
        is_complete = False
    course.withhold_isolated()
    return collect_findings(course, relation, is_refined=is_refined, is_complete=is_complete)


def refine_new_extremes(course: MeasureCourse, refined: dict[int, Sample | None]) -> None:
    """Refine the least and the greatest value, if it is not the one that was refined before, and record it.

    refined: the extremes after their last refinement, by LEAST and GREATEST

    Raises SampleLimitError.
    """
    for direction in (LEAST, GREATEST):
        if direction not in refined or find_extreme(course, direction) != refined[direction]:
            refine_extreme(course, direction)
            refined[direction] = find_extreme(course, direction)


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
        least=find_extreme(course, LEAST),
        greatest=find_extreme(course, GREATEST),
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
        for end, direction in ((group[0], LEFT), (group[-1], RIGHT)):
            for _ in range(TOUCH_HALVINGS):
                k = course.samples.index(end)
                if not 0 <= k + direction < len(course.samples) or course.is_interrupted(min(k, k + direction)):
                    break
                outer = course.samples[k + direction]
                if outer.distance <= CLOSE_TO_VALUE * end.error or abs(outer.x - end.x) <= course.finest:
                    break
                place = step_towards_value(course, min(k, k + direction))
                sample = course.sample_at(0.5 * (end.x + outer.x) if place is None else place)
                if sample.gap is None:
                    break
                if sample.side == AT_VALUE:
                    end = sample


def find_touching_groups(course: MeasureCourse) -> list[SideGroup]:
    """Return the groups of samples that meet the value, with neighbours on the same side of it at both ends."""
    side_groups = group_by_side(course)
    return [
        group
        for previous, group, following in zip(side_groups, side_groups[1:], side_groups[2:], strict=False)
        if group.side == AT_VALUE and previous.side and previous.side == following.side
    ]
