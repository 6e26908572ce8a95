"""The change of joint friction that depends on the joint's own load, along a direction of the state: joint_friction.py,
differentiated.

    dN_j = sum over both ends of E / |E| . (dE + sum over k of A_k dN_k)

dE is the change of E at the same N, from the change of the joint's own load and of the directions that define E. dN_k
then acts as friction as N_k does, and has the same kind of response.
"""

from __future__ import annotations

from heuncli.kernel.closures import apply_multipliers
from heuncli.kernel.declarations import *
from heuncli.kernel.joint_friction import (
    FORCE_CHANGE,
    find_normal_force_tangent,
    joint_force,
    joint_moment,
    store_end_forces,
    store_force_parts,
    thread_thrust,
)
from heuncli.kernel.kinematics import locate_point
from heuncli.kernel.loads import sliding_velocity
from heuncli.kernel.tangent_loads import opposite_load, push_load_tangent, row_tangent
from heuncli.kernel.tangent_motion import point_tangent, vector_tangent
from heuncli.kernel.tree import balance_joints


def find_joint_load_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Find the changes of the loads of all joints, from the accelerations and multipliers due to the change."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_applied = scale_vector(-1.0, scene.tangents[i].M)
        scene.bodies[i].f_applied = scale_vector(-1.0, scene.tangents[i].f)
    apply_multipliers(scene)
    balance_joints(scene, False)


def add_friction_tangent(scene: cython.pointer[Scene]) -> cython.double:
    """Apply the change of friction due to that of the normal forces to the bodies. Returns the change of its power."""
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.friction_count
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    power: cython.double = 0.0
    find_joint_load_tangents(scene)
    record_contact_force_tangents(scene)
    find_normal_force_tangent(scene)
    for k in range(n):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.friction_loads[k]])
        change: Vec3 = scale_vector(scene.friction_trial[FORCE_CHANGE * n + k], load.unit)
        power += dot(change, world_direction(scene, load.a, load.axis)) * load.rate
        d: LoadTangent = LoadTangent(zero, zero, change)
        if load.kind == SHIFT_FRICTION:
            d = LoadTangent(zero, change, zero)
        elif load.kind == THREAD_FRICTION:
            d = LoadTangent(zero, scale_vector(load.factor, change), change)
            power += dot(d.force, sliding_velocity(scene, load, locate_point(scene, load.b, load.q).v))
        push_load_tangent(scene, load.b, load.place, zero, d)
        push_load_tangent(scene, load.a, load.place, zero, opposite_load(d))
    return power


def record_contact_force_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Store the change of E of all joints, in the column after those of friction."""
    j: cython.Py_ssize_t
    column: cython.Py_ssize_t = scene.friction_count + 1
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for j in range(scene.friction_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.friction_loads[j]])
        if load.normal_force_kind == THRUST_OF_ROW:
            store_force_parts(scene, column, j, thread_thrust(scene, load), zero)
            continue
        change: Vec3 = joint_force_tangent(scene, load)
        if load.normal_force_kind == WHOLE:
            store_force_parts(scene, column, j, change, zero)
            continue
        n: Vec3 = world_direction(scene, load.a, load.axis)
        dn: Vec3 = vector_tangent(scene, load.a, n)
        F: Vec3 = base_joint_force(scene, load)
        normal_change: cython.double = dot(dn, F) + dot(n, change)
        change = add_scaled(add_scaled(change, -dot(n, F), dn), -normal_change, n)
        if load.normal_force_kind == ENDS:
            couple: Vec3 = add_cross(cross(dn, base_joint_moment(scene, load)), n, joint_moment_tangent(scene, load))
            store_end_forces(scene, column, j, change, couple)
        else:
            store_force_parts(scene, column, j, change, zero)


def base_joint_force(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the force of the load's joint at the base state (`joint_force`)."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.joint_body >= 0:
        return scene.state_values[load.joint_body].f
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.multipliers[i], scene.closures[i].f)
    return total


def base_joint_moment(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the moment of the load's joint about its `to` point at the base state (`joint_moment`)."""
    i: cython.Py_ssize_t
    total: Vec3 = Vec3(0.0, 0.0, 0.0)
    if load.joint_body >= 0:
        base: cython.pointer[BodyAtState] = cython.address(scene.state_values[load.joint_body])
        return add_cross(base.M, sub(scene.bodies[load.joint_body].r, load.place), base.f)
    for i in range(load.row, load.row + load.row_count):
        total = add_scaled(total, scene.multipliers[i], scene.closures[i].m)
    return total


def joint_force_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the change of the force of the load's joint; for a cut one d(lambda) f + lambda df."""
    i: cython.Py_ssize_t
    total: Vec3 = joint_force(scene, load)
    if load.joint_body < 0:
        for i in range(load.row, load.row + load.row_count):
            row: cython.pointer[Closure] = cython.address(scene.closures[i])
            if row.rank >= 0:
                total = add_scaled(total, scene.multipliers[i], row_tangent(scene, row).f)
    return total


def joint_moment_tangent(scene: cython.pointer[Scene], load: cython.pointer[Load]) -> Vec3:
    """Return the change of the joint's moment about its `to` point x: dM + (dr - dx) x F + (r - x) x dF."""
    i: cython.Py_ssize_t
    total: Vec3 = joint_moment(scene, load)
    if load.joint_body >= 0:
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[load.joint_body])
        arm_change: Vec3 = sub(d.r, point_tangent(scene, load.b, load.q).x)
        return add_cross(total, arm_change, scene.state_values[load.joint_body].f)
    for i in range(load.row, load.row + load.row_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.rank >= 0:
            total = add_scaled(total, scene.multipliers[i], row_tangent(scene, row).m)
    return total
