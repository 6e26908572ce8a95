"""A load fixed in a carrier, between two bodies that it carries: the condition of teeth, threads and belts.

    f . (v_b - v_a) + m . (omega_b - omega_a) = 0        f, m and the place Q fixed in the body c

The bodies turn and slide in their joints on c only. So the sum of their coordinates, each times the work of the load
for a unit of it, is constant: that is the gap.
"""

from __future__ import annotations

from heuncli.kernel.carried_points import point_motion, world_place
from heuncli.kernel.declarations import *


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
