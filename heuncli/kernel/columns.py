"""One configuration, many right-hand sides: the response to each load, each cause, each impulse.

    M V + ... = loads + J' lambda,   J V + gamma = 0

The loads are affine in the applied loads, gravity, the prescribed accelerations and the velocity terms. So there is one
column for each cause, and the columns add up to the whole (manual/theory.md, "Shares by cause"). The jump due to an
impulse (45)-(48) is one more column: M dV = impulses + J' Lambda, J dV = -(jumps of prescribed rates), without gravity
and velocity terms, with the same factors.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.closures import measure_rows, row_residual, size_of_row_acceleration
from heuncli.kernel.declarations import *
from heuncli.kernel.kinematics import add_load_to_body, update_kinematics
from heuncli.kernel.loads import apply_rope_pull
from heuncli.kernel.orthogonal import response_of_row, size_of_multipliers
from heuncli.kernel.response import configure, solve_applied


def write_column(
    scene: cython.pointer[Scene], buffer: cython.p_double, offset: cython.Py_ssize_t, with_drives: cython.bint
) -> cython.Py_ssize_t:
    """Write the response to a column: bodies, freedoms, multipliers (tables.COLUMN_BODY, COLUMN_FREEDOM).

    with_drives: whether the accelerations of driven freedoms are part of the column.
    """
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        offset = write_vector(buffer, offset, body.alpha)
        offset = write_vector(buffer, offset, body.a)
        offset = write_vector(buffer, offset, body.M_joint)
        offset = write_vector(buffer, offset, body.f_joint)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        offset = write_number(buffer, offset, freedom.udot if with_drives or not freedom.driven else 0.0)
        offset = write_number(buffer, offset, freedom.drive if freedom.driven else 0.0)
    for i in range(scene.closure_count):
        offset = write_number(buffer, offset, scene.closures[i].multiplier)
    return offset


def clear_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Set the applied loads of all bodies to zero."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero


def solve_column(
    scene: cython.pointer[Scene], load: cython.p_double, buffer: cython.p_double, inertial: cython.bint
) -> cython.void:
    """Solve for one column of loads (moment about the joint point, force; per body) and write the response."""
    apply_column(scene, load)
    solve_applied(scene, inertial)
    write_column(scene, buffer, 0, inertial)


def apply_column(scene: cython.pointer[Scene], load: cython.p_double) -> cython.void:
    """Apply a column of loads to the bodies."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = read_vector(load, 6 * i)
        scene.bodies[i].f_applied = read_vector(load, 6 * i + 3)


# Causes


def solve_causes(
    scene: cython.pointer[Scene],
    t: cython.double,
    y: cython.p_double,
    buffer: cython.p_double,
    offset: cython.Py_ssize_t,
) -> cython.Py_ssize_t:
    """Write one column for each cause at a projected state: each load as it is there, then velocities, drives and
    gravity, each alone.
    """
    i: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    update_kinematics(scene, t, y)
    measure_rows(scene, t)
    configure(scene, t)
    for i in range(scene.load_count):
        clear_loads(scene)
        reapply_load(scene, cython.address(scene.loads[i]))
        solve_applied(scene, False)
        offset = write_column(scene, buffer, offset, False)
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    remove_prescribed(scene)
    clear_loads(scene)
    solve_applied(scene, True)
    offset = write_column(scene, buffer, offset, False)
    clear_motion(scene)
    add_prescribed(scene)
    clear_loads(scene)
    solve_applied(scene, True)
    offset = write_column(scene, buffer, offset, True)
    scene.gravity = gravity
    clear_motion(scene)
    clear_loads(scene)
    solve_applied(scene, True)
    return write_column(scene, buffer, offset, False)


def reapply_load(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.void:
    """Apply a load to the bodies with its last value; a load within one body moves nothing."""
    if load.kind == ROPE:
        apply_rope_pull(scene, load)
        return
    if load.a == load.b:
        return
    add_load_to_body(scene, load.b, load.place, load.force, load.moment)
    add_load_to_body(scene, load.a, load.place_on_a, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))


def remove_prescribed(scene: cython.pointer[Scene]) -> cython.void:
    """Remove the prescribed accelerations from the velocity terms."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            add_bias(scene, freedom, -freedom.udot)
    for i in range(scene.closure_count):
        scene.closures[i].gamma += scene.closures[i].prescribed_second


def add_prescribed(scene: cython.pointer[Scene]) -> cython.void:
    """Add the prescribed accelerations, or jumps."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            add_bias(scene, freedom, freedom.udot)
    for i in range(scene.closure_count):
        scene.closures[i].gamma -= scene.closures[i].prescribed_second


def add_bias(scene: cython.pointer[Scene], freedom: cython.pointer[Freedom], udot: cython.double) -> cython.void:
    """Add an acceleration along a freedom to its body's acceleration that does not depend on the loads."""
    body: cython.pointer[Body] = cython.address(scene.bodies[freedom.body])
    if freedom.kind == SHIFT:
        body.a_bias = add_scaled(body.a_bias, udot, freedom.s)
    else:
        body.alpha_bias = add_scaled(body.alpha_bias, udot, freedom.s)


def clear_motion(scene: cython.pointer[Scene]) -> cython.void:
    """Set velocities, velocity terms and prescribed accelerations to zero."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.omega = zero
        body.v = zero
        body.alpha_bias = zero
        body.a_bias = zero
        body.gyroscopic = zero
        body.centrifugal = zero
    for i in range(scene.closure_count):
        scene.closures[i].gamma = 0.0


# Blows


def solve_impulse(
    scene: cython.pointer[Scene], load: cython.p_double, jumps: cython.p_double, buffer: cython.p_double
) -> cython.void:
    """Solve for the jump due to impulses on the bodies and jumps of the prescribed rates, with factors already found.

    load: a column of impulses
    jumps: of each freedom's rate, then of each closure row's (of what is driven)

    After the column stands the part of J dV = -jumps that the rows leave unmet, relative to the size of its terms.
    """
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    clear_motion(scene)
    for i in range(scene.freedom_count):
        scene.freedoms[i].udot = jumps[i]
    for i in range(scene.closure_count):
        scene.closures[i].prescribed_second = jumps[scene.freedom_count + i]
    add_prescribed(scene)
    apply_column(scene, load)
    solve_applied(scene, True)
    offset = write_column(scene, buffer, 0, True)
    # next to a row that jumps, rates of the other rows are zero only to the rounding of their reactions
    buffer[offset] = largest_relative_residual(scene, scene.load_size + size_of_multipliers(scene))
    scene.gravity = gravity


def measure_row_responses(scene: cython.pointer[Scene]) -> cython.void:
    """Find the size of the freedoms' response to the unit load of every row; the factors of the closures are lost."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        row.response_size = sqrt(response_of_row(scene, row))


def largest_relative_residual(scene: cython.pointer[Scene], load_response: cython.double) -> cython.double:
    """Return the largest |J V + gamma| of all rows that must stay closed at the solution, relative to its terms.

    load_response: size of the freedoms' response without these rows, in the norm of M
    """
    r: cython.Py_ssize_t
    largest: cython.double = 0.0
    residual: cython.double
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        size: cython.double = size_of_row_acceleration(scene, row) + row.response_size * load_response
        residual = row_residual(scene, row) if row.mode == CARRIES else 0.0
        if not residual <= largest * size:
            largest = residual / size
    return largest
