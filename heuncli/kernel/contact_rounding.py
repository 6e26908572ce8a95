"""Remove the error that is mere rounding along closed contacts from the estimated error of a step.

    e <- e - M^-1 J' (J M^-1 J')^-1 J_c e,   of rates and of coordinates

J is that of all closures at the step's end, J_c that of the closed contacts: the change removed is the smallest in the
norm of M, as in the projection (response.py). What a contact holds need not move: loads that cancel there leave
rounding, and there is no rate to compare it with. What exceeds rounding stays in the error: so a drive that jerks a
rope is noticed.

Accelerations are likewise cleared of J Vdot + gamma, the rounding error of those loads: otherwise contact forces would
do work on the rates it produces. What is left is the rounding of the terms of J Vdot + gamma.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.closures import row_acceleration, row_motion, size_of_row_acceleration
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time
from heuncli.kernel.response import add_motion, refactor_at, solve_demands_only

# Bound of the sum of the stages' weights: for high order they are some tens, of either sign.
MAX_STAGE_SUM = 32.0


def has_closed_contact(scene: cython.pointer[Scene]) -> cython.bint:
    """Return whether a contact is closed."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        if scene.closures[scene.contacts[i].row].mode == CARRIES:
            return True
    return False


def clear_accelerations(
    scene: cython.pointer[Scene], method: cython.pointer[Method], dy: cython.p_double, is_first: cython.bint
) -> cython.void:
    """Clear the accelerations evaluated last of rounding along the rows, if a contact is closed; the multipliers are
    lost.

    is_first: whether it is the first evaluation of a step, over which the size of the rows' terms is recorded
    """
    r: cython.Py_ssize_t
    size: cython.double
    if method.attitude or not has_closed_contact(scene):
        return
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        size = size_of_row_acceleration(scene, row)
        row.demand = row_acceleration(scene, row)
        if is_first or size > row.terms:
            row.terms = size
    if not method.implicit:
        solve_demands_only(scene)
        add_motion(scene, dy, True)


def remove_contact_rounding(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Remove from the estimates of a step's error what contacts hold, if it may be rounding.

    Errors in a chart of attitudes stay as they are: they are not in the state's numbers.
    """
    if method.attitude or not has_closed_contact(scene):
        return
    refactor_at(scene, clip_time(run, run.stop), run.z)
    if not scene.pivot > 0.0:
        return
    remove_rounding(scene, run, run.fine)
    if method.estimates == 2:
        remove_rounding(scene, run, run.coarse)


def remove_rounding(scene: cython.pointer[Scene], run: cython.pointer[Run], e: cython.p_double) -> cython.void:
    """Remove rounding along the closed contacts from an error per step length, of coordinates and of rates.

    Rates err by the rounding of accelerations over the step, coordinates by that of such rates.
    """
    rates: cython.int
    rounding: cython.double = MAX_STAGE_SUM * MAX_STAGE_SUM * scene.limits.rounding * run.h
    for rates in range(2):
        propagate_error(scene, run.z, e, rates == 1)
        set_contact_demands(scene, rounding)
        solve_demands_only(scene)
        add_response(scene, run.z, e, rates == 1)
        rounding = MAX_STAGE_SUM * scene.limits.rounding


def set_contact_demands(scene: cython.pointer[Scene], rounding: cython.double) -> cython.void:
    """Set the demand of each closed contact to the bodies' motion along it, if that is rounding; else to 0."""
    i: cython.Py_ssize_t
    motion: cython.double
    for i in range(scene.closure_count):
        scene.closures[i].demand = 0.0
    for i in range(scene.contact_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.contacts[i].row])
        if row.mode != CARRIES:
            continue
        motion = row_motion(scene, row, 0.0)
        if fabs(motion) <= rounding * row.terms:
            row.demand = motion


def propagate_error(
    scene: cython.pointer[Scene], z: cython.p_double, e: cython.p_double, rates: cython.bint
) -> cython.void:
    """Find the bodies' motion alpha and a for small changes e of the coordinates, or of the rates, roots to tips."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    x: cython.double
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: Vec3 = Vec3(0.0, 0.0, 0.0)
        a: Vec3 = alpha
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            alpha = parent.alpha
            a = add_cross(parent.a, alpha, body.arm)
        for k in range(body.end_freedom - 1, body.first_freedom - 1, -1):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                continue
            x = e[freedom.u_at if rates else freedom.q_at]
            if freedom.kind == SHIFT:
                a = add_scaled(a, x, freedom.s)
            else:
                alpha = add_scaled(alpha, x, freedom.s)
        if body.ball:
            alpha = ball_rotation(body, z, e, rates)
        body.alpha = alpha
        body.a = a


def ball_rotation(body: cython.pointer[Body], z: cython.p_double, e: cython.p_double, rates: cython.bint) -> Vec3:
    """Return the small rotation 2 e q^-1 for an error of a quaternion; the error of an angular velocity as it is."""
    k: cython.Py_ssize_t = body.rate_at if rates else body.attitude_at
    if rates:
        return read_vector(e, k)
    return Vec3(
        2.0 * (z[k] * e[k + 1] - z[k + 1] * e[k] + z[k + 2] * e[k + 3] - z[k + 3] * e[k + 2]),
        2.0 * (z[k] * e[k + 2] - z[k + 2] * e[k] + z[k + 3] * e[k + 1] - z[k + 1] * e[k + 3]),
        2.0 * (z[k] * e[k + 3] - z[k + 3] * e[k] + z[k + 1] * e[k + 2] - z[k + 2] * e[k + 1]),
    )


def add_response(
    scene: cython.pointer[Scene], z: cython.p_double, e: cython.p_double, rates: cython.bint
) -> cython.void:
    """Add the response to an error of the coordinates, or of the rates."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball and rates:
            k = body.rate_at
            e[k] += body.alpha.x
            e[k + 1] += body.alpha.y
            e[k + 2] += body.alpha.z
        elif body.ball:
            k = body.attitude_at
            turn: Quaternion = quaternion_rate(read_quaternion(z, k), body.alpha)
            e[k] += turn.w
            e[k + 1] += turn.x
            e[k + 2] += turn.y
            e[k + 3] += turn.z
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            e[freedom.u_at if rates else freedom.q_at] += freedom.udot
