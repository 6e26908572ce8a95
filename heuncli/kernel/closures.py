"""Closed chains on top of the sweep: the rows that the closures ask of the motion, and their unit loads.

    J Vdot + gamma = 0
Row r puts the force f at the point Q and the couple m on body b for lambda = 1, and the opposite at the same place on
a; its column e_r, what the freedoms answer to that, comes from one upward pass along the two paths to the ground.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import (
        Vec3,
        add,
        add_cross,
        add_scaled,
        dot,
        norm,
        rotate_back,
        scaled,
        sub,
    )
    from heuncli.kernel.conditions import condition, condition_count, enter, measure_condition
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.jets import jet
    from heuncli.kernel.plane_rows import demanded_in_plane
    from heuncli.kernel.programs import Jet
    from heuncli.kernel.scene import SUM, TURN, Body, Closure, Counter, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tracks import pace_of
    from heuncli.kernel.tree import answered, push


def measure_rows(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Unit load, gap, rate and gamma of every row at the present kinematics."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        measure_row(scene, cython.address(scene.closures[r]), t)


def measure_moving_rows(scene: cython.pointer[Scene], t: cython.double) -> cython.void:
    """Unit load, gap, rate and gamma of the rows that the freedoms can change; all others were measured before.

    Those are, in a flat scene, the rows that hold what stands across it: their gaps stay, their rates are zero.
    """
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        if scene.flat and row.kind != TURN and row.kind != SUM and (row.e.z != 0.0 or row.g.z != 0.0):
            continue
        measure_row(scene, row, t)


def measure_row(scene: cython.pointer[Scene], row: cython.pointer[Closure], t: cython.double) -> cython.void:
    """Unit load (f, m at Q), gap, rate and gamma of one row, less what is prescribed of its length."""
    if row.kind == SUM:
        measure_sum(scene, row)
    else:
        measure_condition(scene, row)
    row.prescribed_rate, row.prescribed_second = 0.0, 0.0  # a blow has left its jumps there
    if row.program.count:
        given: Jet = jet(scene.programs, row.program, t)
        row.gap -= given.value
        row.rate -= given.rate
        row.gamma -= given.second
        row.prescribed_rate = given.rate
        row.prescribed_second = given.second


def measure_sum(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """A row that is a sum of conditions: their gaps, rates and gammas, and the sums of their unit loads."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    row.f, row.m = zero, zero
    row.gap, row.rate, row.gamma = -row.length, 0.0, 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        measure_condition(scene, part)
        enter(scene, part)
        row.gap += part.factor * part.gap
        row.rate += part.factor * part.rate
        row.gamma += part.factor * part.gamma
        row.f = add_scaled(row.f, part.factor, part.f)
        row.m = add_scaled(row.m, part.factor, part.m)
    row.Q = scene.parts[row.part].Q


