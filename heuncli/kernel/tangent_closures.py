"""The change of closure rows along a direction of the state: closures.py, differentiated line by line.

d(J Vdot + gamma)      at the present accelerations: the demand on the response to the direction
d(J' lambda)           at the present multipliers: applied to the bodies as loads are
"""

from __future__ import annotations

from heuncli.kernel.conditions import condition, condition_count, condition_tangent
from heuncli.kernel.declarations import *
from heuncli.kernel.tangent_loads import opposite_load, push_load_tangent


def add_closure_tangents(scene: cython.pointer[Scene]) -> cython.void:
    """Set the demands of the independent rows; apply the changes of their multipliers' loads to the bodies."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        force: cython.double = scene.multipliers[scene.selected[i]]
        row.demand = 0.0
        for k in range(condition_count(row)):
            part: cython.pointer[Closure] = condition(scene, row, k)
            row.demand += part.factor * add_condition_tangent(scene, part, force * part.factor)


def add_condition_tangent(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], force: cython.double
) -> cython.double:
    """Return the demand of a condition between two bodies; apply the change of its load to them."""
    if (
        is_motion_unchanged(scene, row.a)
        and is_motion_unchanged(scene, row.b)
        and is_motion_unchanged(scene, row.c if row.kind == MESH or row.kind == CAM else -1)
    ):
        return 0.0
    d: RowTangent = condition_tangent(scene, row)
    load: LoadTangent = LoadTangent(d.Q, scale_vector(force, d.f), scale_vector(force, d.m))
    push_load_tangent(scene, row.b, row.Q, scale_vector(force, row.f), load)
    push_load_tangent(scene, row.a, row.Q, scale_vector(-force, row.f), opposite_load(load))
    return d.acceleration


def is_motion_unchanged(scene: cython.pointer[Scene], body: cython.int) -> cython.bint:
    """Return whether nothing of a body's motion changes."""
    return body < 0 or not scene.tangents[body].moves


def row_tangent(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Return the change of one row: its place and unit load, its rate and its acceleration J Vdot + gamma."""
    k: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    total: RowTangent = RowTangent(zero, zero, zero, 0.0, 0.0)
    for k in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, k)
        d: RowTangent = condition_tangent(scene, part)
        f: Vec3 = add_scaled(total.f, part.factor, d.f)
        m: Vec3 = add_scaled(total.m, part.factor, d.m)
        rate: cython.double = total.rate + part.factor * d.rate
        total = RowTangent(d.Q, f, m, rate, total.acceleration + part.factor * d.acceleration)
    return total
