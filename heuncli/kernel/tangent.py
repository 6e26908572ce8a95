"""The derivative of the motion along a direction of its state: exact, with the factors at the state.

    M V' - J' lambda = k,  J V' + gamma = 0              with V', lambda as they are at the state
    M dV' - J' dlambda = -d(M V' - J' lambda - k),   J dV' = -d(J V' + gamma)

The right sides are the changes of Newton's and Euler's balance of every branch, and of every closure row, along the
direction at the accelerations and multipliers of the state (tangent_motion, tangent_loads); the map on the left is that
of the state, factored once for all directions. A freedom's equation s . F = 0 changes by s . dF + ds . F, because its
direction turns. A ball's equation is M = 0 of its own body, in absolute angular velocities.

The Jacobian J = d(ydot)/dy has one direction of the state after the other. ydot is that of `evaluate`: the chosen
closure rows stay chosen, held branches of expressions stay held, and the four numbers of a ball joint's attitude are
varied one by one as they are.
"""

from __future__ import annotations

from heuncli.kernel.carried_points import body_omega
from heuncli.kernel.closures import apply_multipliers
from heuncli.kernel.declarations import *
from heuncli.kernel.orthogonal import solve_closures
from heuncli.kernel.response import evaluate, find_artificial_loads
from heuncli.kernel.strains import set_variable_slopes
from heuncli.kernel.tangent_friction import add_friction_tangent, find_joint_load_tangents
from heuncli.kernel.tangent_loads import add_closure_tangents, add_load_tangents, row_tangent
from heuncli.kernel.tangent_motion import differentiate_motion, omega_tangent, vector_tangent
from heuncli.kernel.tracks import track_speed_tangent
from heuncli.kernel.tree import balance_joints, project_on_freedom, push_artificial_load, sweep_down


