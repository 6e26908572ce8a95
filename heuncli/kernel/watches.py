"""What the stages of a step see of variables and watched programs, and whether these do more between the stages.

The bounds of a load over a part of the step (enclosure.py) are compared with its values at the stages. Parts that the
bounds leave undecided are divided.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.course import bound_derivatives, bound_variables, course_instant, set_time_range, set_variables
from heuncli.kernel.declarations import *
from heuncli.kernel.enclosure import enclose, enclose_closely
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.intervals import all_numbers, magnitude
from heuncli.kernel.jets import jet
from heuncli.kernel.libm import INFINITY
from heuncli.kernel.points import has_far_turn

# Divisions of an interval after which a value counts as seen, a millionth of the step; parts in which a load's peak is
# searched; parts checked for values that bounds do not decide, and in all.
MAX_DIVISIONS, MAX_PEAK_PARTS, MAX_VALUE_PARTS, MAX_PARTS = 20, 60, 1000, 4000


# What the stages see


def reset_extremes(scene: cython.pointer[Scene]) -> cython.void:
    """Reset the extremes of variables and watched programs at the start of a step."""
    i: cython.Py_ssize_t
    for i in range(scene.variable_count):
        scene.least[i] = INFINITY
        scene.most[i] = -INFINITY
    for i in range(scene.watch_count):
        scene.watches[i].low = INFINITY
        scene.watches[i].high = -INFINITY


def reset_watches(scene: cython.pointer[Scene]) -> cython.void:
    """Reset the watches at the start of a run, so that it does not depend on the run before it."""
    i: cython.Py_ssize_t
    for i in range(scene.watch_count):
        scene.watches[i].rounding = 0.0


def record_extremes(scene: cython.pointer[Scene]) -> cython.void:
    """Include the variables evaluated last, and the watched programs there, in the extremes."""
    i: cython.Py_ssize_t
    x: cython.double
    for i in range(scene.variable_count):
        x = scene.programs.variables[i]
        if x < scene.least[i]:
            scene.least[i] = x
        if x > scene.most[i]:
            scene.most[i] = x
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        x = watched_value(scene, watch)
        if x < watch.low:
            watch.low = x
        if x > watch.high:
            watch.high = x


def watched_value(scene: cython.pointer[Scene], watch: cython.pointer[Watch]) -> cython.double:
    """Return the watched number at the present variables: a load, or a drive's acceleration."""
    if watch.curved:
        return jet(scene.programs, watch.program, scene.programs.variables[0]).second
    return evaluate_program(scene.programs, watch.program)


def largest_recorded(watch: cython.pointer[Watch]) -> cython.double:
    """Return the largest magnitude that the stages saw."""
    return fabs(watch.high) if fabs(watch.high) > fabs(watch.low) else fabs(watch.low)


def exceeds_recorded(
    scene: cython.pointer[Scene], watch: cython.pointer[Watch], bounds: Bounds, scale: cython.double
) -> cython.bint:
    """Return whether a number within bounds may lie outside what the stages saw, by more than half of its variation
    there.

    The motion does not depend on the value of a condition, only on its branches.
    """
    if watch.condition:
        return False
    margin: cython.double = 0.5 * (watch.high - watch.low) + scene.limits.unseen * scale + watch.rounding
    return not (bounds.low >= watch.low - margin and bounds.high <= watch.high + margin)


def check_coarsely(scene: cython.pointer[Scene], begin: cython.double, end: cython.double) -> cython.int:
    """Return what may have happened between two instants: CLEAR, BRANCH_IN_DOUBT or VALUE_IN_DOUBT.

    A coarse check: variables are assumed to go a quarter of their variation outside what was seen.
    """
    i: cython.Py_ssize_t
    width: cython.double
    doubt: cython.int = CLEAR
    if scene.point_count and has_far_turn(scene, end - begin):
        return BRANCH_IN_DOUBT
    programs: cython.pointer[Programs] = scene.programs
    for i in range(scene.variable_count):
        width = 0.25 * (scene.most[i] - scene.least[i])
        programs.ranges[i] = Span(Bounds(scene.least[i] - width, scene.most[i] + width), all_numbers(), all_numbers())
    set_time_range(programs, begin, end)
    clear_doubts(scene)
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        if exceeds_recorded(scene, watch, bound_watched(scene, watch), largest_recorded(watch)):
            doubt = VALUE_IN_DOUBT
    return BRANCH_IN_DOUBT if has_doubt(scene) else doubt


def bound_watched(scene: cython.pointer[Scene], watch: cython.pointer[Watch]) -> Bounds:
    """Bound the watched number over the present ranges; mark the branches that these leave in doubt."""
    span: Span = enclose(scene.programs, watch.program)
    return span.second if watch.curved else span.value


