"""The motion of a tree of bodies from its coordinates and rates, from the root outward: places, velocities, and those
parts of the accelerations that no freedom's acceleration changes.

Gravity enters as the ground's acceleration -g, so `a` always is the acceleration minus g.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.jets import jet
from heuncli.kernel.paths import place_on_path
from heuncli.kernel.plane import move_in_plane
from heuncli.kernel.strains import evaluate_load_variable


def set_coordinates(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Set coordinates, rates and prescribed accelerations of the scalar freedoms, and the expressions' variables."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            drive: Jet = jet(scene.programs, freedom.program, t)
            freedom.q = drive.value
            freedom.u = drive.rate
            freedom.udot = drive.second
        else:
            freedom.q = y[freedom.q_at]
            freedom.u = y[freedom.u_at]
            freedom.udot = 0.0
    for i in range(scene.counter_count):
        scene.counters[i].value = y[scene.counters[i].state_at]
    scene.programs.variables[0] = t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if not variable.is_point:
            variable_freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[variable.freedom])
            scene.programs.variables[i] = (
                (0.0 if variable_freedom.is_held else variable_freedom.u) if variable.is_rate else variable_freedom.q
            )


def update_kinematics(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Find attitudes, joint points, velocities (46) and velocity terms of all bodies at y; clear the applied loads."""
    set_coordinates(scene, t, y)
    if scene.flat:
        move_in_plane(scene)
    else:
        move_in_space(scene, y)
    if scene.point_count:
        set_point_variables(scene)


def set_point_variables(scene: cython.pointer[Scene]) -> cython.void:
    """Set the variables that are places and velocities of points, or belong to loads, at the present pose."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            scene.programs.variables[i] = evaluate_load_variable(scene, variable)
        elif variable.is_point:
            point: PointMotion = locate_point(scene, variable.body, variable.q)
            if variable.is_rate:
                scene.programs.variables[i] = dot(variable.direction, point.v)
            else:
                scene.programs.variables[i] = dot(variable.direction, point.x) + variable.offset


def move_in_space(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """Find attitudes, joint points, velocities and velocity terms from the freedoms and the attitudes in y."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        set_joint_point(scene, body)
        if body.ball:
            offset: cython.Py_ssize_t = body.attitude_at
            body.R = rotation_matrix(read_quaternion(y, offset))
            offset = body.rate_at
            body.omega = read_vector(y, offset)
        else:
            set_orientation(scene, body)
        set_velocity_terms(body)


def set_joint_point(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Find the joint point, its velocity and its velocity terms, from the parent and the shifts of the joint.

    r = r_p + l,  v = v_p + omega_p x l + w,  a - a_p - alpha_p x l = omega_p x (omega_p x l + 2 w) + wdot, w = sum u s

    Along a path s = r' turns with the coordinate: wdot = udot r' + u^2 r''.
    """
    k: cython.Py_ssize_t
    sliding: Vec3 = Vec3(0.0, 0.0, 0.0)
    path_acceleration: Vec3 = sliding
    body.arm = world_direction(scene, body.parent, body.joint_in_parent)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.pieces:
            body.arm = add(body.arm, place_on_path(scene, body.parent, freedom))
            sliding = add_scaled(sliding, freedom.u, freedom.s)
            path_acceleration = add_scaled(
                add_scaled(path_acceleration, freedom.udot, freedom.s), freedom.u * freedom.u, freedom.curved
            )
        elif freedom.kind == SHIFT:
            freedom.s = world_direction(scene, body.parent, freedom.direction)
            body.arm = add_scaled(body.arm, freedom.q, freedom.s)
            sliding = add_scaled(sliding, freedom.u, freedom.s)
            path_acceleration = add_scaled(path_acceleration, freedom.udot, freedom.s)
    if body.parent < 0:
        body.r = body.arm
        body.v = sliding
        body.a_bias = path_acceleration
        return
    parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
    swept: Vec3 = cross(parent.omega, body.arm)
    body.r = add(parent.r, body.arm)
    body.v = add(add(parent.v, swept), sliding)
    body.a_bias = add(cross(parent.omega, add_scaled(swept, 2.0, sliding)), path_acceleration)


def set_orientation(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Find attitude and angular velocity of a body on single axes: turns in the parent, frame, turns in the body."""
    k: cython.Py_ssize_t
    body.alpha_bias = Vec3(0.0, 0.0, 0.0)
    if body.parent < 0:
        body.R = unit_matrix()
        body.omega = Vec3(0.0, 0.0, 0.0)
    else:
        parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
        body.R = parent.R
        body.omega = parent.omega
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_PARENT:
            apply_turn(body, cython.address(scene.freedoms[k]))
    if body.has_frame:
        body.R = product(body.R, body.frame)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_BODY:
            apply_turn(body, cython.address(scene.freedoms[k]))


def apply_turn(body: cython.pointer[Body], freedom: cython.pointer[Freedom]) -> cython.void:
    """Apply a turn about an axis s: alpha_bias += omega x s u + s udot, omega += s u, R <- R Rot."""
    freedom.s = rotate(body.R, freedom.direction)
    spin: Vec3 = scale_vector(freedom.u, freedom.s)
    body.alpha_bias = add(body.alpha_bias, add_scaled(cross(body.omega, spin), freedom.udot, freedom.s))
    body.omega = add(body.omega, spin)
    body.R = product(body.R, rotation(freedom.direction, freedom.q))


def set_velocity_terms(body: cython.pointer[Body]) -> cython.void:
    """Find inertia and first moment in world axes; omega x J omega and omega x (omega x m c), the bias h of (49)."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    body.mc = rotate(body.R, body.first_moment)
    body.A = rotate_tensor(body.R, body.inertia)
    body.gyroscopic = cross(body.omega, transform(body.A, body.omega))
    body.centrifugal = cross(body.omega, cross(body.omega, body.mc))
    body.M_applied = zero
    body.f_applied = zero


def locate_point(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> PointMotion:
    """Return place and velocity of a body's point, given from its joint point in its axes; a ground point is returned
    as it is.
    """
    if body < 0:
        return PointMotion(q, Vec3(0.0, 0.0, 0.0))
    carrier: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = rotate(carrier.R, q)
    return PointMotion(add(arm, carrier.r), add(cross(carrier.omega, arm), carrier.v))


def add_load_to_body(
    scene: cython.pointer[Scene], body: cython.int, place: Vec3, force: Vec3, moment: Vec3
) -> cython.void:
    """Add a force at a place, and a moment, to the applied loads of a body; the ground ignores them."""
    if body >= 0:
        target: cython.pointer[Body] = cython.address(scene.bodies[body])
        target.M_applied = add(target.M_applied, add_cross(moment, sub(place, target.r), force))
        target.f_applied = add(target.f_applied, force)
