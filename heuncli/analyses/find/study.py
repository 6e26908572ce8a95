"""Where a function of one number meets a value: all crossings of an interval that its course gives away."""

from __future__ import annotations

from collections.abc import Callable

from heuncli.analyses.find.edges import close_edges
from heuncli.analyses.find.places import SideGroup, doubtful, groups, meetings, met, unsolved
from heuncli.analyses.find.results import CourseFindings, CourseJump, Crossing, NotExcluded, OpenBracket, Touch
from heuncli.analyses.find.search import check_scan, close_all, not_excluded, search
from heuncli.analyses.find.touches import find_touches, size
from heuncli.analyses.variants.conditions import Sign
from heuncli.analyses.variants.course import MeasureCourse, Sample, SpentError
from heuncli.analyses.variants.course_extremes import extreme, refine_extreme

HALVINGS = 8  # towards a crossing whose slope is not well known: a 250th of the neighbour's distance
HALVINGS_OF_TOUCH = (
    12  # towards each end of a touch: flat ones come to an end a 4,000th of the neighbour's distance off
)
CLOSE_TO_VALUE = 4.0  # times the error: |g| at the end of a touch, which tells where it is

SIDES: dict[Sign, int] = {"=": 0, "<": -1, "<=": -1, ">": 1, ">=": 1}  # of the value: where it is met


def look(
    ask: Callable[[float], Sample],
    low: float,
    high: float,
    relation: Sign,
    *,
    count: int,
    most: int,
    value: float = 0.0,
) -> CourseFindings:
    """What is found between low and high.

    count: places of the scan, most: that may be asked in all; value: what the measure is less its gap.
    """
    course = MeasureCourse(ask, low, high, count, most, value)
    complete, refined = True, False
    try:
        course.scan()
        looked_at, enclosed = 0, -1
        refined_at: dict[int, Sample | None] = {}  # the extremes as their refinement left them
        while len(course.samples) > looked_at:  # whatever was found is looked at like the scan
            looked_at = len(course.samples)
            course.withhold_isolated()
            search(course)
            check_scan(course)
            if (met_at := sum(1 for _ in meetings(course))) != enclosed:  # where more is met than was enclosed before
                enclose(course)
                enclosed = met_at
            find_touches(course)
            enclose_touches(course)
            if not any(meetings(course)) and extreme(course, 1) is not None:
                refined = True
                for way in (-1, 1):
                    if way not in refined_at or extreme(course, way) != refined_at[way]:  # another one by now
                        refine_extreme(course, way)
                        refined_at[way] = extreme(course, way)
            if len(course.samples) == looked_at:
                close_edges(course)
    except SpentError:
        complete = False
    course.withhold_isolated()
    return collect_findings(course, relation, refined=refined, complete=complete)


def collect_findings(course: MeasureCourse, relation: Sign, *, refined: bool, complete: bool) -> CourseFindings:
    """What the samples of a course tell; complete: the search has ended before its places were spent."""
    found = list(meetings(course))
    return CourseFindings(
        crossings=tuple(each for each in found if isinstance(each, Crossing)),
        touches=tuple(each for each in found if isinstance(each, Touch)),
        jumps=tuple(each for each in found if isinstance(each, CourseJump)),
        brackets=tuple(each for each in found if isinstance(each, OpenBracket)),
        not_excluded=tuple(
            NotExcluded(*pair)
            for pair in not_excluded(course)
            if not any(isinstance(one, Touch) and one.low <= pair[0].x and pair[1].x <= one.high for one in found)
        ),
        unsolved=tuple(unsolved(course)),
        met=tuple(met(course, SIDES[relation], equal="=" in relation)) if SIDES[relation] else (),
        least=extreme(course, -1),
        greatest=extreme(course, 1),
        refined=refined,
        samples=tuple(course.samples),
        spacing=course.spacing,
        complete=complete,
    )


def enclose(course: MeasureCourse) -> None:
    """Enclose crossings whose slope is not well known. Raises SpentError."""
    for _ in range(HALVINGS):
        for place in list(doubtful(course)):
            course.at(place)
        close_all(course)  # a group that was one may have come apart


def enclose_touches(course: MeasureCourse) -> None:
    """Close in from both sides on what is not told from the value, so that its ends tell where the touch is.

    Each end is halved towards it until |g| is a few errors only. Raises SpentError.
    """
    for group in touching_groups(course):
        for end, way in ((group[0], -1), (group[-1], 1)):
            for _ in range(HALVINGS_OF_TOUCH):
                k = course.samples.index(end)
                if not 0 <= k + way < len(course.samples) or course.parted(min(k, k + way)):
                    break
                outer = course.samples[k + way]
                if size(outer) <= CLOSE_TO_VALUE * end.error or abs(outer.x - end.x) <= course.finest:
                    break
                found = course.at(0.5 * (end.x + outer.x))
                if found.gap is None:
                    break
                if found.side == 0:
                    end = found


def touching_groups(course: MeasureCourse) -> list[SideGroup]:
    """Neighbours that are not told from the value and have the same side before and behind."""
    found = groups(course)
    return [
        group
        for before, group, after in zip(found, found[1:], found[2:], strict=False)
        if group.side == 0 and before.side and before.side == after.side
    ]
