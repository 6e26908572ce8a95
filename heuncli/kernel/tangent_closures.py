"""What closure rows change by along a direction of the state: closures.py, differentiated line by line.

d(J Vdot + gamma)      at the accelerations that stand: what the answer to the direction has to meet
d(J' lambda)           at the multipliers that stand: put on the bodies as loads are
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import Vec3, add_scaled, scaled
    from heuncli.kernel.conditions import condition, condition_count
    from heuncli.kernel.scene import CAM, MESH, Closure, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_conditions import condition_along
    from heuncli.kernel.tangent_loads import opposite, push_along
    from heuncli.kernel.values import LoadTangent, RowTangent


def closures_along(scene: cython.pointer[Scene]) -> cython.void:
    """What the independent rows demand of the answer; their multipliers' loads, as they change, on the bodies."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        force: cython.double = scene.multipliers[scene.selected[i]]
        row.demand = 0.0
        for k in range(condition_count(row)):
            part: cython.pointer[Closure] = condition(scene, row, k)
            row.demand += part.factor * condition_loads_along(scene, part, force * part.factor)


def condition_loads_along(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], force: cython.double
) -> cython.double:
    """What a condition of two bodies demands of the answer; its load, as it changes, on them."""
    if (
        is_motion_unchanged(scene, row.a)
        and is_motion_unchanged(scene, row.b)
        and is_motion_unchanged(scene, row.c if row.kind == MESH or row.kind == CAM else -1)
    ):
        return 0.0
    d: RowTangent = condition_along(scene, row)
    load: LoadTangent = LoadTangent(d.Q, scaled(force, d.f), scaled(force, d.m))
    push_along(scene, row.b, row.Q, scaled(force, row.f), load)
    push_along(scene, row.a, row.Q, scaled(-force, row.f), opposite(load))
    return d.acceleration


def is_motion_unchanged(scene: cython.pointer[Scene], body: cython.int) -> cython.bint:
    """Whether nothing of a body's motion changes."""
    return body < 0 or not scene.tangents[body].moves


def row_along(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> RowTangent:
    """Of one row: its place and unit load, its rate and its acceleration J Vdot + gamma."""
    k: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    found: RowTangent = RowTangent(zero, zero, zero, 0.0, 0.0)
    for k in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, k)
        d: RowTangent = condition_along(scene, part)
        f: Vec3 = add_scaled(found.f, part.factor, d.f)
        m: Vec3 = add_scaled(found.m, part.factor, d.m)
        rate: cython.double = found.rate + part.factor * d.rate
        found = RowTangent(d.Q, f, m, rate, found.acceleration + part.factor * d.acceleration)
    return found
