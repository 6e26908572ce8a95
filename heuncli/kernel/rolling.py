"""Wheels that roll on the plane of another body: where they touch it, and the conditions of the contact.

    t = k x n / |k x n|,  c = C - R t x k      lowest point of a thin rim about the axle k; of a ball c = C - R n
    e . (v_b - v_a) = 0 at c                   e = n: the rim stays on the plane, n . (c - P) = 0
                                               e = t, n x t: it slips neither along its track nor sideways

As c is the lowest point, n . (v_b - v_a) is the rate of the gap. The other two are the rate of no gap: they constrain a
speed, not a pose. c moves along the rim and along the plane, and so does not move with either body's point:

    gamma = e' . (v_b - v_a) + e . (cen_b - cen_a + omega_b x (c' - v_b) - omega_a x (c' - v_a))
"""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *


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
