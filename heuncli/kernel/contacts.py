"""Contacts: where within a step tried an open one would close for the first time, or a closed one have to pull.

The margin of a one-sided row, its gap while it is open and its multiplier while it is closed (times its sense), is
followed along the dense output and bounded by its second differences; parts in doubt are halved, from left to right.
The step is done again up to there, until both agree. What happens then is decided outside
(motion/integration/contacts/restitution.py).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import norm
    from heuncli.kernel.closures import measure_row
    from heuncli.kernel.dense import (
        AGAIN_TO,
        MOST_LANDINGS,
        STANDS,
        TURNS_OVER,
        clipped,
        interpolate,
        need_interpolant,
    )
    from heuncli.kernel.response import evaluate, settle
    from heuncli.kernel.scene import APART, CARRIES, LEANS, Closure, Contact, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Method, Run
    from heuncli.kernel.tree import kinematics

    # Halvings of a step, down to the rounding of its instants; into how many a part is divided to be looked at; parts
    # looked at, before rounding alone is what is in doubt.
    HALVINGS, POINTS, MOST_MARGIN_LOOKS = 46, 8, 400


# Margins


def margin(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.double:
    """What must not become positive: the gap of an open contact, the multiplier of a closed one."""
    row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
    return contact.sense * (row.gap if row.mode == APART else row.multiplier)


def measure_open(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Gaps and rates of the contacts that are open, at the present kinematics."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.contacts[i].row])
        if row.mode == APART:
            measure_row(scene, row, t)


def start_contacts(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """The margins, as evaluated last, are those at the start of a step."""
    i: cython.Py_ssize_t
    measure_open(scene, t)
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        contact.start = margin(scene, contact)
        contact.start_rate = contact.sense * scene.closures[contact.row].rate


def see_start(scene: cython.pointer[Scene]) -> cython.void:
    """The start of a step is the first that is seen of it."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        contact.most = contact.start
        contact.least = contact.start


