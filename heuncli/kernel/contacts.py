"""Contacts: where within a trial step an open one first closes, or a closed one would have to pull.

The margin of a unilateral row, by its mode:

    APART      open                            sense * gap
    CARRIES    closed                          sense * multiplier
    LEANS      kept closed by other contacts   |gap|, for a drive may open it

It must not become positive, and |gap| must not exceed its rounding. That of a friction is in sticking.py. The margin is
followed along the dense output and bounded by its second differences; parts in doubt are halved, from left to right.
The step is repeated up to there until both agree. What happens then is decided outside
(motion/integration/contacts/restitution.py).
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.closures import measure_row, size_of_row_gap
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time, ensure_interpolant, interpolate
from heuncli.kernel.kinematics import update_kinematics
from heuncli.kernel.response import evaluate, project_state
from heuncli.kernel.sticking import UNREACHED, find_friction_threshold, measure_friction_margin

MAX_STEP_HALVINGS = 46  # of a step, down to the rounding of its instants
POINTS = 8  # in which a part of a step is checked
MAX_MARGIN_PARTS = 400  # of a step that are checked before only rounding can be in doubt
# Which margins may pass their thresholds within a step; those of closed contacts need the loads.
NO_MARGIN, GAPS_ONLY, FORCES_TOO = range(3)


# Margins


def contact_margin(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.double:
    """Return the margin of a contact (see above)."""
    if contact.friction:
        return measure_friction_margin(scene, contact)
    row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
    if row.mode == LEANS:
        return fabs(row.gap)
    return contact.sense * (row.gap if row.mode == APART else row.multiplier)


def measure_open_contacts(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Find gaps and rates of the contacts that carry nothing at the present kinematics."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.contacts[i].row])
        if row.mode != CARRIES:
            measure_row(scene, row, t)


def start_contacts(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Store the margins evaluated last as those at the start of a step."""
    i: cython.Py_ssize_t
    measure_open_contacts(scene, t)
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        contact.start = contact_margin(scene, contact)
        contact.start_rate = contact.sense * scene.closures[contact.row].rate


def begin_margin_extremes(scene: cython.pointer[Scene]) -> cython.void:
    """Start the extremes of the margins with those at the start of a step."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        contact.most = contact.start
        contact.least = contact.start


def update_margin_extremes(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Include the margins evaluated last in the extremes."""
    i: cython.Py_ssize_t
    x: cython.double
    measure_open_contacts(scene, t)
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        x = contact_margin(scene, contact)
        if x > contact.most:
            contact.most = x
        if x < contact.least:
            contact.least = x


