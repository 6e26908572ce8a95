"""Steps that end on events: a step tried is looked through, and done again up to the first event within it.

What an event asks for happens at the end of the step that lands there: branches turn, or a rope goes slack. Where it
lies is found on the dense output of the step that went over it, then on the end of the one that should have met it,
until both agree.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.dense import clipped, hermite, interpolant, interpolate
    from heuncli.kernel.events import (
        BRANCH_IN_DOUBT,
        CLEAR,
        NOTHING,
        TURNS,
        UNSEEN,
        differentiate,
        first_event,
        forget,
        instant,
        quiet,
        raise_by_rest,
        raise_by_x,
        see,
        take_branches,
    )
    from heuncli.kernel.response import evaluate, settle
    from heuncli.kernel.scene import Closure, Freedom, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Course, Method, Run
    from heuncli.kernel.tree import coordinates

    # What a step tried comes to; for C these stand in landing.pxd, in the same order.
    STANDS, AGAIN_TO, SLACK, CHATTERS = range(4)
    # Landings on one event, each of which finds its place to the square of the error of the one before; halvings of a
    # step where a rope goes slack, and points of a part that is looked at; events that gather at an instant.
    MOST_LANDINGS, ROPE_HALVINGS, POINTS, FLURRY = 6, 46, 8, 16


# What the steps see


def begin_to_see(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """The start of a step is the first that is seen of it."""
    if scene.watch_count:
        forget(scene)
        coordinates(scene, clipped(run, run.t), run.y)
        see(scene)
    if scene.roped:
        run.most_slack = run.start_slack
        run.least_slack = run.start_slack


def see_stage(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """What was evaluated last is seen."""
    if scene.watch_count:
        see(scene)
    if scene.roped:
        x: cython.double = slackness(scene, run)
        if x > run.most_slack:
            run.most_slack = x
        if x < run.least_slack:
            run.least_slack = x


# A step tried


def meet(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """STANDS, with `turns` where branches turn at its end; AGAIN_TO `cut`; SLACK at its end; CHATTERS."""
    code: cython.int = STANDS
    pivot: cython.double = scene.pivot
    least: cython.double = scene.pivot_of_step
    run.turns = 0
    run.has_interpolant = 0
    if scene.watch_count:
        code = meet_branches(scene, method, run)
        if code == STANDS:
            run.landings = 0
    if scene.roped and code == STANDS:
        code = meet_slack(scene, method, run)
    scene.pivot = pivot
    scene.pivot_of_step = least
    return code


def meet_branches(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Turns of branches, and what no stage has seen, within a step tried."""
    found: cython.int
    course: cython.pointer[Course] = cython.address(run.course)
    if run.landings:
        lay_window(scene, method, run)
        if first_event(scene, course) == TURNS and course.event > 0.0:
            return land_on(scene, run)
    found = quiet(scene, run.t, clipped(run, run.stop))
    if found == CLEAR:
        return STANDS
    if found != BRANCH_IN_DOUBT:
        hermite(method, run)
        lay_course(scene, run, 3)
        if first_event(scene, course) == NOTHING and not course.undecided:
            return STANDS
    need_interpolant(scene, method, run)
    lay_course(scene, run, 3 + method.dense_rows)
    found = first_event(scene, course)
    if found == NOTHING:
        run.undecided += course.undecided
        return STANDS
    if found == TURNS:
        return land_on(scene, run)
    return shorten(scene, run, found)


