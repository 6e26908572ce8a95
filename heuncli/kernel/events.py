"""Events: where within a step a branch of an expression changes, or a load does what no stage has seen.

Within a step the branches of all expressions are held (kernel/evaluator.py), so that the step is smooth. Whether one of
them changes is decided, not sampled: interval arithmetic takes the bounds of the coordinates' courses (course.py)
through the programs (enclosure.py). Parts of the step that leave a branch in doubt are divided, from left to right,
down to the limit of rounding. In the same way a load's bounds are compared with the values at the stages. Moore,
Interval Analysis (1966).
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

# What happens in an interval of time, and what bounds leave undecided.
NOTHING, TURNS, UNSEEN, UNDECIDED, CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, PASSED = range(8)
AS_HELD, BRANCH_TURNED, UNCERTAIN = range(3)  # branches at an instant
# Divisions of an interval after which a value counts as seen, a millionth of the step; parts in which a
# load's
# peak is searched; parts checked for values that bounds do not decide, and in all.
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


# Events


def record_branches(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """Hold the branches that the present variables select; store those held so far in `before`."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        course.before[i] = scene.programs.held[i]
    scene.programs.holding = TAKEN
    for i in range(scene.watch_count):
        evaluate_program(scene.programs, scene.watches[i].program)
    scene.programs.holding = HELD


