"""One configuration, many columns: what answers each load, each cause, each blow.

    M V + ... = loads + J' lambda,   J V + gamma = 0
The loads are affine in what is applied, in gravity, in the prescribed accelerations and in the velocity terms: so one
column a cause, which add up to the whole (manual/theory.md, "Shares by cause"). The jump of a blow (45)-(48) is one
more column: M dV = impulses + J' Lambda, J dV = -(jumps of what is prescribed), without gravity and velocity terms,
with the same factors.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import sqrt

    from heuncli.kernel.algebra import Vec3, add_scaled, scaled
    from heuncli.kernel.closures import measure_rows, residual_of, size_of_answer
    from heuncli.kernel.loads import pull_along
    from heuncli.kernel.orthogonal import answer_of_row, size_of_multipliers
    from heuncli.kernel.response import answer_applied, configure
    from heuncli.kernel.scene import APART, ROPE, SHIFT, Body, Closure, Freedom, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import kinematics, push


def put(out: cython.p_double, at: cython.Py_ssize_t, a: Vec3) -> cython.Py_ssize_t:
    """Write a vector; where the next one goes."""
    out[at] = a.x
    out[at + 1] = a.y
    out[at + 2] = a.z
    return at + 3


def put_column(
    scene: cython.pointer[Scene], out: cython.p_double, at: cython.Py_ssize_t, prescribed: cython.bint
) -> cython.Py_ssize_t:
    """What answers a column: bodies, freedoms, multipliers (tables.COLUMN_BODY, COLUMN_FREEDOM).

    prescribed: whether the accelerations of what is driven are part of the column.
    """
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        at = put(out, at, body.alpha)
        at = put(out, at, body.a)
        at = put(out, at, body.M_joint)
        at = put(out, at, body.f_joint)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        out[at] = freedom.udot if prescribed or not freedom.driven else 0.0
        out[at + 1] = freedom.drive if freedom.driven else 0.0
        at += 2
    for i in range(scene.closure_count):
        out[at] = scene.closures[i].multiplier
        at += 1
    return at


def apply_none(scene: cython.pointer[Scene]) -> cython.void:
    """No load on any body."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero


def answer_column(
    scene: cython.pointer[Scene], load: cython.p_double, out: cython.p_double, inertial: cython.bint
) -> cython.void:
    """What answers one column of loads (moment about the joint point, force; a body each)."""
    apply_column(scene, load)
    answer_applied(scene, inertial)
    put_column(scene, out, 0, inertial)


def apply_column(scene: cython.pointer[Scene], load: cython.p_double) -> cython.void:
    """Put a column of loads on the bodies."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = Vec3(load[6 * i], load[6 * i + 1], load[6 * i + 2])
        scene.bodies[i].f_applied = Vec3(load[6 * i + 3], load[6 * i + 4], load[6 * i + 5])


# Causes


def answer_causes(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, out: cython.p_double, at: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """A column a cause at a settled state: each load as it is there, then velocities, drives, gravity, each alone."""
    i: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    kinematics(scene, t, y)
    measure_rows(scene, t)
    configure(scene, t)
    for i in range(scene.load_count):
        apply_none(scene)
        apply_again(scene, cython.address(scene.loads[i]))
        answer_applied(scene, False)
        at = put_column(scene, out, at, False)
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    leave_prescribed(scene)
    apply_none(scene)
    answer_applied(scene, True)
    at = put_column(scene, out, at, False)
    stand_still(scene)
    prescribe(scene)
    apply_none(scene)
    answer_applied(scene, True)
    at = put_column(scene, out, at, True)
    scene.gravity = gravity
    stand_still(scene)
    apply_none(scene)
    answer_applied(scene, True)
    return put_column(scene, out, at, False)


def apply_again(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> cython.void:
    """Put a load on the bodies as it was found last; within one body it moves nothing."""
    if load.kind == ROPE:
        pull_along(scene, load)
        return
    if load.a == load.b:
        return
    push(scene, load.b, load.at, load.force, load.moment)
    push(scene, load.a, load.from_at, scaled(-1.0, load.force), scaled(-1.0, load.moment))


def leave_prescribed(scene: cython.pointer[Scene]) -> cython.void:
    """Take the prescribed accelerations out of what the velocities ask for."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            bias(scene, freedom, -freedom.udot)
    for i in range(scene.closure_count):
        scene.closures[i].gamma += scene.closures[i].prescribed_second


def prescribe(scene: cython.pointer[Scene]) -> cython.void:
    """Put in the prescribed accelerations, or jumps."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            bias(scene, freedom, freedom.udot)
    for i in range(scene.closure_count):
        scene.closures[i].gamma -= scene.closures[i].prescribed_second


def bias(scene: cython.pointer[Scene], freedom: cython.pointer[Freedom], udot: cython.double) -> cython.void:
    """Add an acceleration along a freedom to what its body has whatever the loads."""
    body: cython.pointer[Body] = cython.address(scene.bodies[freedom.body])
    if freedom.kind == SHIFT:
        body.a_bias = add_scaled(body.a_bias, udot, freedom.s)
    else:
        body.alpha_bias = add_scaled(body.alpha_bias, udot, freedom.s)


def stand_still(scene: cython.pointer[Scene]) -> cython.void:
    """As if nothing moved, nor were to: no velocities, no velocity terms, nothing prescribed."""
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


def answer_blow(
    scene: cython.pointer[Scene], load: cython.p_double, jumps: cython.p_double, out: cython.p_double
) -> cython.void:
    """The jump that answers impulses on the bodies and jumps of the prescribed rates, at factors already found.

    load: a column of impulses; jumps: of each freedom's rate, then of each closure row's (of what is driven). After
    the column: what of J dV = -jumps all rows leave unmet, of the terms it is the sum of.
    """
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t
    gravity: Vec3 = scene.gravity
    scene.gravity = Vec3(0.0, 0.0, 0.0)
    stand_still(scene)
    for i in range(scene.freedom_count):
        scene.freedoms[i].udot = jumps[i]
    for i in range(scene.closure_count):
        scene.closures[i].prescribed_second = jumps[scene.freedom_count + i]
    prescribe(scene)
    apply_column(scene, load)
    answer_applied(scene, True)
    at = put_column(scene, out, 0, True)
    # what stands still beside a row that jumps does so to the rounding of what holds it
    out[at] = unmet(scene, scene.load_size + size_of_multipliers(scene))
    scene.gravity = gravity


def measure_answers(scene: cython.pointer[Scene]) -> cython.void:
    """What the freedoms answer to the unit load of every row; the factors of the closures are lost."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        row.answer = sqrt(answer_of_row(scene, row))


def unmet(scene: cython.pointer[Scene], pushed: cython.double) -> cython.double:
    """The largest |J V + gamma| of all closed rows at the answer found, of the terms it is the sum of.

    pushed: what the freedoms would answer without these rows, in the measure of M.
    """
    r: cython.Py_ssize_t
    found: cython.double = 0.0
    residual: cython.double
    for r in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[r])
        size: cython.double = size_of_answer(scene, row) + row.answer * pushed
        residual = residual_of(scene, row) if row.mode != APART else 0.0
        if not residual <= found * size:
            found = residual / size
    return found
