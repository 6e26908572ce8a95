"""Closure rows whose force and point stay in the plane, and couples about z: closures.py, where z counts nothing.

    J Vdot + gamma = 0
In a flat scene all rows that the freedoms can answer are of these: forces along z, and couples across it, do no work.
Heights along z count in the length of a rod alone.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import sqrt

    from heuncli.kernel.algebra import Vec3
    from heuncli.kernel.scene import DOT, GUIDE, MESH, SUM, TURN, Body, Closure, Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.values import CarriedInPlane


def turned_in_plane(scene: cython.pointer[Scene], body: cython.int, a: Vec3) -> Vec3:
    """World components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    x: cython.double = on.R.xx * a.x + on.R.xy * a.y
    return Vec3(x, on.R.yx * a.x + on.R.yy * a.y, a.z)


def place_in_plane(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> Vec3:
    """World place of a body's point, given from its joint point in its axes; a ground point as it is."""
    if body < 0:
        return q
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    x: cython.double = on.r.x + (on.R.xx * q.x + on.R.xy * q.y)
    return Vec3(x, on.r.y + (on.R.yx * q.x + on.R.yy * q.y), on.r.z + q.z)


def carried_in_plane(scene: cython.pointer[Scene], body: cython.int, at: Vec3) -> CarriedInPlane:
    """Velocity, centripetal acceleration and angular velocity of the body's point at a world place."""
    if body < 0:
        return CarriedInPlane(0.0, 0.0, 0.0, 0.0, 0.0)
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    omega: cython.double = on.omega.z
    x: cython.double = at.x - on.r.x
    y: cython.double = at.y - on.r.y
    square: cython.double = -omega * omega
    return CarriedInPlane(on.v.x - omega * y, on.v.y + omega * x, square * x, square * y, omega)


def measure_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Unit load, gap, rate and gamma of a row at the present kinematics."""
    row.Q = place_in_plane(scene, row.b, row.q)
    if row.kind == GUIDE:
        guide_in_plane(scene, row)
    elif row.kind == DOT:
        dot_in_plane(scene, row)
    elif row.kind == TURN:
        angle_in_plane(scene, row)
    elif row.kind == MESH:
        mesh_in_plane(scene, row)
    else:
        rod_in_plane(scene, row)


def guide_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . (Q - P) = length, e fixed in a: gamma = e . (cen_b - cen_a - 2 omega_a x (v_b - v_a)), both at Q."""
    e: Vec3 = turned_in_plane(scene, row.a, row.e)
    P: Vec3 = place_in_plane(scene, row.a, row.p)
    b: CarriedInPlane = carried_in_plane(scene, row.b, row.Q)
    a: CarriedInPlane = carried_in_plane(scene, row.a, row.Q)
    vx: cython.double = b.vx - a.vx
    vy: cython.double = b.vy - a.vy
    row.f = Vec3(e.x, e.y, 0.0)
    row.m = Vec3(0.0, 0.0, 0.0)
    row.gap = e.x * (row.Q.x - P.x) + e.y * (row.Q.y - P.y) - row.length
    row.rate = e.x * vx + e.y * vy
    row.gamma = e.x * (b.cx - a.cx + 2.0 * a.omega * vy) + e.y * (b.cy - a.cy - 2.0 * a.omega * vx)


def dot_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e . g = 0, e fixed in a, g in b: gamma = -(omega_b - omega_a)^2 e . g."""
    e: Vec3 = turned_in_plane(scene, row.a, row.e)
    g: Vec3 = turned_in_plane(scene, row.b, row.g)
    b: CarriedInPlane = carried_in_plane(scene, row.b, row.Q)
    a: CarriedInPlane = carried_in_plane(scene, row.a, row.Q)
    turn: cython.double = b.omega - a.omega
    couple: cython.double = g.x * e.y - g.y * e.x
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = Vec3(0.0, 0.0, couple)
    row.gap = e.x * g.x + e.y * g.y
    row.rate = couple * turn
    row.gamma = -turn * turn * row.gap


def rod_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """|Q - P| = length along the unit vector n: gamma = n . (cen_b - cen_a) + (v^2 - (n . v)^2) / |Q - P|."""
    P: Vec3 = place_in_plane(scene, row.a, row.p)
    b: CarriedInPlane = carried_in_plane(scene, row.b, row.Q)
    a: CarriedInPlane = carried_in_plane(scene, row.a, P)
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


def angle_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A pin's angle = length, about z: gamma = 0."""
    row.f = Vec3(0.0, 0.0, 0.0)
    row.m = row.e
    row.gap = scene.freedoms[row.freedom].q - row.length
    row.rate = row.e.z * (turn_rate(scene, row.b) - turn_rate(scene, row.a))
    row.gamma = 0.0


def turn_rate(scene: cython.pointer[Scene], body: cython.int) -> cython.double:
    """Angular velocity of a body about z; the ground has none."""
    return scene.bodies[body].omega.z if body >= 0 else 0.0


def mesh_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A load fixed in the carrier c: gamma as in meshing.py; its couple, about z, turns with nothing.

    gamma = f . (w_b - w_a) + (omega_c x f) . (v_b - v_a),  w = cen + omega x (v_c - v)
    """
    f: Vec3 = turned_in_plane(scene, row.c, row.e)
    row.Q = place_in_plane(scene, row.c, row.p)
    c: CarriedInPlane = carried_in_plane(scene, row.c, row.Q)
    b: CarriedInPlane = carried_in_plane(scene, row.b, row.Q)
    a: CarriedInPlane = carried_in_plane(scene, row.a, row.Q)
    x: cython.double = b.vx - a.vx
    y: cython.double = b.vy - a.vy
    wx: cython.double = b.cx - a.cx - b.omega * (c.vy - b.vy) + a.omega * (c.vy - a.vy)
    wy: cython.double = b.cy - a.cy + b.omega * (c.vx - b.vx) - a.omega * (c.vx - a.vx)
    row.f = f
    row.m = turned_in_plane(scene, row.c, row.g)
    row.gap = row.ratio * scene.freedoms[row.freedom].q + row.ratio_b * scene.freedoms[row.freedom_b].q - row.length
    row.rate = f.x * x + f.y * y + row.m.z * (b.omega - a.omega)
    row.gamma = f.x * wx + f.y * wy + c.omega * (f.x * y - f.y * x)


def demanded_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """J Vdot of a row if no freedom accelerated."""
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


def unit_load_in_plane(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.void:
    """The row's load for lambda = -sign on one of its bodies, as M_branch and f_branch about the joint point."""
    if body >= 0:
        on: cython.pointer[Body] = cython.address(scene.bodies[body])
        fx: cython.double = sign * row.f.x
        fy: cython.double = sign * row.f.y
        turn: cython.double = (row.Q.x - on.r.x) * fy - (row.Q.y - on.r.y) * fx
        on.M_branch.z += sign * row.m.z + turn
        on.f_branch.x += fx
        on.f_branch.y += fy


def spread_in_plane(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """D^(-1/2) e_r, what the freedoms of the row's paths answer to its unit load, spread over all freedoms."""
    n: cython.Py_ssize_t
    for n in range(row.answers + row.answer_count, row.answers + row.filled_count):
        scene.spread[scene.indices[n]] = 0.0
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        body.M_branch = Vec3(0.0, 0.0, 0.0)
        body.f_branch = Vec3(0.0, 0.0, 0.0)
    if row.kind == SUM:
        for n in range(row.part, row.part + row.part_count):
            part: cython.pointer[Closure] = cython.address(scene.parts[n])
            unit_load_in_plane(scene, part, part.b, -part.factor)
            unit_load_in_plane(scene, part, part.a, part.factor)
    else:
        unit_load_in_plane(scene, row, row.b, -1.0)
        unit_load_in_plane(scene, row, row.a, 1.0)
    for n in range(row.path, row.path + row.path_count):
        climb_in_plane(scene, cython.address(scene.bodies[scene.indices[n]]))


def climb_in_plane(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """What the body's freedoms answer to what stands in M_branch and f_branch; what they leave goes to the parent."""
    k: cython.Py_ssize_t
    M: cython.double = body.M_branch.z
    x: cython.double = body.f_branch.x
    y: cython.double = body.f_branch.y
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        e: cython.double = 0.0
        if not freedom.driven:
            e = -(freedom.s.x * x + freedom.s.y * y + freedom.s.z * M)
        scene.spread[freedom.answer_at] = scene.root[freedom.answer_at] * e
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
