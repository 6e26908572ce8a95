"""What a wheel's row changes by along a direction of the state: rolling.py, differentiated line by line.

    A = e' . (v_b - v_a) + e . (a_b - a_a + omega_b x (c' - v_b) - omega_a x (c' - v_a))       J Vdot + gamma
A vector goes with its rate, with what it changes by along the direction, and with what its rate changes by.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.carried_points import carried
    from heuncli.kernel.loads import omega_of
    from heuncli.kernel.rolling import along_moving, centre_moving, cross_moving, direction_moving
    from heuncli.kernel.scene import BALL_ROLLS, BALL_TOUCHES, ROLLS, ROLLS_ASIDE, Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_motion import omega_along, point_along, swung
    from heuncli.kernel.tangent_points import acceleration_at, carried_along
    from heuncli.kernel.values import (
        MotionTangent,
        PointMotion,
        RowTangent,
        VectorRate,
        VectorRateTangent,
        WheelTangent,
    )


def rolling_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Of one row: its place and unit load, its rate and its acceleration J Vdot + gamma."""
    at: WheelTangent = wheel_along(scene, row)
    c: VectorRate = at.c.own
    e: VectorRate = at.e.own
    ob: Vec3 = omega_of(scene, row.b)
    oa: Vec3 = omega_of(scene, row.a)
    vb: Vec3 = carried(scene, row.b, c.x).v
    va: Vec3 = carried(scene, row.a, c.x).v
    b: MotionTangent = carried_along(scene, row.b, c.x, at.c.change.x)
    a: MotionTangent = carried_along(scene, row.a, c.x, at.c.change.x)
    v: Vec3 = sub(vb, va)
    dv: Vec3 = sub(b.v, a.v)
    X: Vec3 = sub(acceleration_at(scene, row.b, c.x), acceleration_at(scene, row.a, c.x))
    X = sub(add(X, cross(ob, sub(c.rate, vb))), cross(oa, sub(c.rate, va)))
    dX: Vec3 = sub(b.a, a.a)
    dX = add(dX, slid_along(omega_along(scene, row.b), ob, sub(c.rate, vb), sub(at.c.change.rate, b.v)))
    dX = sub(dX, slid_along(omega_along(scene, row.a), oa, sub(c.rate, va), sub(at.c.change.rate, a.v)))
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    rate: cython.double = dot(at.e.change.x, v) + dot(e.x, dv)
    acceleration: cython.double = dot(at.e.change.rate, v) + dot(e.rate, dv)
    acceleration += dot(at.e.change.x, X) + dot(e.x, dX)
    return RowTangent(at.c.change.x, at.e.change.x, zero, rate, acceleration)


def slid_along(domega: Vec3, omega: Vec3, v: Vec3, dv: Vec3) -> Vec3:
    """What omega x v changes by."""
    return add(cross(domega, v), cross(omega, dv))


def wheel_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> WheelTangent:
    """What the contact and the direction that the row looks along change by."""
    n: VectorRateTangent = direction_along(scene, row.a, row.e)
    centre: PointMotion = point_along(scene, row.b, row.q)
    C: VectorRateTangent = VectorRateTangent(centre_moving(scene, row), VectorRate(centre.x, centre.v))
    if row.kind == BALL_TOUCHES or row.kind == BALL_ROLLS:
        return WheelTangent(sum_along(C, -row.radius, n), direction_along(scene, row.a, row.g))
    k: VectorRateTangent = direction_along(scene, row.b, row.g)
    t: VectorRateTangent = unit_along(cross_along(k, n))
    c: VectorRateTangent = sum_along(C, -row.radius, cross_along(t, k))
    if row.kind == ROLLS:
        return WheelTangent(c, t)
    if row.kind == ROLLS_ASIDE:
        return WheelTangent(c, cross_along(n, t))
    return WheelTangent(c, n)


def direction_along(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> VectorRateTangent:
    """Of a direction fixed in a body: e by turn x e, its rate omega x e by d omega x e + omega x de."""
    own: VectorRate = direction_moving(scene, body, a)
    de: Vec3 = swung(scene, body, own.x)
    rate: Vec3 = slid_along(omega_along(scene, body), omega_of(scene, body), own.x, de)
    return VectorRateTangent(own, VectorRate(de, rate))


def cross_along(a: VectorRateTangent, b: VectorRateTangent) -> VectorRateTangent:
    """Of a x b."""
    left: VectorRate = cross_moving(a.change, b.own)
    return VectorRateTangent(cross_moving(a.own, b.own), along_moving(left, 1.0, cross_moving(a.own, b.change)))


def sum_along(a: VectorRateTangent, s: cython.double, b: VectorRateTangent) -> VectorRateTangent:
    """Of a + s b."""
    return VectorRateTangent(along_moving(a.own, s, b.own), along_moving(a.change, s, b.change))


def unit_along(w: VectorRateTangent) -> VectorRateTangent:
    """Of u = w / |w|: |w| du = dw - (u . dw) u, and |w| u' + |w|' u = w' once more."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    size: cython.double = norm(w.own.x)
    if size == 0.0:
        return VectorRateTangent(VectorRate(zero, zero), VectorRate(zero, zero))
    s: cython.double = 1.0 / size
    u: Vec3 = scaled(s, w.own.x)
    grows: cython.double = dot(u, w.own.rate)
    rate: Vec3 = scaled(s, add_scaled(w.own.rate, -grows, u))
    longer: cython.double = dot(u, w.change.x)
    du: Vec3 = scaled(s, add_scaled(w.change.x, -longer, u))
    growing: cython.double = dot(du, w.own.rate) + dot(u, w.change.rate)
    drate: Vec3 = add_scaled(add_scaled(w.change.rate, -growing, u), -grows, du)
    return VectorRateTangent(VectorRate(u, rate), VectorRate(du, scaled(s, add_scaled(drate, -longer, rate))))
