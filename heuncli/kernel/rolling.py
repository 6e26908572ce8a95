"""Wheels that roll on the plane of another body, and what meshes: teeth, threads and belts.

A wheel touches the plane where its rim is lowest:

    t = k x n / |k x n|,  c = C - R t x k      lowest point of a thin rim about the axle k; of a ball c = C - R n
    e . (v_b - v_a) = 0 at c                   e = n: the rim stays on the plane, n . (c - P) = 0
                                               e = t, n x t: it slips neither along its track nor sideways

As c is the lowest point, n . (v_b - v_a) is the rate of the gap. The other two are the rate of no gap: they constrain a
speed, not a pose. c moves along the rim and along the plane, and so does not move with either body's point:

    gamma = e' . (v_b - v_a) + e . (cen_b - cen_a + omega_b x (c' - v_b) - omega_a x (c' - v_a))

Below: the change along a direction of the state, line by line:

    A = e' . (v_b - v_a) + e . (a_b - a_a + omega_b x (c' - v_b) - omega_a x (c' - v_a))       J Vdot + gamma

A vector comes with its rate, with its change along the direction, and with the change of its rate.

Teeth, threads and belts: a load fixed in a carrier, between two bodies that it carries.

    f . (v_b - v_a) + m . (omega_b - omega_a) = 0        f, m and the place Q fixed in the body c

The bodies turn and slide in their joints on c only. So the sum of their coordinates, each times the work of the load
for a unit of it, is constant: that is the gap. Below, too: the change along a direction of the state.
"""

from __future__ import annotations