def demanded(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """gamma + J Vdot of a row if no freedom accelerated: what the freedoms have to answer."""
    i: cython.Py_ssize_t
    found: cython.double = row.gamma
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        found += part.factor * zero_acceleration(scene, part)
    return found


def zero_acceleration(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """J Vdot of a condition of two bodies if no freedom accelerated."""
    if scene.flat:
        return demanded_in_plane(scene, row)
    found: cython.double = 0.0
    if row.b >= 0:
        found += along_row(row, scene.bodies[row.b].r, scene.bodies[row.b].a_zero, scene.bodies[row.b].alpha_zero)
    if row.a >= 0:
        found -= along_row(row, scene.bodies[row.a].r, scene.bodies[row.a].a_zero, scene.bodies[row.a].alpha_zero)
    return found


def along_row(row: cython.pointer[Closure], r: Vec3, a: Vec3, alpha: Vec3) -> cython.double:
    """f . (a + alpha x (Q - r)) + m . alpha."""
    return dot(row.f, add_cross(a, alpha, sub(row.Q, r))) + dot(row.m, alpha)


def residual_of(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """|J Vdot + gamma| of a row at the accelerations found."""
    return fabs(acceleration_of(scene, row))


def acceleration_of(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """J Vdot + gamma of a row at the accelerations found, which are less that of gravity, the ground's too."""
    return row.gamma + moved_by(scene, row, -1.0)


def moved_by(scene: cython.pointer[Scene], row: cython.pointer[Closure], ground: cython.double) -> cython.double:
    """J Vdot of a row at what stands in alpha and a; ground: how many times gravity the ground's is."""
    i: cython.Py_ssize_t
    found: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        found += part.factor * moved_apart(scene, part, ground)
    return found


def moved_apart(scene: cython.pointer[Scene], row: cython.pointer[Closure], ground: cython.double) -> cython.double:
    """The same of a condition of two bodies."""
    b: cython.double = ground * dot(row.f, scene.gravity)
    a: cython.double = b
    if row.b >= 0:
        b = along_row(row, scene.bodies[row.b].r, scene.bodies[row.b].a, scene.bodies[row.b].alpha)
    if row.a >= 0:
        a = along_row(row, scene.bodies[row.a].r, scene.bodies[row.a].a, scene.bodies[row.a].alpha)
    return b - a


def size_of_demand(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Size of the terms of `demanded`."""
    i: cython.Py_ssize_t
    found: cython.double = fabs(row.gamma)
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        found += fabs(part.factor) * size_if_zero(scene, part)
    return found


def size_if_zero(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Size of the terms of `zero_acceleration`."""
    found: cython.double = 0.0
    if row.b >= 0:
        b: cython.pointer[Body] = cython.address(scene.bodies[row.b])
        found += size_of_terms(b, row, b.a_zero, b.alpha_zero)
    if row.a >= 0:
        a: cython.pointer[Body] = cython.address(scene.bodies[row.a])
        found += size_of_terms(a, row, a.a_zero, a.alpha_zero)
    return found


def size_of_answer(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Size of the terms of `residual_of`."""
    i: cython.Py_ssize_t
    found: cython.double = fabs(row.gamma)
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        found += fabs(part.factor) * size_moved(scene, part)
    return found


def size_moved(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Size of the terms of `moved_apart`."""
    found: cython.double = 0.0
    if row.b >= 0:
        b: cython.pointer[Body] = cython.address(scene.bodies[row.b])
        found += size_of_terms(b, row, b.a, b.alpha)
    if row.a >= 0:
        a: cython.pointer[Body] = cython.address(scene.bodies[row.a])
        found += size_of_terms(a, row, a.a, a.alpha)
    return found


def size_of_terms(body: cython.pointer[Body], row: cython.pointer[Closure], a: Vec3, alpha: Vec3) -> cython.double:
    """|f| (|a| + (|alpha| + omega^2) |Q - r|) + |m| (|alpha| + omega^2)."""
    turn: cython.double = norm(alpha) + dot(body.omega, body.omega)
    return norm(row.f) * (norm(a) + turn * norm(sub(row.Q, body.r))) + norm(row.m) * turn


def put_unit_load(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.void:
    """The row's load for lambda = sign on one of its bodies, as M_branch and f_branch about the joint point."""
    if body >= 0:
        on: cython.pointer[Body] = cython.address(scene.bodies[body])
        on.M_branch = add_scaled(on.M_branch, -sign, add_cross(row.m, sub(row.Q, on.r), row.f))
        on.f_branch = add_scaled(on.f_branch, -sign, row.f)


def put_unit_loads(scene: cython.pointer[Scene], row: cython.pointer[Closure], sign: cython.double) -> cython.void:
    """The row's load for lambda = sign on all its bodies."""
    i: cython.Py_ssize_t
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        put_unit_load(scene, part, part.b, sign * part.factor)
        put_unit_load(scene, part, part.a, -sign * part.factor)


def clear_path(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """No unit load on the row's path."""
    n: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        body.M_branch = zero
        body.f_branch = zero


def build_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """e_r: what the freedoms of the row's paths answer to its unit load, by the factored inertias."""
    clear_path(scene, row)
    put_unit_loads(scene, row, 1.0)
    sweep_column(scene, row)


def sweep_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """One upward pass of what stands in M_branch and f_branch along the row's paths, tips first."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = row.column
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            scene.columns[at] = -body.M_branch.x
            scene.columns[at + 1] = -body.M_branch.y
            scene.columns[at + 2] = -body.M_branch.z
            at += 3
            body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
            body.M_branch = Vec3(0.0, 0.0, 0.0)
        for k in range(body.first_freedom, body.end_freedom):
            scene.columns[at] = answered(body, cython.address(scene.freedoms[k]))
            at += 1
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_branch = add(parent.M_branch, add_cross(body.M_branch, body.arm, body.f_branch))
            parent.f_branch = add(parent.f_branch, body.f_branch)


def push_closures(scene: cython.pointer[Scene]) -> cython.void:
    """Put the multipliers' forces and couples on the bodies, beside the applied loads."""
    r: cython.Py_ssize_t
    i: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        for i in range(condition_count(row)):
            part: cython.pointer[Closure] = condition(scene, row, i)
            push_condition(scene, part, row.multiplier * part.factor)


def push_condition(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], multiplier: cython.double
) -> cython.void:
    """Put the load of a condition of two bodies on them."""
    push(scene, row.b, row.Q, scaled(multiplier, row.f), scaled(multiplier, row.m))
    push(scene, row.a, row.Q, scaled(-multiplier, row.f), scaled(-multiplier, row.m))


def count_turns(scene: cython.pointer[Scene], dy: cython.p_double) -> cython.void:
    """Rates of the angles that are counted beside the tree (pins that were cut): n . (omega_b - omega_a); of places."""
    i: cython.Py_ssize_t
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            dy[counter.at] = pace_of(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = counter.axis if scene.flat else direction_of(scene, counter.a, counter.axis)
        dy[counter.at] = 0.0
        if counter.b >= 0:
            dy[counter.at] += dot(n, scene.bodies[counter.b].omega)
        if counter.a >= 0:
            dy[counter.at] -= dot(n, scene.bodies[counter.a].omega)
