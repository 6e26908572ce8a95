"""Joint friction that depends on the joint's own load: the normal forces, found together with the loads that they
change.

    E = E_0 + sum over k of A_k N_k          contact force of a joint, two vectors: linear in the joint's load
    N_j = |E1_j| + |E2_j|                    normal force; friction is -c_j tanh(v_j / v0_j) N_j against the motion

For a pin E1 is the joint's force and E2 zero; for a guide it is the part of the force across it; for one that tilts the
forces at its two ends, E1,2 = F / 2 -+ (n x M) / length; for a thread E1 is the multiplier of its row. E_0 is the
response to all loads without this friction, A_k that to the friction of the k-th joint for N_k = 1: all with the
present factors.

B_jk = |A1_jk| + |A2_jk| bounds what a unit of N_k adds to N_j. If 1 - B is an M-matrix (elimination leaves positive
pivots) there is exactly one solution, whatever E_0 is: in the weights w = (1 - B)^-1 1, N -> |E(N)| is a contraction
(Berman, Plemmons, Nonnegative Matrices in the Mathematical Sciences (1994), ch. 6). Otherwise a single N is decided
separately: |E(N)| - N is convex and rises in the end, so that it has two zeros or none, and Newton's method reaches the
first from below. For several N nothing is proved but that bound.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.declarations import *
from heuncli.kernel.kinematics import add_load_to_body
from heuncli.kernel.libm import NAN

# Rows of `friction_trial`, a number for each joint: N, what is left of N = |E1| + |E2|, its weight, the contraction's
# step, and the change of N by Newton's method or along a direction.
NORMAL_FORCE, RESIDUAL, WEIGHT, CONTRACTION_STEP, FORCE_CHANGE = range(5)
MAX_FRICTION_ITERATIONS = 500  # corrections: Newton's method takes a few

FRICTION_ROUNDING = 8.8817841970012523e-16  # relative to the terms: four roundings


# Normal forces


def store_applied_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Store the loads applied to the bodies."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        write_vector(scene.stored_loads, write_vector(scene.stored_loads, 6 * i, body.M_applied), body.f_applied)


def restore_applied_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Apply the stored loads again."""
    i: cython.Py_ssize_t
    x: cython.Py_ssize_t
    for i in range(scene.body_count):
        x = 6 * i
        scene.bodies[i].M_applied = read_vector(scene.stored_loads, x)
        scene.bodies[i].f_applied = read_vector(scene.stored_loads, x + 3)


def apply_unit_friction(scene: cython.pointer[Scene], k: cython.Py_ssize_t) -> cython.void:
    """Apply the friction of the k-th joint for a normal force of 1 N, and nothing else."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero
    apply_friction(scene, cython.address(scene.loads[scene.friction_loads[k]]), 1.0)


def apply_friction(scene: cython.pointer[Scene], load: cython.pointer[Load], N: cython.double) -> cython.void:
    """Apply friction for the normal force N to the two bodies."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    friction: Vec3 = scale_vector(N, load.unit)
    if load.kind == SHIFT_FRICTION:
        load.force = friction
        load.moment = zero
    else:
        load.force = scale_vector(load.factor, friction) if load.kind == THREAD_FRICTION else zero
        load.moment = friction
    add_load_to_body(scene, load.b, load.place, load.force, load.moment)
    add_load_to_body(scene, load.a, load.place, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))


def joint_force(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the force of the load's joint in the solution, on either of its bodies."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.joint_body >= 0:
        return scene.bodies[load.joint_body].f_joint
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.closures[i].multiplier, scene.closures[i].f)
    return total


def joint_moment(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the moment of the load's joint about its `to` point, where the rows of a cut joint act; signed like its
    force.
    """
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.joint_body >= 0:
        body: cython.pointer[Body] = cython.address(scene.bodies[load.joint_body])
        return add_cross(body.M_joint, sub(body.r, load.place), body.f_joint)
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.closures[i].multiplier, scene.closures[i].m)
    return total


def thread_thrust(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the force of a thread's flanks along its axis in the solution, as the first component."""
    return Vec3(scene.closures[load.row].multiplier, 0.0, 0.0)


def record_contact_forces(scene: cython.pointer[Scene], column: cython.Py_ssize_t) -> cython.void:
    """Store E of all joints in the solution, in a column: 0 for all other loads, k + 1 for the k-th friction."""
    j: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for j in range(scene.friction_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.friction_loads[j]])
        if load.normal_force_kind == THRUST_OF_ROW:
            store_force_parts(scene, column, j, thread_thrust(scene, load), zero)
            continue
        F: Vec3 = joint_force(scene, load)
        if load.normal_force_kind == WHOLE:
            store_force_parts(scene, column, j, F, zero)
            continue
        n: Vec3 = world_direction(scene, load.a, load.axis)
        F = add_scaled(F, -dot(n, F), n)
        if load.normal_force_kind == ENDS:
            store_end_forces(scene, column, j, F, cross(n, joint_moment(scene, load)))
        else:
            store_force_parts(scene, column, j, F, zero)


