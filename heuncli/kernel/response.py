"""The one linear map: at a configuration the tree and the closures are factored once, then any load can be solved for.

    configure       factors of tree and closures at the present kinematics: no loads
    solve_response  loads on the bodies -> accelerations and multipliers; inertial: with velocity terms, drives, gravity

Accelerations (49), velocity jumps (48), projection onto the closures and single columns of loads
(heuncli/multibody/response.py) are all results of this map: M V + ... = loads + J' lambda, J V + gamma = 0.
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.closures import (
    apply_multipliers,
    find_counter_rates,
    measure_moving_rows,
    measure_row,
    required_acceleration,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.joint_friction import (
    apply_friction,
    apply_unit_friction,
    find_normal_forces,
    record_contact_forces,
    restore_applied_loads,
    store_applied_loads,
)
from heuncli.kernel.kinematics import update_kinematics
from heuncli.kernel.loads import apply_loads
from heuncli.kernel.orthogonal import factor_closures, solve_closures
from heuncli.kernel.tree import (
    add_zero_accelerations,
    balance_joints,
    factor_tree,
    factor_with_loads,
    push_artificial_load,
    set_branch_loads,
    set_full_branch_loads,
    sweep_down,
    sweep_up,
    write_derivative,
)


def configure(scene: cython.pointer[Scene], t: cython.double) -> cython.int:
    """Factor the tree, the closures and the artificial inertia. Returns how many freedoms have no inertia behind them,
    or -1 for lost closures.
    """
    i: cython.Py_ssize_t
    massless: cython.int = factor_tree(scene)
    if scene.selected_count:
        for i in range(scene.selected_count):
            measure_row(scene, cython.address(scene.closures[scene.selected[i]]), t)
        scene.pivot = factor_closures(scene)
        if scene.pivot < scene.pivot_of_step:
            scene.pivot_of_step = scene.pivot
        if scene.pivot < 0.0:
            return -1
    if scene.artificial_count:
        massless += factor_inertia_shares(scene)
        if scene.limits.own_share < scene.own_share < scene.limits.much_artificial:
            reduce_artificial_inertia(scene)
    return massless


def solve_response(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Find the accelerations and multipliers for the loads on the bodies; artificial inertia has no effect on them.

    With closures, loads and the rows' demands from the kinematics are kept separate: the response to loads is then as
    exact as the geometry (orthogonal.py).
    """
    i: cython.Py_ssize_t
    separate: cython.bint = inertial and scene.selected_count > 0
    for i in range(scene.artificial_count):
        scene.artificial_inertias[i].z = 0.0
    solve_loads(scene, inertial, separate)
    if scene.artificial_count:
        find_artificial_loads(scene)
        solve_loads(scene, inertial, separate)
    if separate:
        add_zero_accelerations(scene)


def solve_loads(scene: cython.pointer[Scene], inertial: cython.bint, separate: cython.bint) -> cython.void:
    """Find the response for given loads of the artificial inertia; separate: minus the accelerations if no freedom
    accelerated.
    """
    i: cython.Py_ssize_t
    if separate:
        set_full_branch_loads(scene)
    else:
        set_branch_loads(scene, inertial)
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        row.demand = required_acceleration(scene, row) if separate else 0.0
    solve_branch_loads(scene, inertial and not separate)


