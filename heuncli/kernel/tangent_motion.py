"""What the motion of a tree changes by along a direction of its state, at the accelerations that stand there.

    dR = turn x R;   r, v, omega, a, alpha: their derivatives along the direction, a letter each as in tree.py
The same recursion from the roots to the tips as `kinematics`, differentiated line by line; accelerations of bodies are
those that the accelerations of the freedoms make, which stay as they are. Planar scenes have the same equations.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_cross, add_scaled, cross, rotate, scaled, sub, transform
    from heuncli.kernel.scene import (
        SHIFT,
        TURN_IN_BODY,
        TURN_IN_PARENT,
        Body,
        BodyAtState,
        BodyTangent,
        Freedom,
        FreedomTangent,
        Scene,
        Variable,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import PointMotion


def move_along(scene: cython.pointer[Scene], y: cython.p_double, along: cython.p_double) -> cython.void:
    """What all bodies change by, and the inertia that they resist with."""
    i: cython.Py_ssize_t
    coordinates_along(scene, along)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[i])
        clear_body_tangent(d)
        d.moves = is_moved(scene, body, along)
        if not d.moves:
            continue
        hang_along(scene, body, d)
        if body.ball:
            ball_along(body, d, y, along)
        else:
            orient_along(scene, body, d)
        resist_along(body, cython.address(scene.at_state[i]), d)


def coordinates_along(scene: cython.pointer[Scene], along: cython.p_double) -> cython.void:
    """Coordinates and rates of the scalar freedoms, and the variables of the expressions; what is driven stays."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        d: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[i])
        d.q = 0.0 if freedom.driven else along[freedom.q_at]
        d.u = 0.0 if freedom.driven else along[freedom.u_at]
        d.load = 0.0
        d.s = zero
    scene.sloping = 0
    scene.slopes[0] = 0.0
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point:
            continue
        of: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[variable.freedom])
        scene.slopes[i] = of.u if variable.is_rate else of.q
        if scene.slopes[i] != 0.0:
            scene.sloping = 1


def is_moved(scene: cython.pointer[Scene], body: cython.pointer[Body], along: cython.p_double) -> cython.bint:
    """Whether anything of a body's motion changes: by its own freedoms, or with what it hangs on."""
    k: cython.Py_ssize_t
    if body.parent >= 0 and scene.tangents[body.parent].moves:
        return True
    if body.ball:
        for k in range(body.attitude_at, body.attitude_at + 4):
            if along[k] != 0.0:
                return True
        for k in range(body.rate_at, body.rate_at + 3):
            if along[k] != 0.0:
                return True
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedom_tangents[k].q != 0.0 or scene.freedom_tangents[k].u != 0.0:
            return True
    return False


def clear_body_tangent(d: cython.pointer[BodyTangent]) -> cython.void:
    """Nothing of the body changes."""
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


def hang_along(scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]) -> cython.void:
    """Of the joint point, its velocity and its acceleration, from the parent and the shifts of the joint.

    r = r_p + l,  v = v_p + omega_p x l + w,  a = a_p + alpha_p x l + omega_p x (omega_p x l + 2 w) + sum udot s
    """
    shift_along(scene, body, d)
    if body.parent < 0:
        return
    parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
    alpha: Vec3 = scene.at_state[body.parent].alpha
    on: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
    w: Vec3 = find_sliding_speed(scene, body)
    swept: Vec3 = cross(parent.omega, body.arm)
    change: Vec3 = add_cross(cross(on.omega, body.arm), parent.omega, d.arm)  # of omega_p x l
    d.r = add(on.r, d.arm)
    d.a = add(add(d.a, on.a), add_cross(cross(on.alpha, body.arm), alpha, d.arm))
    d.a = add_cross(d.a, on.omega, add_scaled(swept, 2.0, w))
    d.a = add_cross(d.a, parent.omega, add_scaled(change, 2.0, d.v))
    d.v = add(add(on.v, change), d.v)


