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
from heuncli.kernel.libm import NAN
from heuncli.kernel.tree import add_load_to_body

# Rows of `trial`, a number for each joint: N, what is left of N = |E1| + |E2|, its weight, the contraction's step,
# and the change of N by Newton's method or along a direction.
NORMAL_FORCE, RESIDUAL, WEIGHT, CONTRACTION_STEP, FORCE_CHANGE = range(5)
MAX_FRICTION_ITERATIONS = 500  # corrections: Newton's method takes a few

FRICTION_ROUNDING = 8.8817841970012523e-16  # relative to the terms: four roundings


# What presses


def store_applied_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Store the loads applied to the bodies."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        scene.kept[6 * i] = body.M_applied.x
        scene.kept[6 * i + 1] = body.M_applied.y
        scene.kept[6 * i + 2] = body.M_applied.z
        scene.kept[6 * i + 3] = body.f_applied.x
        scene.kept[6 * i + 4] = body.f_applied.y
        scene.kept[6 * i + 5] = body.f_applied.z


def restore_applied_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Apply the stored loads again."""
    i: cython.Py_ssize_t
    x: cython.Py_ssize_t
    for i in range(scene.body_count):
        x = 6 * i
        scene.bodies[i].M_applied = Vec3(scene.kept[x], scene.kept[x + 1], scene.kept[x + 2])
        scene.bodies[i].f_applied = Vec3(scene.kept[x + 3], scene.kept[x + 4], scene.kept[x + 5])


def apply_unit_friction(scene: cython.pointer[Scene], k: cython.Py_ssize_t) -> cython.void:
    """Apply the friction of the k-th joint for a normal force of 1 N, and nothing else."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero
    apply_friction(scene, cython.address(scene.loads[scene.rubs[k]]), 1.0)


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
    add_load_to_body(scene, load.b, load.at, load.force, load.moment)
    add_load_to_body(scene, load.a, load.at, scale_vector(-1.0, load.force), scale_vector(-1.0, load.moment))


def joint_force(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the force of the load's joint in the solution, on either of its bodies."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        return scene.bodies[load.held_by].f_joint
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.closures[i].multiplier, scene.closures[i].f)
    return total


