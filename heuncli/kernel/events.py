"""Events: where within a step a branch of an expression changes, or a load does what no stage has seen.

Within a step the branches of all expressions are held (kernel/evaluator.py), so that the step is smooth. Whether one
of them changes is decided, not sampled: interval arithmetic takes the bounds of the coordinates' courses (course.py)
through the programs (enclosure.py). Parts of the step that leave a branch in doubt are divided, from left to right,
down to where rounding leaves it open. In the same way a load's bounds are compared with what the stages saw of it.
Moore, Interval Analysis (1966).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import norm
    from heuncli.kernel.course import bound_derivatives, instant, range_over, set_time, stand_at
    from heuncli.kernel.enclosure import enclose, enclose_closely
    from heuncli.kernel.evaluator import value
    from heuncli.kernel.intervals import anything, magnitude
    from heuncli.kernel.jets import jet
    from heuncli.kernel.libm import INFINITY
    from heuncli.kernel.points import turned_far
    from heuncli.kernel.programs import ATAN2, HELD, HOLD, TAKEN, Bounds, Program, Programs, Span
    from heuncli.kernel.scene import BUSHING_SHIFT, Load, Scene, Watch
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Course

    # What a stretch of time holds, and what bounds leave open.
    NOTHING, TURNS, UNSEEN, UNDECIDED, CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, PASSED = range(8)
    AS_HELD, BRANCH_TURNED, OPEN = range(3)  # branches at an instant
    # Divisions of a stretch after which a value is taken for seen, a millionth of the step; parts in which a load's
    # peak is looked for; parts looked at for values that bounds do not settle, and in all.
    LOOKS, PARTS, MOST_LOOKS, MOST_PARTS = 20, 60, 1000, 4000


# What the stages see


def forget(scene: cython.pointer[Scene]) -> cython.void:
    """Nothing is seen yet of a step that begins."""
    i: cython.Py_ssize_t
    for i in range(scene.variable_count):
        scene.least[i] = INFINITY
        scene.most[i] = -INFINITY
    for i in range(scene.watch_count):
        scene.watches[i].low = INFINITY
        scene.watches[i].high = -INFINITY


def watch_afresh(scene: cython.pointer[Scene]) -> cython.void:
    """A run begins: it is to hang on its start alone, and on nothing that the run before it met."""
    i: cython.Py_ssize_t
    for i in range(scene.watch_count):
        scene.watches[i].rounding = 0.0


def see(scene: cython.pointer[Scene]) -> cython.void:
    """What a stage sees: the variables as they were evaluated last, and the watched programs there."""
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
        x = watched(scene, watch)
        if x < watch.low:
            watch.low = x
        if x > watch.high:
            watch.high = x


def watched(scene: cython.pointer[Scene], watch: cython.pointer[Watch]) -> cython.double:
    """The number that is watched, at the variables as they are: a load, or a drive's acceleration."""
    if watch.curved:
        return jet(scene.programs, watch.program, scene.programs.variables[0]).second
    return value(scene.programs, watch.program)


def largest_seen(watch: cython.pointer[Watch]) -> cython.double:
    """The largest magnitude that the stages saw."""
    return fabs(watch.high) if fabs(watch.high) > fabs(watch.low) else fabs(watch.low)


def out_of_sight(
    scene: cython.pointer[Scene], watch: cython.pointer[Watch], bounds: Bounds, scale: cython.double
) -> cython.bint:
    """Whether a number within bounds may lie beyond what the stages saw, by half of what they saw it vary.

    The motion hangs on no condition, so its value need not be seen: what matters of it are its branches.
    """
    if watch.condition:
        return False
    room: cython.double = 0.5 * (watch.high - watch.low) + scene.limits.unseen * scale + watch.rounding
    return not (bounds.low >= watch.low - room and bounds.high <= watch.high + room)


