"""Trees whose bodies turn about z and shift across it: the sweep of tree.py with three components for a motion.

    [n_z; f_x; f_y] = A [alpha_z; a_x; a_y] + [M_z; f_x; f_y]       what a joint must exert on its branch

The turn and the two shifts are the whole motion, so the articulated inertia of a branch is one symmetric matrix of
three (body.A; C and G are unused; K holds the sizes of its terms before any freedom was eliminated: K.xx of the turn,
of masses at their levers, K.yy of the shifts). Behind a joint that turns freely nothing is left of the first row: the
branch acts on its parent as a mass at the joint, not the same in all directions. Other fields are as in space, with
zeros in the components that do not exist, so that loads and closures read them alike; heights along z are kept, because
lengths include them. Loads out of the plane are not found here: they move nothing.
"""

from __future__ import annotations

from math import cos, sin

from heuncli.kernel.declarations import *
from heuncli.kernel.paths import place_on_path


def move_in_plane(scene: cython.pointer[Scene]) -> cython.void:
    """Find attitudes, joint points, velocities (46) and velocity terms from the freedoms; clear the applied loads."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        set_joint_point_in_plane(scene, body)
        set_orientation_in_plane(scene, body)
        square: cython.double = -body.omega.z * body.omega.z
        x: cython.double = body.R.xx * body.first_moment.x - body.R.yx * body.first_moment.y
        y: cython.double = body.R.yx * body.first_moment.x + body.R.xx * body.first_moment.y
        body.mc = Vec3(x, y, body.first_moment.z)
        body.centrifugal = Vec3(square * x, square * y, 0.0)
        body.M_applied = Vec3(0.0, 0.0, 0.0)
        body.f_applied = Vec3(0.0, 0.0, 0.0)


def set_joint_point_in_plane(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Find the joint point, its velocity and its velocity terms, from the parent and the shifts of the joint.

    r = r_p + l,  v = v_p + omega_p x l + w,  a - a_p - alpha_p x l = omega_p x (omega_p x l + 2 w) + wdot, w = sum u s
    """
    k: cython.Py_ssize_t
    c: cython.double = 1.0
    s: cython.double = 0.0
    wx: cython.double = 0.0
    wy: cython.double = 0.0
    px: cython.double = 0.0
    py: cython.double = 0.0
    x: cython.double = body.joint_in_parent.x
    y: cython.double = body.joint_in_parent.y
    if body.parent >= 0:
        parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
        c = parent.R.xx
        s = parent.R.yx
        x = c * body.joint_in_parent.x - s * body.joint_in_parent.y
        y = s * body.joint_in_parent.x + c * body.joint_in_parent.y
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.pieces:
            place: Vec3 = place_on_path(scene, body.parent, freedom)
            bent: cython.double = freedom.u * freedom.u
            x += place.x
            y += place.y
            wx += freedom.u * freedom.s.x
            wy += freedom.u * freedom.s.y
            px += freedom.udot * freedom.s.x + bent * freedom.curved.x
            py += freedom.udot * freedom.s.y + bent * freedom.curved.y
        elif freedom.kind == SHIFT:
            sx: cython.double = c * freedom.direction.x - s * freedom.direction.y
            sy: cython.double = s * freedom.direction.x + c * freedom.direction.y
            freedom.s = Vec3(sx, sy, 0.0)
            x += freedom.q * sx
            y += freedom.q * sy
            wx += freedom.u * sx
            wy += freedom.u * sy
            px += freedom.udot * sx
            py += freedom.udot * sy
    body.arm = Vec3(x, y, body.joint_in_parent.z)
    if body.parent < 0:
        body.r = Vec3(x, y, body.joint_in_parent.z)
        body.v = Vec3(wx, wy, 0.0)
        body.a_bias = Vec3(px, py, 0.0)
        return
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
    omega: cython.double = carrier.omega.z
    body.r = Vec3(carrier.r.x + x, carrier.r.y + y, carrier.r.z + body.joint_in_parent.z)
    x *= omega
    y *= omega
    body.v = Vec3(carrier.v.x - y + wx, carrier.v.y + x + wy, 0.0)
    body.a_bias = Vec3(px - omega * (x + 2.0 * wy), py + omega * (2.0 * wx - y), 0.0)


