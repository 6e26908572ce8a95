"""Friction as it is, without a smoothed sign: while it sticks a closure row, while it slips a load of a given sign.

    sticks:  rate = 0, |value| <= breakaway N        slips:  value = -slip coefficient N,   slip rate >= 0

The row holds the coordinate of its joint; its multiplier is the friction ON b. N is the normal force, or 1 times a
given size. Several may stick as one on a single freedom, as in all pins of a four-bar: with t_i, the rate of each per
unit rate of one of them, their leader, only a sum of the multipliers is determinate, and

    | sum of t_i multiplier_i |  <=  sum of |t_i| breakaway_i N_i

What must not become positive, as for other contacts (contacts.py), is |value| - breakaway N while it sticks
and -slip rate while it slips. Which of them it does from an event on is decided outside
(motion/integration/contacts/sticking.py).
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.closures import size_of_row_gap, size_of_row_rate
from heuncli.kernel.declarations import *

# Relative to the largest rate of a step: a friction that began at rest and is slower has not stopped again, it has not
# yet left its start.
BEGINS_TO_SLIP = 1e-9
UNREACHED = 1e300  # a threshold that no margin passes; minus it, the margin of what causes no event


def set_friction_mode(
    scene: cython.pointer[Scene], contact: cython.pointer[Contact], place: cython.double
) -> cython.bint:
    """Set where the friction's row holds if it is closed, else the sign of its slip. Returns whether that changed."""
    if contact.friction > scene.load_count:  # a scene without its loads
        return False
    row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
    load: cython.pointer[Load] = cython.address(scene.loads[contact.friction - 1])
    length: cython.double = row.length
    slip: cython.double = load.slip
    contact.sticks = 1 if row.mode == CARRIES else 0
    row.length = place if contact.sticks else 0.0
    load.slip = 0.0 if contact.sticks else place
    return length != row.length or slip != load.slip


def measure_friction_margin(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.double:
    """Return what must not become positive: how far the friction exceeds what it can hold, or the rate against its
    slip.
    """
    if contact.friction > scene.load_count:
        return -UNREACHED
    row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
    load: cython.pointer[Load] = cython.address(scene.loads[contact.friction - 1])
    if row.mode != APART:
        if contact.leader and not leads_group(scene, contact):
            return -UNREACHED  # its leader's margin is that of all
        return fabs(sum_sticking_force(scene, contact)) - sum_sticking_limit(scene, contact)
    return -load.slip * row.rate if load.slip != 0.0 else -UNREACHED


def leads_group(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.bint:
    """Return whether a friction is the leader of its group."""
    return scene.contacts[contact.leader - 1].row == contact.row


def sum_sticking_force(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.double:
    """Return the friction of a contact that sticks; of a group the sum, at its leader."""
    i: cython.Py_ssize_t
    total: cython.double = 0.0
    if contact.leader == 0:
        return scene.closures[contact.row].multiplier
    for i in range(scene.contact_count):
        if scene.contacts[i].sticks and scene.contacts[i].leader == contact.leader:
            total += scene.contacts[i].transmission * scene.closures[scene.contacts[i].row].multiplier
    return total


def sum_sticking_limit(scene: cython.pointer[Scene], contact: cython.pointer[Contact]) -> cython.double:
    """Return what a friction that sticks can hold; of a group the sum, at its leader."""
    i: cython.Py_ssize_t
    total: cython.double = 0.0
    load: cython.pointer[Load] = cython.address(scene.loads[contact.friction - 1])
    if contact.leader == 0:
        return load.breakaway * load.normal_force
    for i in range(scene.contact_count):
        if scene.contacts[i].sticks and scene.contacts[i].leader == contact.leader:
            load = cython.address(scene.loads[scene.contacts[i].friction - 1])
            total += fabs(scene.contacts[i].transmission) * load.breakaway * load.normal_force
    return total


def find_friction_threshold(
    scene: cython.pointer[Scene], contact: cython.pointer[Contact], end_time: cython.double, late: cython.bint
) -> cython.double:
    """Return the margin above which the state changes, from its rounding over a step whose extremes are known.

    end_time: of the piece [s]; late: as Run.late, a friction that sticks slips at twice the rounding

    What begins at rest may begin with the rounding of its rate against its slip: in the shortest steps that is more
    than all that it gains.
    """
    rounding: cython.double
    row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
    largest: cython.double = fabs(contact.least) if fabs(contact.least) > fabs(contact.most) else fabs(contact.most)
    if row.mode != APART:
        rounding = scene.limits.friction_rounding * (largest + sum_sticking_limit(scene, contact))
        return 2.0 * rounding if late else rounding
    rounding = find_rate_rounding(scene, row, end_time)
    if contact.start >= -BEGINS_TO_SLIP * largest or contact.start >= -rounding:
        return BEGINS_TO_SLIP * largest if BEGINS_TO_SLIP * largest > rounding else rounding
    return scene.limits.rounding * largest


def find_rate_rounding(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], end_time: cython.double
) -> cython.double:
    """Return the rate below which a row is at rest: rounding of the terms of its rate, or of its gap up to the end.

    The same as `measure_coordinate_rate` (motion/integration/contacts/latches.py), by which its state is decided.
    """
    rounding: cython.double = scene.limits.still_rate * size_of_row_rate(scene, row)
    drift: cython.double = scene.limits.touching * size_of_row_gap(scene, row)
    return rounding if rounding * end_time > drift else drift / end_time


def record_sticking(scene: cython.pointer[Scene]) -> cython.void:
    """Store what sticks as the load that it exerts, and how much more each friction could take."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.friction == 0 or contact.friction > scene.load_count:
            continue
        load: cython.pointer[Load] = cython.address(scene.loads[contact.friction - 1])
        load.reserve = 0.0
        if contact.sticks:
            row: cython.pointer[Closure] = cython.address(scene.closures[contact.row])
            load.value = row.multiplier
            load.force = scale_vector(row.multiplier, row.f)
            load.moment = scale_vector(row.multiplier, row.m)
            if load.kind == THREAD_FRICTION:  # its row is a sum, whose load is that of its parts
                load.moment = scale_vector(row.multiplier, world_direction(scene, load.a, load.axis))
                load.force = scale_vector(load.factor, load.moment)
            load.rate = 0.0
            load.power = 0.0
            load.reserve = sum_sticking_limit(scene, contact) - fabs(sum_sticking_force(scene, contact))
            if contact.leader:
                load.reserve /= fabs(contact.transmission)


def open_sticking_rows(scene: cython.pointer[Scene]) -> cython.bint:
    """Open the rows of what sticks, whose loads `record_sticking` has stored. Returns whether there are any."""
    i: cython.Py_ssize_t
    found: cython.bint = False
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.sticks:
            scene.closures[contact.row].mode = APART
            scene.closures[contact.row].multiplier = 0.0
            found = True
    return found


def close_sticking_rows(scene: cython.pointer[Scene]) -> cython.void:
    """Close the rows that `open_sticking_rows` has opened."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        contact: cython.pointer[Contact] = cython.address(scene.contacts[i])
        if contact.sticks:
            scene.closures[contact.row].mode = CARRIES