def store_end_forces(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, F: Vec3, couple: Vec3
) -> cython.void:
    """Store the forces at two ends from a force across the axis n and a moment M, given as n x M."""
    tilt: Vec3 = scale_vector(1.0 / scene.loads[scene.friction_loads[j]].reach, couple)
    half: Vec3 = scale_vector(0.5, F)
    store_force_parts(scene, column, j, sub(half, tilt), add(half, tilt))


def store_force_parts(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, E1: Vec3, E2: Vec3
) -> cython.void:
    """Store E1 and E2 of a joint in a column."""
    offset: cython.Py_ssize_t = 6 * (column * scene.friction_count + j)
    write_vector(scene.contact_forces, write_vector(scene.contact_forces, offset, E1), E2)


def force_part(scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """Return E1 or E2 (end 0, 1) of a joint in a column."""
    offset: cython.Py_ssize_t = 6 * (column * scene.friction_count + j) + 3 * end
    return read_vector(scene.contact_forces, offset)


# Solve for the normal forces


def find_normal_forces(scene: cython.pointer[Scene]) -> cython.void:
    """Find N of all joints, NaN if there is not exactly one solution; `friction_outcome` then says why, and
    `friction_outcome_load` at which load.
    """
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.friction_count
    outcome: cython.int = FOUND
    failing: cython.int = factor_friction_bound(scene)
    if failing < 0:
        iterate_normal_forces(scene)
    elif scene.friction_bound[n * failing + failing] != scene.friction_bound[n * failing + failing]:
        for k in range(n):
            scene.friction_trial[k] = NAN  # loads without a value (NaN): no solution, but friction is not the reason
    else:
        outcome = solve_single_friction(scene) if n == 1 else UNPROVED
    if outcome != FOUND:
        scene.friction_outcome = outcome
        scene.friction_outcome_load = scene.friction_loads[failing]
        scene.friction_outcome_time = scene.programs.variables[0]
    for k in range(n):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.friction_loads[k]])
        load.normal_force = scene.friction_trial[k] if outcome == FOUND else NAN
        load.friction_outcome = outcome if k == failing else FOUND