def clear_doubts(scene: cython.pointer[Scene]) -> cython.void:
    """Mark no branch as in doubt."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        scene.programs.doubt[i] = 0


def has_doubt(scene: cython.pointer[Scene]) -> cython.bint:
    """Return whether a branch is in doubt."""
    i: cython.Py_ssize_t
    doubts: cython.int = 0
    for i in range(scene.held_count):
        doubts += scene.programs.doubt[i]
    return doubts > 0


def is_resting(course: cython.pointer[Course], i: cython.Py_ssize_t, x: cython.double) -> cython.bint:
    """Return whether a branch is skipped at x because its margin rests at zero."""
    return 0.0 < course.rests_to and x <= course.rests_to and course.resting[i] > 0.0


def has_moving_doubt(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Return whether a branch is in doubt at x that is not skipped there."""
    i: cython.Py_ssize_t
    in_doubt: cython.bint = False
    for i in range(scene.held_count):
        in_doubt = in_doubt or (scene.programs.doubt[i] > 0 and not is_resting(course, i, x))
    return in_doubt


def check_part(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.int:
    """Return what may happen between x0 and x1: CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, or UNSEEN in the middle."""
    i: cython.Py_ssize_t
    doubt: cython.int = CLEAR
    bounds: Bounds
    middle_value: cython.double
    bound_variables(scene, course, scene.programs.ranges, x0, x1)
    clear_doubts(scene)
    is_evaluated: cython.bint = False
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        bounds = bound_watched(scene, watch)
        if not exceeds_recorded(scene, watch, bounds, watch.scale):
            continue
        if not is_evaluated:
            set_variables(scene, course, 0.5 * (x0 + x1))
            is_evaluated = True
        middle_value = watched_value(scene, watch)
        if exceeds_recorded(scene, watch, Bounds(middle_value, middle_value), watch.scale):
            doubt = UNSEEN
        elif doubt == CLEAR and exceeds_recorded(
            scene, watch, tighten_bounds(scene, course, watch, x0, x1), watch.scale
        ):
            doubt = VALUE_IN_DOUBT
    return BRANCH_IN_DOUBT if has_moving_doubt(scene, course, x0) else doubt


def tighten_bounds(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    watch: cython.pointer[Watch],
    x0: cython.double,
    x1: cython.double,
) -> Bounds:
    """Bound the watched number between x0 and x1 more closely, from its value in the middle."""
    span: Span
    middle: cython.double = 0.5 * (x0 + x1)
    bound_variables(scene, course, scene.programs.middles, middle, middle)
    bound_derivatives(scene, course, scene.programs.middles, middle, middle)
    set_time_range(scene.programs, course_instant(course, x0), course_instant(course, x1))
    bound_derivatives(scene, course, scene.programs.ranges, x0, x1)
    span = enclose_closely(scene.programs, watch.program)
    return span.second if watch.curved else span.value


def scale_watches(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """Find how large each watched number becomes over the interval."""
    i: cython.Py_ssize_t
    bounds: Bounds
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        # bounds at an instant are as wide as the rounding of the terms, which may be larger than their sum
        bounds = bound_watched_part(scene, course, watch, 0.5, 0.5)
        if bounds.high - bounds.low > watch.rounding and bounds.high - bounds.low < INFINITY:
            watch.rounding = bounds.high - bounds.low
        watch.scale = largest_recorded(watch)
        if not watch.scale >= scene.limits.least_load:
            watch.scale = scene.limits.least_load
        if watch.load >= 0 and watch.scale < bushing_size(cython.address(scene.loads[watch.load])):
            watch.scale = bushing_size(cython.address(scene.loads[watch.load]))
        if exceeds_recorded(scene, watch, bound_watched_part(scene, course, watch, 0.0, 1.0), watch.scale):
            look_for_peak(scene, course, watch)


def bushing_size(load: cython.pointer[Load]) -> cython.double:
    """Return how large a bushing's force, or moment, was last, with which its components are compared."""
    return norm(load.force) if load.kind == BUSHING_SHIFT else norm(load.moment)


def bound_watched_part(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    watch: cython.pointer[Watch],
    x0: cython.double,
    x1: cython.double,
) -> Bounds:
    """Bound the watched number between x0 and x1."""
    bound_variables(scene, course, scene.programs.ranges, x0, x1)
    return bound_watched(scene, watch)


def look_for_peak(
    scene: cython.pointer[Scene], course: cython.pointer[Course], watch: cython.pointer[Watch]
) -> cython.void:
    """Raise the scale of a watched number to its values in the middle of the parts with the largest bounds.

    The part with the largest bound is halved each time, until no part's bound exceeds twice the scale.
    """
    k: cython.int
    best: cython.int
    count: cython.int = 1
    middle_value: cython.double
    begins: cython.p_double = course.begins
    ends: cython.p_double = course.ends
    promise: cython.p_double = course.promise
    begins[0] = 0.0
    ends[0] = 1.0
    promise[0] = INFINITY
    while count < MAX_PEAK_PARTS:
        best = 0
        for k in range(1, count):
            if promise[k] > promise[best]:
                best = k
        if promise[best] <= 2.0 * watch.scale:
            return
        middle: cython.double = 0.5 * (begins[best] + ends[best])
        set_variables(scene, course, middle)
        middle_value = fabs(watched_value(scene, watch))
        if middle_value > watch.scale and middle_value < INFINITY:
            watch.scale = middle_value
        begins[count] = middle
        ends[count] = ends[best]
        ends[best] = middle
        promise[best] = magnitude(bound_watched_part(scene, course, watch, begins[best], middle)).high
        promise[count] = magnitude(bound_watched_part(scene, course, watch, middle, ends[count])).high
        count += 1
