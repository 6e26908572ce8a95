"""The change of a condition between two bodies along a direction of the state: conditions.py, differentiated line by
line.

Each kind's rate and acceleration are written from the motion of the two bodies' points at Q.
"""

from __future__ import annotations

from heuncli.kernel.cams import cam_tangent
from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.loads import body_omega
from heuncli.kernel.tangent_meshing import mesh_tangent
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, vector_tangent
from heuncli.kernel.tangent_points import alpha_tangent, body_alpha, point_acceleration, point_motion_tangent
from heuncli.kernel.tangent_rolling import rolling_tangent
from heuncli.kernel.tangent_sheaves import strand_tangent
from heuncli.kernel.tangent_tracks import track_row_tangent


def condition_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Return the change of a condition between two bodies."""
    if row.kind == MESH:
        return mesh_tangent(scene, row)
    if row.kind == CAM:
        return cam_tangent(scene, row)
    if row.kind >= TOUCHES:
        return rolling_tangent(scene, row)
    Q: Vec3 = point_tangent(scene, row.b, row.q).x
    if row.kind == GUIDE:
        return guide_tangent(scene, row, Q)
    elif row.kind == DOT:
        return dot_tangent(scene, row, Q)
    elif row.kind == TURN:
        return turn_tangent(scene, row, Q)
    elif row.kind == ROD:
        return rod_tangent(scene, row, Q)
    elif row.kind == TRACK or row.kind == ALONG:
        return track_row_tangent(scene, row, Q)
    elif row.kind == STRAND:
        return strand_tangent(scene, row)
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, zero, zero, 0.0, 0.0)  # what lies on a sheave


def guide_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """e . (A_b - A_a - 2 omega_a x (v_b - v_a)), e fixed in a."""
    e: Vec3 = vector_tangent(scene, row.a, row.f)
    omega: Vec3 = body_omega(scene, row.a)
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, Q)
    a: MotionTangent = point_motion_tangent(scene, row.a, row.Q, Q)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, row.Q).v)
    dv: Vec3 = sub(b.v, a.v)
    A: Vec3 = sub(point_acceleration(scene, row.b, row.Q), point_acceleration(scene, row.a, row.Q))
    A = add_scaled(A, -2.0, cross(omega, v))
    dA: Vec3 = add_scaled(sub(b.a, a.a), -2.0, add_cross(cross(omega_tangent(scene, row.a), v), omega, dv))
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, e, zero, dot(e, v) + dot(row.f, dv), dot(e, A) + dot(row.f, dA))


def rod_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """n . (A_b - A_a) + (v^2 - (n . v)^2) / l along the unit vector n, of the two points."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    P: Vec3 = world_place(scene, row.a, row.p)
    dP: Vec3 = point_tangent(scene, row.a, row.p).x
    b: MotionTangent = point_motion_tangent(scene, row.b, row.Q, Q)
    a: MotionTangent = point_motion_tangent(scene, row.a, P, dP)
    v: Vec3 = sub(point_motion(scene, row.b, row.Q).v, point_motion(scene, row.a, P).v)
    dv: Vec3 = sub(b.v, a.v)
    A: Vec3 = sub(point_acceleration(scene, row.b, row.Q), point_acceleration(scene, row.a, P))
    change: Vec3 = sub(Q, dP)
    span: cython.double = norm(sub(row.Q, P))
    w: cython.double = 1.0 / span if span > 0.0 else 0.0
    length: cython.double = dot(row.f, change)
    n: Vec3 = scale_vector(w, add_scaled(change, -length, row.f))
    along: cython.double = dot(row.f, v)
    rate: cython.double = dot(n, v) + dot(row.f, dv)
    across: cython.double = w * (dot(v, v) - along * along)
    bent: cython.double = 2.0 * w * (dot(v, dv) - along * rate) - w * across * length
    return RowTangent(Q, n, zero, rate, dot(n, A) + dot(row.f, sub(b.a, a.a)) + bent)


def dot_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """m . (alpha_b - alpha_a) + (omega_a - omega_b) . ((omega_a x e) x g + e x (omega_b x g)), m = g x e."""
    e: Vec3 = world_direction(scene, row.a, row.e)
    g: Vec3 = world_direction(scene, row.b, row.g)
    de: Vec3 = vector_tangent(scene, row.a, e)
    dg: Vec3 = vector_tangent(scene, row.b, g)
    a: Vec3 = body_omega(scene, row.a)
    b: Vec3 = body_omega(scene, row.b)
    da: Vec3 = omega_tangent(scene, row.a)
    db: Vec3 = omega_tangent(scene, row.b)
    m: Vec3 = add_cross(cross(dg, e), g, de)
    swept_e: Vec3 = cross(a, e)
    swept_g: Vec3 = cross(b, g)
    w: Vec3 = add_cross(cross(swept_e, g), e, swept_g)
    dw: Vec3 = add_cross(cross(add_cross(cross(da, e), a, de), g), swept_e, dg)
    dw = add_cross(add_cross(dw, de, swept_g), e, add_cross(cross(db, g), b, dg))
    turn: Vec3 = sub(b, a)
    change: Vec3 = sub(db, da)
    A: Vec3 = sub(body_alpha(scene, row.b), body_alpha(scene, row.a))
    dA: Vec3 = sub(alpha_tangent(scene, row.b), alpha_tangent(scene, row.a))
    acceleration: cython.double = dot(m, A) + dot(row.m, dA) - dot(change, w) - dot(turn, dw)
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, zero, m, dot(m, turn) + dot(row.m, change), acceleration)


def turn_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure], Q: Vec3) -> RowTangent:
    """e . (alpha_b - alpha_a) + (omega_a x e) . (omega_b - omega_a), e fixed in a."""
    e: Vec3 = vector_tangent(scene, row.a, row.m)
    a: Vec3 = body_omega(scene, row.a)
    turn: Vec3 = sub(body_omega(scene, row.b), a)
    da: Vec3 = omega_tangent(scene, row.a)
    change: Vec3 = sub(omega_tangent(scene, row.b), da)
    A: Vec3 = sub(body_alpha(scene, row.b), body_alpha(scene, row.a))
    dA: Vec3 = sub(alpha_tangent(scene, row.b), alpha_tangent(scene, row.a))
    swept: Vec3 = cross(a, row.m)
    bent: cython.double = dot(add_cross(cross(da, row.m), a, e), turn) + dot(swept, change)
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, zero, e, dot(e, turn) + dot(row.m, change), dot(e, A) + dot(row.m, dA) + bent)
