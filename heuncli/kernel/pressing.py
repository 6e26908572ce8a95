"""Friction by what a joint carries: how hard its parts are pressed together, found with the loads that it changes.

    E = E_0 + sum over k of A_k N_k          what presses in a joint, two vectors: linear in what it carries
    N_j = |E1_j| + |E2_j|                    how hard; friction is -c_j tanh(v_j / v0_j) N_j against the motion
of a pin E1 is the joint's force and E2 nothing, of a guide what of the force is across it, of one that tilts what its
two ends carry, E1,2 = F / 2 -+ (n x M) / length; of a thread E1 is the multiplier of its row alone. E_0 answers all
loads without this friction, A_k what rubs in the k-th joint if N_k = 1: all by the factors that stand.

B_jk = |A1_jk| + |A2_jk| bounds what a unit of N_k adds to N_j. Where 1 - B is an M-matrix (elimination leaves positive
pivots) there is one answer and no other, whatever E_0 is: in the weights w = (1 - B)^-1 1, N -> |E(N)| is a contraction
(Berman, Plemmons, Nonnegative Matrices in the Mathematical Sciences (1994), ch. 6). Beyond, a single N is decided for
itself: |E(N)| - N is convex and rises in the end, so that it has two zeros or none, and Newton's method comes to the
first from below. Of several no more is proved than that bound.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs

    from heuncli.kernel.algebra import Vec3, add, add_cross, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.libm import NAN
    from heuncli.kernel.scene import (
        ENDS,
        FOUND,
        JAMS,
        SHIFT_FRICTION,
        THREAD_FRICTION,
        THRUST_OF_ROW,
        TWO,
        UNPROVED,
        WHOLE,
        Body,
        Load,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import push

    MOST = 500  # corrections: Newton's method takes a few

ROUNDING = 8.8817841970012523e-16  # of the terms: four roundings


# What presses


def keep_applied(scene: cython.pointer[Scene]) -> cython.void:
    """Put the loads applied to the bodies aside."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        scene.kept[6 * i] = body.M_applied.x
        scene.kept[6 * i + 1] = body.M_applied.y
        scene.kept[6 * i + 2] = body.M_applied.z
        scene.kept[6 * i + 3] = body.f_applied.x
        scene.kept[6 * i + 4] = body.f_applied.y
        scene.kept[6 * i + 5] = body.f_applied.z


def apply_kept(scene: cython.pointer[Scene]) -> cython.void:
    """Apply again what was put aside."""
    i: cython.Py_ssize_t
    x: cython.Py_ssize_t
    for i in range(scene.body_count):
        x = 6 * i
        scene.bodies[i].M_applied = Vec3(scene.kept[x], scene.kept[x + 1], scene.kept[x + 2])
        scene.bodies[i].f_applied = Vec3(scene.kept[x + 3], scene.kept[x + 4], scene.kept[x + 5])


def apply_unit(scene: cython.pointer[Scene], k: cython.Py_ssize_t) -> cython.void:
    """Apply what rubs in the k-th joint if 1 N presses there, and nothing else."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = zero
        scene.bodies[i].f_applied = zero
    rub(scene, cython.address(scene.loads[scene.rubs[k]]), 1.0)


def rub(scene: cython.pointer[Scene], load: cython.pointer[Load], N: cython.double) -> cython.void:
    """Put friction on the two bodies, N pressing."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    acts: Vec3 = scaled(N, load.unit)
    if load.kind == SHIFT_FRICTION:
        load.force = acts
        load.moment = zero
    else:
        load.force = scaled(load.factor, acts) if load.kind == THREAD_FRICTION else zero
        load.moment = acts
    push(scene, load.b, load.at, load.force, load.moment)
    push(scene, load.a, load.at, scaled(-1.0, load.force), scaled(-1.0, load.moment))


def carried_force(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Force of the load's joint in the answer found, on either of its bodies."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        return scene.bodies[load.held_by].f_joint
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.closures[i].multiplier, scene.closures[i].f)
    return total


def carried_moment(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Moment of the load's joint about its `to` point, where the rows of one that was cut act; sign as its force."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        body: cython.pointer[Body] = cython.address(scene.bodies[load.held_by])
        return add_cross(body.M_joint, sub(body.r, load.at), body.f_joint)
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.closures[i].multiplier, scene.closures[i].m)
    return total