def find_sliding_speed(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> Vec3:
    """w = sum u s over the shifts of the joint."""
    k: cython.Py_ssize_t
    w: Vec3 = Vec3(0.0, 0.0, 0.0)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == SHIFT:
            w = add_scaled(w, scene.freedoms[k].u, scene.freedoms[k].s)
    return w


def shift_along(
    scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Of the arm, of w = sum u s (in d.v) and of sum udot s (in d.a); the directions s turn with the parent."""
    k: cython.Py_ssize_t
    turn: Vec3 = Vec3(0.0, 0.0, 0.0)
    if body.parent >= 0:
        turn = scene.tangents[body.parent].turn
    d.arm = cross(turn, body.arm)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        own: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[k])
        if freedom.kind == SHIFT:
            own.s = add_scaled(cross(turn, freedom.s), own.q, freedom.curved)
            d.arm = add_scaled(d.arm, own.q, freedom.s)
            if freedom.pieces:
                d.a = add(d.a, bent_along(freedom, own, turn))
            d.v = add_scaled(add_scaled(d.v, own.u, freedom.s), freedom.u, own.s)
            d.a = add_scaled(d.a, own.udot, own.s)
    if body.parent < 0:
        d.r = d.arm


def bent_along(freedom: cython.pointer[Freedom], own: cython.pointer[FreedomTangent], turn: Vec3) -> Vec3:
    """Of u^2 r'', what a path adds to sum udot s; it turns with the parent, and changes with the coordinate."""
    bend: Vec3 = add_scaled(cross(turn, freedom.curved), own.q, freedom.twisted)
    return scaled(freedom.u, add_scaled(scaled(2.0 * own.u, freedom.curved), freedom.u, bend))


def orient_along(
    scene: cython.pointer[Scene], body: cython.pointer[Body], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Of attitude, angular velocity and acceleration of a body on single axes, in the order of its turns."""
    k: cython.Py_ssize_t
    d.spin = Vec3(0.0, 0.0, 0.0)
    if body.parent >= 0:
        on: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
        d.spin = scene.bodies[body.parent].omega
        d.turn = on.turn
        d.omega = on.omega
        d.alpha = on.alpha
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_PARENT:
            turn_along(cython.address(scene.freedoms[k]), cython.address(scene.freedom_tangents[k]), d)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_BODY:
            turn_along(cython.address(scene.freedoms[k]), cython.address(scene.freedom_tangents[k]), d)


def turn_along(
    freedom: cython.pointer[Freedom], own: cython.pointer[FreedomTangent], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Of a turn about an axis s: alpha += omega x s u + s udot, omega += s u, R <- R Rot; the axis turns before it."""
    own.s = cross(d.turn, freedom.s)
    spin: Vec3 = scaled(freedom.u, freedom.s)
    change: Vec3 = add_scaled(scaled(own.u, freedom.s), freedom.u, own.s)
    d.alpha = add_cross(add_cross(d.alpha, d.omega, spin), d.spin, change)
    d.alpha = add_scaled(d.alpha, own.udot, own.s)
    d.omega = add(d.omega, change)
    d.spin = add(d.spin, spin)
    d.turn = add_scaled(d.turn, own.q, freedom.s)


def ball_along(
    body: cython.pointer[Body], d: cython.pointer[BodyTangent], y: cython.p_double, along: cython.p_double
) -> cython.void:
    """Of a body's own attitude, turn = 2 dq q* / |q|^2, and of its angular velocity; its acceleration stands."""
    k: cython.Py_ssize_t = body.attitude_at
    g: cython.double = 2.0 / (y[k] * y[k] + y[k + 1] * y[k + 1] + y[k + 2] * y[k + 2] + y[k + 3] * y[k + 3])
    q: Vec3 = Vec3(y[k + 1], y[k + 2], y[k + 3])
    change: Vec3 = Vec3(along[k + 1], along[k + 2], along[k + 3])
    d.turn = scaled(g, add_cross(add_scaled(scaled(y[k], change), -along[k], q), q, change))
    k = body.rate_at
    d.omega = Vec3(along[k], along[k + 1], along[k + 2])


def resist_along(
    body: cython.pointer[Body], at: cython.pointer[BodyAtState], d: cython.pointer[BodyTangent]
) -> cython.void:
    """Of M = J alpha + omega x J omega + m c x a and f = m a + alpha x m c + omega x (omega x m c), world axes.

    J turns with the body: d(J x) = turn x J x + J (dx - turn x x).
    """
    spin: Vec3 = transform(at.inertia, at.alpha)
    momentum: Vec3 = transform(at.inertia, body.omega)
    mc: Vec3 = cross(d.turn, body.mc)
    spin = add(cross(d.turn, spin), transform(at.inertia, sub(d.alpha, cross(d.turn, at.alpha))))
    change: Vec3 = add(cross(d.turn, momentum), transform(at.inertia, sub(d.omega, cross(d.turn, body.omega))))
    d.M = add_cross(add_cross(spin, d.omega, momentum), body.omega, change)
    d.M = add_cross(add_cross(d.M, mc, at.a), body.mc, d.a)
    d.f = add_cross(add_cross(scaled(body.mass, d.a), d.alpha, body.mc), at.alpha, mc)
    d.f = add_cross(d.f, d.omega, cross(body.omega, body.mc))
    d.f = add_cross(d.f, body.omega, add_cross(cross(d.omega, body.mc), body.omega, mc))


def swung(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """What a vector that turns with a body, or stands on the ground (-1), changes by; a is in world axes."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return cross(scene.tangents[body].turn, a)


def turn_along_of(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """By what a body turns; the ground does not."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].turn


def omega_along(scene: cython.pointer[Scene], body: cython.int) -> Vec3:
    """What a body's angular velocity changes by; the ground's does not."""
    if body < 0:
        return Vec3(0.0, 0.0, 0.0)
    return scene.tangents[body].omega


def point_along(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> PointMotion:
    """What place and velocity of a body's point change by, given from its joint point in its axes."""
    if body < 0:
        return PointMotion(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    d: cython.pointer[BodyTangent] = cython.address(scene.tangents[body])
    arm: Vec3 = rotate(on.R, q)
    swing: Vec3 = cross(d.turn, arm)
    return PointMotion(add(d.r, swing), add_cross(add_cross(d.v, d.omega, arm), on.omega, swing))