def solve_branch_loads(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Find the accelerations and multipliers for M_branch, f_branch and the rows' demands."""
    sweep_up(scene, inertial)
    scene.load_size = 0.0
    if scene.selected_count:
        solve_closures(scene)
    sweep_down(scene, inertial)


def factor_inertia_shares(scene: cython.pointer[Scene]) -> cython.int:
    """Factor 1 - T (Cholesky), T_ij = n_i . alpha of the response to n_j alone. Returns how many motions nothing
    resists.

    Artificial inertia takes z = n . alpha of the loads. Applied again as loads of their own they give z = z_0 + T z,
    where z_0 is the result of the loads alone: so the solution is that of the bodies as they are, for any artificial
    inertia. The eigenvalues of 1 - T are the shares of the bodies' own inertia in the motions; where nothing can move
    they are 1.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.artificial_count
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    unheld: cython.int = 0
    x: cython.double
    scene.own_share = 1.0
    for i in range(scene.closure_count):
        scene.closures[i].demand = 0.0
    for j in range(n):
        for i in range(scene.body_count):
            scene.bodies[i].M_branch = zero
            scene.bodies[i].f_branch = zero
        scene.artificial_inertias[j].z = 1.0
        push_artificial_load(scene, cython.address(scene.artificial_inertias[j]))
        solve_branch_loads(scene, False)
        for i in range(j, n):
            scene.own_inertia[n * i + j] = (1.0 if i == j else 0.0) - artificial_acceleration(
                scene, cython.address(scene.artificial_inertias[i])
            )
    for j in range(n):
        x = eliminate_share_column(scene, j)
        if x < scene.own_share:
            scene.own_share = x
        unheld += x <= scene.limits.own_share
    return unheld


def reduce_artificial_inertia(scene: cython.pointer[Scene]) -> cython.void:
    """Factor again with so much less artificial inertia that 1 - T loses half as many digits; share and pivot stay."""
    i: cython.Py_ssize_t
    share: cython.double = scene.own_share
    pivot: cython.double = scene.pivot
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.A = rotate_tensor(body.R, body.inertia)
    scene.artificial_part = sqrt(sqrt(share))
    factor_tree(scene)
    if scene.selected_count:
        factor_closures(scene)
    factor_inertia_shares(scene)
    scene.artificial_part = 1.0
    scene.own_share = share
    scene.pivot = pivot


def artificial_acceleration(scene: cython.pointer[Scene], inertia: cython.pointer[ArtificialInertia]) -> cython.double:
    """n . alpha at the accelerations found."""
    return dot(inertia.n, scene.bodies[inertia.body].alpha)


def eliminate_share_column(scene: cython.pointer[Scene], j: cython.Py_ssize_t) -> cython.double:
    """Find column j of the Cholesky factor of 1 - T (diagonal inverted, zero if next to nothing is left). Returns its
    pivot.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.artificial_count
    x: cython.double
    pivot: cython.double = scene.own_inertia[n * j + j]
    for k in range(j):
        pivot -= scene.own_inertia[n * j + k] * scene.own_inertia[n * j + k]
    scene.own_inertia[n * j + j] = 1.0 / sqrt(pivot) if pivot > scene.limits.own_share else 0.0
    for i in range(j + 1, n):
        x = scene.own_inertia[n * i + j]
        for k in range(j):
            x -= scene.own_inertia[n * i + k] * scene.own_inertia[n * j + k]
        scene.own_inertia[n * i + j] = x * scene.own_inertia[n * j + j]
    return pivot


def find_artificial_loads(scene: cython.pointer[Scene]) -> cython.void:
    """z = (1 - T)^-1 z_0 from the accelerations due to the loads alone."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.artificial_count
    z: cython.double
    for i in range(n):
        z = artificial_acceleration(scene, cython.address(scene.artificial_inertias[i]))
        for k in range(i):
            z -= scene.own_inertia[n * i + k] * scene.artificial_inertias[k].z
        scene.artificial_inertias[i].z = z * scene.own_inertia[n * i + i]
    for i in range(n - 1, -1, -1):
        z = scene.artificial_inertias[i].z
        for k in range(i + 1, n):
            z -= scene.own_inertia[n * k + i] * scene.artificial_inertias[k].z
        scene.artificial_inertias[i].z = z * scene.own_inertia[n * i + i]


def evaluate(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double) -> cython.int:
    """Find the time derivative dy of the state y at t. Returns what `configure` returns: a count of massless freedoms,
    or -1.
    """
    trouble: cython.int
    power: cython.double = prepare_evaluation(scene, t, y, dy)
    if is_free_tree(scene):
        trouble = factor_with_loads(scene)
        scene.load_size = 0.0
        sweep_down(scene, True)
        write_state_derivative(scene, y, dy, power)
    else:
        trouble = configure(scene, t)
        evaluate_with_factors(scene, y, dy, power)
    return trouble


def is_free_tree(scene: cython.pointer[Scene]) -> cython.bint:
    """Return whether the scene is a spatial tree without closures: its loads can be swept together with the factors."""
    return not (scene.flat or scene.closure_count or scene.artificial_count or scene.friction_count)


def evaluate_projected(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.void:
    """Find the derivative of the state that `project_state` has just left; in the plane its factors are reused, as only
    rates have changed.
    """
    i: cython.Py_ssize_t
    if not scene.flat or scene.selected_count == 0:
        evaluate(scene, t, y, dy)
        return
    power: cython.double = prepare_evaluation(scene, t, y, dy)
    for i in range(scene.selected_count):
        measure_row(scene, cython.address(scene.closures[scene.selected[i]]), t)
    if scene.pivot < scene.pivot_of_step:
        scene.pivot_of_step = scene.pivot
    evaluate_with_factors(scene, y, dy, power)


def prepare_evaluation(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.double:
    """Find kinematics and applied loads at y, and rates of counted angles. Returns the power of what has no potential
    [W].
    """
    update_kinematics(scene, t, y)
    find_counter_rates(scene, dy)
    return apply_loads(scene) if scene.load_count else 0.0


def evaluate_with_factors(
    scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double
) -> cython.void:
    """Find the time derivative with the present factors."""
    if scene.friction_count:
        power += solve_joint_friction(scene)
    solve_response(scene, True)
    write_state_derivative(scene, y, dy, power)


def write_state_derivative(
    scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double
) -> cython.void:
    """Write the time derivative from the accelerations found.

    If something is driven the joint loads are found too, for the work of the drives.
    """
    if scene.has_drives:
        apply_multipliers(scene)
        balance_joints(scene, True)
        power += driving_power(scene)
    write_derivative(scene, y, dy, power)


def solve_applied(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Find the response to the loads on the bodies, with joint loads; inertial: with velocity terms, prescribed
    accelerations and gravity.
    """
    solve_response(scene, inertial)
    apply_multipliers(scene)
    balance_joints(scene, inertial)


def solve_joint_friction(scene: cython.pointer[Scene]) -> cython.double:
    """Find the normal forces of joint friction with the present factors, and apply that friction. Returns its power."""
    k: cython.Py_ssize_t
    power: cython.double = 0.0
    store_applied_loads(scene)
    solve_applied(scene, True)
    record_contact_forces(scene, 0)
    for k in range(scene.friction_count):
        apply_unit_friction(scene, k)
        solve_applied(scene, False)
        record_contact_forces(scene, k + 1)
    find_normal_forces(scene)
    restore_applied_loads(scene)
    for k in range(scene.friction_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.friction_loads[k]])
        apply_friction(scene, load, load.normal_force)
        load.value *= load.normal_force
        load.power *= load.normal_force
        power += load.power
    return power