def evaluate_base_state(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.int:
    """Evaluate and store the state from which directions are evaluated. Returns what `evaluate` returns."""
    i: cython.Py_ssize_t
    trouble: cython.int = evaluate(scene, t, y, dy)
    if not scene.has_drives:
        apply_multipliers(scene)
    for i in range(scene.artificial_count):
        if keeps_artificial_inertia(scene, i):
            inertia: cython.pointer[ArtificialInertia] = cython.address(scene.artificial_inertias[i])
            carrier: cython.pointer[Body] = cython.address(scene.bodies[inertia.body])
            carrier.M_applied = add_scaled(carrier.M_applied, -dot(inertia.n, carrier.alpha), inertia.n)
    balance_joints(scene, True)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        base: cython.pointer[BodyAtState] = cython.address(scene.state_values[i])
        base.inertia = rotate_tensor(body.R, body.inertia)
        base.alpha = body.alpha
        base.a = body.a
        base.M = body.M_joint
        base.f = body.f_joint
    for i in range(scene.freedom_count):
        scene.freedom_tangents[i].udot = scene.freedoms[i].udot
    for i in range(scene.closure_count):
        scene.multipliers[i] = scene.closures[i].multiplier
    return trouble


def keeps_artificial_inertia(scene: cython.pointer[Scene], j: cython.int) -> cython.bint:
    """Return whether an artificial inertia is not compensated, as nothing else resists its rotation
    (`factor_inertia_shares`).
    """
    return scene.own_inertia[scene.artificial_count * j + j] == 0.0


def differentiate_state(
    scene: cython.pointer[Scene], y: cython.p_double, direction: cython.p_double, result: cython.p_double
) -> cython.void:
    """Write the change of the state's time derivative along a direction, from the base state."""
    differentiate_motion(scene, y, direction)
    if scene.point_count:
        set_variable_slopes(scene)
    add_artificial_inertia_tangents(scene)
    power: cython.double = add_load_tangents(scene)
    add_closure_tangents(scene)
    add_branch_tangents(scene)
    solve_tangent(scene)
    if scene.friction_count:
        power += add_friction_tangent(scene)
        solve_tangent(scene)
    if scene.has_drives and scene.work_at >= 0:
        power += drive_power_tangent(scene)
    write_rate_tangents(scene, y, direction, result)
    if scene.work_at >= 0:
        result[scene.work_at] = power


def add_artificial_inertia_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Add the change of the moment n (n . alpha) of each artificial inertia that is not compensated; n turns with its
    body.
    """
    i: cython.Py_ssize_t
    for i in range(scene.artificial_count):
        inertia: cython.pointer[ArtificialInertia] = cython.address(scene.artificial_inertias[i])
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[inertia.body])
        if d.moves and keeps_artificial_inertia(scene, i):
            alpha: Vec3 = scene.state_values[inertia.body].alpha
            n: Vec3 = vector_tangent(scene, inertia.body, inertia.n)
            d.M = add_scaled(d.M, dot(inertia.n, alpha), n)
            d.M = add_scaled(d.M, dot(n, alpha) + dot(inertia.n, d.alpha), inertia.n)


def add_branch_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Find ds . F of every freedom; add the effect of the changing arms on the moments of the branches' loads."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if not scene.tangents[i].moves:
            continue
        base: cython.pointer[BodyAtState] = cython.address(scene.state_values[i])
        if body.parent >= 0:
            parent_tangent: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
            parent_tangent.M = add_cross(parent_tangent.M, scene.tangents[i].arm, base.f)
        for k in range(body.first_freedom, body.end_freedom):
            d: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[k])
            d.load = dot(d.s, base.f if scene.freedoms[k].kind == SHIFT else base.M)


def solve_tangent(scene: cython.pointer[Scene]) -> cython.void:
    """Find the accelerations and multipliers due to the change; artificial inertia has no effect on them."""
    i: cython.Py_ssize_t
    for i in range(scene.artificial_count):
        scene.artificial_inertias[i].z = 0.0
    solve_tangent_loads(scene)
    if scene.artificial_count:
        find_artificial_loads(scene)
        solve_tangent_loads(scene)


def solve_tangent_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Find the accelerations and multipliers due to the change, for given loads of the artificial inertia."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_branch = scene.tangents[i].M
        scene.bodies[i].f_branch = scene.tangents[i].f
    for i in range(scene.artificial_count):
        push_artificial_load(scene, cython.address(scene.artificial_inertias[i]))
    sweep_up_tangents(scene)
    if scene.selected_count:
        solve_closures(scene)
    sweep_down(scene, False)


def sweep_up_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """From M_branch, f_branch and ds . F find e, the loads on the freedoms; tips to roots."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            offset: cython.Py_ssize_t = body.velocity_at
            write_vector(scene.e, offset, scale_vector(-1.0, body.M_branch))
            body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            scene.e[freedom.velocity_at] = eliminate_tangent_load(body, freedom, scene.freedom_tangents[k].load)
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            moment: Vec3 = cross(body.arm, body.f_branch)
            if not body.ball:
                moment = add(moment, body.M_branch)
            parent.M_branch = add(parent.M_branch, moment)
            parent.f_branch = add(parent.f_branch, body.f_branch)


def eliminate_tangent_load(
    body: cython.pointer[Body], freedom: cython.pointer[Freedom], load: cython.double
) -> cython.double:
    """Return the load e = -s . dF - ds . F on a freedom; take its effect off the branch, as `eliminate_load` does."""
    if freedom.driven:
        return 0.0
    e: cython.double = -project_on_freedom(freedom, body.M_branch, body.f_branch) - load
    body.M_branch = add_scaled(body.M_branch, e * freedom.D, freedom.U_turn)
    body.f_branch = add_scaled(body.f_branch, e * freedom.D, freedom.U_shift)
    return e


def drive_power_tangent(scene: cython.pointer[Scene]) -> cython.double:
    """Return the change of the power of all drives: their rates are given, their loads change with the joints'."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    find_joint_load_tangents(scene)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            power += (freedom.drive + scene.freedom_tangents[i].load) * freedom.u
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.program.count:
            power += row.multiplier * row.prescribed_rate
    return power


def write_rate_tangents(
    scene: cython.pointer[Scene], y: cython.p_double, direction: cython.p_double, result: cython.p_double
) -> cython.void:
    """Write the changes of the derivatives of attitudes, coordinates, counted angles and rates."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            k = body.attitude_at
            q: Quaternion = quaternion_rate(read_quaternion(y, k), scene.tangents[i].omega)
            dq: Quaternion = quaternion_rate(read_quaternion(direction, k), body.omega)
            result[k] = q.w + dq.w
            result[k + 1] = q.x + dq.x
            result[k + 2] = q.y + dq.y
            result[k + 3] = q.z + dq.z
            k = body.rate_at
            write_vector(result, k, body.alpha)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            result[freedom.q_at] = scene.freedom_tangents[i].u
            result[freedom.u_at] = freedom.udot
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            result[counter.state_at] = track_speed_tangent(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = world_direction(scene, counter.a, counter.axis)
        change: Vec3 = sub(omega_tangent(scene, counter.b), omega_tangent(scene, counter.a))
        turn: Vec3 = sub(body_omega(scene, counter.b), body_omega(scene, counter.a))
        result[counter.state_at] = dot(n, change) + dot(vector_tangent(scene, counter.a, n), turn)


def find_jacobian(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, tangent: cython.pointer[Tangent]
) -> cython.void:
    """Write J to tangent.J and the derivative at the state to tangent.at; the accelerations are lost."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = tangent.n
    evaluate_base_state(scene, t, y, tangent.derivative)
    for j in range(n):
        scene.direction[j] = 0.0
        tangent.change[j] = 0.0
    for j in range(n):
        scene.direction[j] = 1.0
        differentiate_state(scene, y, scene.direction, tangent.change)
        scene.direction[j] = 0.0
        for i in range(n):
            tangent.J[n * i + j] = tangent.change[i]


def find_motions(
    scene: cython.pointer[Scene], y: cython.p_double, n: cython.Py_ssize_t, buffer: cython.p_double
) -> cython.void:
    """Write the changes of bodies and of the rates of closure rows, one direction of the base state after the other.

    Of each body turn, r, omega and v (of the joint point); then of each row its rate, 0 if it is not chosen.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    offset: cython.Py_ssize_t = 0
    for j in range(n):
        scene.direction[j] = 0.0
    for j in range(n):
        scene.direction[j] = 1.0
        differentiate_motion(scene, y, scene.direction)
        scene.direction[j] = 0.0
        for i in range(scene.body_count):
            d: cython.pointer[BodyTangent] = cython.address(scene.tangents[i])
            offset = write_vector(buffer, write_vector(buffer, offset, d.turn), d.r)
            offset = write_vector(buffer, write_vector(buffer, offset, d.omega), d.v)
        for i in range(scene.closure_count):
            buffer[offset + i] = 0.0
        for i in range(scene.selected_count):
            buffer[offset + scene.selected[i]] = row_tangent(
                scene, cython.address(scene.closures[scene.selected[i]])
            ).rate
        offset += scene.closure_count