def find_pushing_rope(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Set run.contact to a rope that would have to push at the start of a piece, which ends the run. Returns whether
    there is one.
    """
    i: cython.Py_ssize_t
    most: cython.double = 0.0
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.mode_index == 0 and contact.start > most:
            most = contact.start
            run.contact = contact.row + 1
    return most > 0.0


def find_contact_code(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Return what the contact found does: STRUCK, LET_GO, or ROPE_SLACK if a rope without restitution would push."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        if scene.contacts[i].row + 1 == run.contact:
            if scene.closures[scene.contacts[i].row].mode == APART:
                return STRUCK
            return LET_GO if scene.contacts[i].mode_index else ROPE_SLACK
    return LET_GO


# A step tried


def set_contact_thresholds(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Set the margins above which contacts close or open, from their rounding. Returns NO_MARGIN, GAPS_ONLY or
    FORCES_TOO.

    A gap that is open, or leaves with a rate, closes where it is zero again, to the rounding of its sum; one that
    touches at rest is known to the accuracy of the projection. If run.late is set (stepping.py), a gap that comes
    within that closes there already: so a run that just grazes a limit, or misses it, is compared with one that touches
    it.
    """
    i: cython.Py_ssize_t
    needed: cython.int = NO_MARGIN
    size: cython.double
    rounding: cython.double
    likely: cython.double
    early: cython.bint
    least: cython.double = 0.0
    for i in range(scene.contact_count):
        if scene.closures[scene.contacts[i].row].mode == CARRIES and scene.contacts[i].least < least:
            least = scene.contacts[i].least
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
        contact.threshold = UNREACHED
        if contact.friction and may_change_state(scene, contact, run):
            contact.threshold = find_friction_threshold(scene, contact, fabs(run.end), run.late)
            needed = FORCES_TOO if row.mode == CARRIES or needed == FORCES_TOO else GAPS_ONLY
        if contact.sense == 0:
            continue
        if row.mode == LEANS:
            rounding = scene.limits.reopened * scene.size / row.weight
            if contact.most + 0.5 * (contact.most - contact.least) > rounding or run.landing.contact_attempts:
                contact.threshold = rounding
                needed = GAPS_ONLY if needed == NO_MARGIN else needed
            continue
        size = size_of_row_gap(scene, row)
        rounding = scene.limits.touching * size
        early = row.mode == APART and run.late and may_close_early(contact, rounding)
        likely = contact.most + 0.5 * (contact.most - contact.least)
        if likely < (-rounding if early else 0.0) and not run.landing.contact_attempts:
            continue
        if row.mode == CARRIES:
            contact.threshold = scene.limits.rounding * fabs(least)
            needed = FORCES_TOO
        elif early:
            contact.threshold = -rounding
        else:
            contact.threshold = rounding
            if contact.start < -contact.threshold or contact.start_rate * run.h < -contact.threshold:
                contact.threshold = scene.limits.rounding * size
            # a contact that opens does not close again where it opened
            if contact.start > 0.0 and contact.start_rate <= 0.0:
                contact.threshold += contact.start
        if row.mode == APART and needed == NO_MARGIN:
            needed = GAPS_ONLY
    return needed


def may_change_state(
    scene: cython.pointer[Scene], contact: cython.pointer[Contact], run: cython.pointer[Run]
) -> cython.bint:
    """Return whether a friction may begin to stick or to slip within the step, or an attempt to find where goes on."""
    if contact.friction > scene.load_count:
        return False
    return contact.most + 0.5 * (contact.most - contact.least) > 0.0 or run.landing.contact_attempts > 0


def may_close_early(contact: cython.pointer[Contact], rounding: cython.double) -> cython.bint:
    """Return whether a gap may close before it is zero: it is open by more than its rounding, or comes back to it."""
    return contact.start < -rounding or (contact.start_rate > 0.0 and contact.start < -0.5 * rounding)


def evaluate_within_step(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x: cython.double,
    needed: cython.int,
) -> cython.void:
    """Evaluate the scene at x of the trial step from its dense output.

    needed: GAPS_ONLY: positions and rates; FORCES_TOO: also loads
    """
    t: cython.double = clip_time(run, run.t + x * run.h)
    interpolate(scene, method, run, x, run.stage)
    project_state(scene, t, run.stage)
    if needed == FORCES_TOO:
        evaluate(scene, t, run.stage, run.fine)
        run.evaluations += 1
    else:
        update_kinematics(scene, t, run.stage)
    measure_open_contacts(scene, t)


def find_contact_event(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Find where within a trial step a contact first closes or opens, and let the step end there."""
    x: cython.double
    event_time: cython.double
    least_distance: cython.double = scene.limits.least_step * fabs(run.end)
    needed: cython.int = set_contact_thresholds(scene, run)
    if needed == NO_MARGIN:
        return NO_EVENT
    ensure_interpolant(scene, method, run)
    x = find_first_contact(scene, method, run, needed)
    if x > 1.0:
        run.landing.contact_attempts = 0
        return NO_EVENT
    event_time = run.t + locate_closing(scene, method, run, x) * run.h
    if event_time - run.t <= least_distance:
        run.stop = run.t
        return CONTACT_EVENT
    if run.stop - event_time <= least_distance or run.landing.contact_attempts >= MAX_LANDINGS:
        return CONTACT_EVENT
    run.landing.contact_attempts += 1
    run.landing.cut = event_time
    return REPEAT_TO


def locate_closing(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], x: cython.double
) -> cython.double:
    """Return where the gap of the contact found is zero, just before x, where it has not passed its threshold; x for
    other contacts.

    If run.late is set (stepping.py), return where it is at the threshold.
    """
    i: cython.Py_ssize_t
    rate: cython.double
    back: cython.double
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.row + 1 == run.contact and scene.closures[contact.row].mode == APART and not run.late:
            evaluate_within_step(scene, method, run, x, GAPS_ONLY)
            rate = contact.sense * scene.closures[contact.row].rate * run.h
            back = contact_margin(scene, contact)
            # a flight that begins with a positive gap ends at that gap
            if contact.start > 0.0 and contact.start_rate < 0.0:
                back -= contact.start
            if rate > 0.0 and back > 0.0:
                back /= rate
                return x - back if back < x else 0.0
    return x


def find_first_contact(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], needed: cython.int
) -> cython.double:
    """Return x just before the first instant of the trial step at which a margin is above its threshold; 2 if there is
    none.
    """
    x: cython.double = 0.0
    middle: cython.double
    top: cython.int = 0
    looks: cython.int = 0
    ends: cython.p_double = run.course.ends
    ends[0] = 1.0
    while top >= 0:
        looks += 1
        middle = 0.5 * (x + ends[top])
        if top == MAX_STEP_HALVINGS or looks > MAX_MARGIN_PARTS or middle <= x or middle >= ends[top]:
            evaluate_within_step(scene, method, run, ends[top], needed)
            if find_exceeded_margin(scene, run):
                return x
            x = ends[top]
            top -= 1
        elif stays_below_thresholds(scene, method, run, x, ends[top], needed):
            x = ends[top]
            top -= 1
        else:
            top += 1
            ends[top] = middle
    return 2.0


def find_exceeded_margin(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Set run.contact to the last contact whose margin is above its threshold. Returns whether there is one."""
    i: cython.Py_ssize_t
    found: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if not contact_margin(scene, contact) <= contact.threshold:
            run.contact = contact.row + 1
            found = True
    return found


def stays_below_thresholds(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x0: cython.double,
    x1: cython.double,
    needed: cython.int,
) -> cython.bint:
    """Return whether no margin rises above its threshold between x0 and x1.

    Between equidistant points a function exceeds the larger of two neighbours by at most an eighth of its second
    differences; twice that is allowed for, as they vary. A gap whose rate is nowhere positive does not rise.
    """
    i: cython.int
    k: cython.Py_ssize_t
    for i in range(POINTS + 1):
        evaluate_within_step(scene, method, run, x0 + (x1 - x0) * i / POINTS, needed)
        if find_exceeded_margin(scene, run):
            return False
        for k in range(scene.contact_count):
            record_margin(scene, cython.address(scene.contacts[k]), i)
    for k in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[k])
        if contact.highest + 0.25 * contact.bent <= contact.threshold:
            continue
        if contact.friction:
            return False
        if scene.closures[contact.row].mode == APART and contact.fastest + 0.25 * contact.rate_bent <= 0.0:
            continue
        return False
    return True


def record_margin(scene: cython.pointer[Scene], contact: cython.pointer[Contact], i: cython.int) -> cython.void:
    """Include the i-th of equidistant points: the largest margin and rate, and their largest second differences."""
    x: cython.double = contact_margin(scene, contact)
    rate: cython.double = contact.sense * scene.closures[contact.row].rate
    bend: cython.double
    if i == 0:
        contact.highest = x
        contact.fastest = rate
        contact.bent = 0.0
        contact.rate_bent = 0.0
    if x > contact.highest:
        contact.highest = x
    if rate > contact.fastest:
        contact.fastest = rate
    if i > 1:
        bend = fabs(x - 2.0 * contact.previous + contact.before_previous)
        if bend > contact.bent:
            contact.bent = bend
        bend = fabs(rate - 2.0 * contact.rate_previous + contact.rate_before_previous)
        if bend > contact.rate_bent:
            contact.rate_bent = bend
    contact.before_previous = contact.previous
    contact.previous = x
    contact.rate_before_previous = contact.rate_previous
    contact.rate_previous = rate
