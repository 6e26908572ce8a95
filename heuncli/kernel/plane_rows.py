"""Closure rows whose force and point lie in the plane, and couples about z: closures.py in two dimensions.

    J Vdot + gamma = 0

In a planar scene all rows that the freedoms respond to are of these: forces along z, and couples across it, do no work.
Heights along z count in the length of a rod only.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.carried_points import angle_of_pin
from heuncli.kernel.declarations import *


def direction_in_plane(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """Return the world components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    x: cython.double = carrier.R.xx * a.x + carrier.R.xy * a.y
    return Vec3(x, carrier.R.yx * a.x + carrier.R.yy * a.y, a.z)


def place_in_plane(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """Return the world place of a body's point, given from its joint point in its axes; a ground point is returned as
    it is.
    """
    if body < 0:
        return q
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    x: cython.double = carrier.r.x + (carrier.R.xx * q.x + carrier.R.xy * q.y)
    return Vec3(x, carrier.r.y + (carrier.R.yx * q.x + carrier.R.yy * q.y), carrier.r.z + q.z)


def point_motion_in_plane(scene: cython.pointer[Scene], body: cython.int, place: Vec3) -> PlanarPointKinematics:
    """Return velocity, centripetal acceleration and angular velocity of the body's point at a world place."""
    if body < 0:
        return PlanarPointKinematics(0.0, 0.0, 0.0, 0.0, 0.0)
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    omega: cython.double = carrier.omega.z
    x: cython.double = place.x - carrier.r.x
    y: cython.double = place.y - carrier.r.y
    square: cython.double = -omega * omega
    return PlanarPointKinematics(carrier.v.x - omega * y, carrier.v.y + omega * x, square * x, square * y, omega)


def measure_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Find unit load, gap, rate and gamma of a row at the present kinematics."""
    row.Q = place_in_plane(scene, row.b, row.q)
    if row.kind == GUIDE:
        measure_guide_in_plane(scene, row)
    elif row.kind == DOT:
        measure_dot_in_plane(scene, row)
    elif row.kind == TURN:
        measure_angle_in_plane(scene, row)
    elif row.kind == MESH:
        measure_mesh_in_plane(scene, row)
    else:
        measure_rod_in_plane(scene, row)


def measure_guide_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . (Q - P) = length, e fixed in a: gamma = e . (cen_b - cen_a - 2 omega_a x (v_b - v_a)), both at Q."""
    e: Vec3 = direction_in_plane(scene, row.a, row.e)
    P: Vec3 = place_in_plane(scene, row.a, row.p)
    b: PlanarPointKinematics = point_motion_in_plane(scene, row.b, row.Q)
    a: PlanarPointKinematics = point_motion_in_plane(scene, row.a, row.Q)
    vx: cython.double = b.vx - a.vx
    vy: cython.double = b.vy - a.vy
    row.f = Vec3(e.x, e.y, 0.0)
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = e.x * (row.Q.x - P.x) + e.y * (row.Q.y - P.y) - row.length
    row.rate = e.x * vx + e.y * vy
    row.gamma = e.x * (b.cx - a.cx + 2.0 * a.omega * vy) + e.y * (b.cy - a.cy - 2.0 * a.omega * vx)


def measure_dot_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . g = 0, e fixed in a, g in b: gamma = -(omega_b - omega_a)^2 e . g."""
    e: Vec3 = direction_in_plane(scene, row.a, row.e)
    g: Vec3 = direction_in_plane(scene, row.b, row.g)
    b: PlanarPointKinematics = point_motion_in_plane(scene, row.b, row.Q)
    a: PlanarPointKinematics = point_motion_in_plane(scene, row.a, row.Q)
    turn: cython.double = b.omega - a.omega
    couple: cython.double = g.x * e.y - g.y * e.x
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = Vec3(0.0, 0.0, couple)
    row.gap = e.x * g.x + e.y * g.y
    row.rate = couple * turn
    row.gamma = -turn * turn * row.gap


def measure_rod_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """|Q - P| = length along the unit vector n: gamma = n . (cen_b - cen_a) + (v^2 - (n . v)^2) / |Q - P|."""
    P: Vec3 = place_in_plane(scene, row.a, row.p)
    b: PlanarPointKinematics = point_motion_in_plane(scene, row.b, row.Q)
    a: PlanarPointKinematics = point_motion_in_plane(scene, row.a, P)
    x: cython.double = row.Q.x - P.x
    y: cython.double = row.Q.y - P.y
    z: cython.double = row.Q.z - P.z
    vx: cython.double = b.vx - a.vx
    vy: cython.double = b.vy - a.vy
    span: cython.double = sqrt(x * x + y * y + z * z)
    if span > 0.0:
        x = x / span
        y = y / span
        z = z / span
    row.f = Vec3(x, y, z)
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = span - row.length
    row.rate = x * vx + y * vy
    row.gamma = x * (b.cx - a.cx) + y * (b.cy - a.cy)
    if span > 0.0:
        row.gamma += (vx * vx + vy * vy - row.rate * row.rate) / span


def measure_angle_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A pin's angle = length, about z: gamma = 0."""
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = row.e
    row.gap = angle_of_pin(scene, row)
    row.rate = row.e.z * (planar_omega(scene, row.b) - planar_omega(scene, row.a))
    row.gamma = 0.0


def planar_omega(scene: cython.pointer[Scene], body: cython.int) -> cython.double:
    """Return the angular velocity of a body about z; 0 for the ground."""
    return scene.bodies[body].omega.z if body >= 0 else 0.0


def measure_mesh_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Measure a load fixed in the carrier c: gamma as in rolling.py; its couple, about z, keeps its direction.

    gamma = f . (w_b - w_a) + (omega_c x f) . (v_b - v_a),  w = cen + omega x (v_c - v)
    """
    f: Vec3 = direction_in_plane(scene, row.c, row.e)
    row.Q = place_in_plane(scene, row.c, row.p)
    c: PlanarPointKinematics = point_motion_in_plane(scene, row.c, row.Q)
    b: PlanarPointKinematics = point_motion_in_plane(scene, row.b, row.Q)
    a: PlanarPointKinematics = point_motion_in_plane(scene, row.a, row.Q)
    x: cython.double = b.vx - a.vx
    y: cython.double = b.vy - a.vy
    wx: cython.double = b.cx - a.cx - b.omega * (c.vy - b.vy) + a.omega * (c.vy - a.vy)
    wy: cython.double = b.cy - a.cy + b.omega * (c.vx - b.vx) - a.omega * (c.vx - a.vx)
    row.f = f
    row.m = direction_in_plane(scene, row.c, row.g)
    row.gap = row.ratio * scene.freedoms[row.freedom].q + row.ratio_b * scene.freedoms[row.freedom_b].q - row.length
    row.rate = f.x * x + f.y * y + row.m.z * (b.omega - a.omega)
    row.gamma = f.x * wx + f.y * wy + c.omega * (f.x * y - f.y * x)


def zero_acceleration_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return J Vdot of a row if no freedom accelerated."""
    x: cython.double = 0.0
    y: cython.double = 0.0
    couple: cython.double = 0.0
    alpha: cython.double
    if row.b >= 0:
        b: cython.pointer[Body] = cython.address(scene.bodies[row.b])
        alpha = b.alpha_zero.z
        couple = alpha
        x = b.a_zero.x - alpha * (row.Q.y - b.r.y)
        y = b.a_zero.y + alpha * (row.Q.x - b.r.x)
    if row.a >= 0:
        a: cython.pointer[Body] = cython.address(scene.bodies[row.a])
        alpha = a.alpha_zero.z
        couple -= alpha
        x -= a.a_zero.x - alpha * (row.Q.y - a.r.y)
        y -= a.a_zero.y + alpha * (row.Q.x - a.r.x)
    return row.f.x * x + row.f.y * y + row.m.z * couple


def add_unit_load_in_plane(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.void:
    """Add the row's load for lambda = -sign on one of its bodies to M_branch and f_branch, about the joint point."""
    if body >= 0:
        target: cython.pointer[Body] = cython.address(scene.bodies[body])
        fx: cython.double = sign * row.f.x
        fy: cython.double = sign * row.f.y
        turn: cython.double = (row.Q.x - target.r.x) * fy - (row.Q.y - target.r.y) * fx
        target.M_branch.z += sign * row.m.z + turn
        target.f_branch.x += fx
        target.f_branch.y += fy


def spread_row_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Spread D^(-1/2) e_r, the response of the freedoms of the row's paths to its unit load, over all freedoms."""
    n: cython.Py_ssize_t
    for n in range(row.velocities + row.velocity_count, row.velocities + row.filled_count):
        scene.velocity_vector[scene.indices[n]] = 0.0
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        body.M_branch = Vec3(0.0, 0.0, 0.0)
        body.f_branch = Vec3(0.0, 0.0, 0.0)
    if row.kind == SUM:
        for n in range(row.part, row.part + row.part_count):
            part: cython.pointer[Closure] = cython.address(scene.parts[n])
            add_unit_load_in_plane(scene, part, part.b, -part.factor)
            add_unit_load_in_plane(scene, part, part.a, part.factor)
    else:
        add_unit_load_in_plane(scene, row, row.b, -1.0)
        add_unit_load_in_plane(scene, row, row.a, 1.0)
    for n in range(row.path, row.path + row.path_count):
        sweep_column_in_plane(scene, cython.address(scene.bodies[scene.indices[n]]))


def sweep_column_in_plane(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Find the response of the body's freedoms to M_branch and f_branch; pass the rest to the parent."""
    k: cython.Py_ssize_t
    M: cython.double = body.M_branch.z
    x: cython.double = body.f_branch.x
    y: cython.double = body.f_branch.y
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        e: cython.double = 0.0
        if not freedom.driven:
            e = -(freedom.s.x * x + freedom.s.y * y + freedom.s.z * M)
        scene.velocity_vector[freedom.velocity_at] = scene.inertia_root[freedom.velocity_at] * e
        e *= freedom.D
        x += e * freedom.U_shift.x
        y += e * freedom.U_shift.y
        M += e * freedom.U_turn.z
    if body.parent >= 0:
        parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
        M += body.arm.x * y - body.arm.y * x
        parent.M_branch.z += M
        parent.f_branch.x += x
        parent.f_branch.y += y
