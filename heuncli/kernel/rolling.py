"""Wheels that roll on the plane of another body: where they touch it, and what the contact asks of the motion.

    t = k x n / |k x n|,  c = C - R t x k      lowest point of a thin rim about the axle k; of a ball c = C - R n
    e . (v_b - v_a) = 0 at c                   e = n: the rim stays on the plane, n . (c - P) = 0
                                               e = t, n x t: it does not slip along its track, or aside
That c is the lowest point makes n . (v_b - v_a) the rate of the gap. No gap has the other two as its rate: what they
hold is a speed, not a pose. c runs along the rim and along the plane, and so does not move as either body's point:
    gamma = e' . (v_b - v_a) + e . (cen_b - cen_a + omega_b x (c' - v_b) - omega_a x (c' - v_a))
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.scene import BALL_ROLLS, BALL_TOUCHES, ROLLS, ROLLS_ASIDE, Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import Carried, VectorRate, WheelContact


def rolling_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Unit load, gap, rate and gamma of a wheel's row: e normal of the plane in a, g axle in b (of a ball e itself)."""
    at: WheelContact = wheel_contact(scene, row)
    row.Q = at.c.x
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    v: Vec3 = sub(b.v, a.v)
    w: Vec3 = sub(b.centripetal, a.centripetal)
    w = add(w, cross(b.omega, sub(at.c.rate, b.v)))
    w = sub(w, cross(a.omega, sub(at.c.rate, a.v)))
    row.f = at.e.x
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = 0.0 if is_of_speed(row) else dot(at.e.x, sub(row.Q, place_of(scene, row.a, row.p)))
    row.rate = dot(at.e.x, v)
    row.gamma = dot(at.e.rate, v) + dot(at.e.x, w)


def is_of_speed(row: cython.pointer[Closure]) -> cython.bint:
    """Whether a row holds a speed and no pose: it has no gap."""
    return row.kind == ROLLS or row.kind == ROLLS_ASIDE or row.kind == BALL_ROLLS


def wheel_contact(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> WheelContact:
    """Where the wheel touches the plane, and the direction that its row looks along."""
    n: VectorRate = direction_moving(scene, row.a, row.e)
    C: VectorRate = centre_moving(scene, row)
    if row.kind == BALL_TOUCHES or row.kind == BALL_ROLLS:
        return WheelContact(along_moving(C, -row.radius, n), direction_moving(scene, row.a, row.g))
    k: VectorRate = direction_moving(scene, row.b, row.g)
    t: VectorRate = unit_moving(cross_moving(k, n))
    c: VectorRate = along_moving(C, -row.radius, cross_moving(t, k))
    if row.kind == ROLLS:
        return WheelContact(c, t)
    if row.kind == ROLLS_ASIDE:
        return WheelContact(c, cross_moving(n, t))
    return WheelContact(c, n)


def direction_moving(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> VectorRate:
    """A direction fixed in a body, world axes, and its rate."""
    e: Vec3 = direction_of(scene, body, a)
    if body < 0:
        return VectorRate(e, Vec3(0.0, 0.0, 0.0))
    return VectorRate(e, cross(scene.bodies[body].omega, e))


def centre_moving(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> VectorRate:
    """The wheel's centre and its velocity."""
    C: Vec3 = place_of(scene, row.b, row.q)
    return VectorRate(C, carried(scene, row.b, C).v)


def cross_moving(a: VectorRate, b: VectorRate) -> VectorRate:
    """a x b."""
    return VectorRate(cross(a.x, b.x), add(cross(a.rate, b.x), cross(a.x, b.rate)))


def along_moving(a: VectorRate, s: cython.double, b: VectorRate) -> VectorRate:
    """a + s b."""
    return VectorRate(add_scaled(a.x, s, b.x), add_scaled(a.rate, s, b.rate))


def unit_moving(w: VectorRate) -> VectorRate:
    """w / |w|; no direction where a rim lies flat on its plane."""
    size: cython.double = norm(w.x)
    if size == 0.0:
        return VectorRate(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))
    u: Vec3 = scaled(1.0 / size, w.x)
    return VectorRate(u, scaled(1.0 / size, add_scaled(w.rate, -dot(u, w.rate), u)))