from heuncli.kernel.carried_points import (
    alpha_tangent,
    body_alpha,
    body_omega,
    point_acceleration,
    point_motion,
    point_motion_tangent,
    world_place,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, vector_tangent


def measure_rolling(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma of a wheel's row: e normal of the plane in a, g axle in b (for a ball e
    itself).
    """
    contact: WheelContact = find_wheel_contact(scene, row)
    row.Q = contact.c.x
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    w: Vec3 = sub(b.centripetal, a.centripetal)
    w = add(w, cross(b.omega, sub(contact.c.rate, b.v)))
    w = sub(w, cross(a.omega, sub(contact.c.rate, a.v)))
    row.f = contact.e.x
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = 0.0 if constrains_speed(row) else dot(contact.e.x, sub(row.Q, world_place(scene, row.a, row.p)))
    row.rate = dot(contact.e.x, v)
    row.gamma = dot(contact.e.rate, v) + dot(contact.e.x, w)


def constrains_speed(row: cython.pointer[Closure]) -> cython.bint:
    """Return whether a row constrains a speed and no pose: it has no gap."""
    return row.kind == ROLLS or row.kind == ROLLS_ASIDE or row.kind == BALL_ROLLS


def find_wheel_contact(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> WheelContact:
    """Find where the wheel touches the plane, and the direction of its row."""
    n: VectorRate = direction_rate(scene, row.a, row.e)
    C: VectorRate = centre_rate(scene, row)
    if row.kind == BALL_TOUCHES or row.kind == BALL_ROLLS:
        return WheelContact(sum_rate(C, -row.radius, n), direction_rate(scene, row.a, row.g))
    k: VectorRate = direction_rate(scene, row.b, row.g)
    t: VectorRate = unit_rate(cross_rate(k, n))
    c: VectorRate = sum_rate(C, -row.radius, cross_rate(t, k))
    if row.kind == ROLLS:
        return WheelContact(c, t)
    if row.kind == ROLLS_ASIDE:
        return WheelContact(c, cross_rate(n, t))
    return WheelContact(c, n)


def direction_rate(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> VectorRate:
    """Return a direction fixed in a body, in world axes, and its rate."""
    e: Vec3 = world_direction(scene, body, a)
    if body < 0:
        return VectorRate(e, Vec3(0.0, 0.0, 0.0))
    return VectorRate(e, cross(scene.bodies[body].omega, e))


def centre_rate(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> VectorRate:
    """Return the wheel's centre and its velocity."""
    C: Vec3 = world_place(scene, row.b, row.q)
    return VectorRate(C, point_motion(scene, row.b, C).v)


def cross_rate(a: VectorRate, b: VectorRate) -> VectorRate:
    """a x b, with its rate."""
    return VectorRate(cross(a.x, b.x), add(cross(a.rate, b.x), cross(a.x, b.rate)))


def sum_rate(a: VectorRate, s: cython.double, b: VectorRate) -> VectorRate:
    """a + s b, with its rate."""
    return VectorRate(add_scaled(a.x, s, b.x), add_scaled(a.rate, s, b.rate))


def unit_rate(w: VectorRate) -> VectorRate:
    """w / |w|, with its rate; zero if w is zero, as for a rim that lies flat on its plane."""
    size: cython.double = norm(w.x)
    if size == 0.0:
        return VectorRate(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    u: Vec3 = scale_vector(1.0 / size, w.x)
    return VectorRate(u, scale_vector(1.0 / size, add_scaled(w.rate, -dot(u, w.rate), u)))


# Along a direction of the state


def rolling_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Return the change of one row: its place and unit load, its rate and its acceleration J Vdot + gamma."""
    contact: WheelTangent = wheel_contact_tangent(scene, row)
    c: VectorRate = contact.c.own
    e: VectorRate = contact.e.own
    ob: Vec3 = body_omega(scene, row.b)
    oa: Vec3 = body_omega(scene, row.a)
    vb: Vec3 = point_motion(scene, row.b, c.x).v
    va: Vec3 = point_motion(scene, row.a, c.x).v
    b: MotionTangent = point_motion_tangent(scene, row.b, c.x, contact.c.change.x)
    a: MotionTangent = point_motion_tangent(scene, row.a, c.x, contact.c.change.x)
    v: Vec3 = sub(vb, va)
    dv: Vec3 = sub(b.v, a.v)
    X: Vec3 = sub(point_acceleration(scene, row.b, c.x), point_acceleration(scene, row.a, c.x))
    X = sub(add(X, cross(ob, sub(c.rate, vb))), cross(oa, sub(c.rate, va)))
    dX: Vec3 = sub(b.a, a.a)
    dX = add(
        dX, cross_product_tangent(omega_tangent(scene, row.b), ob, sub(c.rate, vb), sub(contact.c.change.rate, b.v))
    )
    dX = sub(
        dX, cross_product_tangent(omega_tangent(scene, row.a), oa, sub(c.rate, va), sub(contact.c.change.rate, a.v))
    )
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    rate: cython.double = dot(contact.e.change.x, v) + dot(e.x, dv)
    acceleration: cython.double = dot(contact.e.change.rate, v) + dot(e.rate, dv)
    acceleration += dot(contact.e.change.x, X) + dot(e.x, dX)
    return RowTangent(contact.c.change.x, contact.e.change.x, zero, rate, acceleration)


def cross_product_tangent(domega: Vec3, omega: Vec3, v: Vec3, dv: Vec3) -> Vec3:
    """Return the change of omega x v."""
    return add(cross(domega, v), cross(omega, dv))


def wheel_contact_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> WheelTangent:
    """Return the contact and the direction of the row, with their changes."""
    n: VectorRateTangent = direction_rate_tangent(scene, row.a, row.e)
    centre: PointMotion = point_tangent(scene, row.b, row.q)
    C: VectorRateTangent = VectorRateTangent(centre_rate(scene, row), VectorRate(centre.x, centre.v))
    if row.kind == BALL_TOUCHES or row.kind == BALL_ROLLS:
        return WheelTangent(sum_rate_tangent(C, -row.radius, n), direction_rate_tangent(scene, row.a, row.g))
    k: VectorRateTangent = direction_rate_tangent(scene, row.b, row.g)
    t: VectorRateTangent = unit_rate_tangent(cross_rate_tangent(k, n))
    c: VectorRateTangent = sum_rate_tangent(C, -row.radius, cross_rate_tangent(t, k))
    if row.kind == ROLLS:
        return WheelTangent(c, t)
    if row.kind == ROLLS_ASIDE:
        return WheelTangent(c, cross_rate_tangent(n, t))
    return WheelTangent(c, n)


def direction_rate_tangent(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> VectorRateTangent:
    """Return a direction fixed in a body with its change: e by turn x e, its rate omega x e by d omega x e + omega x
    de.
    """
    base_direction: VectorRate = direction_rate(scene, body, a)
    de: Vec3 = vector_tangent(scene, body, base_direction.x)
    rate: Vec3 = cross_product_tangent(omega_tangent(scene, body), body_omega(scene, body), base_direction.x, de)
    return VectorRateTangent(base_direction, VectorRate(de, rate))


def cross_rate_tangent(a: VectorRateTangent, b: VectorRateTangent) -> VectorRateTangent:
    """a x b, with its change."""
    left: VectorRate = cross_rate(a.change, b.own)
    return VectorRateTangent(cross_rate(a.own, b.own), sum_rate(left, 1.0, cross_rate(a.own, b.change)))


def sum_rate_tangent(a: VectorRateTangent, s: cython.double, b: VectorRateTangent) -> VectorRateTangent:
    """a + s b, with its change."""
    return VectorRateTangent(sum_rate(a.own, s, b.own), sum_rate(a.change, s, b.change))


def unit_rate_tangent(w: VectorRateTangent) -> VectorRateTangent:
    """u = w / |w|, with its change: |w| du = dw - (u . dw) u, and the same from |w| u' + |w|' u = w'."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    size: cython.double = norm(w.own.x)
    if size == 0.0:
        return VectorRateTangent(VectorRate(zero, zero), VectorRate(zero, zero))
    s: cython.double = 1.0 / size
    u: Vec3 = scale_vector(s, w.own.x)
    grows: cython.double = dot(u, w.own.rate)
    rate: Vec3 = scale_vector(s, add_scaled(w.own.rate, -grows, u))
    longer: cython.double = dot(u, w.change.x)
    du: Vec3 = scale_vector(s, add_scaled(w.change.x, -longer, u))
    growing: cython.double = dot(du, w.own.rate) + dot(u, w.change.rate)
    drate: Vec3 = add_scaled(add_scaled(w.change.rate, -growing, u), -grows, du)
    return VectorRateTangent(VectorRate(u, rate), VectorRate(du, scale_vector(s, add_scaled(drate, -longer, rate))))


def measure_mesh(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """gamma = f . (w_b - w_a) + (omega_c x f) . (v_b - v_a) + (omega_c x m) . (omega_b - omega_a).

    w = omega x (omega x arm) + omega x (v_c - v): the velocity-dependent acceleration of a body's point that stays at
    Q.
    """
    row.Q = world_place(scene, row.c, row.p)
    c: PointKinematics = point_motion(scene, row.c, row.Q)
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    turn: Vec3 = sub(b.omega, a.omega)
    row.f = world_direction(scene, row.c, row.e)
    row.m = world_direction(scene, row.c, row.g)
    row.gap = row.ratio * scene.freedoms[row.freedom].q + row.ratio_b * scene.freedoms[row.freedom_b].q - row.length
    row.rate = dot(row.f, v) + dot(row.m, turn)
    w: Vec3 = sub(b.centripetal, a.centripetal)
    w = add_scaled(w, 1.0, cross(b.omega, sub(c.v, b.v)))
    w = add_scaled(w, -1.0, cross(a.omega, sub(c.v, a.v)))
    row.gamma = dot(row.f, w) + dot(cross(c.omega, row.f), v) + dot(cross(c.omega, row.m), turn)


# Along a direction of the state


def mesh_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """f . (A_b - A_a) + m . (alpha_b - alpha_a) + (omega_c x f) . (v_b - v_a) + (omega_c x m) . (omega_b - omega_a).

    A: acceleration of a body's point that stays at Q.
    """
    dQ: Vec3 = point_tangent(scene, row.c, row.p).x
    df: Vec3 = vector_tangent(scene, row.c, row.f)
    dm: Vec3 = vector_tangent(scene, row.c, row.m)
    c: Vec3 = body_omega(scene, row.c)
    dc: Vec3 = omega_tangent(scene, row.c)
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, dQ)
    a: MotionTangent = point_motion_tangent(scene, row.a, row.Q, dQ)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    turn: Vec3 = sub(body_omega(scene, row.b), body_omega(scene, row.a))
    dturn: Vec3 = sub(omega_tangent(scene, row.b), omega_tangent(scene, row.a))
    A: Vec3 = sub(fixed_place_acceleration(scene, row, row.b), fixed_place_acceleration(scene, row, row.a))
    dA: Vec3 = sub(
        fixed_place_acceleration_tangent(scene, row, row.b, dQ), fixed_place_acceleration_tangent(scene, row, row.a, dQ)
    )
    alpha: Vec3 = sub(body_alpha(scene, row.b), body_alpha(scene, row.a))
    dalpha: Vec3 = sub(alpha_tangent(scene, row.b), alpha_tangent(scene, row.a))
    rate: cython.double = dot(df, v) + dot(row.f, dv) + dot(dm, turn) + dot(row.m, dturn)
    acceleration: cython.double = dot(df, A) + dot(row.f, dA) + dot(dm, alpha) + dot(row.m, dalpha)
    acceleration += dot(add_cross(cross(dc, row.f), c, df), v) + dot(cross(c, row.f), dv)
    acceleration += dot(add_cross(cross(dc, row.m), c, dm), turn) + dot(cross(c, row.m), dturn)
    return RowTangent(dQ, df, dm, rate, acceleration)


def fixed_place_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int) -> Vec3:
    """Return the acceleration, minus gravity, of a body's point that stays at Q: A + omega x (v_c - v)."""
    slip: Vec3 = sub(point_motion(scene, row.c, row.Q).v, point_motion(scene, body, row.Q).v)
    return add_cross(point_acceleration(scene, body, row.Q), body_omega(scene, body), slip)


def fixed_place_acceleration_tangent(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, dQ: Vec3
) -> Vec3:
    """Return the change of `fixed_place_acceleration`."""
    slip: Vec3 = sub(point_motion(scene, row.c, row.Q).v, point_motion(scene, body, row.Q).v)
    point_change: MotionTangent = point_motion_tangent(scene, body, row.Q, dQ)
    slip_change: Vec3 = sub(point_motion_tangent(scene, row.c, row.Q, dQ).v, point_change.v)
    return add_cross(add_cross(point_change.a, omega_tangent(scene, body), slip), body_omega(scene, body), slip_change)
