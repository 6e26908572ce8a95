"""What closed contacts hold of a step has no error to be judged by, but rounding.

    e <- e - M^-1 J' (J M^-1 J')^-1 J_c e,   of rates and of coordinates
J of all closures at the step's end, J_c of the closed contacts: what is taken off is the least change, in the measure
of M, that settling makes too (response.py). What a contact holds need not move: loads that cancel in it leave rounding,
and there is no rate of its own to measure that by. What is more than rounding is judged: a drive that jerks a rope is
seen by it.

Accelerations are cleared likewise of J Vdot + gamma, which the rounding of those loads leaves: what presses would do
work on the rates that it makes. What is left is the rounding of the terms of J Vdot + gamma.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import Quaternion, Vec3, add_cross, add_scaled, quaternion_rate
    from heuncli.kernel.closures import acceleration_of, moved_by, size_of_answer
    from heuncli.kernel.dense import clipped
    from heuncli.kernel.response import move, refactor, take_back
    from heuncli.kernel.scene import CARRIES, SHIFT, Body, Closure, Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Method, Run

# By how much the weights of stages may add up: those of high order are some tens, of either sign.
STAGES = 32.0


def is_held(scene: cython.pointer[Scene]) -> cython.bint:
    """Whether a contact is closed."""
    i: cython.Py_ssize_t
    for i in range(scene.contact_count):
        if scene.closures[scene.contacts[i].row].mode == CARRIES:
            return True
    return False


def clear_accelerations(
    scene: cython.pointer[Scene], method: cython.pointer[Method], dy: cython.p_double, begins: cython.bint
) -> cython.void:
    """Clear what was evaluated last of rounding along the rows, where a contact is closed; the multipliers are lost.

    begins: whether it is the first of a step, over which the size of the rows' terms is seen.
    """
    r: cython.Py_ssize_t
    size: cython.double
    if method.attitude or not is_held(scene):
        return
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        size = size_of_answer(scene, row)
        row.demand = acceleration_of(scene, row)
        if begins or size > row.terms:
            row.terms = size
    if not method.implicit:
        take_back(scene)
        move(scene, dy, True)


def take_off_held(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Take off the estimates of a step's error what contacts hold, if it may be rounding.

    Errors in a chart of attitudes stay as they are: they are none of the state's numbers.
    """
    if method.attitude or not is_held(scene):
        return
    refactor(scene, clipped(run, run.stop), run.z)
    if not scene.pivot > 0.0:
        return
    take_off(scene, run, run.fine)
    if method.estimates == 2:
        take_off(scene, run, run.coarse)


def take_off(scene: cython.pointer[Scene], run: cython.pointer[Run], e: cython.p_double) -> cython.void:
    """Take what is rounding along the closed contacts off an error by the step's length, of coordinates and of rates.

    Rates err by the rounding of accelerations over the step, coordinates by that of such rates.
    """
    rates: cython.int
    rounding: cython.double = STAGES * STAGES * scene.limits.rounding * run.h
    for rates in range(2):
        carry_error(scene, run.z, e, rates == 1)
        demand_back(scene, rounding)
        take_back(scene)
        add_answer(scene, run.z, e, rates == 1)
        rounding = STAGES * scene.limits.rounding


def demand_back(scene: cython.pointer[Scene], rounding: cython.double) -> cython.void:
    """Closed contacts demand that what the bodies are moved by along them is taken back, where that is rounding."""
    i: cython.Py_ssize_t
    moved: cython.double
    for i in range(scene.closure_count):
        scene.closures[i].demand = 0.0
    for i in range(scene.contact_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.contacts[i].row])
        if row.mode != CARRIES:
            continue
        moved = moved_by(scene, row, 0.0)
        if fabs(moved) <= rounding * row.terms:
            row.demand = moved


def carry_error(
    scene: cython.pointer[Scene], z: cython.p_double, e: cython.p_double, rates: cython.bint
) -> cython.void:
    """What small changes e of the coordinates, or of the rates, move the bodies by, roots to tips: alpha and a."""
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
            alpha = turn_of(body, z, e, rates)
        body.alpha = alpha
        body.a = a


def turn_of(body: cython.pointer[Body], z: cython.p_double, e: cython.p_double, rates: cython.bint) -> Vec3:
    """The small turn 2 e q^-1 that an error of a quaternion is; the error of an angular velocity as it is."""
    k: cython.Py_ssize_t = body.rate_at if rates else body.attitude_at
    if rates:
        return Vec3(e[k], e[k + 1], e[k + 2])
    return Vec3(
        2.0 * (z[k] * e[k + 1] - z[k + 1] * e[k] + z[k + 2] * e[k + 3] - z[k + 3] * e[k + 2]),
        2.0 * (z[k] * e[k + 2] - z[k + 2] * e[k] + z[k + 3] * e[k + 1] - z[k + 1] * e[k + 3]),
        2.0 * (z[k] * e[k + 3] - z[k + 3] * e[k] + z[k + 1] * e[k + 2] - z[k + 2] * e[k + 1]),
    )


def add_answer(scene: cython.pointer[Scene], z: cython.p_double, e: cython.p_double, rates: cython.bint) -> cython.void:
    """Add the answer found to an error of the coordinates, or of the rates."""
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
            turn: Quaternion = quaternion_rate(Quaternion(z[k], z[k + 1], z[k + 2], z[k + 3]), body.alpha)
            e[k] += turn.w
            e[k + 1] += turn.x
            e[k + 2] += turn.y
            e[k + 3] += turn.z
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            e[freedom.u_at if rates else freedom.q_at] += freedom.udot