def see_contacts(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """What was evaluated last is seen."""
    i: cython.Py_ssize_t
    x: cython.double
    measure_open(scene, t)
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        x = margin(scene, contact)
        if x > contact.most:
            contact.most = x
        if x < contact.least:
            contact.least = x


def pushed_at_once(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether a rope that ends the run would push where a piece begins."""
    i: cython.Py_ssize_t
    most: cython.double = 0.0
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.opens == 0 and contact.start > most:
            most = contact.start
            run.contact = contact.row + 1
    return most > 0.0


def opened_by_others(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether a contact that others kept closed is not closed any more."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.contacts[i].row])
        if row.mode == LEANS and not fabs(row.gap) * row.weight <= scene.limits.reopened * scene.size:
            run.contact = scene.contacts[i].row + 1
            return True
    return False


def turned_over(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """What the contact found does: 1 an open one closes, 2 a closed one opens, 3 a rope that must not would push."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        if scene.contacts[i].row + 1 == run.contact:
            if scene.closures[scene.contacts[i].row].mode == APART:
                return 1
            return 2 if scene.contacts[i].opens else 3
    return 0


# A step tried


def set_levels(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.int:
    """Above what margins contacts close or open, by their rounding; 0: none is in doubt, 1: open ones, 2: closed ones.

    A gap that is open, or leaves with a rate, closes where it is zero again, to the rounding of its sum; one that
    touches at rest is known to what settling leaves. Late, to show what rounding makes of it, a gap that comes to that
    closes there already: so a run that grazes a limit, or does not, is compared with one that does.
    """
    i: cython.Py_ssize_t
    found: cython.int = 0
    size: cython.double
    reach: cython.double
    likely: cython.double
    early: cython.bint
    least: cython.double = 0.0
    for i in range(scene.contact_count):
        if scene.closures[scene.contacts[i].row].mode == CARRIES and scene.contacts[i].least < least:
            least = scene.contacts[i].least
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
        contact.level = 1e300  # no doubt
        if row.mode == LEANS or contact.sense == 0:
            continue
        size = (scene.size + norm(row.Q)) / row.weight + fabs(row.length)
        reach = scene.limits.touching * size
        early = row.mode == APART and run.late and closes_early(contact, reach)
        likely = contact.most + 0.5 * (contact.most - contact.least)
        if likely < (-reach if early else 0.0) and not run.landing.contact_attempts:
            continue
        if row.mode == CARRIES:
            contact.level = scene.limits.rounding * fabs(least)
            found = 2
        elif early:
            contact.level = -reach
        else:
            contact.level = reach
            if contact.start < -contact.level or contact.start_rate * run.h < -contact.level:
                contact.level = scene.limits.rounding * size
            if contact.start > 0.0 and contact.start_rate <= 0.0:  # what leaves is not met again where it was left
                contact.level += contact.start
        if row.mode == APART and found == 0:
            found = 1
    return found


def closes_early(contact: cython.pointer[Contact], reach: cython.double) -> cython.bint:
    """Whether a gap is open beyond its rounding, or comes back to it."""
    return contact.start < -reach or (contact.start_rate > 0.0 and contact.start < -0.5 * reach)


def stand_within(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x: cython.double,
    doubt: cython.int,
) -> cython.void:
    """The scene at x of the step tried, by its dense output; where closed contacts are in doubt with their loads."""
    t: cython.double = clipped(run, run.t + x * run.h)
    interpolate(scene, method, run, x, run.stage)
    settle(scene, t, run.stage)
    if doubt == 2:
        evaluate(scene, t, run.stage, run.fine)
        run.evaluations += 1
    else:
        kinematics(scene, t, run.stage)
    measure_open(scene, t)


def meet_contacts(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Where within a step tried a contact would close, or open, for the first time: the step ends there."""
    x: cython.double
    at: cython.double
    near: cython.double = scene.limits.least_step * fabs(run.end)
    doubt: cython.int = set_levels(scene, run)
    if doubt == 0:
        return STANDS
    need_interpolant(scene, method, run)
    x = first_contact(scene, method, run, doubt)
    if x > 1.0:
        run.landing.contact_attempts = 0
        return STANDS
    at = run.t + where_closed(scene, method, run, x) * run.h
    if at - run.t <= near:
        run.stop = run.t
        return TURNS_OVER
    if run.stop - at <= near or run.landing.contact_attempts >= MOST_LANDINGS:
        return TURNS_OVER
    run.landing.contact_attempts += 1
    run.landing.cut = at
    return AGAIN_TO


def where_closed(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], x: cython.double
) -> cython.double:
    """Where the gap of the contact found is zero, just before x, where it is no more than its level; x of others.

    Late, there where it is at that level: so the rounding of a gap is seen.
    """
    i: cython.Py_ssize_t
    rate: cython.double
    back: cython.double
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.row + 1 == run.contact and scene.closures[contact.row].mode == APART and not run.late:
            stand_within(scene, method, run, x, 1)
            rate = contact.sense * scene.closures[contact.row].rate * run.h
            back = margin(scene, contact)
            if contact.start > 0.0 and contact.start_rate < 0.0:  # begun beyond it, a flight ends where it began
                back -= contact.start
            if rate > 0.0 and back > 0.0:
                back /= rate
                return x - back if back < x else 0.0
    return x


def first_contact(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], doubt: cython.int
) -> cython.double:
    """x just before the first instant of the step tried at which a margin is above its level; 2 where none is."""
    x: cython.double = 0.0
    middle: cython.double
    top: cython.int = 0
    looks: cython.int = 0
    ends: cython.p_double = run.course.ends
    ends[0] = 1.0
    while top >= 0:
        looks += 1
        middle = 0.5 * (x + ends[top])
        if top == HALVINGS or looks > MOST_MARGIN_LOOKS or middle <= x or middle >= ends[top]:
            stand_within(scene, method, run, ends[top], doubt)
            if is_above(scene, run):
                return x
            x = ends[top]
            top -= 1
        elif is_clear(scene, method, run, x, ends[top], doubt):
            x = ends[top]
            top -= 1
        else:
            top += 1
            ends[top] = middle
    return 2.0


def is_above(scene: cython.pointer[Scene], run: cython.pointer[Run]) -> cython.bint:
    """Whether a margin is above its level; run.contact: the last of them."""
    i: cython.Py_ssize_t
    found: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if not margin(scene, contact) <= contact.level:
            run.contact = contact.row + 1
            found = True
    return found


def is_clear(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x0: cython.double,
    x1: cython.double,
    doubt: cython.int,
) -> cython.bint:
    """Whether no margin rises above its level between x0 and x1.

    Between equidistant points a function rises above the larger of two neighbours by no more than an eighth of its
    second differences; twice that is allowed for, as they vary. A gap whose rate is nowhere positive does not rise.
    """
    i: cython.int
    k: cython.Py_ssize_t
    for i in range(POINTS + 1):
        stand_within(scene, method, run, x0 + (x1 - x0) * i / POINTS, doubt)
        if is_above(scene, run):
            return False
        for k in range(scene.contact_count):
            note_margin(scene, cython.address(scene.contacts[k]), i)
    for k in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[k])
        if contact.highest + 0.25 * contact.bent <= contact.level:
            continue
        if scene.closures[contact.row].mode == APART and contact.fastest + 0.25 * contact.rate_bent <= 0.0:
            continue
        return False
    return True


def note_margin(scene: cython.pointer[Scene], contact: cython.pointer[Contact], i: cython.int) -> cython.void:
    """The i-th of equidistant points is seen: the largest margin and rate, and their largest second differences."""
    x: cython.double = margin(scene, contact)
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
        bend = fabs(x - 2.0 * contact.before + contact.first)
        if bend > contact.bent:
            contact.bent = bend
        bend = fabs(rate - 2.0 * contact.rate_before + contact.rate_first)
        if bend > contact.rate_bent:
            contact.rate_bent = bend
    contact.first = contact.before
    contact.before = x
    contact.rate_first = contact.rate_before
    contact.rate_before = rate
