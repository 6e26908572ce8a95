"""Conditions between two bodies, of which closure rows are made: unit load, gap, rate and gamma of each.

A row is one condition, or, for a coupling, a sum of several: callers go through its conditions one by one.
"""

from __future__ import annotations

from heuncli.kernel.cams import measure_cam
from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *
from heuncli.kernel.meshing import measure_mesh
from heuncli.kernel.plane_rows import measure_in_plane
from heuncli.kernel.rolling import measure_rolling
from heuncli.kernel.sheaves import measure_arc, measure_strand, measure_wound
from heuncli.kernel.tracks import measure_track


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
    row.gamma = dot(e, add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v)))


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
    row.gap = scene.freedoms[row.freedom].q - row.length
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
