"""The change of a tree's motion along a direction of its state, at the accelerations of the state.

    dR = turn x R;   r, v, omega, a, alpha: their derivatives along the direction, a letter each as in tree.py

The same recursion from the roots to the tips as `update_kinematics`, differentiated line by line; the accelerations of
bodies are those due to the accelerations of the freedoms, which stay as they are. Planar scenes have the same
equations.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *


def differentiate_motion(scene: cython.pointer[Scene], y: cython.p_double, direction: cython.p_double) -> cython.void:
    """Find the changes of all bodies' motions, and of their inertia loads."""
    i: cython.Py_ssize_t
    set_coordinate_tangents(scene, direction)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[i])
        clear_body_tangent(d)
        d.moves = has_motion_change(scene, body, direction)
        if not d.moves:
            continue
        set_joint_point_tangent(scene, body, d)
        if body.ball:
            set_ball_tangent(body, d, y, direction)
        else:
            set_orientation_tangent(scene, body, d)
        set_inertia_load_tangent(body, cython.address(scene.state_values[i]), d)


def set_coordinate_tangents(scene: cython.pointer[Scene], direction: cython.p_double) -> cython.void:
    """Set the changes of coordinates and rates of the scalar freedoms, and of the expressions' variables; driven ones
    do not change.
    """
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        d: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[i])
        d.q = 0.0 if freedom.driven else direction[freedom.q_at]
        d.u = 0.0 if freedom.driven else direction[freedom.u_at]
        d.load = 0.0
        d.s = zero
    scene.has_slopes = 0
    scene.slopes[0] = 0.0
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point:
            continue
        freedom_tangent: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[variable.freedom])
        scene.slopes[i] = freedom_tangent.u if variable.is_rate else freedom_tangent.q
        if scene.slopes[i] != 0.0:
            scene.has_slopes = 1


def has_motion_change(
    scene: cython.pointer[Scene], body: cython.pointer[Body], direction: cython.p_double
) -> cython.bint:
    """Return whether anything of a body's motion changes: by its own freedoms, or with its parent."""
    k: cython.Py_ssize_t
    if body.parent >= 0 and scene.tangents[body.parent].moves:
        return True
    if body.ball:
        for k in range(body.attitude_at, body.attitude_at + 4):
            if direction[k] != 0.0:
                return True
        for k in range(body.rate_at, body.rate_at + 3):
            if direction[k] != 0.0:
                return True
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedom_tangents[k].q != 0.0 or scene.freedom_tangents[k].u != 0.0:
            return True
    return False


def clear_body_tangent(d: cython.pointer[BodyTangent]) -> cython.void:
    """Set all changes of the body to zero."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    d.turn = zero
    d.arm = zero
    d.r = zero
    d.omega = zero
    d.v = zero
    d.alpha = zero
    d.a = zero
    d.M = zero
    d.f = zero


def set_joint_point_tangent(
    scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Set the changes of the joint point, its velocity and its acceleration, from the parent and the shifts of the
    joint.

    r = r_p + l,  v = v_p + omega_p x l + w,  a = a_p + alpha_p x l + omega_p x (omega_p x l + 2 w) + sum udot s
    """
    set_shift_tangent(scene, body, d)
    if body.parent < 0:
        return
    parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
    alpha: Vec3 = scene.state_values[body.parent].alpha
    parent_tangent: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
    w: Vec3 = find_sliding_velocity(scene, body)
    swept: Vec3 = cross(parent.omega, body.arm)
    change: Vec3 = add_cross(cross(parent_tangent.omega, body.arm), parent.omega, d.arm)  # of omega_p x l
    d.r = add(parent_tangent.r, d.arm)
    d.a = add(add(d.a, parent_tangent.a), add_cross(cross(parent_tangent.alpha, body.arm), alpha, d.arm))
    d.a = add_cross(d.a, parent_tangent.omega, add_scaled(swept, 2.0, w))
    d.a = add_cross(d.a, parent.omega, add_scaled(change, 2.0, d.v))
    d.v = add(add(parent_tangent.v, change), d.v)


