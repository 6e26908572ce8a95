"""Conditions between two bodies, of which closure rows are made: unit load, gap, rate and gamma of each, and their
change along a direction of the state.

A row is one condition, or, for a coupling, a sum of several: callers go through its conditions one by one.

The kinds of joints that were cut stand here: GUIDE, DOT, TURN, ROD; those of couplings and paths in a file each (cams,
rolling, sheaves, tracks). The change of a kind is written line by line, its rate and acceleration from the
motion of the two bodies' points at Q.
"""

from __future__ import annotations

from heuncli.kernel.cams import cam_tangent, measure_cam
from heuncli.kernel.carried_points import (
    alpha_tangent,
    angle_of_pin,
    body_alpha,
    body_omega,
    find_relative_motion,
    point_acceleration,
    point_motion,
    point_motion_tangent,
    relative_centripetal,
    world_place,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.plane_rows import measure_in_plane
from heuncli.kernel.rolling import measure_mesh, measure_rolling, mesh_tangent, rolling_tangent
from heuncli.kernel.sheaves import measure_arc, measure_strand, measure_wound, strand_tangent
from heuncli.kernel.tangent_motion import omega_tangent, point_tangent, vector_tangent
from heuncli.kernel.tracks import measure_track, track_row_tangent


def condition_count(row: cython.pointer[Closure]) -> cython.Py_ssize_t:
    """Return how many conditions a row is the sum of."""
    return row.part_count if row.kind == SUM else 1


def condition(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], i: cython.Py_ssize_t
) -> cython.pointer[Closure]:
    """Return condition i of a row that is a sum; otherwise the row itself."""
    return cython.address(scene.parts[row.part + i]) if row.kind == SUM else row


def measure_condition(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma of a condition between two bodies."""
    if scene.flat and is_in_plane(row):
        measure_in_plane(scene, row)
        return
    row.Q = world_place(scene, row.b, row.q)
    if row.kind == GUIDE:
        measure_guide(scene, row)
    elif row.kind == DOT:
        measure_dot(scene, row)
    elif row.kind == TURN:
        measure_turn(scene, row)
    elif row.kind == ROD:
        measure_rod(scene, row)
    elif row.kind == MESH:
        measure_mesh(scene, row)
    elif row.kind == CAM:
        measure_cam(scene, row)
    elif row.kind == STRAND:
        measure_strand(scene, row)
    elif row.kind == ARC:
        measure_arc(scene, row)
    elif row.kind == WOUND:
        measure_wound(scene, row)
    elif row.kind == TRACK or row.kind == ALONG:
        measure_track(scene, row)
    else:
        measure_rolling(scene, row)


def is_in_plane(row: cython.pointer[Closure]) -> cython.bint:
    """Return whether a planar scene has its own formulas for the condition: not for directions along z."""
    if row.kind <= DOT:
        return row.e.z == 0.0 and row.g.z == 0.0
    return row.kind == ROD or row.kind == TURN or row.kind == MESH


def set_load_places(scene: cython.pointer[Scene], part: cython.pointer[Closure]) -> cython.void:
    """Set where the load of a part acts on its two bodies: at one place, unless the part spans a distance."""
    if part.kind != STRAND:
        part.on_b = part.Q
        part.on_a = world_place(scene, part.a, part.p) if part.kind == ROD else part.Q


def measure_guide(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . (Q - P) = length, e fixed in a: gamma = e . (cen_b - cen_a - 2 omega_a x (v_b - v_a)), both at Q."""
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    e: Vec3 = world_direction(scene, row.a, row.e)
    v: Vec3 = sub(b.v, a.v)
    row.f = e
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = dot(e, sub(row.Q, world_place(scene, row.a, row.p))) - row.length
    row.rate = dot(e, v)
    row.gamma = dot(e, relative_centripetal(a, b, v))


def measure_dot(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . g = 0, e fixed in a, g in b: gamma = (omega_a - omega_b) . ((omega_a x e) x g + e x (omega_b x g))."""
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    e: Vec3 = world_direction(scene, row.a, row.e)
    g: Vec3 = world_direction(scene, row.b, row.g)
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = cross(g, e)
    row.gap = dot(e, g)
    row.rate = dot(row.m, sub(b.omega, a.omega))
    row.gamma = dot(sub(a.omega, b.omega), add(cross(cross(a.omega, e), g), cross(e, cross(b.omega, g))))


def measure_turn(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A pin's angle = length, about e fixed in a: gamma = (omega_a x e) . (omega_b - omega_a)."""
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, row.Q)
    turn: Vec3 = sub(b.omega, a.omega)
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = world_direction(scene, row.a, row.e)
    row.gap = angle_of_pin(scene, row)
    row.rate = dot(row.m, turn)
    row.gamma = dot(cross(a.omega, row.m), turn)


def measure_rod(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """|Q - P| = length along the unit vector n: gamma = n . (cen_b - cen_a) + (v^2 - (n . v)^2) / |Q - P|."""
    P: Vec3 = world_place(scene, row.a, row.p)
    b: PointKinematics = point_motion(scene, row.b, row.Q)
    a: PointKinematics = point_motion(scene, row.a, P)
    D: Vec3 = sub(row.Q, P)
    v: Vec3 = sub(b.v, a.v)
    span: cython.double = norm(D)
    if span > 0.0:
        D = Vec3(D.x / span, D.y / span, D.z / span)
    row.f = D
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = span - row.length
    row.rate = dot(D, v)
    row.gamma = dot(D, sub(b.centripetal, a.centripetal))
    if span > 0.0:
        row.gamma += (dot(v, v) - row.rate * row.rate) / span


# Along a direction of the state


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
    d: RelativeMotion = find_relative_motion(scene, row, Q)
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    return RowTangent(Q, e, zero, dot(e, d.v) + dot(row.f, d.dv), dot(e, d.A) + dot(row.f, d.dA))


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