def thrust(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """What the flanks of a thread press with along its axis, a single number, in the answer found."""
    return Vec3(scene.closures[load.row].multiplier, 0.0, 0.0)


def see_pressing(scene: cython.pointer[Scene], column: cython.Py_ssize_t) -> cython.void:
    """Put down E of all joints in the answer found, in a column: 0 of all other loads, k + 1 of the k-th friction."""
    j: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for j in range(scene.rub_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[j]])
        if load.presses == THRUST_OF_ROW:
            put_parts(scene, column, j, thrust(scene, load), zero)
            continue
        F: Vec3 = carried_force(scene, load)
        if load.presses == WHOLE:
            put_parts(scene, column, j, F, zero)
            continue
        n: Vec3 = direction_of(scene, load.a, load.axis)
        F = add_scaled(F, -dot(n, F), n)
        if load.presses == ENDS:
            put_ends(scene, column, j, F, cross(n, carried_moment(scene, load)))
        else:
            put_parts(scene, column, j, F, zero)


def put_ends(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, F: Vec3, couple: Vec3
) -> cython.void:
    """Put down what two ends carry of a force across the axis n and of a moment M, of which n x M is given."""
    tilt: Vec3 = scaled(1.0 / scene.loads[scene.rubs[j]].reach, couple)
    half: Vec3 = scaled(0.5, F)
    put_parts(scene, column, j, sub(half, tilt), add(half, tilt))


def put_parts(
    scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, E1: Vec3, E2: Vec3
) -> cython.void:
    """Put down E1 and E2 of a joint in a column."""
    at: cython.Py_ssize_t = 6 * (column * scene.rub_count + j)
    scene.carried[at] = E1.x
    scene.carried[at + 1] = E1.y
    scene.carried[at + 2] = E1.z
    scene.carried[at + 3] = E2.x
    scene.carried[at + 4] = E2.y
    scene.carried[at + 5] = E2.z


def part(scene: cython.pointer[Scene], column: cython.Py_ssize_t, j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """E1 or E2 (end 0, 1) of a joint in a column."""
    at: cython.Py_ssize_t = 6 * (column * scene.rub_count + j) + 3 * end
    return Vec3(scene.carried[at], scene.carried[at + 1], scene.carried[at + 2])


# How hard


def find_pressed(scene: cython.pointer[Scene]) -> cython.void:
    """N of all, which is no number where there is not one answer; `jammed` then says why, `jammed_load` of which."""
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.rub_count
    found: cython.int = FOUND
    at_fault: cython.int = measure_bound(scene)
    if at_fault < 0:
        correct_pressed(scene)
    elif scene.bound[n * at_fault + at_fault] != scene.bound[n * at_fault + at_fault]:
        scene.trial[0] = NAN  # loads without a value: nothing is found, and friction is not why
    else:
        found = alone(scene) if n == 1 else UNPROVED
    if found != FOUND:
        scene.jammed = found
        scene.jammed_load = scene.rubs[at_fault]
        scene.jammed_at = scene.programs.variables[0]
    for k in range(n):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[k]])
        load.pressed = scene.trial[k] if found == FOUND else NAN
        load.span = found if k == at_fault else FOUND


def measure_bound(scene: cython.pointer[Scene]) -> cython.int:
    """Eliminate 1 - B, and take w = (1 - B)^-1 1 for weights; -1, or where too little is left of a pivot."""
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    x: cython.double
    w: cython.Py_ssize_t = 2 * n
    for j in range(n):
        scene.trial[w + j] = 1.0
        for k in range(n):
            x = norm(part(scene, k + 1, j, 0)) + norm(part(scene, k + 1, j, 1))
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


def summed(scene: cython.pointer[Scene], j: cython.Py_ssize_t, end: cython.int) -> Vec3:
    """E1 or E2 of a joint at the N tried."""
    k: cython.Py_ssize_t
    total: Vec3 = part(scene, 0, j, end)
    for k in range(scene.rub_count):
        total = add_scaled(total, scene.trial[k], part(scene, k + 1, j, end))
    return total