def compare_branches(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.int:
    """Return whether the branches at x are AS_HELD, BRANCH_TURNED, or UNCERTAIN because of the rounding of a margin.

    The branches found there are stored as the ones to switch to.
    """
    i: cython.Py_ssize_t
    state: cython.int = AS_HELD
    set_variables(scene, course, x)
    record_branches(scene, course)
    for i in range(scene.held_count):
        course.turned[i] = course.before[i] if is_resting(course, i, x) else scene.programs.held[i]
        if course.turned[i] != course.before[i]:
            state = BRANCH_TURNED
            course.slot = i
    if is_branch_in_doubt(scene, course, x):
        state = UNCERTAIN
    hold_branches(scene, course.before)
    return state


def branches_differ(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Return whether branches at x differ from those held, rounding or not."""
    i: cython.Py_ssize_t
    changed: cython.bint = False
    set_variables(scene, course, x)
    record_branches(scene, course)
    for i in range(scene.held_count):
        changed = changed or (scene.programs.held[i] != course.before[i] and not is_resting(course, i, x))
    hold_branches(scene, course.before)
    return changed


def relative_jump(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.double:
    """Return the largest jump of a watched number at the event where branches change, relative to its scale; for a kink
    it is rounding.
    """
    i: cython.Py_ssize_t
    largest: cython.double = 0.0
    jump: cython.double
    set_variables(scene, course, course.event)
    for i in range(scene.held_count):
        course.before[i] = scene.programs.held[i]
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        jump = evaluate_program(scene.programs, watch.program)
        hold_branches(scene, course.turned)
        jump = fabs(evaluate_program(scene.programs, watch.program) - jump)
        hold_branches(scene, course.before)
        if not jump <= largest * watch.scale:
            largest = jump / watch.scale
    return largest


def is_branch_in_doubt(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Return whether bounds at x itself, wider than a point by the rounding of coordinates, leave a branch in doubt."""
    i: cython.Py_ssize_t
    width: cython.double
    bound_variables(scene, course, scene.programs.ranges, x, x)
    for i in range(1, scene.variable_count):
        bounds: Bounds = scene.programs.ranges[i].value
        width = scene.limits.one_instant * fabs(bounds.high)
        scene.programs.ranges[i] = Span(Bounds(bounds.low - width, bounds.high + width), all_numbers(), all_numbers())
    clear_doubts(scene)
    for i in range(scene.watch_count):
        enclose(scene.programs, scene.watches[i].program)
    return has_moving_doubt(scene, course, x)


def leave_uncertainty(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double, end: cython.double
) -> cython.double:
    """Return the first x from a given one at which branches are not UNCERTAIN, to a fraction of its distance; or the
    end.
    """
    low: cython.double = x
    high: cython.double = x + course.finest
    middle: cython.double
    while high < end and compare_branches(scene, course, high) == UNCERTAIN:
        low = high
        high = x + 2.0 * (high - x)
    if high >= end:
        return end
    while high - low > 0.01 * (high - x) + course.finest:
        middle = 0.5 * (low + high)
        if compare_branches(scene, course, middle) == UNCERTAIN:
            low = middle
        else:
            high = middle
    return high


def leave_start(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.double:
    """Return how far from the start the branches are as held or uncertain; 0 if they change at the start and stay so.

    At an event the margin is zero but for the coordinates' rounding, of either sign: what counts is where it goes.
    """
    x: cython.double = scene.limits.leaving_first
    while x <= scene.limits.leaving_last:
        if compare_branches(scene, course, x) != BRANCH_TURNED:
            return x
        x = 10.0 * x
    return 0.0


def find_first_event(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.int:
    """Find the first event of an interval: TURNS just before `event`, UNSEEN at it, UNDECIDED from it on; or NOTHING.

    Parts in doubt are divided; `ends` holds the ends of the parts still to be checked, the next one on top. Values that
    remain in doubt although the middle of every part was evaluated count as undecided.
    """
    x: cython.double = 0.0
    doubt: cython.int
    top: cython.int = 0
    checks: cython.int = 0
    course.undecided = 0
    course.crossed_by = -1.0
    course.rests_to = 0.0
    scale_watches(scene, course)
    if scene.held_count and compare_branches(scene, course, 0.0) == BRANCH_TURNED:
        x = leave_start(scene, course)
        course.event = 0.0
        if x == 0.0:
            return TURNS
    course.ends[0] = 1.0
    while top >= 0:
        checks += 1
        if x < course.rests_to < course.ends[top] and top < MAX_PEAK_PARTS - 1:
            top += 1
            course.ends[top] = course.rests_to
        doubt = check_part(scene, course, x, course.ends[top])
        if doubt == BRANCH_IN_DOUBT:
            doubt = check_branch_part(scene, course, x, course.ends[top])
            if doubt == TURNS:
                return TURNS
        smallest: cython.bint = course.ends[top] - x <= course.finest or top == MAX_PEAK_PARTS - 1
        if doubt == UNSEEN and not smallest:
            course.event = 0.5 * (x + course.ends[top])
            return UNSEEN
        if doubt == VALUE_IN_DOUBT and top >= MAX_DIVISIONS:
            doubt = CLEAR
        elif doubt == VALUE_IN_DOUBT and checks > MAX_VALUE_PARTS:
            course.undecided = 1
            doubt = CLEAR
        if doubt == PASSED:
            x = course.event
            if x >= course.ends[top]:
                top -= 1
        elif doubt == CLEAR or smallest:
            x = course.ends[top]
            top -= 1
        elif checks > MAX_PARTS:
            course.event = x
            return UNDECIDED
        else:
            top += 1
            course.ends[top] = find_division(scene, course, x, course.ends[top - 1], doubt)
        if 0.0 < course.rests_to <= x and leaves_rest(scene, course, x):
            return TURNS
    return NOTHING


def check_branch_part(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.int:
    """Check a part in doubt at its start: TURNS if that is the event, PASSED to `event` if it is uncertain by rounding.

    Otherwise BRANCH_IN_DOUBT: the part is to be divided.
    """
    if x1 - x0 <= course.finest:
        course.event = x1
        return TURNS if compare_branches(scene, course, x1) == BRANCH_TURNED else BRANCH_IN_DOUBT
    if compare_branches(scene, course, x0) != UNCERTAIN:
        return BRANCH_IN_DOUBT
    course.event = leave_uncertainty(scene, course, x0, x1)
    if course.event - x0 > scene.limits.leaving_last and skip_resting_branches(scene, course, x0, course.event):
        if compare_branches(scene, course, x0) != UNCERTAIN:
            return BRANCH_IN_DOUBT
        course.event = leave_uncertainty(scene, course, x0, x1)
    if compare_branches(scene, course, course.event) != BRANCH_TURNED:
        return PASSED
    # not where the change is certain, which would be late each time, but where the margin itself is zero
    if not course.late:
        course.event = find_crossing(scene, course, x0, course.event, 0.0)
    return TURNS


def skip_resting_branches(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.bint:
    """Skip the branches that stay uncertain from x0 to x1, a good part of the interval. Returns whether there are any.

    A margin that rests at zero, as on a stop, is uncertain for that long, and other events may happen meanwhile.
    """
    i: cython.Py_ssize_t
    is_found: cython.bint = False
    course.rests_to = 0.0
    compare_branches(scene, course, x0)  # afterwards those branches are in doubt that are neither as held nor changed
    for i in range(scene.held_count):
        course.resting[i] = scene.programs.doubt[i]
    compare_branches(scene, course, 0.5 * (x0 + x1))
    for i in range(scene.held_count):
        if scene.programs.doubt[i] == 0:
            course.resting[i] = 0.0
        is_found = is_found or course.resting[i] > 0.0
    course.rests_from = x0
    course.rests_to = x1 if is_found else 0.0
    return is_found


def leaves_rest(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Return whether skipped branches change at x; the event is then where their margin is zero."""
    course.rests_to = 0.0
    if compare_branches(scene, course, x) != BRANCH_TURNED:
        return False
    course.event = x if course.late else find_crossing(scene, course, course.rests_from, x, 0.0)
    return True


def find_crossing(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x0: cython.double,
    x1: cython.double,
    width: cython.double,
) -> cython.double:
    """Return where branches change between x0, where they are as held, and x1; to a width, or to the last digit."""
    low: cython.double = x0
    high: cython.double = x1
    middle: cython.double = 0.5 * (low + high)
    while high - low > width and low < middle and middle < high:
        if branches_differ(scene, course, middle):
            high = middle
        else:
            low = middle
        middle = 0.5 * (low + high)
    return high


def find_division(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x0: cython.double,
    x1: cython.double,
    doubt: cython.int,
) -> cython.double:
    """Return where to divide a part in doubt: in the middle, or just before a crossing within it, up to which all is
    clear.

    The bounds decide which crossing is the first; this only avoids checking many small parts next to it.
    """
    if doubt != BRANCH_IN_DOUBT:
        return 0.5 * (x0 + x1)
    if course.crossed_by != x1:
        course.crossed_by = x1
        course.crossing = x1
        if branches_differ(scene, course, x1):
            course.crossing = find_crossing(scene, course, x0, x1, 0.25 * course.finest)
    if course.crossing >= x1 or course.crossing <= x0:
        return 0.5 * (x0 + x1)
    if course.crossing - x0 <= course.finest:
        return course.crossing
    return course.crossing - 1e-3 * (course.crossing - x0)


def find_angles(scene: cython.pointer[Scene]) -> cython.void:
    """Mark the branches of atan2."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    scene.angle_count = 0
    for i in range(scene.watch_count):
        program: Program = scene.watches[i].program
        for j in range(program.start, program.start + program.count - 1):
            if scene.programs.code[j].op == HOLD and scene.programs.code[j + 1].op == ATAN2:
                scene.is_angle[scene.programs.code[j].argument] = 1
                scene.angle_count += 1


def follow_angles(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """Take the branches of atan2 from the present variables: for positive x they change without an event.

    Only across the negative x axis the value jumps by a turn; from there on it must be known from which side y came.
    """
    i: cython.Py_ssize_t
    record_branches(scene, course)
    for i in range(scene.held_count):
        if not scene.is_angle[i]:
            scene.programs.held[i] = course.before[i]


def hold_branches(scene: cython.pointer[Scene], branches: cython.p_double) -> cython.void:
    """Hold other branches."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        scene.programs.held[i] = branches[i]