def quiet(scene: cython.pointer[Scene], begin: cython.double, end: cython.double) -> cython.int:
    """What may have happened between two instants, by far: variables are taken to go a quarter beyond what was seen.

    CLEAR, BRANCH_IN_DOUBT or VALUE_IN_DOUBT.
    """
    i: cython.Py_ssize_t
    width: cython.double
    found: cython.int = CLEAR
    if scene.point_count and turned_far(scene, end - begin):
        return BRANCH_IN_DOUBT
    programs: cython.pointer[Programs] = scene.programs
    for i in range(scene.variable_count):
        width = 0.25 * (scene.most[i] - scene.least[i])
        programs.ranges[i] = Span(Bounds(scene.least[i] - width, scene.most[i] + width), anything(), anything())
    set_time(programs, begin, end)
    clear_doubts(scene)
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        if out_of_sight(scene, watch, bounds_of(scene, watch), largest_seen(watch)):
            found = VALUE_IN_DOUBT
    return BRANCH_IN_DOUBT if any_doubt(scene) else found


def bounds_of(scene: cython.pointer[Scene], watch: cython.pointer[Watch]) -> Bounds:
    """What is watched over the ranges as they are; the branches that these leave in doubt are marked."""
    span: Span = enclose(scene.programs, watch.program)
    return span.second if watch.curved else span.value


def clear_doubts(scene: cython.pointer[Scene]) -> cython.void:
    """No branch is in doubt yet."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        scene.programs.doubt[i] = 0


def any_doubt(scene: cython.pointer[Scene]) -> cython.bint:
    """Whether some branch is in doubt."""
    i: cython.Py_ssize_t
    doubts: cython.int = 0
    for i in range(scene.held_count):
        doubts += scene.programs.doubt[i]
    return doubts > 0


def is_resting(course: cython.pointer[Course], i: cython.Py_ssize_t, x: cython.double) -> cython.bint:
    """Whether a branch is passed over at x, because its margin rests at zero."""
    return 0.0 < course.rests_to and x <= course.rests_to and course.resting[i] > 0.0


def moving_doubt(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Whether some branch is in doubt at x that is not passed over there."""
    i: cython.Py_ssize_t
    found: cython.bint = False
    for i in range(scene.held_count):
        found = found or (scene.programs.doubt[i] > 0 and not is_resting(course, i, x))
    return found


