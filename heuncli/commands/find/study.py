"""Where a function of one number meets a value: all crossings of an interval that its course gives away."""

from __future__ import annotations

from collections.abc import Callable

from heuncli.commands.find.course import MeasureCourse, Sample, SpentError
from heuncli.commands.find.places import doubtful, meetings, met, unsolved
from heuncli.commands.find.results import CourseFindings, CourseJump, Crossing, Touch
from heuncli.commands.find.search import close_all, refine_extreme, search
from heuncli.variants.conditions import Sign

HALVINGS = 8  # towards a crossing whose slope is not well known: a 250th of the neighbour's distance


SIDES: dict[Sign, int] = {"=": 0, "<": -1, "<=": -1, ">": 1, ">=": 1}  # of the value: where it is met


def look(
    ask: Callable[[float], Sample], low: float, high: float, relation: Sign, *, count: int, most: int
) -> CourseFindings:
    """What is found between low and high; count: places of the scan, most: that may be asked in all."""
    course = MeasureCourse(ask, low, high, count, most)
    complete, refined = True, False
    try:
        search(course)
        for _ in range(HALVINGS):
            for place in list(doubtful(course)):
                course.at(place)
            close_all(course)  # a group that was one may have come apart
        if not any(meetings(course)) and any(sample.gap is not None for sample in course.samples):
            for way in (-1, 1):
                refine_extreme(course, way)
            refined = True
    except SpentError:
        complete = False
    found = list(meetings(course))
    known = [sample for sample in course.samples if sample.gap is not None]
    return CourseFindings(
        crossings=tuple(each for each in found if isinstance(each, Crossing)),
        touches=tuple(each for each in found if isinstance(each, Touch)),
        jumps=tuple(each for each in found if isinstance(each, CourseJump)),
        unsolved=tuple(unsolved(course)),
        met=tuple(met(course, SIDES[relation], equal="=" in relation)) if SIDES[relation] else (),
        least=min(known, key=lambda sample: sample.gap or 0.0, default=None),
        greatest=max(known, key=lambda sample: sample.gap or 0.0, default=None),
        refined=refined,
        samples=tuple(course.samples),
        spacing=course.spacing,
        complete=complete,
    )
