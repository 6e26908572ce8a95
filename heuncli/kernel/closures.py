"""Loop closures on top of the tree: the conditions that closure rows put on the motion, and their unit loads.

    J Vdot + gamma = 0

Row r applies the force f at the point Q and the couple m to body b for lambda = 1, and the opposite at the same place
to a. Its column e_r, the response of the freedoms to that, comes from one upward pass along the two paths to the
ground.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.conditions import condition, condition_count, measure_condition, set_load_places
from heuncli.kernel.declarations import *
from heuncli.kernel.jets import jet
from heuncli.kernel.kinematics import add_load_to_body
from heuncli.kernel.plane_rows import zero_acceleration_in_plane
from heuncli.kernel.tracks import track_speed
from heuncli.kernel.tree import eliminate_load


def measure_rows(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Find unit load, gap, rate and gamma of every row at the present kinematics."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        measure_row(scene, cython.address(scene.closures[r]), t)


def measure_moving_rows(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Find unit load, gap, rate and gamma of the rows that the freedoms can change; the others were measured before.

    In a planar scene those others are the rows that constrain motion out of the plane: their gaps are constant, their
    rates zero.
    """
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        if scene.flat and row.kind != TURN and row.kind != SUM and (row.e.z != 0.0 or row.g.z != 0.0):
            continue
        measure_row(scene, row, t)


def measure_row(scene: cython.pointer[Scene], row: cython.pointer[Closure], t: cython.double) -> cython.void:
    """Find unit load (f, m at Q), gap, rate and gamma of one row, minus the prescribed motion of its length."""
    if row.kind == SUM:
        measure_sum(scene, row)
    else:
        measure_condition(scene, row)
    row.prescribed_rate, row.prescribed_second = 0.0, 0.0  # a blow has left its jumps there
    if row.program.count:
        length: Jet = jet(scene.programs, row.program, t)
        row.gap -= length.value
        row.rate -= length.rate
        row.gamma -= length.second
        row.prescribed_rate = length.rate
        row.prescribed_second = length.second


def measure_sum(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Measure a row that is a sum of conditions: sum their gaps, rates, gammas and unit loads."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    row.f, row.m = zero, zero
    row.gap, row.rate, row.gamma = -row.length, 0.0, 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        measure_condition(scene, part)
        set_load_places(scene, part)
        row.gap += part.factor * part.gap
        row.rate += part.factor * part.rate
        row.gamma += part.factor * part.gamma
        row.f = add_scaled(row.f, part.factor, part.f)
        row.m = add_scaled(row.m, part.factor, part.m)
    row.Q = scene.parts[row.part].Q


def required_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return gamma + J Vdot of a row if no freedom accelerated: what the freedoms must compensate."""
    i: cython.Py_ssize_t
    total: cython.double = row.gamma
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        total += part.factor * zero_acceleration(scene, part)
    return total


def zero_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return J Vdot of a condition between two bodies if no freedom accelerated."""
    if scene.flat:
        return zero_acceleration_in_plane(scene, row)
    total: cython.double = 0.0
    if row.b >= 0:
        total += project_on_row(row, scene.bodies[row.b].r, scene.bodies[row.b].a_zero, scene.bodies[row.b].alpha_zero)
    if row.a >= 0:
        total -= project_on_row(row, scene.bodies[row.a].r, scene.bodies[row.a].a_zero, scene.bodies[row.a].alpha_zero)
    return total


def project_on_row(row: cython.pointer[Closure], r: Vec3, a: Vec3, alpha: Vec3) -> cython.double:
    """f . (a + alpha x (Q - r)) + m . alpha."""
    return dot(row.f, add_cross(a, alpha, sub(row.Q, r))) + dot(row.m, alpha)


def row_residual(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return |J Vdot + gamma| of a row at the accelerations found."""
    return fabs(row_acceleration(scene, row))


def row_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return J Vdot + gamma of a row at the accelerations found, which exclude gravity; so does the ground's."""
    return row.gamma + row_motion(scene, row, -1.0)


def row_motion(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], gravity_factor: cython.double
) -> cython.double:
    """Return J Vdot of a row for the values in alpha and a; gravity_factor: the ground's acceleration in units of
    gravity.
    """
    i: cython.Py_ssize_t
    total: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        total += part.factor * condition_motion(scene, part, gravity_factor)
    return total


def condition_motion(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], gravity_factor: cython.double
) -> cython.double:
    """Return J Vdot of a condition between two bodies."""
    b: cython.double = gravity_factor * dot(row.f, scene.gravity)
    a: cython.double = b
    if row.b >= 0:
        b = project_on_row(row, scene.bodies[row.b].r, scene.bodies[row.b].a, scene.bodies[row.b].alpha)
    if row.a >= 0:
        a = project_on_row(row, scene.bodies[row.a].r, scene.bodies[row.a].a, scene.bodies[row.a].alpha)
    return b - a


def size_of_required_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of `required_acceleration`."""
    i: cython.Py_ssize_t
    total: cython.double = fabs(row.gamma)
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        total += fabs(part.factor) * size_of_zero_acceleration(scene, part)
    return total


def size_of_zero_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of `zero_acceleration`."""
    total: cython.double = 0.0
    if row.b >= 0:
        b: cython.pointer[Body] = cython.address(scene.bodies[row.b])
        total += size_of_terms(b, row, b.a_zero, b.alpha_zero)
    if row.a >= 0:
        a: cython.pointer[Body] = cython.address(scene.bodies[row.a])
        total += size_of_terms(a, row, a.a_zero, a.alpha_zero)
    return total