def driving_power(scene: cython.pointer[Scene]) -> cython.double:
    """Return the power of all drives [W]."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            power += freedom.drive * freedom.u
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.program.count:
            power += row.multiplier * row.prescribed_rate
    return power


def project_state(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Project y onto unit quaternions and the closures, positions and rates. Returns the gap left over all rows [m]."""
    normalize_quaternions(scene, y)
    if scene.closure_count == 0:
        return 0.0
    update_kinematics(scene, t, y)
    if scene.selected_count:
        factor_tree(scene)
        measure_moving_rows(scene, t)
        scene.pivot = factor_closures(scene)
        return project_with_factors(scene, t, y)
    measure_moving_rows(scene, t)
    return largest_gap(scene)  # rows that no freedom can move may still open, for example in a singular pose


def project_evaluated_state(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Project the state that `evaluate` saw last: in the plane, without ball joints, its factors are reused."""
    if not scene.flat or scene.selected_count == 0:
        return project_state(scene, t, y)
    measure_moving_rows(scene, t)
    return project_with_factors(scene, t, y)


def project_with_factors(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Project positions, then rates, onto the closures with the present factors; leave those of the new positions."""
    gap: cython.double = close_gaps(scene, t, y)
    correct_rates(scene, y)
    if scene.pivot < scene.limits.near_singular:  # there the correction of the rates turns the rows: repeat it
        refactor_at(scene, t, y)
        correct_rates(scene, y)
    return gap


def must_choose_rows(scene: cython.pointer[Scene], gap: cython.double) -> cython.bint:
    """Return whether a row that was left out opens, or the chosen ones become nearly dependent."""
    return not gap <= scene.limits.reopened * scene.size or scene.pivot < scene.limits.pivot_drop * scene.pivot_chosen


def normalize_quaternions(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """Scale quaternions to length 1."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    s: cython.double
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            k = scene.bodies[i].attitude_at
            s = 1.0 / sqrt(y[k] * y[k] + y[k + 1] * y[k + 1] + y[k + 2] * y[k + 2] + y[k + 3] * y[k + 3])
            y[k] *= s
            y[k + 1] *= s
            y[k + 2] *= s
            y[k + 3] *= s


def refactor_at(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Find kinematics, rows and factors at y."""
    update_kinematics(scene, t, y)
    measure_moving_rows(scene, t)
    factor_tree(scene)
    scene.pivot = factor_closures(scene)


def close_gaps(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Take Newton steps of least motion, in the norm of M, until the gaps are rounding. Returns the largest gap left
    [m].

    Near a singular pose the rows turn with every small motion: there a step must at least halve the gap.
    """
    n: cython.int
    previous: cython.double
    r: cython.Py_ssize_t
    gap: cython.double = largest_gap(scene)
    for n in range(5):
        if gap <= scene.limits.closed * scene.size:
            break
        previous = gap
        for r in range(scene.closure_count):
            scene.closures[r].demand = scene.closures[r].gap
        solve_demands_only(scene)
        add_motion(scene, y, False)
        refactor_at(scene, t, y)
        gap = largest_gap(scene)
        if scene.pivot < scene.limits.near_singular:
            if gap > 0.5 * previous:
                break
        elif gap <= scene.limits.nearly_closed * scene.size:
            break
    return gap


def correct_rates(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """Change the velocities as little as possible, in the norm of M, so that they meet the rates of all rows."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        scene.closures[r].demand = scene.closures[r].rate
    solve_demands_only(scene)
    add_motion(scene, y, True)


def largest_gap(scene: cython.pointer[Scene]) -> cython.double:
    """Return the largest gap of all rows that must stay closed [m], angular ones by their weight."""
    r: cython.Py_ssize_t
    largest: cython.double = 0.0
    gap: cython.double
    for r in range(scene.closure_count):
        gap = fabs(scene.closures[r].gap) * scene.closures[r].weight
        if scene.closures[r].mode == CARRIES and not gap <= largest:
            largest = gap
    return largest


def solve_demands_only(scene: cython.pointer[Scene]) -> cython.void:
    """Find the least motion, in the norm of M, that compensates the rows' demands: a response to no load at all."""
    i: cython.Py_ssize_t
    for i in range(scene.velocity_count):
        scene.e[i] = 0.0
    solve_closures(scene)
    sweep_down(scene, False)


def add_motion(scene: cython.pointer[Scene], y: cython.p_double, rates: cython.bint) -> cython.void:
    """Add the response (small rotations and shifts) to the coordinates of the state, or to its velocities."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball and rates:
            k = body.rate_at
            y[k] += body.alpha.x
            y[k + 1] += body.alpha.y
            y[k + 2] += body.alpha.z
        elif body.ball:
            k = body.attitude_at
            q: Quaternion = apply_small_rotation(read_quaternion(y, k), body.alpha)
            write_quaternion(y, k, q)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            y[freedom.u_at if rates else freedom.q_at] += freedom.udot
