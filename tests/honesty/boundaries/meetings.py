"""A measure between its samples: what is a jump, a touch, a crossing, or an end, by the samples about it."""

from __future__ import annotations

import math
from collections.abc import Callable

from heuncli.analyses.find.meetings import is_flattening
from heuncli.analyses.find.narrowing import is_jump_size, is_steep
from heuncli.analyses.find.poles import is_far_from_value, is_rising_exponentially
from heuncli.analyses.find.search import is_near_jump
from heuncli.analyses.find.touches import find_touch_range
from heuncli.analyses.sweep_rows import SweptSample, is_swept_jump
from heuncli.analyses.variants.course import MeasureCourse
from heuncli.analyses.variants.samples import Sample
from tests.honesty.boundaries.part import Part, Row

ERROR = 1e-15


def sampled(places: list[float], measure: Callable[[float], float], *, value: float = 0.0) -> MeasureCourse:
    """A course from -1 to 1 that was sampled at these places."""
    course = MeasureCourse(lambda x: Sample(x, measure(x) - value, ERROR), -1.0, 1.0, 5, 100, value)
    for x in places:
        course.sample_at(x)
    course.median_magnitude = 1.0
    return course


def beside(x: float) -> str:
    """Two samples that end x scan intervals from a jump."""
    course = sampled([-0.5, 0.0, 0.5], lambda _: 1.0)
    left, right = Sample(-0.5, 1.0), Sample(x * course.spacing, 1.0)
    return "doubted" if is_near_jump(course, left._replace(x=0.0), right, [(0.0, 0.0)]) else "certain"


def bracketed(x: float) -> str:
    """A slope of 1 outside of the narrowest bracket, and of x within."""
    h = 1e-9
    law = lambda at: x * at if abs(at) <= h else math.copysign(x * h + abs(at) - h, at)  # noqa: E731
    course = sampled([-0.5, -h, h, 0.5], law)
    return "steep" if is_steep(course, course.samples[1], course.samples[2]) else "no slope"


def kept(x: float) -> str:
    """Across the narrowest bracket the measure changes by x of what it changes across one a thousand times as wide."""
    h = 1e-9
    course = sampled([-0.5, -h, h, 0.5], lambda at: math.copysign(x if abs(at) <= h else 1.0, at))
    return "jump" if is_jump_size(course, course.samples[1], course.samples[2]) else "no jump"


def beyond(x: float) -> str:
    """Two samples of x times the usual size."""
    course = sampled([-0.5, 0.5], lambda _: x)
    return "out of reach" if is_far_from_value(course, *course.samples) else "may come back"


def rising(x: float) -> str:
    """A measure that grows e-fold towards its last sample but one, and to the last by x of that factor."""
    course = sampled([-1.0, 0.0, 1.0], lambda at: math.exp(at) if at < 0.5 else x * math.e)
    return "rises" if is_rising_exponentially(course, 2, 1, 0) else "passed a peak"


def growing(x: float) -> str:
    """A measure that grows with the power x of the distance."""
    near, far = (Sample(at, math.copysign(abs(at) ** x, at)) for at in (0.1, 0.2))
    return "flat" if is_flattening(Sample(0.0, 0.0), [near, far]) else "crossing"


def doubled(x: float) -> str:
    """A measure that doubles at x of the smallest distances on both sides."""
    place = [0.0]
    course = sampled([], lambda at: 2.0 if abs(at) > 0.5 * abs(place[0]) else 1.0)
    place[0] = x * course.finest
    for at in (-place[0], 0.0, place[0]):
        course.sample_at(at)
    return "touch" if find_touch_range(course, course.samples[1]) is not None else "minimum"


def passing(x: float) -> str:
    """Samples of singular positions over x scan intervals."""
    course = sampled([-0.5, 0.5], lambda _: 1.0)
    for at in (0.0, x * course.spacing):
        course.sample_at(at)
    course.samples = [one._replace(singular=abs(one.x) < 0.5 and one.x != -0.5) for one in course.samples]
    course.withhold_isolated()
    return "withheld" if course.samples[1].gap is None else "of the course"


def swept(x: float) -> str:
    """A measure that rises by 1 from each variant to the next, and once by x."""
    values = (0.0, 1.0, 2.0, 2.0 + x, 3.0 + x, 4.0 + x)
    samples = [SweptSample(k, float(k), value, ERROR) for k, value in enumerate(values)]
    return "jump" if is_swept_jump(samples, 2) else "steep"


PART = Part(
    headings=("meetings",),
    rows=(
        Row("DOUBTED_NEAR_JUMP", beside, "doubted", "certain"),
        Row("STEEPER_THAN_SLOPE", bracketed, "steep", "no slope"),
        Row("JUMP_KEEPS", kept, "no jump", "jump"),
        Row("FAR_FROM_VALUE", beyond, "may come back", "out of reach"),
        Row("RISES_TO_END", rising, "passed a peak", "rises"),
        Row("FLATTENS", growing, "crossing", "flat"),
        Row("TOUCH_DOUBLES", doubled, "touch", "minimum"),
        Row("SWEPT_JUMP", swept, "steep", "jump"),
        Row("ISOLATED_SINGULAR", passing, "withheld", "of the course", (0.01, 1 / 3, 3.0)),
    ),
    exempt={
        "EDGE_BRACKET": "how an edge is narrowed: it ends at the same last bit",
        "NEAR_SINGULAR_RUN": "how closely an edge by singular positions is bracketed: both ends are told",
    },
)
