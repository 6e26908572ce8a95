"""Steps that end on events: a step tried is looked through, and done again up to the first event within it.

What an event asks for happens at the end of the step that lands there: branches turn, or a contact closes or opens
(contacts.py).
Where it lies is found on the dense output of the step that went over it, then on the end of the one that should have
met it, until both agree.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.contacts import meet_contacts, see_contacts, see_start, start_contacts
    from heuncli.kernel.course import instant, lay_course, lay_window
    from heuncli.kernel.dense import (
        AGAIN_TO,
        CHATTERS,
        MOST_LANDINGS,
        STANDS,
        clipped,
        hermite,
        need_interpolant,
    )
    from heuncli.kernel.events import (
        BRANCH_IN_DOUBT,
        CLEAR,
        NOTHING,
        TURNS,
        UNSEEN,
        first_event,
        forget,
        jump_at,
        quiet,
        see,
        take_branches,
    )
    from heuncli.kernel.held import clear_accelerations
    from heuncli.kernel.points import look_at
    from heuncli.kernel.response import evaluate
    from heuncli.kernel.scene import Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Course, Method, Run

    FLURRY = 16  # events that gather at an instant


# What the steps see


def begin_to_see(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """The start of a step is the first that is seen of it."""
    if scene.watch_count:
        forget(scene)
        look_at(scene, clipped(run, run.t), run.y)
        see(scene)
    if run.watching:
        see_start(scene)


def see_stage(scene: cython.pointer[Scene], run: cython.pointer[Run], t: cython.double) -> cython.void:
    """What was evaluated last, at t, is seen: lengths that a law tells are those of that instant."""
    if scene.watch_count:
        see(scene)
    if run.watching:
        see_contacts(scene, t)


# A step tried


def find_events_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """STANDS, with `turns` where branches turn at its end; AGAIN_TO `cut`; TURNS_OVER of a contact; CHATTERS."""
    code: cython.int = STANDS
    pivot: cython.double = scene.pivot
    least: cython.double = scene.pivot_of_step
    run.landing.turns = 0
    if scene.watch_count:
        code = meet_branches(scene, method, run)
        if code == STANDS:
            run.landing.attempts = 0
    if run.watching and code == STANDS:
        code = meet_contacts(scene, method, run)
    scene.pivot = pivot
    scene.pivot_of_step = least
    return code


def meet_branches(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Turns of branches, and what no stage has seen, within a step tried."""
    found: cython.int
    course: cython.pointer[Course] = cython.address(run.course)
    if run.landing.attempts:
        lay_window(scene, method, run)
        if first_event(scene, course) == TURNS and course.event > 0.0:
            return land_on(scene, method, run)
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
        return land_on(scene, method, run)
    return shorten(scene, run, found)


def shorten(scene: cython.pointer[Scene], run: cython.pointer[Run], found: cython.int) -> cython.int:
    """A step up to what no stage has seen, or up to where bounds ceased to decide."""
    to: cython.double = instant(cython.address(run.course), run.course.event)
    if found == UNSEEN or to - run.t > 0.1 * run.h:
        run.landing.cut = to
    elif run.h > scene.limits.locked_step * fabs(run.end):
        run.landing.cut = run.t + 0.1 * run.h
    else:
        run.undecided += 1
        return STANDS
    run.landing.attempts = 0
    return AGAIN_TO


def land_on(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The branches turn here: at once, at the end of the step tried, or after another one that ends there."""
    course: cython.pointer[Course] = cython.address(run.course)
    near: cython.double = one_instant(scene, run)
    at: cython.double = instant(course, course.event)
    if run.late:
        at = at + near
    off: cython.double = fabs(at - run.stop)
    if at - run.t <= 2.0 * near:
        run.landing.at_once += 1
        if run.landing.at_once > 4 + 2 * scene.held_count or gathered(scene, run, run.t):
            return CHATTERS
        take_branches(scene, course.turned)
        evaluate(scene, clipped(run, run.t), run.y, run.K[0])
        start_contacts(scene, run.t)
        clear_accelerations(scene, method, run.K[0], True)
        run.evaluations += 1
        run.landing.attempts = 0
        run.landing.cut = run.t  # none
        return AGAIN_TO
    if scene.limits.near_kink * run.h > near and jump_at(scene, course) <= scene.limits.no_jump:
        near = scene.limits.near_kink * run.h
    if run.landing.attempts and (off <= near or run.landing.attempts >= MOST_LANDINGS):
        run.landing.turns = 1
        return CHATTERS if gathered(scene, run, run.stop) else STANDS
    if at >= run.end:
        return STANDS  # beyond the piece
    run.landing.attempts += 1
    run.landing.cut = at
    return AGAIN_TO


def one_instant(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """What is so near to the end of the step under way is there: its rounding, or a hundredth of the run's end's."""
    t: cython.double = fabs(run.stop)
    if t < 0.01 * fabs(run.end):
        t = 0.01 * fabs(run.end)
    return scene.limits.one_instant * t


def in_flurry(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether several events lie just behind."""
    return run.landing.flurry > 2 and fabs(run.t - run.landing.flurry_begin) <= scene.limits.flurry * fabs(run.end)


def gathered(scene: cython.pointer[Scene], run: cython.pointer[Run], t: cython.double) -> cython.bint:
    """Whether events follow each other without end at t, one of which is counted."""
    if not fabs(t - run.landing.flurry_begin) <= scene.limits.flurry * fabs(run.end):
        run.landing.flurry_begin = t
        run.landing.flurry = 0
    run.landing.flurry += 1
    return run.landing.flurry > FLURRY
