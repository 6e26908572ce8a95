"""Events: where within a step a branch of an expression changes, or a load does what no stage has seen.

Within a step the branches of all expressions are held (kernel/evaluator.py), so that the step is smooth. Whether one of
them changes is decided, not sampled: interval arithmetic takes the bounds of the coordinates' courses (course.py)
through the programs (enclosure.py). Parts of the step that leave a branch in doubt are divided, from left to right,
down to the limit of rounding. In the same way a load's bounds are compared with the values at the stages. Moore,
Interval Analysis (1966).
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.course import bound_variables, set_variables
from heuncli.kernel.declarations import *
from heuncli.kernel.enclosure import enclose
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.intervals import all_numbers
from heuncli.kernel.watches import (
    MAX_DIVISIONS,
    MAX_PARTS,
    MAX_PEAK_PARTS,
    MAX_VALUE_PARTS,
    check_part,
    clear_doubts,
    has_moving_doubt,
    is_resting,
    scale_watches,
)

# Events


def record_branches(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """Hold the branches that the present variables select; store those held so far in `before`."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        course.saved_branches[i] = scene.programs.branches[i]
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
        course.turned[i] = course.saved_branches[i] if is_resting(course, i, x) else scene.programs.branches[i]
        if course.turned[i] != course.saved_branches[i]:
            state = BRANCH_TURNED
            course.slot = i
    if is_branch_in_doubt(scene, course, x):
        state = UNCERTAIN
    hold_branches(scene, course.saved_branches)
    return state


def branches_differ(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Return whether branches at x differ from those held, rounding or not."""
    i: cython.Py_ssize_t
    changed: cython.bint = False
    set_variables(scene, course, x)
    record_branches(scene, course)
    for i in range(scene.held_count):
        changed = changed or (scene.programs.branches[i] != course.saved_branches[i] and not is_resting(course, i, x))
    hold_branches(scene, course.saved_branches)
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
        course.saved_branches[i] = scene.programs.branches[i]
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        jump = evaluate_program(scene.programs, watch.program)
        hold_branches(scene, course.turned)
        jump = fabs(evaluate_program(scene.programs, watch.program) - jump)
        hold_branches(scene, course.saved_branches)
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
            scene.programs.branches[i] = course.saved_branches[i]


def hold_branches(scene: cython.pointer[Scene], branches: cython.p_double) -> cython.void:
    """Hold other branches."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        scene.programs.branches[i] = branches[i]
