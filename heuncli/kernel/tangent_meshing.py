"""What a load fixed in a carrier changes by along a direction of the state: meshing.py, differentiated line by line."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add_cross, cross, dot, sub
    from heuncli.kernel.carried_points import carried
    from heuncli.kernel.loads import omega_of
    from heuncli.kernel.scene import Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_motion import omega_along, point_along, swung
    from heuncli.kernel.tangent_points import acceleration_at, alpha_along, alpha_at, carried_along
    from heuncli.kernel.values import MotionTangent, RowTangent


def mesh_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """f . (A_b - A_a) + m . (alpha_b - alpha_a) + (omega_c x f) . (v_b - v_a) + (omega_c x m) . (omega_b - omega_a).

    A: acceleration of a body's point that stays at Q.
    """
    dQ: Vec3 = point_along(scene, row.c, row.p).x
    df: Vec3 = swung(scene, row.c, row.f)
    dm: Vec3 = swung(scene, row.c, row.m)
    c: Vec3 = omega_of(scene, row.c)
    dc: Vec3 = omega_along(scene, row.c)
    b: MotionTangent = carried_along(scene, row.b, row.Q, dQ)
    a: MotionTangent = carried_along(scene, row.a, row.Q, dQ)
    v: Vec3 = sub(carried(scene, row.b, row.Q).v, carried(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    turn: Vec3 = sub(omega_of(scene, row.b), omega_of(scene, row.a))
    dturn: Vec3 = sub(omega_along(scene, row.b), omega_along(scene, row.a))
    A: Vec3 = sub(staying(scene, row, row.b), staying(scene, row, row.a))
    dA: Vec3 = sub(staying_along(scene, row, row.b, dQ), staying_along(scene, row, row.a, dQ))
    alpha: Vec3 = sub(alpha_at(scene, row.b), alpha_at(scene, row.a))
    dalpha: Vec3 = sub(alpha_along(scene, row.b), alpha_along(scene, row.a))
    rate: cython.double = dot(df, v) + dot(row.f, dv) + dot(dm, turn) + dot(row.m, dturn)
    found: cython.double = dot(df, A) + dot(row.f, dA) + dot(dm, alpha) + dot(row.m, dalpha)
    found += dot(add_cross(cross(dc, row.f), c, df), v) + dot(cross(c, row.f), dv)
    found += dot(add_cross(cross(dc, row.m), c, dm), turn) + dot(cross(c, row.m), dturn)
    return RowTangent(dQ, df, dm, rate, found)


def staying(scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int) -> Vec3:
    """Acceleration, less gravity, of a body's point that stays at Q: A + omega x (v_c - v)."""
    way: Vec3 = sub(carried(scene, row.c, row.Q).v, carried(scene, body, row.Q).v)
    return add_cross(acceleration_at(scene, body, row.Q), omega_of(scene, body), way)


def staying_along(scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, dQ: Vec3) -> Vec3:
    """What that changes by."""
    way: Vec3 = sub(carried(scene, row.c, row.Q).v, carried(scene, body, row.Q).v)
    own: MotionTangent = carried_along(scene, body, row.Q, dQ)
    dway: Vec3 = sub(carried_along(scene, row.c, row.Q, dQ).v, own.v)
    return add_cross(add_cross(own.a, omega_along(scene, body), way), omega_of(scene, body), dway)