def doubt_over(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.int:
    """What may happen between x0 and x1: CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, or UNSEEN in the middle."""
    i: cython.Py_ssize_t
    found: cython.int = CLEAR
    bounds: Bounds
    there: cython.double
    range_over(scene, course, scene.programs.ranges, x0, x1)
    clear_doubts(scene)
    stands: cython.bint = False
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        bounds = bounds_of(scene, watch)
        if not out_of_sight(scene, watch, bounds, watch.scale):
            continue
        if not stands:
            stand_at(scene, course, 0.5 * (x0 + x1))
            stands = True
        there = watched(scene, watch)
        if out_of_sight(scene, watch, Bounds(there, there), watch.scale):
            found = UNSEEN
        elif found == CLEAR and out_of_sight(scene, watch, tighten_bounds(scene, course, watch, x0, x1), watch.scale):
            found = VALUE_IN_DOUBT
    return BRANCH_IN_DOUBT if moving_doubt(scene, course, x0) else found


def tighten_bounds(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    watch: cython.pointer[Watch],
    x0: cython.double,
    x1: cython.double,
) -> Bounds:
    """Closer bounds of what is watched between x0 and x1, from what it is in the middle."""
    span: Span
    middle: cython.double = 0.5 * (x0 + x1)
    range_over(scene, course, scene.programs.middles, middle, middle)
    bound_derivatives(scene, course, scene.programs.middles, middle, middle)
    set_time(scene.programs, instant(course, x0), instant(course, x1))
    bound_derivatives(scene, course, scene.programs.ranges, x0, x1)
    span = enclose_closely(scene.programs, watch.program)
    return span.second if watch.curved else span.value


def scale_watches(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """How large what is watched becomes over the stretch."""
    i: cython.Py_ssize_t
    there: Bounds
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        # bounds at an instant are as wide as the rounding of the terms, which may be that of larger ones
        there = over_part(scene, course, watch, 0.5, 0.5)
        if there.high - there.low > watch.rounding and there.high - there.low < INFINITY:
            watch.rounding = there.high - there.low
        watch.scale = largest_seen(watch)
        if not watch.scale >= scene.limits.least_load:
            watch.scale = scene.limits.least_load
        if watch.load >= 0 and watch.scale < size_of(cython.address(scene.loads[watch.load])):
            watch.scale = size_of(cython.address(scene.loads[watch.load]))
        if out_of_sight(scene, watch, over_part(scene, course, watch, 0.0, 1.0), watch.scale):
            look_for_peak(scene, course, watch)


def size_of(load: cython.pointer[Load]) -> cython.double:
    """Of a bushing how large its force, or its moment, was last: a part counts by the whole, and not by itself."""
    return norm(load.force) if load.kind == BUSHING_SHIFT else norm(load.moment)


def over_part(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    watch: cython.pointer[Watch],
    x0: cython.double,
    x1: cython.double,
) -> Bounds:
    """What is watched between x0 and x1."""
    range_over(scene, course, scene.programs.ranges, x0, x1)
    return bounds_of(scene, watch)


def look_for_peak(
    scene: cython.pointer[Scene], course: cython.pointer[Course], watch: cython.pointer[Watch]
) -> cython.void:
    """Raise the scale of what is watched by its values in the middle of the parts that promise most.

    Of the parts so far the one with the largest bound is halved; what no part promises any more is not there.
    """
    k: cython.int
    best: cython.int
    count: cython.int = 1
    there: cython.double
    begins: cython.p_double = course.begins
    ends: cython.p_double = course.ends
    promise: cython.p_double = course.promise
    begins[0] = 0.0
    ends[0] = 1.0
    promise[0] = INFINITY
    while count < PARTS:
        best = 0
        for k in range(1, count):
            if promise[k] > promise[best]:
                best = k
        if promise[best] <= 2.0 * watch.scale:
            return
        middle: cython.double = 0.5 * (begins[best] + ends[best])
        stand_at(scene, course, middle)
        there = fabs(watched(scene, watch))
        if there > watch.scale and there < INFINITY:
            watch.scale = there
        begins[count] = middle
        ends[count] = ends[best]
        ends[best] = middle
        promise[best] = magnitude(over_part(scene, course, watch, begins[best], middle)).high
        promise[count] = magnitude(over_part(scene, course, watch, middle, ends[count])).high
        count += 1


# Events


def take_afresh(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.void:
    """Hold the branches that the variables as they are ask for; those held so far are put aside in `before`."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        course.before[i] = scene.programs.held[i]
    scene.programs.holding = TAKEN
    for i in range(scene.watch_count):
        value(scene.programs, scene.watches[i].program)
    scene.programs.holding = HELD


def branches_at(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.int:
    """AS_HELD or TURNED, as branches are at x; OPEN where rounding of a margin tells neither.

    Those met are kept as the ones to turn to.
    """
    i: cython.Py_ssize_t
    found: cython.int = AS_HELD
    stand_at(scene, course, x)
    take_afresh(scene, course)
    for i in range(scene.held_count):
        course.turned[i] = course.before[i] if is_resting(course, i, x) else scene.programs.held[i]
        if course.turned[i] != course.before[i]:
            found = BRANCH_TURNED
            course.slot = i
    if is_branch_in_doubt(scene, course, x):
        found = OPEN
    take_branches(scene, course.before)
    return found


def changed_at(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Whether branches are others at x than those held, rounding or not."""
    i: cython.Py_ssize_t
    changed: cython.bint = False
    stand_at(scene, course, x)
    take_afresh(scene, course)
    for i in range(scene.held_count):
        changed = changed or (scene.programs.held[i] != course.before[i] and not is_resting(course, i, x))
    take_branches(scene, course.before)
    return changed


def jump_at(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.double:
    """By how much what is watched jumps where branches turn at the event, of its scale; a kink's is rounding."""
    i: cython.Py_ssize_t
    found: cython.double = 0.0
    jump: cython.double
    stand_at(scene, course, course.event)
    for i in range(scene.held_count):
        course.before[i] = scene.programs.held[i]
    for i in range(scene.watch_count):
        watch: cython.pointer[Watch] = cython.address(scene.watches[i])
        jump = value(scene.programs, watch.program)
        take_branches(scene, course.turned)
        jump = fabs(value(scene.programs, watch.program) - jump)
        take_branches(scene, course.before)
        if not jump <= found * watch.scale:
            found = jump / watch.scale
    return found


def is_branch_in_doubt(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Whether bounds at x itself, wider than a point by the rounding of coordinates, leave the branches in doubt."""
    i: cython.Py_ssize_t
    wide: cython.double
    range_over(scene, course, scene.programs.ranges, x, x)
    for i in range(1, scene.variable_count):
        there: Bounds = scene.programs.ranges[i].value
        wide = scene.limits.one_instant * fabs(there.high)
        scene.programs.ranges[i] = Span(Bounds(there.low - wide, there.high + wide), anything(), anything())
    clear_doubts(scene)
    for i in range(scene.watch_count):
        enclose(scene.programs, scene.watches[i].program)
    return moving_doubt(scene, course, x)


def beyond_rounding(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double, end: cython.double
) -> cython.double:
    """The first x from a given one at which branches are not open, to a part of its distance; or the end."""
    low: cython.double = x
    high: cython.double = x + course.finest
    middle: cython.double
    while high < end and branches_at(scene, course, high) == OPEN:
        low = high
        high = x + 2.0 * (high - x)
    if high >= end:
        return end
    while high - low > 0.01 * (high - x) + course.finest:
        middle = 0.5 * (low + high)
        if branches_at(scene, course, middle) == OPEN:
            low = middle
        else:
            high = middle
    return high


def turns_at_once(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.double:
    """How far from the start branches are others than those held; 0 where they stay so: they turn at the start.

    At an event the margin is zero but for the coordinates' rounding, of either sign: what counts is where it goes.
    """
    x: cython.double = scene.limits.leaving_first
    while x <= scene.limits.leaving_last:
        if branches_at(scene, course, x) != BRANCH_TURNED:
            return x
        x = 10.0 * x
    return 0.0


def first_event(scene: cython.pointer[Scene], course: cython.pointer[Course]) -> cython.int:
    """The first event of a stretch: TURNS just before `event`, UNSEEN at it, UNDECIDED from it on; or NOTHING.

    Parts in doubt are divided; `ends` are those of the parts still to be looked at, the next one on top. Values that
    remain in doubt, seen in the middle of every part, are counted as undecided.
    """
    x: cython.double = 0.0
    found: cython.int
    top: cython.int = 0
    looks: cython.int = 0
    course.undecided = 0
    course.crossed_by = -1.0
    course.rests_to = 0.0
    scale_watches(scene, course)
    if scene.held_count and branches_at(scene, course, 0.0) == BRANCH_TURNED:
        x = turns_at_once(scene, course)
        course.event = 0.0
        if x == 0.0:
            return TURNS
    course.ends[0] = 1.0
    while top >= 0:
        looks += 1
        if x < course.rests_to < course.ends[top] and top < PARTS - 1:
            top += 1
            course.ends[top] = course.rests_to
        found = doubt_over(scene, course, x, course.ends[top])
        if found == BRANCH_IN_DOUBT:
            found = look_at_turn(scene, course, x, course.ends[top])
            if found == TURNS:
                return TURNS
        smallest: cython.bint = course.ends[top] - x <= course.finest or top == PARTS - 1
        if found == UNSEEN and not smallest:
            course.event = 0.5 * (x + course.ends[top])
            return UNSEEN
        if found == VALUE_IN_DOUBT and top >= LOOKS:
            found = CLEAR
        elif found == VALUE_IN_DOUBT and looks > MOST_LOOKS:
            course.undecided = 1
            found = CLEAR
        if found == PASSED:
            x = course.event
            if x >= course.ends[top]:
                top -= 1
        elif found == CLEAR or smallest:
            x = course.ends[top]
            top -= 1
        elif looks > MOST_PARTS:
            course.event = x
            return UNDECIDED
        else:
            top += 1
            course.ends[top] = division(scene, course, x, course.ends[top - 1], found)
        if 0.0 < course.rests_to <= x and moves_off(scene, course, x):
            return TURNS
    return NOTHING


def look_at_turn(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.int:
    """What the start of a part in doubt tells: TURNS where it is the event, PASSED to `event` where rounding opens it.

    Else BRANCH_IN_DOUBT: the part is to be divided.
    """
    if x1 - x0 <= course.finest:
        course.event = x1
        return TURNS if branches_at(scene, course, x1) == BRANCH_TURNED else BRANCH_IN_DOUBT
    if branches_at(scene, course, x0) != OPEN:
        return BRANCH_IN_DOUBT
    course.event = beyond_rounding(scene, course, x0, x1)
    if course.event - x0 > scene.limits.leaving_last and pass_over(scene, course, x0, course.event):
        if branches_at(scene, course, x0) != OPEN:
            return BRANCH_IN_DOUBT
        course.event = beyond_rounding(scene, course, x0, x1)
    if branches_at(scene, course, course.event) != BRANCH_TURNED:
        return PASSED
    # not where it is certain, which would be late each time: where the margin itself is zero
    if not course.late:
        course.event = crossing_in(scene, course, x0, course.event, 0.0)
    return TURNS


def pass_over(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.bint:
    """Pass over the branches that rounding leaves open from x0 to x1, in a good part of the stretch; whether any.

    What rests at a margin, as on a stop, is open for so long, and the others are to be met meanwhile.
    """
    i: cython.Py_ssize_t
    found: cython.bint = False
    course.rests_to = 0.0
    branches_at(scene, course, x0)  # in doubt is then what is neither as held nor turned
    for i in range(scene.held_count):
        course.resting[i] = scene.programs.doubt[i]
    branches_at(scene, course, 0.5 * (x0 + x1))
    for i in range(scene.held_count):
        if scene.programs.doubt[i] == 0:
            course.resting[i] = 0.0
        found = found or course.resting[i] > 0.0
    course.rests_from = x0
    course.rests_to = x1 if found else 0.0
    return found


def moves_off(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.bint:
    """Whether branches that were passed over up to x turn there: then the event is where their margin is zero."""
    course.rests_to = 0.0
    if branches_at(scene, course, x) != BRANCH_TURNED:
        return False
    course.event = x if course.late else crossing_in(scene, course, course.rests_from, x, 0.0)
    return True


def crossing_in(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x0: cython.double,
    x1: cython.double,
    width: cython.double,
) -> cython.double:
    """Where branches change between x0, where they are as held, and x1; to a width, or to the last digit."""
    low: cython.double = x0
    high: cython.double = x1
    middle: cython.double = 0.5 * (low + high)
    while high - low > width and low < middle and middle < high:
        if changed_at(scene, course, middle):
            high = middle
        else:
            low = middle
        middle = 0.5 * (low + high)
    return high


def division(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x0: cython.double,
    x1: cython.double,
    found: cython.int,
) -> cython.double:
    """Where a part in doubt is divided: in the middle; or just before a crossing within it, up to which all is clear.

    Which crossing is the first one the bounds decide: this only saves looking at many small parts beside it.
    """
    if found != BRANCH_IN_DOUBT:
        return 0.5 * (x0 + x1)
    if course.crossed_by != x1:
        course.crossed_by = x1
        course.crossing = x1
        if changed_at(scene, course, x1):
            course.crossing = crossing_in(scene, course, x0, x1, 0.25 * course.finest)
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
    """The branches of atan2 at the variables as they are: in front of the axis they change without an event.

    Only behind it the value jumps by a turn, and from there on it must be known from which side y came.
    """
    i: cython.Py_ssize_t
    take_afresh(scene, course)
    for i in range(scene.held_count):
        if not scene.is_angle[i]:
            scene.programs.held[i] = course.before[i]


def take_branches(scene: cython.pointer[Scene], branches: cython.p_double) -> cython.void:
    """Hold other branches."""
    i: cython.Py_ssize_t
    for i in range(scene.held_count):
        scene.programs.held[i] = branches[i]