def leave(scene: cython.pointer[Scene]) -> cython.double:
    """What the N tried leaves of N = |E1| + |E2|, and its slope 1 - dN/dN into `newton`; the largest by its weight.

    0 where all is rounding of the terms.
    """
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    size: cython.double
    length: cython.double
    largest: cython.double = 0.0
    open_: cython.bint = False
    for j in range(n):
        scene.trial[n + j] = -scene.trial[j]
        size = fabs(scene.trial[j])
        for k in range(n):
            scene.newton[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = summed(scene, j, end)
            length = norm(E)
            scene.trial[n + j] += length
            size += norm(part(scene, 0, j, end))
            for k in range(n):
                A: Vec3 = part(scene, k + 1, j, end)
                size += fabs(scene.trial[k]) * norm(A)
                if length > 0.0:
                    scene.newton[n * j + k] -= dot(E, A) / length
        open_ = open_ or not fabs(scene.trial[n + j]) <= ROUNDING * size
        if not fabs(scene.trial[n + j]) <= largest * scene.trial[2 * n + j]:
            largest = fabs(scene.trial[n + j]) / scene.trial[2 * n + j]
    return largest if open_ else 0.0


def correct_pressed(scene: cython.pointer[Scene]) -> cython.void:
    """Newton's method; where it does not halve what is left, the contraction itself."""
    n: cython.Py_ssize_t = scene.rub_count
    k: cython.Py_ssize_t
    i: cython.int
    left: cython.double
    before: cython.double
    for k in range(n):
        scene.trial[k] = norm(part(scene, 0, k, 0)) + norm(part(scene, 0, k, 1))
    left = leave(scene)
    for i in range(MOST):
        if not left > 0.0:
            break
        before = left
        for k in range(n):
            scene.trial[3 * n + k] = scene.trial[n + k]
            scene.trial[4 * n + k] = scene.trial[n + k]
        solve_newton(scene, 4 * n)
        for k in range(n):
            scene.trial[k] += scene.trial[4 * n + k]
        left = leave(scene)
        if not left <= 0.5 * before:
            for k in range(n):
                scene.trial[k] += scene.trial[3 * n + k] - scene.trial[4 * n + k]
            left = leave(scene)
            if not left < before:
                break  # what is left is rounding


def solve_newton(scene: cython.pointer[Scene], at: cython.Py_ssize_t) -> cython.void:
    """Solve `newton` x = what stands in `trial` from a place on, in place; it is eliminated there, and lost.

    No row is exchanged: 1 - B bounds it, so that no pivot is less than what is left of that (an H-matrix).
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
            scene.trial[at + j] -= x * scene.trial[at + k]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            scene.trial[at + k] -= scene.newton[n * k + i] * scene.trial[at + i]
        scene.trial[at + k] /= scene.newton[n * k + k]


def alone(scene: cython.pointer[Scene]) -> cython.int:
    """Of a single N beyond the bound: FOUND where nothing presses, else two answers or none.

    From below Newton's method on the convex |E(N)| - N falls short of its first zero; where it rises there is none.
    Just before the bound there is one: it is on its way to where there is none, or a second one comes from far away.
    """
    i: cython.int
    left: cython.double
    if scene.bound[0] > 0.0 and pressed_far(scene) > 0.0:
        return JAMS
    scene.trial[0] = 0.0
    scene.trial[2] = 1.0
    for i in range(MOST):
        left = leave(scene)
        if not left > 0.0:
            return FOUND if scene.trial[0] == 0.0 else TWO
        if not scene.newton[0] > 0.0:
            return JAMS
        scene.trial[0] += scene.trial[1] / scene.newton[0]
    return TWO


def pressed_far(scene: cython.pointer[Scene]) -> cython.double:
    """What |E(N)| has beyond B N where N is large: where that is positive N is beyond all numbers at the bound."""
    end: cython.int
    found: cython.double = 0.0
    for end in range(2):
        A: Vec3 = part(scene, 1, 0, end)
        if norm(A) > 0.0:
            found += dot(part(scene, 0, 0, end), A) / norm(A)
        else:
            found += norm(part(scene, 0, 0, end))
    return found


# Along a direction of the state


def pressed_along(scene: cython.pointer[Scene]) -> cython.void:
    """What N changes by, into `trial` from 4 n on, from what E does at the same N: the column n + 1."""
    n: cython.Py_ssize_t = scene.rub_count
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    end: cython.int
    length: cython.double
    for j in range(n):
        scene.trial[4 * n + j] = 0.0
        for k in range(n):
            scene.newton[n * j + k] = 1.0 if j == k else 0.0
        for end in range(2):
            E: Vec3 = summed(scene, j, end)
            length = norm(E)
            if length > 0.0:
                scene.trial[4 * n + j] += dot(E, part(scene, n + 1, j, end)) / length
                for k in range(n):
                    scene.newton[n * j + k] -= dot(E, part(scene, k + 1, j, end)) / length
    solve_newton(scene, 4 * n)