def find_sliding_velocity(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> Vec3:
    """w = sum u s over the shifts of the joint."""
    k: cython.Py_ssize_t
    w: Vec3 = Vec3(0.0, 0.0, 0.0)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == SHIFT:
            w = add_scaled(w, scene.freedoms[k].u, scene.freedoms[k].s)
    return w


def set_shift_tangent(
    scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Set the changes of the arm, of w = sum u s (in d.v) and of sum udot s (in d.a); the directions s turn with the
    parent.
    """
    k: cython.Py_ssize_t
    turn: Vec3 = Vec3(0.0, 0.0, 0.0)
    if body.parent >= 0:
        turn = scene.tangents[body.parent].turn
    d.arm = cross(turn, body.arm)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        freedom_tangent: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[k])
        if freedom.kind == SHIFT:
            freedom_tangent.s = add_scaled(cross(turn, freedom.s), freedom_tangent.q, freedom.curved)
            d.arm = add_scaled(d.arm, freedom_tangent.q, freedom.s)
            if freedom.pieces:
                d.a = add(d.a, path_acceleration_tangent(freedom, freedom_tangent, turn))
            d.v = add_scaled(add_scaled(d.v, freedom_tangent.u, freedom.s), freedom.u, freedom_tangent.s)
            d.a = add_scaled(d.a, freedom_tangent.udot, freedom_tangent.s)
    if body.parent < 0:
        d.r = d.arm


def path_acceleration_tangent(
    freedom: cython.pointer[Freedom], freedom_tangent: cython.pointer[FreedomTangent], turn: Vec3
) -> Vec3:
    """Return the change of u^2 r'', which a path adds to sum udot s; it turns with the parent, and changes with the
    coordinate.
    """
    bend: Vec3 = add_scaled(cross(turn, freedom.curved), freedom_tangent.q, freedom.twisted)
    return scale_vector(freedom.u, add_scaled(scale_vector(2.0 * freedom_tangent.u, freedom.curved), freedom.u, bend))


def set_orientation_tangent(
    scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Set the changes of attitude, angular velocity and acceleration of a body on single axes, in the order of its
    turns.
    """
    k: cython.Py_ssize_t
    d.spin = Vec3(0.0, 0.0, 0.0)
    if body.parent >= 0:
        parent_tangent: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
        d.spin = scene.bodies[body.parent].omega
        d.turn = parent_tangent.turn
        d.omega = parent_tangent.omega
        d.alpha = parent_tangent.alpha
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_PARENT:
            add_turn_tangent(cython.address(scene.freedoms[k]), cython.address(scene.freedom_tangents[k]), d)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_BODY:
            add_turn_tangent(cython.address(scene.freedoms[k]), cython.address(scene.freedom_tangents[k]), d)


def add_turn_tangent(
    freedom: cython.pointer[Freedom], freedom_tangent: cython.pointer[FreedomTangent], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Add a turn about an axis s: alpha += omega x s u + s udot, omega += s u, R <- R Rot; the turns before it turn the
    axis.
    """
    freedom_tangent.s = cross(d.turn, freedom.s)
    spin: Vec3 = scale_vector(freedom.u, freedom.s)
    change: Vec3 = add_scaled(scale_vector(freedom_tangent.u, freedom.s), freedom.u, freedom_tangent.s)
    d.alpha = add_cross(add_cross(d.alpha, d.omega, spin), d.spin, change)
    d.alpha = add_scaled(d.alpha, freedom_tangent.udot, freedom_tangent.s)
    d.omega = add(d.omega, change)
    d.spin = add(d.spin, spin)
    d.turn = add_scaled(d.turn, freedom_tangent.q, freedom.s)


def set_ball_tangent(
    body: cython.pointer[Body], d: cython.pointer[BodyTangent], y: cython.p_double, direction: cython.p_double
) -> cython.void:
    """Set the changes of a body's own attitude, turn = 2 dq q* / |q|^2, and angular velocity; its acceleration does not
    change.
    """
    k: cython.Py_ssize_t = body.attitude_at
    g: cython.double = 2.0 / (y[k] * y[k] + y[k + 1] * y[k + 1] + y[k + 2] * y[k + 2] + y[k + 3] * y[k + 3])
    q: Vec3 = Vec3(y[k + 1], y[k + 2], y[k + 3])
    change: Vec3 = Vec3(direction[k + 1], direction[k + 2], direction[k + 3])
    d.turn = scale_vector(g, add_cross(add_scaled(scale_vector(y[k], change), -direction[k], q), q, change))
    k = body.rate_at
    d.omega = read_vector(direction, k)


def set_inertia_load_tangent(
    body: cython.pointer[Body], base: cython.pointer[BodyAtState], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Set the changes of M = J alpha + omega x J omega + m c x a and f = m a + alpha x m c + omega x (omega x m c),
    world axes.

    J turns with the body: d(J x) = turn x J x + J (dx - turn x x).
    """
    spin: Vec3 = transform(base.inertia, base.alpha)
    momentum: Vec3 = transform(base.inertia, body.omega)
    mc: Vec3 = cross(d.turn, body.mc)
    spin = add(cross(d.turn, spin), transform(base.inertia, sub(d.alpha, cross(d.turn, base.alpha))))
    change: Vec3 = add(cross(d.turn, momentum), transform(base.inertia, sub(d.omega, cross(d.turn, body.omega))))
    d.M = add_cross(add_cross(spin, d.omega, momentum), body.omega, change)
    d.M = add_cross(add_cross(d.M, mc, base.a), body.mc, d.a)
    d.f = add_cross(add_cross(scale_vector(body.mass, d.a), d.alpha, body.mc), base.alpha, mc)
    d.f = add_cross(d.f, d.omega, cross(body.omega, body.mc))
    d.f = add_cross(d.f, body.omega, add_cross(cross(d.omega, body.mc), body.omega, mc))


def vector_tangent(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """Return the change of a vector that turns with a body, or is fixed in the ground (-1); a is in world axes."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return cross(scene.tangents[body].turn, a)


def rotation_tangent(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the small rotation of a body; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].turn


def omega_tangent(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """Return the change of a body's angular velocity; zero for the ground."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].omega


def point_tangent(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> PointMotion:
    """Return the changes of place and velocity of a body's point, given from its joint point in its axes."""
    if body < 0:
        return PointMotion(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    d: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
    arm: Vec3 = rotate(carrier.R, q)
    swing: Vec3 = cross(d.turn, arm)
    return PointMotion(add(d.r, swing), add_cross(add_cross(d.v, d.omega, arm), carrier.omega, swing))