def set_orientation_in_plane(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Find attitude and angular velocity: the sum of the parent's, the frame's and the freedoms' turns about z."""
    k: cython.Py_ssize_t
    angle: cython.double = 0.0
    omega: cython.double = 0.0
    udot: cython.double = 0.0
    has_turn: cython.bint = False
    c: cython.double = body.frame.xx
    s: cython.double = body.frame.yx
    x: cython.double
    if body.parent >= 0:
        parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
        omega = parent.omega.z
        x = parent.R.xx * c - parent.R.yx * s
        s = parent.R.yx * c + parent.R.xx * s
        c = x
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.kind != SHIFT:
            has_turn = True
            freedom.s = freedom.direction
            angle += freedom.direction.z * freedom.q
            omega += freedom.direction.z * freedom.u
            udot += freedom.direction.z * freedom.udot
    if has_turn:
        cosine: cython.double = cos(angle)
        sine: cython.double = sin(angle)
        x = c * cosine - s * sine
        s = s * cosine + c * sine
        c = x
    body.R = Mat3(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
    body.omega = Vec3(0.0, 0.0, omega)
    body.alpha_bias = Vec3(0.0, 0.0, udot)


def factor_in_plane(scene: cython.pointer[Scene]) -> cython.int:
    """Find the articulated inertias, from the tips to the roots, reduced by every freedom that is not driven.

    Returns the number of freedoms with no inertia behind them.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    massless: cython.int = 0
    for i in range(scene.body_count):
        tip: cython.pointer[Body] = cython.address(scene.bodies[i])
        tip.A = Sym3(tip.inertia.zz, -tip.mc.y, tip.mc.x, tip.mass, 0.0, tip.mass)
        tip.K = Sym3(tip.inertia.zz, 0.0, 0.0, tip.mass, 0.0, tip.mass)
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        # compare a freedom's inertia with that before any freedom was eliminated: a much smaller rest is
        # rounding
        mass: cython.double = scene.limits.no_inertia * body.K.yy
        turning: cython.double = scene.limits.no_inertia * body.K.xx
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                freedom.D = 0.0
            elif freedom.kind == SHIFT:
                massless += eliminate_shift(body, freedom, mass)
            else:
                massless += eliminate_turn(body, freedom, turning)
        if body.parent >= 0:
            add_branch_in_plane(cython.address(scene.bodies[body.parent]), body)
    return massless


def eliminate_turn(
    body: cython.pointer[Body], freedom: cython.pointer[Freedom], min_inertia: cython.double
) -> cython.int:
    """U = I s, D = s . U, I <- I - U U' / D for a turn. Returns 1 if its inertia is not above `min_inertia`."""
    turn: cython.double = body.A.xx
    x: cython.double = body.A.xy
    y: cython.double = body.A.xz
    freedom.U_turn = Vec3(0.0, 0.0, freedom.s.z * turn)
    freedom.U_shift = Vec3(freedom.s.z * x, freedom.s.z * y, 0.0)
    freedom.D = 1.0 / turn if turn > min_inertia else 0.0
    if freedom.D == 0.0:
        return 1
    ux: cython.double = freedom.D * x
    uy: cython.double = freedom.D * y
    body.A = Sym3(0.0, 0.0, 0.0, body.A.yy - ux * x, body.A.yz - ux * y, body.A.zz - uy * y)
    return 0


def eliminate_shift(
    body: cython.pointer[Body], freedom: cython.pointer[Freedom], min_inertia: cython.double
) -> cython.int:
    """Do the same as `eliminate_turn` for a shift."""
    sx: cython.double = freedom.s.x
    sy: cython.double = freedom.s.y
    turn: cython.double = body.A.xy * sx + body.A.xz * sy
    x: cython.double = body.A.yy * sx + body.A.yz * sy
    y: cython.double = body.A.yz * sx + body.A.zz * sy
    D: cython.double = sx * x + sy * y
    freedom.U_turn = Vec3(0.0, 0.0, turn)
    freedom.U_shift = Vec3(x, y, 0.0)
    freedom.D = 1.0 / D if D > min_inertia else 0.0
    D = freedom.D
    body.A = Sym3(
        body.A.xx - D * turn * turn,
        body.A.xy - D * turn * x,
        body.A.xz - D * turn * y,
        body.A.yy - D * x * x,
        body.A.yz - D * x * y,
        body.A.zz - D * y * y,
    )
    return D == 0.0


def add_branch_in_plane(parent: cython.pointer[Body], body: cython.pointer[Body]) -> cython.void:
    """Add the branch at the arm l: K += K_b, C += C_b + l x K_b, A += A_b + 2 l x C_b + (l x K_b) x l."""
    x: cython.double = body.arm.x
    y: cython.double = body.arm.y
    lx: cython.double = x * body.A.yz - y * body.A.yy
    ly: cython.double = x * body.A.zz - y * body.A.yz
    parent.K.xx += body.K.xx + body.K.yy * (x * x + y * y)
    parent.K.yy += body.K.yy
    parent.A = Sym3(
        parent.A.xx + body.A.xx + 2.0 * (x * body.A.xz - y * body.A.xy) + (x * ly - y * lx),
        parent.A.xy + body.A.xy + lx,
        parent.A.xz + body.A.xz + ly,
        parent.A.yy + body.A.yy,
        parent.A.yz + body.A.yz,
        parent.A.zz + body.A.zz,
    )


def set_branch_loads_in_plane(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Set the load that each body needs from its joint: its velocity terms minus the applied loads."""
    i: cython.Py_ssize_t
    count: cython.double = 1.0 if inertial else 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.M_branch = Vec3(0.0, 0.0, -body.M_applied.z)
        x: cython.double = count * body.centrifugal.x - body.f_applied.x
        body.f_branch = Vec3(x, count * body.centrifugal.y - body.f_applied.y, 0.0)


def set_full_branch_loads_in_plane(scene: cython.pointer[Scene]) -> cython.void:
    """Add the inertia loads for the case that no freedom accelerates; set alpha_zero and a_zero."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: cython.double = body.alpha_bias.z
        x: cython.double = body.a_bias.x
        y: cython.double = body.a_bias.y
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            x += parent.a_zero.x - parent.alpha_zero.z * body.arm.y
            y += parent.a_zero.y + parent.alpha_zero.z * body.arm.x
            alpha += parent.alpha_zero.z
        body.alpha_zero = Vec3(0.0, 0.0, alpha)
        body.a_zero = Vec3(x, y, 0.0)
        x -= scene.gravity.x
        y -= scene.gravity.y
        body.M_branch = Vec3(0.0, 0.0, turning_load(body, alpha, x, y))
        body.f_branch = Vec3(
            body.mass * x - alpha * body.mc.y + body.centrifugal.x - body.f_applied.x,
            body.mass * y + alpha * body.mc.x + body.centrifugal.y - body.f_applied.y,
            0.0,
        )


def turning_load(body: cython.pointer[Body], alpha: cython.double, x: cython.double, y: cython.double) -> cython.double:
    """J alpha + m c x a, minus the applied moment."""
    return body.inertia.zz * alpha + (body.mc.x * y - body.mc.y * x) - body.M_applied.z


def add_zero_accelerations_in_plane(scene: cython.pointer[Scene]) -> cython.void:
    """Add the accelerations if no freedom accelerated, minus gravity, to those that respond to the loads."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.alpha.z += body.alpha_zero.z
        body.a.x += body.a_zero.x - scene.gravity.x
        body.a.y += body.a_zero.y - scene.gravity.y


def sweep_up_in_plane(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From M_branch, f_branch and velocity terms find e, the loads on the freedoms; tips to roots."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        M: cython.double = body.M_branch.z
        x: cython.double = body.f_branch.x
        y: cython.double = body.f_branch.y
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            e: cython.double = 0.0
            if not freedom.driven:
                e = -(freedom.s.x * x + freedom.s.y * y + freedom.s.z * M)
            scene.e[freedom.velocity_at] = e
            e *= freedom.D
            x += e * freedom.U_shift.x
            y += e * freedom.U_shift.y
            M += e * freedom.U_turn.z
        if body.parent >= 0:
            if inertial:
                alpha: cython.double = body.alpha_bias.z
                ax: cython.double = body.a_bias.x
                ay: cython.double = body.a_bias.y
                M += body.A.xx * alpha + body.A.xy * ax + body.A.xz * ay
                x += body.A.xy * alpha + body.A.yy * ax + body.A.yz * ay
                y += body.A.xz * alpha + body.A.yz * ax + body.A.zz * ay
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            M += body.arm.x * y - body.arm.y * x
            parent.M_branch.z += M
            parent.f_branch.x += x
            parent.f_branch.y += y


def sweep_down_in_plane(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From e find the accelerations of freedoms and bodies, roots to tips."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: cython.double = 0.0
        x: cython.double = 0.0
        y: cython.double = 0.0
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            alpha = parent.alpha.z
            x = parent.a.x - alpha * body.arm.y
            y = parent.a.y + alpha * body.arm.x
        elif inertial:
            x = -scene.gravity.x
            y = -scene.gravity.y
        if inertial:
            x += body.a_bias.x
            y += body.a_bias.y
            alpha += body.alpha_bias.z
        for k in range(body.end_freedom - 1, body.first_freedom - 1, -1):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                continue
            base_load: cython.double = freedom.U_shift.x * x + freedom.U_shift.y * y + freedom.U_turn.z * alpha
            udot: cython.double = freedom.D * (scene.e[freedom.velocity_at] - base_load)
            freedom.udot = udot
            x += udot * freedom.s.x
            y += udot * freedom.s.y
            alpha += udot * freedom.s.z
        body.alpha = Vec3(0.0, 0.0, alpha)
        body.a = Vec3(x, y, 0.0)


def balance_in_plane(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Find the joint loads in the plane from the accelerations found and the applied loads, tips to roots."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    count: cython.double = 1.0 if inertial else 0.0
    for i in range(scene.body_count):
        tip: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: cython.double = tip.alpha.z
        tip.M_joint = Vec3(0.0, 0.0, turning_load(tip, alpha, tip.a.x, tip.a.y))
        tip.f_joint = Vec3(
            tip.mass * tip.a.x - alpha * tip.mc.y + count * tip.centrifugal.x - tip.f_applied.x,
            tip.mass * tip.a.y + alpha * tip.mc.x + count * tip.centrifugal.y - tip.f_applied.y,
            0.0,
        )
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        M: cython.double = body.M_joint.z
        x: cython.double = body.f_joint.x
        y: cython.double = body.f_joint.y
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_joint.z += M + (body.arm.x * y - body.arm.y * x)
            parent.f_joint.x += x
            parent.f_joint.y += y
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                freedom.drive = freedom.s.x * x + freedom.s.y * y + freedom.s.z * M
