"""The conditions of two bodies that closure rows are made of: unit load, gap, rate and gamma of each.

A row is one of them, or, of a coupling, a sum of several: what reads it takes its conditions one after another.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add, add_scaled, cross, dot, norm, sub
    from heuncli.kernel.cams import cam_part
    from heuncli.kernel.carried_points import carried, place_of
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.meshing import mesh_part
    from heuncli.kernel.plane_rows import measure_in_plane
    from heuncli.kernel.rolling import rolling_row
    from heuncli.kernel.scene import (
        ALONG,
        ARC,
        CAM,
        DOT,
        GUIDE,
        MESH,
        ROD,
        STRAND,
        SUM,
        TRACK,
        TURN,
        WOUND,
        Closure,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.sheaves import arc_part, strand_part, wound_part
    from heuncli.kernel.tracks import track_row
    from heuncli.kernel.values import Carried


def condition_count(row: cython.pointer[Closure]) -> cython.Py_ssize_t:
    """How many conditions a row is the sum of."""
    return row.part_count if row.kind == SUM else 1


def condition(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], i: cython.Py_ssize_t
) -> cython.pointer[Closure]:
    """One of the conditions that a row is the sum of; of a row that is no sum, taken once, it is the row itself."""
    return cython.address(scene.parts[row.part + i]) if row.kind == SUM else row


def measure_condition(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Unit load, gap, rate and gamma of a condition of two bodies."""
    if scene.flat and is_in_plane(row):
        measure_in_plane(scene, row)
        return
    row.Q = place_of(scene, row.b, row.q)
    if row.kind == GUIDE:
        guide_row(scene, row)
    elif row.kind == DOT:
        dot_row(scene, row)
    elif row.kind == TURN:
        turn_row(scene, row)
    elif row.kind == ROD:
        rod_row(scene, row)
    elif row.kind == MESH:
        mesh_part(scene, row)
    elif row.kind == CAM:
        cam_part(scene, row)
    elif row.kind == STRAND:
        strand_part(scene, row)
    elif row.kind == ARC:
        arc_part(scene, row)
    elif row.kind == WOUND:
        wound_part(scene, row)
    elif row.kind == TRACK or row.kind == ALONG:
        track_row(scene, row)
    else:
        rolling_row(scene, row)


def is_in_plane(row: cython.pointer[Closure]) -> cython.bint:
    """Whether it is one of those that a flat scene has formulae for: of directions the others look along z."""
    if row.kind <= DOT:
        return row.e.z == 0.0 and row.g.z == 0.0
    return row.kind == ROD or row.kind == TURN or row.kind == MESH


def enter(scene: cython.pointer[Scene], part: cython.pointer[Closure]) -> cython.void:
    """Where the load of a part enters its two bodies: at one place, but for what spans the way between two."""
    if part.kind != STRAND:
        part.on_b = part.Q
        part.on_a = place_of(scene, part.a, part.p) if part.kind == ROD else part.Q


def guide_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . (Q - P) = length, e fixed in a: gamma = e . (cen_b - cen_a - 2 omega_a x (v_b - v_a)), both at Q."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    e: Vec3 = direction_of(scene, row.a, row.e)
    v: Vec3 = sub(b.v, a.v)
    row.f = e
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = dot(e, sub(row.Q, place_of(scene, row.a, row.p))) - row.length
    row.rate = dot(e, v)
    row.gamma = dot(e, add_scaled(sub(b.centripetal, a.centripetal), -2.0, cross(a.omega, v)))


def dot_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . g = 0, e fixed in a, g in b: gamma = (omega_a - omega_b) . ((omega_a x e) x g + e x (omega_b x g))."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    e: Vec3 = direction_of(scene, row.a, row.e)
    g: Vec3 = direction_of(scene, row.b, row.g)
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = cross(g, e)
    row.gap = dot(e, g)
    row.rate = dot(row.m, sub(b.omega, a.omega))
    row.gamma = dot(sub(a.omega, b.omega), add(cross(cross(a.omega, e), g), cross(e, cross(b.omega, g))))


def turn_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A pin's angle = length, about e fixed in a: gamma = (omega_a x e) . (omega_b - omega_a)."""
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, row.Q)
    turn: Vec3 = sub(b.omega, a.omega)
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = direction_of(scene, row.a, row.e)
    row.gap = scene.freedoms[row.freedom].q - row.length
    row.rate = dot(row.m, turn)
    row.gamma = dot(cross(a.omega, row.m), turn)


def rod_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """|Q - P| = length along the unit vector n: gamma = n . (cen_b - cen_a) + (v^2 - (n . v)^2) / |Q - P|."""
    P: Vec3 = place_of(scene, row.a, row.p)
    b: Carried = carried(scene, row.b, row.Q)
    a: Carried = carried(scene, row.a, P)
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