def factor_friction_bound(scene: cython.pointer[Scene]) -> cython.int:
    """Eliminate 1 - B and find the weights w = (1 - B)^-1 1. Returns -1, or the row whose pivot is too small."""
    n: cython.Py_ssize_t = scene.friction_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    x: cython.double
    w: cython.Py_ssize_t = WEIGHT * n
    for j in range(n):
        scene.friction_trial[w + j] = 1.0
        for k in range(n):
            x = norm(force_part(scene, k + 1, j, 0)) + norm(force_part(scene, k + 1, j, 1))
            scene.friction_bound[n * j + k] = (1.0 if j == k else 0.0) - x
    for k in range(n):
        if not scene.friction_bound[n * k + k] > scene.limits.friction_left:
            return k
        for j in range(k + 1, n):
            x = scene.friction_bound[n * j + k] / scene.friction_bound[n * k + k]
            for i in range(k + 1, n):
                scene.friction_bound[n * j + i] -= x * scene.friction_bound[n * k + i]
            scene.friction_trial[w + j] -= x * scene.friction_trial[w + k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            scene.friction_trial[w + k] -= scene.friction_bound[n * k + i] * scene.friction_trial[w + i]
        scene.friction_trial[w + k] /= scene.friction_bound[n * k + k]
    return -1


def contact_force_part(scene: cython.pointer[Scene], j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """Return E1 or E2 of a joint at the trial N."""
    k: cython.Py_ssize_t
    total: Vec3 = force_part(scene, 0, j, end)
    for k in range(scene.friction_count):
        total = add_scaled(total, scene.friction_trial[k], force_part(scene, k + 1, j, end))
    return total


def friction_residual(scene: cython.pointer[Scene]) -> cython.double:
    """Find the residual of N = |E1| + |E2| at the trial N and its slope 1 - dN/dN; return the largest weighted
    residual.

    0 if all residuals are rounding of their terms.
    """
    n: cython.Py_ssize_t = scene.friction_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    size: cython.double
    length: cython.double
    largest: cython.double = 0.0
    has_residual: cython.bint = False
    for j in range(n):
        scene.friction_trial[RESIDUAL * n + j] = -scene.friction_trial[j]
        size = fabs(scene.friction_trial[j])
        for k in range(n):
            scene.friction_slope[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = contact_force_part(scene, j, end)
            length = norm(E)
            scene.friction_trial[RESIDUAL * n + j] += length
            size += norm(force_part(scene, 0, j, end))
            for k in range(n):
                A: Vec3 = force_part(scene, k + 1, j, end)
                size += fabs(scene.friction_trial[k]) * norm(A)
                if length > 0.0:
                    scene.friction_slope[n * j + k] -= dot(E, A) / length
        has_residual = has_residual or not fabs(scene.friction_trial[RESIDUAL * n + j]) <= FRICTION_ROUNDING * size
        if not fabs(scene.friction_trial[RESIDUAL * n + j]) <= largest * scene.friction_trial[WEIGHT * n + j]:
            largest = fabs(scene.friction_trial[RESIDUAL * n + j]) / scene.friction_trial[WEIGHT * n + j]
    return largest if has_residual else 0.0


def iterate_normal_forces(scene: cython.pointer[Scene]) -> cython.void:
    """Solve by Newton's method; if a step does not halve the residual, by the contraction itself."""
    n: cython.Py_ssize_t = scene.friction_count
    k: cython.Py_ssize_t
    i: cython.int
    residual: cython.double
    previous: cython.double
    for k in range(n):
        scene.friction_trial[k] = norm(force_part(scene, 0, k, 0)) + norm(force_part(scene, 0, k, 1))
    residual = friction_residual(scene)
    for i in range(MAX_FRICTION_ITERATIONS):
        if not residual > 0.0:
            break
        previous = residual
        for k in range(n):
            scene.friction_trial[CONTRACTION_STEP * n + k] = scene.friction_trial[RESIDUAL * n + k]
            scene.friction_trial[FORCE_CHANGE * n + k] = scene.friction_trial[RESIDUAL * n + k]
        solve_friction_newton(scene, FORCE_CHANGE * n)
        for k in range(n):
            scene.friction_trial[k] += scene.friction_trial[FORCE_CHANGE * n + k]
        residual = friction_residual(scene)
        if not residual <= 0.5 * previous:
            for k in range(n):
                scene.friction_trial[k] += (
                    scene.friction_trial[CONTRACTION_STEP * n + k] - scene.friction_trial[FORCE_CHANGE * n + k]
                )
            residual = friction_residual(scene)
            if not residual < previous:
                break  # what is left is rounding


def solve_friction_newton(scene: cython.pointer[Scene], offset: cython.Py_ssize_t) -> cython.void:
    """Solve S x = the part of `friction_trial` from an offset on, in place; S is `friction_slope`, which is lost.

    No rows are exchanged: 1 - B bounds the matrix, so that no pivot is less than that of 1 - B (an H-matrix).
    """
    n: cython.Py_ssize_t = scene.friction_count
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    x: cython.double
    for k in range(n):
        for j in range(k + 1, n):
            x = scene.friction_slope[n * j + k] / scene.friction_slope[n * k + k]
            for i in range(k + 1, n):
                scene.friction_slope[n * j + i] -= x * scene.friction_slope[n * k + i]
            scene.friction_trial[offset + j] -= x * scene.friction_trial[offset + k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            scene.friction_trial[offset + k] -= scene.friction_slope[n * k + i] * scene.friction_trial[offset + i]
        scene.friction_trial[offset + k] /= scene.friction_slope[n * k + k]


def solve_single_friction(scene: cython.pointer[Scene]) -> cython.int:
    """Decide a single N for which the bound fails: FOUND if there is no normal force, else JAMS or TWO.

    From below Newton's method on the convex |E(N)| - N stays short of its first zero; where it rises there is none.
    Just before the bound fails there is one solution: it is about to disappear, or a second one comes from infinity.
    """
    i: cython.int
    residual: cython.double
    if scene.friction_bound[0] > 0.0 and find_excess_at_infinity(scene) > 0.0:
        return JAMS
    scene.friction_trial[NORMAL_FORCE] = 0.0
    scene.friction_trial[WEIGHT] = 1.0
    for i in range(MAX_FRICTION_ITERATIONS):
        residual = friction_residual(scene)
        if not residual > 0.0:
            return FOUND if scene.friction_trial[NORMAL_FORCE] == 0.0 else TWO
        if not scene.friction_slope[0] > 0.0:
            return JAMS
        scene.friction_trial[NORMAL_FORCE] += scene.friction_trial[RESIDUAL] / scene.friction_slope[0]
    return TWO


def find_excess_at_infinity(scene: cython.pointer[Scene]) -> cython.double:
    """Return by how much |E(N)| exceeds B N for large N: if positive, N grows without limit at the bound."""
    end: cython.int
    total: cython.double = 0.0
    for end in range(2):
        A: Vec3 = force_part(scene, 1, 0, end)
        if norm(A) > 0.0:
            total += dot(force_part(scene, 0, 0, end), A) / norm(A)
        else:
            total += norm(force_part(scene, 0, 0, end))
    return total


# Along a direction of the state


def find_normal_force_tangent(scene: cython.pointer[Scene]) -> cython.void:
    """Write the change of N to its row of `friction_trial`, from the change of E at the same N: column n + 1."""
    n: cython.Py_ssize_t = scene.friction_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    length: cython.double
    for j in range(n):
        scene.friction_trial[FORCE_CHANGE * n + j] = 0.0
        for k in range(n):
            scene.friction_slope[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = contact_force_part(scene, j, end)
            length = norm(E)
            if length > 0.0:
                scene.friction_trial[FORCE_CHANGE * n + j] += dot(E, force_part(scene, n + 1, j, end)) / length
                for k in range(n):
                    scene.friction_slope[n * j + k] -= dot(E, force_part(scene, k + 1, j, end)) / length
    solve_friction_newton(scene, FORCE_CHANGE * n)