def need_interpolant(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The dense output of the step tried, once."""
    if not run.has_interpolant:
        interpolant(scene, method, run)
        run.has_interpolant = 1


def shorten(scene: cython.pointer[Scene], run: cython.pointer[Run], found: cython.int) -> cython.int:
    """A step up to what no stage has seen, or up to where bounds ceased to decide."""
    to: cython.double = instant(cython.address(run.course), run.course.event)
    if found == UNSEEN or to - run.t > 0.1 * run.h:
        run.cut = to
    elif run.h > scene.limits.flurry * fabs(run.end):
        run.cut = run.t + 0.1 * run.h
    else:
        run.undecided += 1
        return STANDS
    run.landings = 0
    return AGAIN_TO


def land_on(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """The branches turn here: at once, at the end of the step tried, or after another one that ends there."""
    course: cython.pointer[Course] = cython.address(run.course)
    at: cython.double = instant(course, course.event)
    off: cython.double = fabs(at - run.stop)
    near: cython.double = one_instant(scene, run)
    if run.late:
        at = at + near
        off = fabs(at - run.stop)
    if at - run.t <= 2.0 * near:
        run.at_once += 1
        if run.at_once > 4 + 2 * scene.held_count or gathered(scene, run, run.t):
            return CHATTERS
        take_branches(scene, course.turned)
        evaluate(scene, clipped(run, run.t), run.y, run.K[0])
        run.start_slack = slackness(scene, run)
        run.evaluations += 1
        run.landings = 0
        run.cut = run.t  # none
        return AGAIN_TO
    if course.jump <= scene.limits.no_jump and scene.limits.near_kink * run.h > near:
        near = scene.limits.near_kink * run.h
    if run.landings and (off <= near or run.landings >= MOST_LANDINGS):
        run.turns = 1
        return CHATTERS if gathered(scene, run, run.stop) else STANDS
    if at >= run.end:
        return STANDS  # beyond the piece
    run.landings += 1
    run.cut = at
    return AGAIN_TO


def one_instant(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """What is so near to the end of the step under way is there: its rounding, or a hundredth of the run's end's."""
    t: cython.double = fabs(run.stop)
    if t < 0.01 * fabs(run.end):
        t = 0.01 * fabs(run.end)
    return scene.limits.one_instant * t


def in_flurry(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether several events lie just behind."""
    return run.flurry > 2 and fabs(run.t - run.flurry_begin) <= scene.limits.flurry * fabs(run.end)


def gathered(scene: cython.pointer[Scene], run: cython.pointer[Run], t: cython.double) -> cython.bint:
    """Whether events follow each other without end at t, one of which is counted."""
    if not fabs(t - run.flurry_begin) <= scene.limits.flurry * fabs(run.end):
        run.flurry_begin = t
        run.flurry = 0
    run.flurry += 1
    return run.flurry > FLURRY


# The course of the coordinates


def lay_course(scene: cython.pointer[Scene], run: cython.pointer[Run], rows: cython.int) -> cython.void:
    """The coordinates over the step tried, by some rows of its interpolating polynomial, in Bernstein's form."""
    i: cython.Py_ssize_t
    course: cython.pointer[Course] = cython.address(run.course)
    course.begin = run.t
    course.length = run.h
    course.latest = clipped(run, run.stop)
    course.late = run.late
    course.finest = scene.limits.finest
    course.degree = rows
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        of: cython.pointer[Freedom] = cython.address(scene.freedoms[variable.freedom])
        if not of.driven:
            lay_component(run, of.u_at if variable.is_rate else of.q_at, rows, course.value[i])
            differentiate(course.value[i], course.rate[i], rows, run.h)
            differentiate(course.rate[i], course.second[i], rows - 1, run.h)


def lay_component(
    run: cython.pointer[Run], c: cython.int, rows: cython.int, b: cython.p_double
) -> cython.void:
    """One component of the state over the step: y + x (F0 + (1 - x) (F1 + x (F2 + ...)))."""
    k: cython.int
    i: cython.int
    n: cython.int = 0
    b[0] = 0.0
    for k in range(rows - 1, -1, -1):
        for i in range(n + 1):
            b[i] = b[i] + run.dense[k][c]
        if k % 2 == 0:
            raise_by_x(b, n)
        else:
            raise_by_rest(b, n)
        n += 1
    for i in range(n + 1):
        b[i] = run.y[c] + b[i]


def lay_window(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The coordinates about the end of the step tried, by their derivatives there: parabolas."""
    i: cython.Py_ssize_t
    a: cython.double
    u: cython.double
    half: cython.double = scene.limits.window * run.h
    course: cython.pointer[Course] = cython.address(run.course)
    last: cython.p_double = run.K[method.stages]
    course.begin = run.stop - half
    course.length = 2.0 * half
    course.latest = run.before_end
    course.late = run.late
    course.finest = scene.limits.window * scene.limits.window * scene.limits.window
    course.degree = 2
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        of: cython.pointer[Freedom] = cython.address(scene.freedoms[variable.freedom])
        if of.driven:
            continue
        at: cython.int = of.u_at if variable.is_rate else of.q_at
        u = last[at]
        a = 0.0 if variable.is_rate else last[of.u_at]
        b: cython.p_double = course.value[i]
        # through z at the middle, with u and a there
        b[0] = run.z[at] - u * half + 0.5 * a * half * half
        b[1] = run.z[at] - 0.5 * a * half * half
        b[2] = run.z[at] + u * half + 0.5 * a * half * half
        differentiate(b, course.rate[i], 2, course.length)
        differentiate(course.rate[i], course.second[i], 1, course.length)


# Ropes


def slackness(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """The largest multiplier of a rope, as evaluated last: positive where it would push."""
    r: cython.int
    most: cython.double = -1e300
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        if row.rope and row.multiplier > most:
            most = row.multiplier
            run.rope = r + 1
    return most


def slackness_at(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], x: cython.double
) -> cython.double:
    """The same at x of the step tried, by its dense output."""
    t: cython.double = clipped(run, run.t + x * run.h)
    interpolate(run, 3 + method.dense_rows, x, run.stage)
    settle(scene, t, run.stage)
    evaluate(scene, t, run.stage, run.fine)
    run.evaluations += 1
    return slackness(scene, run)


def meet_slack(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Where within a step tried a rope would have to push for the first time: the run ends there."""
    x: cython.double
    at: cython.double
    near: cython.double = scene.limits.least_step * fabs(run.end)
    if run.most_slack + 0.5 * (run.most_slack - run.least_slack) < 0.0 and not run.slack_landings:
        return STANDS
    need_interpolant(scene, method, run)
    x = first_slack(scene, method, run)
    if x > 1.0:
        run.slack_landings = 0
        return STANDS
    at = run.t + x * run.h
    if at - run.t <= near:
        run.stop = run.t
        return SLACK
    if run.stop - at <= near or run.slack_landings >= MOST_LANDINGS:
        return SLACK
    run.slack_landings += 1
    run.cut = at
    return AGAIN_TO


def first_slack(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.double:
    """x just before the first instant of the step tried at which a rope would push; 2 where none does.

    Parts in doubt are halved, from left to right, as in events.py.
    """
    x: cython.double = 0.0
    middle: cython.double
    top: cython.int = 0
    noise: cython.double = scene.limits.rounding * fabs(run.least_slack)
    ends: cython.p_double = run.course.ends
    ends[0] = 1.0
    while top >= 0:
        middle = 0.5 * (x + ends[top])
        if top == ROPE_HALVINGS or middle <= x or middle >= ends[top]:
            if slackness_at(scene, method, run, ends[top]) > noise:
                return x
            x = ends[top]
            top -= 1
        elif is_taut(scene, method, run, x, ends[top], noise):
            x = ends[top]
            top -= 1
        else:
            top += 1
            ends[top] = middle
    return 2.0


def is_taut(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x0: cython.double,
    x1: cython.double,
    noise: cython.double,
) -> cython.bint:
    """Whether no rope would push between x0 and x1.

    Between equidistant points a function rises above the larger of two neighbours by no more than an eighth of its
    second differences; twice that is allowed for, as they vary.
    """
    i: cython.int
    f: cython.double
    bend: cython.double
    highest: cython.double = -1e300
    bent: cython.double = 0.0
    before: cython.double = 0.0
    first: cython.double = 0.0
    for i in range(POINTS + 1):
        f = slackness_at(scene, method, run, x0 + (x1 - x0) * i / POINTS)
        if not f <= noise:
            return False
        if f > highest:
            highest = f
        if i > 1:
            bend = fabs(f - 2.0 * before + first)
            if bend > bent:
                bent = bend
        first = before
        before = f
    return highest + 0.25 * bent <= noise