def size_of_row_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of `row_acceleration`."""
    i: cython.Py_ssize_t
    total: cython.double = fabs(row.gamma)
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        total += fabs(part.factor) * size_of_condition_motion(scene, part)
    return total


def size_of_condition_motion(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of `condition_motion`."""
    total: cython.double = 0.0
    if row.b >= 0:
        b: cython.pointer[Body] = cython.address(scene.bodies[row.b])
        total += size_of_terms(b, row, b.a, b.alpha)
    if row.a >= 0:
        a: cython.pointer[Body] = cython.address(scene.bodies[row.a])
        total += size_of_terms(a, row, a.a, a.alpha)
    return total


def size_of_row_rate(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of the rate of a row."""
    i: cython.Py_ssize_t
    total: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        if part.b >= 0:
            b: cython.pointer[Body] = cython.address(scene.bodies[part.b])
            total += fabs(part.factor) * size_of_power(b, part, norm(b.v), norm(b.omega))
        if part.a >= 0:
            a: cython.pointer[Body] = cython.address(scene.bodies[part.a])
            total += fabs(part.factor) * size_of_power(a, part, norm(a.v), norm(a.omega))
    return total


def size_of_row_gap(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return the size of the terms of the gap of a row; what lies on a sheave has no point of its own."""
    i: cython.Py_ssize_t
    extent: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        if part.kind != ARC and part.kind != WOUND:
            extent += scene.size + norm(part.Q)
    return extent / row.weight + fabs(row.length)


def size_of_terms(body: cython.pointer[Body], row: cython.pointer[Closure], a: Vec3, alpha: Vec3) -> cython.double:
    """|f| (|a| + (|alpha| + omega^2) |Q - r|) + |m| (|alpha| + omega^2)."""
    return size_of_power(body, row, norm(a), norm(alpha) + dot(body.omega, body.omega))


def size_of_power(
    body: cython.pointer[Body], row: cython.pointer[Closure], shift: cython.double, turn: cython.double
) -> cython.double:
    """|f| (shift + turn |Q - r|) + |m| turn."""
    return norm(row.f) * (shift + turn * norm(sub(row.Q, body.r))) + norm(row.m) * turn


def add_unit_load(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.void:
    """Add the row's load for lambda = sign on one of its bodies to M_branch and f_branch, about the joint point."""
    if body >= 0:
        target: cython.pointer[Body] = cython.address(scene.bodies[body])
        target.M_branch = add_scaled(target.M_branch, -sign, add_cross(row.m, sub(row.Q, target.r), row.f))
        target.f_branch = add_scaled(target.f_branch, -sign, row.f)


def add_unit_loads(scene: cython.pointer[Scene], row: cython.pointer[Closure], sign: cython.double) -> cython.void:
    """Add the row's load for lambda = sign on all its bodies."""
    i: cython.Py_ssize_t
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        add_unit_load(scene, part, part.b, sign * part.factor)
        add_unit_load(scene, part, part.a, -sign * part.factor)


def clear_path(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Set the unit loads on the row's path to zero."""
    n: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        body.M_branch = zero
        body.f_branch = zero


def build_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Compute e_r: the response of the freedoms of the row's paths to its unit load, from the factored inertias."""
    clear_path(scene, row)
    add_unit_loads(scene, row, 1.0)
    sweep_column(scene, row)


def sweep_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Pass the loads in M_branch and f_branch up along the row's paths, tips first, and write the column."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t = row.column
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            write_vector(scene.columns, offset, scale_vector(-1.0, body.M_branch))
            offset += 3
            body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
            body.M_branch = Vec3(0.0, 0.0, 0.0)
        for k in range(body.first_freedom, body.end_freedom):
            scene.columns[offset] = eliminate_load(body, cython.address(scene.freedoms[k]))
            offset += 1
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_branch = add(parent.M_branch, add_cross(body.M_branch, body.arm, body.f_branch))
            parent.f_branch = add(parent.f_branch, body.f_branch)


def apply_multipliers(scene: cython.pointer[Scene]) -> cython.void:
    """Add the multipliers' forces and couples to the applied loads on the bodies."""
    r: cython.Py_ssize_t
    i: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        for i in range(condition_count(row)):
            part: cython.pointer[Closure] = condition(scene, row, i)
            apply_condition_load(scene, part, row.multiplier * part.factor)


def apply_condition_load(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], multiplier: cython.double
) -> cython.void:
    """Apply the load of a condition to its two bodies."""
    add_load_to_body(scene, row.b, row.Q, scale_vector(multiplier, row.f), scale_vector(multiplier, row.m))
    add_load_to_body(scene, row.a, row.Q, scale_vector(-multiplier, row.f), scale_vector(-multiplier, row.m))


def find_counter_rates(scene: cython.pointer[Scene], dy: cython.p_double) -> cython.void:
    """Find the rates of the counted angles outside the tree (pins that were cut), n . (omega_b - omega_a), and of
    positions on tracks.
    """
    i: cython.Py_ssize_t
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            dy[counter.state_at] = track_speed(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = counter.axis if scene.flat else world_direction(scene, counter.a, counter.axis)
        dy[counter.state_at] = 0.0
        if counter.b >= 0:
            dy[counter.state_at] += dot(n, scene.bodies[counter.b].omega)
        if counter.a >= 0:
            dy[counter.state_at] -= dot(n, scene.bodies[counter.a].omega)
