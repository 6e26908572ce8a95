"""What friction by what a joint carries changes by along a direction of the state: pressing.py, differentiated.

    dN_j = sum over both ends of E / |E| . (dE + sum over k of A_k dN_k)
dE is what E changes by at the same N, of the change of the joint's own load and of the directions it is taken along;
dN_k then rubs as N_k does, and is answered likewise.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add_cross, add_scaled, cross, dot, scaled, sub
    from heuncli.kernel.closures import push_closures
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.loads import sliding_in
    from heuncli.kernel.pressing import carried_force, carried_moment, pressed_along, put_ends, put_parts, thrust
    from heuncli.kernel.scene import (
        ENDS,
        SHIFT_FRICTION,
        THREAD_FRICTION,
        THRUST_OF_ROW,
        WHOLE,
        BodyAtState,
        BodyTangent,
        Closure,
        Load,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_closures import row_along
    from heuncli.kernel.tangent_loads import opposite, push_along
    from heuncli.kernel.tangent_motion import point_along, swung
    from heuncli.kernel.tree import balance, point_of
    from heuncli.kernel.values import LoadTangent


def carry_along(scene: cython.pointer[Scene]) -> cython.void:
    """What the loads of all joints change by, by the accelerations and multipliers that answer the change."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = scaled(-1.0, scene.tangents[i].M)
        scene.bodies[i].f_applied = scaled(-1.0, scene.tangents[i].f)
    push_closures(scene)
    balance(scene, False)


def press_along(scene: cython.pointer[Scene]) -> cython.double:
    """Put on the bodies what friction changes by as what presses does; what its power changes by with that."""
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.rub_count
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    power: cython.double = 0.0
    carry_along(scene)
    see_along(scene)
    pressed_along(scene)
    for k in range(n):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[k]])
        change: Vec3 = scaled(scene.trial[4 * n + k], load.unit)
        power += dot(change, direction_of(scene, load.a, load.axis)) * load.rate
        d: LoadTangent = LoadTangent(zero, zero, change)
        if load.kind == SHIFT_FRICTION:
            d = LoadTangent(zero, change, zero)
        elif load.kind == THREAD_FRICTION:
            d = LoadTangent(zero, scaled(load.factor, change), change)
            power += dot(d.force, sliding_in(scene, load, point_of(scene, load.b, load.q).v))
        push_along(scene, load.b, load.at, zero, d)
        push_along(scene, load.a, load.at, zero, opposite(d))
    return power


def see_along(scene: cython.pointer[Scene]) -> cython.void:
    """Put down what E of all joints changes by, in the column behind those of friction."""
    j: cython.Py_ssize_t
    column: cython.Py_ssize_t = scene.rub_count + 1
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for j in range(scene.rub_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[j]])
        if load.presses == THRUST_OF_ROW:
            put_parts(scene, column, j, thrust(scene, load), zero)
            continue
        change: Vec3 = force_along(scene, load)
        if load.presses == WHOLE:
            put_parts(scene, column, j, change, zero)
            continue
        n: Vec3 = direction_of(scene, load.a, load.axis)
        dn: Vec3 = swung(scene, load.a, n)
        F: Vec3 = force_at(scene, load)
        along: cython.double = dot(dn, F) + dot(n, change)
        change = add_scaled(add_scaled(change, -dot(n, F), dn), -along, n)
        if load.presses == ENDS:
            couple: Vec3 = add_cross(cross(dn, moment_at(scene, load)), n, find_moment_change(scene, load))
            put_ends(scene, column, j, change, couple)
        else:
            put_parts(scene, column, j, change, zero)


def force_at(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Force of the load's joint at the state (`carried_force`)."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        return scene.at_state[load.held_by].f
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.multipliers[i], scene.closures[i].f)
    return total


def moment_at(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Moment of the load's joint about its `to` point at the state (`carried_moment`)."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.held_by >= 0:
        at: cython.pointer[BodyAtState] = cython.address(scene.at_state[load.held_by])
        return add_cross(at.M, sub(scene.bodies[load.held_by].r, load.at), at.f)
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.multipliers[i], scene.closures[i].m)
    return total


def force_along(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """What the force of the load's joint changes by; of one that was cut d(lambda) f + lambda df."""
    i: cython.Py_ssize_t
    total: Vec3 = carried_force(scene, load)
    if load.held_by < 0:
        for i in range(load.row, load.row + load.row_count):
            row: cython.pointer[Closure] = cython.address(scene.closures[i])
            if row.rank >= 0:
                total = add_scaled(total, scene.multipliers[i], row_along(scene, row).f)
    return total


def find_moment_change(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """What the moment of the load's joint changes by: dM + (dr - dx) x F + (r - x) x dF, about its `to` point x."""
    i: cython.Py_ssize_t
    total: Vec3 = carried_moment(scene, load)
    if load.held_by >= 0:
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[load.held_by])
        way: Vec3 = sub(d.r, point_along(scene, load.b, load.q).x)
        return add_cross(total, way, scene.at_state[load.held_by].f)
    for i in range(load.row, load.row + load.row_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.rank >= 0:
            total = add_scaled(total, scene.multipliers[i], row_along(scene, row).m)
    return total