def joint_moment(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the moment of the load's joint about its `to` point, where the rows of a cut joint act; signed like its
    force.
    """
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        body: cython.pointer[Body] = cython.address(scene.bodies[load.held_by])
        return add_cross(body.M_joint, sub(body.r, load.at), body.f_joint)
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
    for j in range(scene.rub_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[j]])
        if load.presses == THRUST_OF_ROW:
            store_force_parts(scene, column, j, thread_thrust(scene, load), zero)
            continue
        F: Vec3 = joint_force(scene, load)
        if load.presses == WHOLE:
            store_force_parts(scene, column, j, F, zero)
            continue
        n: Vec3 = world_direction(scene, load.a, load.axis)
        F = add_scaled(F, -dot(n, F), n)
        if load.presses == ENDS:
            store_end_forces(scene, column, j, F, cross(n, joint_moment(scene, load)))
        else:
            store_force_parts(scene, column, j, F, zero)


def store_end_forces(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, F: Vec3, couple: Vec3
) -> cython.void:
    """Store the forces at two ends from a force across the axis n and a moment M, given as n x M."""
    tilt: Vec3 = scale_vector(1.0 / scene.loads[scene.rubs[j]].reach, couple)
    half: Vec3 = scale_vector(0.5, F)
    store_force_parts(scene, column, j, sub(half, tilt), add(half, tilt))


def store_force_parts(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, E1: Vec3, E2: Vec3
) -> cython.void:
    """Store E1 and E2 of a joint in a column."""
    offset: cython.Py_ssize_t = 6 * (column * scene.rub_count + j)
    scene.carried[offset] = E1.x
    scene.carried[offset + 1] = E1.y
    scene.carried[offset + 2] = E1.z
    scene.carried[offset + 3] = E2.x
    scene.carried[offset + 4] = E2.y
    scene.carried[offset + 5] = E2.z


def force_part(scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """Return E1 or E2 (end 0, 1) of a joint in a column."""
    offset: cython.Py_ssize_t = 6 * (column * scene.rub_count + j) + 3 * end
    return Vec3(scene.carried[offset], scene.carried[offset + 1], scene.carried[offset + 2])


# How hard


def find_normal_forces(scene: cython.pointer[Scene]) -> cython.void:
    """Find N of all joints, NaN if there is not exactly one solution; `jammed` then says why, `jammed_load` at which
    load.
    """
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.rub_count
    outcome: cython.int = FOUND
    failing: cython.int = factor_friction_bound(scene)
    if failing < 0:
        iterate_normal_forces(scene)
    elif scene.bound[n * failing + failing] != scene.bound[n * failing + failing]:
        scene.trial[0] = NAN  # loads without a value (NaN): there is no solution, but friction is not the reason
    else:
        outcome = solve_single_friction(scene) if n == 1 else UNPROVED
    if outcome != FOUND:
        scene.jammed = outcome
        scene.jammed_load = scene.rubs[failing]
        scene.jammed_at = scene.programs.variables[0]
    for k in range(n):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[k]])
        load.pressed = scene.trial[k] if outcome == FOUND else NAN
        load.span = outcome if k == failing else FOUND


def factor_friction_bound(scene: cython.pointer[Scene]) -> cython.int:
    """Eliminate 1 - B and find the weights w = (1 - B)^-1 1. Returns -1, or the row whose pivot is too small."""
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    x: cython.double
    w: cython.Py_ssize_t = WEIGHT * n
    for j in range(n):
        scene.trial[w + j] = 1.0
        for k in range(n):
            x = norm(force_part(scene, k + 1, j, 0)) + norm(force_part(scene, k + 1, j, 1))
            scene.bound[n * j + k] = (1.0 if j == k else 0.0) - x
    for k in range(n):
        if not scene.bound[n * k + k] > scene.limits.friction_left:
            return k
        for j in range(k + 1, n):
            x = scene.bound[n * j + k] / scene.bound[n * k + k]
            for i in range(k + 1, n):
                scene.bound[n * j + i] -= x * scene.bound[n * k + i]
            scene.trial[w + j] -= x * scene.trial[w + k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            scene.trial[w + k] -= scene.bound[n * k + i] * scene.trial[w + i]
        scene.trial[w + k] /= scene.bound[n * k + k]
    return -1


def contact_force_part(scene: cython.pointer[Scene], j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """Return E1 or E2 of a joint at the trial N."""
    k: cython.Py_ssize_t
    total: Vec3 = force_part(scene, 0, j, end)
    for k in range(scene.rub_count):
        total = add_scaled(total, scene.trial[k], force_part(scene, k + 1, j, end))
    return total


def friction_residual(scene: cython.pointer[Scene]) -> cython.double:
    """Find the residual of N = |E1| + |E2| at the trial N and its slope 1 - dN/dN; return the largest weighted
    residual.

    0 if all residuals are rounding of their terms.
    """
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    size: cython.double
    length: cython.double
    largest: cython.double = 0.0
    has_residual: cython.bint = False
    for j in range(n):
        scene.trial[RESIDUAL * n + j] = -scene.trial[j]
        size = fabs(scene.trial[j])
        for k in range(n):
            scene.newton[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = contact_force_part(scene, j, end)
            length = norm(E)
            scene.trial[RESIDUAL * n + j] += length
            size += norm(force_part(scene, 0, j, end))
            for k in range(n):
                A: Vec3 = force_part(scene, k + 1, j, end)
                size += fabs(scene.trial[k]) * norm(A)
                if length > 0.0:
                    scene.newton[n * j + k] -= dot(E, A) / length
        has_residual = has_residual or not fabs(scene.trial[RESIDUAL * n + j]) <= FRICTION_ROUNDING * size
        if not fabs(scene.trial[RESIDUAL * n + j]) <= largest * scene.trial[WEIGHT * n + j]:
            largest = fabs(scene.trial[RESIDUAL * n + j]) / scene.trial[WEIGHT * n + j]
    return largest if has_residual else 0.0


def iterate_normal_forces(scene: cython.pointer[Scene]) -> cython.void:
    """Solve by Newton's method; if a step does not halve the residual, by the contraction itself."""
    n: cython.Py_ssize_t = scene.rub_count
    k: cython.Py_ssize_t
    i: cython.int
    residual: cython.double
    previous: cython.double
    for k in range(n):
        scene.trial[k] = norm(force_part(scene, 0, k, 0)) + norm(force_part(scene, 0, k, 1))
    residual = friction_residual(scene)
    for i in range(MAX_FRICTION_ITERATIONS):
        if not residual > 0.0:
            break
        previous = residual
        for k in range(n):
            scene.trial[CONTRACTION_STEP * n + k] = scene.trial[RESIDUAL * n + k]
            scene.trial[FORCE_CHANGE * n + k] = scene.trial[RESIDUAL * n + k]
        solve_friction_newton(scene, FORCE_CHANGE * n)
        for k in range(n):
            scene.trial[k] += scene.trial[FORCE_CHANGE * n + k]
        residual = friction_residual(scene)
        if not residual <= 0.5 * previous:
            for k in range(n):
                scene.trial[k] += scene.trial[CONTRACTION_STEP * n + k] - scene.trial[FORCE_CHANGE * n + k]
            residual = friction_residual(scene)
            if not residual < previous:
                break  # what is left is rounding


def solve_friction_newton(scene: cython.pointer[Scene], offset: cython.Py_ssize_t) -> cython.void:
    """Solve `newton` x = the part of `trial` from an offset on, in place; `newton` is lost.

    No rows are exchanged: 1 - B bounds the matrix, so that no pivot is less than that of 1 - B (an H-matrix).
    """
    n: cython.Py_ssize_t = scene.rub_count
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    x: cython.double
    for k in range(n):
        for j in range(k + 1, n):
            x = scene.newton[n * j + k] / scene.newton[n * k + k]
            for i in range(k + 1, n):
                scene.newton[n * j + i] -= x * scene.newton[n * k + i]
            scene.trial[offset + j] -= x * scene.trial[offset + k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            scene.trial[offset + k] -= scene.newton[n * k + i] * scene.trial[offset + i]
        scene.trial[offset + k] /= scene.newton[n * k + k]


def solve_single_friction(scene: cython.pointer[Scene]) -> cython.int:
    """Decide a single N for which the bound fails: FOUND if nothing presses, else JAMS or TWO.

    From below Newton's method on the convex |E(N)| - N stays short of its first zero; where it rises there is none.
    Just before the bound fails there is one solution: it is about to disappear, or a second one comes from infinity.
    """
    i: cython.int
    residual: cython.double
    if scene.bound[0] > 0.0 and excess_at_infinity(scene) > 0.0:
        return JAMS
    scene.trial[NORMAL_FORCE] = 0.0
    scene.trial[WEIGHT] = 1.0
    for i in range(MAX_FRICTION_ITERATIONS):
        residual = friction_residual(scene)
        if not residual > 0.0:
            return FOUND if scene.trial[NORMAL_FORCE] == 0.0 else TWO
        if not scene.newton[0] > 0.0:
            return JAMS
        scene.trial[NORMAL_FORCE] += scene.trial[RESIDUAL] / scene.newton[0]
    return TWO


def excess_at_infinity(scene: cython.pointer[Scene]) -> cython.double:
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
    """Write the change of N to its row of `trial`, from the change of E at the same N: column n + 1."""
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    length: cython.double
    for j in range(n):
        scene.trial[FORCE_CHANGE * n + j] = 0.0
        for k in range(n):
            scene.newton[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = contact_force_part(scene, j, end)
            length = norm(E)
            if length > 0.0:
                scene.trial[FORCE_CHANGE * n + j] += dot(E, force_part(scene, n + 1, j, end)) / length
                for k in range(n):
                    scene.newton[n * j + k] -= dot(E, force_part(scene, k + 1, j, end)) / length
    solve_friction_newton(scene, FORCE_CHANGE * n)
