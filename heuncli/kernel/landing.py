"""Steps that end on events: a trial step is checked, and repeated up to the first event within it.

The event takes effect at the end of the step that lands there: branches turn (an operation of an expression takes
another of its branches), or a contact closes or opens (contacts.py). Its place is found on the dense output of the step
that went over it, then at the end of the one that should have met it, until both agree.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.contacts import (
    begin_margin_extremes,
    find_contact_event,
    start_contacts,
    update_margin_extremes,
)
from heuncli.kernel.course import build_end_window, build_step_course, course_instant
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import HERMITE_ROWS, build_hermite, clip_time, ensure_interpolant
from heuncli.kernel.events import find_first_event, hold_branches, relative_jump
from heuncli.kernel.points import evaluate_variables
from heuncli.kernel.response import evaluate
from heuncli.kernel.watches import check_coarsely, record_extremes, reset_extremes

MAX_FLURRY_EVENTS = 16  # events that gather at an instant
SPARSE_EVENTS = 2  # so many beside each other are no flurry yet
# Branch changes allowed at one instant: 4, and 2 more for each held branch; more count as endless.
EVENTS_AT_INSTANT, EVENTS_PER_BRANCH = 4, 2
SHORT_PART = 0.1  # of a step, to which it is cut where bounds decide nothing of it
END_SHARE = 0.01  # of the run's end: instants before it are as coarse as there


# What the steps see


def begin_step_extremes(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.void:
    """Start the extremes of watched numbers and contact margins with the start of a step."""
    if scene.watch_count:
        reset_extremes(scene)
        evaluate_variables(scene, clip_time(run, run.t), run.y)
        record_extremes(scene)
    if run.watches_contacts:
        begin_margin_extremes(scene)


def record_stage(scene: cython.pointer[Scene], run: cython.pointer[Run], t: cython.double) -> cython.void:
    """Include what was evaluated last, at t; lengths given by a law are those of that instant."""
    if scene.watch_count:
        record_extremes(scene)
    if run.watches_contacts:
        update_margin_extremes(scene, t)


# A step tried


def find_events_of_step(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Find what happens in a trial step.

    Returns NO_EVENT (`turns`: branches turn at its end), REPEAT_TO (up to `cut`), CONTACT_EVENT or EVENT_CHATTER.
    """
    code: cython.int = NO_EVENT
    pivot: cython.double = scene.pivot
    least: cython.double = scene.pivot_of_step
    run.landing.turns = 0
    if scene.watch_count:
        code = find_branch_event(scene, method, run)
        if code == NO_EVENT:
            run.landing.attempts = 0
    if run.watches_contacts and code == NO_EVENT:
        code = find_contact_event(scene, method, run)
    scene.pivot = pivot
    scene.pivot_of_step = least
    return code


def find_branch_event(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Find where branches turn, and what no stage has seen, within a trial step."""
    event_kind: cython.int
    course: cython.pointer[Course] = cython.address(run.course)
    if run.landing.attempts:  # around the end of a step that is to end on the event
        build_end_window(scene, method, run)
        if find_first_event(scene, course) == TURNS and course.event > 0.0:
            return land_on_event(scene, method, run)
    # as seen by the stages
    doubt: cython.int = check_coarsely(scene, run.t, clip_time(run, run.stop))
    if doubt == CLEAR:
        return NO_EVENT
    if doubt != BRANCH_IN_DOUBT:  # on a cubic through the ends
        build_hermite(method, run)
        build_step_course(scene, run, HERMITE_ROWS)
        if find_first_event(scene, course) == NOTHING and not course.undecided:
            return NO_EVENT
    # on the dense output
    ensure_interpolant(scene, method, run)
    build_step_course(scene, run, HERMITE_ROWS + method.dense_rows)
    event_kind = find_first_event(scene, course)
    if event_kind == NOTHING:
        run.undecided += course.undecided
        return NO_EVENT
    if event_kind == TURNS:
        return land_on_event(scene, method, run)
    return shorten_step(scene, run, event_kind)


def shorten_step(scene: cython.pointer[Scene], run: cython.pointer[Run], event_kind: cython.int) -> cython.int:
    """End the step at what no stage has seen, or where bounds cease to decide."""
    event_time: cython.double = course_instant(cython.address(run.course), run.course.event)
    if event_kind == UNSEEN or event_time - run.t > SHORT_PART * run.h:
        run.landing.cut = event_time
    elif run.h > scene.limits.locked_step * fabs(run.end):
        run.landing.cut = run.t + SHORT_PART * run.h
    else:
        run.undecided += 1
        return NO_EVENT
    run.landing.attempts = 0
    return REPEAT_TO


def land_on_event(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Turn the branches at the event: at the start of the trial step, at its end, or after another step that ends
    there.
    """
    course: cython.pointer[Course] = cython.address(run.course)
    least_distance: cython.double = instant_tolerance(scene, run)
    event_time: cython.double = course_instant(course, course.event)
    if run.late:
        event_time = event_time + least_distance
    distance: cython.double = fabs(event_time - run.stop)
    # at the start of the step: turn the branches now, and try the step again
    if event_time - run.t <= 2.0 * least_distance:
        run.landing.turns_at_instant += 1
        if (
            run.landing.turns_at_instant > EVENTS_AT_INSTANT + EVENTS_PER_BRANCH * scene.held_count
            or count_flurry_event(scene, run, run.t)
        ):
            return EVENT_CHATTER
        hold_branches(scene, course.turned)
        evaluate(scene, clip_time(run, run.t), run.y, run.K[0])
        start_contacts(scene, run.t)
        clear_accelerations(scene, method, run.K[0], True)
        run.evaluations += 1
        run.landing.attempts = 0
        run.landing.cut = run.t  # no shorter step
        return REPEAT_TO
    # a kink: near it is near enough
    if scene.limits.near_kink * run.h > least_distance and relative_jump(scene, course) <= scene.limits.no_jump:
        least_distance = scene.limits.near_kink * run.h
    # the step ends on it
    if run.landing.attempts and (distance <= least_distance or run.landing.attempts >= MAX_LANDINGS):
        run.landing.turns = 1
        return NO_EVENT  # counted when the step is accepted: a contact may end it earlier
    if event_time >= run.end:
        return NO_EVENT  # the event is after the end of the piece
    # try again up to there
    run.landing.attempts += 1
    run.landing.cut = event_time
    return REPEAT_TO


def instant_tolerance(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.double:
    """Return the distance within which instants count as equal: rounding at the end of this step, or a hundredth of
    that at the run's end.
    """
    t: cython.double = fabs(run.stop)
    if t < END_SHARE * fabs(run.end):
        t = END_SHARE * fabs(run.end)
    return scene.limits.one_instant * t


def is_in_flurry(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Return whether several events lie just behind."""
    return run.landing.flurry > SPARSE_EVENTS and fabs(run.t - run.landing.flurry_begin) <= scene.limits.flurry * fabs(
        run.end
    )


def count_flurry_event(scene: cython.pointer[Scene], run: cython.pointer[Run], t: cython.double) -> cython.bint:
    """Count an event at t. Returns whether events follow each other there without end."""
    if not fabs(t - run.landing.flurry_begin) <= scene.limits.flurry * fabs(run.end):
        run.landing.flurry_begin = t
        run.landing.flurry = 0
    run.landing.flurry += 1
    return run.landing.flurry > MAX_FLURRY_EVENTS
