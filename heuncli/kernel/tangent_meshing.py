"""The change of a load fixed in a carrier along a direction of the state: meshing.py, differentiated line by line."""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import body_omega
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, vector_tangent
from heuncli.kernel.tangent_points import alpha_tangent, body_alpha, point_acceleration, point_motion_tangent


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
