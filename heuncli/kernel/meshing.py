"""A load fixed in a carrier, between two bodies that it carries: the condition of teeth, threads and belts.

    f . (v_b - v_a) + m . (omega_b - omega_a) = 0        f, m and the place Q fixed in the body c

The bodies turn and slide in their joints on c only. So the sum of their coordinates, each times the work of the load
for a unit of it, is constant: that is the gap.

Below: the change along a direction of the state, line by line.
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
