"""Which closure rows carry the motion: an independent set, by pivoted Cholesky of A over all rows, scaled.

A row's scale is what its two sides answer, each alone, which no cancelling between the two can make small. How near the
chosen ones come to depending on each other is measured against what a row could answer, not what it does in this pose.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import sqrt

    from heuncli.kernel.algebra import Vec3, cross, dot, inverse_form, sub
    from heuncli.kernel.closures import (
        build_column,
        clear_column,
        clear_path,
        column_product,
        factor_closures,
        measure_rows,
        put_unit_load,
        spread_column,
        sweep_column,
    )
    from heuncli.kernel.scene import SHIFT, Body, Closure, Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import factor_tree, kinematics


def select_independent_rows(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, afresh: cython.bint
) -> cython.int:
    """Choose an independent set of rows at y, and factor A over it; how many. afresh: nearness starts anew, too."""
    i: cython.Py_ssize_t
    rank: cython.int = 0
    kinematics(scene, t, y)
    measure_rows(scene, t)
    factor_tree(scene)
    for i in range(scene.closure_count):
        scale_row(scene, cython.address(scene.closures[i]), afresh)
    while rank < scene.closure_count:
        best: cython.int = next_pivot(scene)
        if best < 0:
            break
        eliminate_pivot(scene, best, rank)
        rank += 1
    scene.selected_count = rank_by_order(scene)
    if scene.selected_count:
        scene.pivot_chosen = factor_closures(scene)
        scene.pivot = scene.pivot_chosen
    return scene.selected_count


def scale_row(scene: cython.pointer[Scene], row: cython.pointer[Closure], afresh: cython.bint) -> cython.void:
    """The row's own answer, scaled, and its two scales; its column stays built."""
    sides: cython.double = answer_of_one_side(scene, row, row.b, 1.0) + answer_of_one_side(scene, row, row.a, -1.0)
    build_column(scene, row)
    row.pivot = own_answer(scene, row)
    row.rank = -1
    # what hardly answers at all (across the only axis its pins have, say) is rounding, and no row
    if sides > scene.limits.moves_nothing * largest_answer(scene, row):
        row.scale = 1.0 / sqrt(sides)
        row.pivot /= sides
    else:
        row.scale = 0.0
        row.pivot = 0.0
    bound: cython.double = scene.limits.across * row_bound(scene, row)
    if sides > bound:
        bound = sides
    near: cython.double = 1.0 / sqrt(bound) if bound > 0.0 else 0.0
    if afresh or near < row.pose_scale:
        row.pose_scale = near


def answer_of_one_side(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], body: cython.int, sign: cython.double
) -> cython.double:
    """e_r . D^-1 e_r of the row's load on one of its two bodies alone."""
    clear_path(scene, row)
    put_unit_load(scene, row, body, sign)
    sweep_column(scene, row)
    return own_answer(scene, row)


def own_answer(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """e_r . D^-1 e_r of the column as it is built."""
    spread_column(scene, row)
    found: cython.double = column_product(scene, row)
    clear_column(scene, row)
    return found


def largest_answer(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """What the freedoms of the row's paths would answer if its force, a size of the scene away, met all of them."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    shift: cython.double = dot(row.f, row.f)
    turn: cython.double = shift * scene.size * scene.size + dot(row.m, row.m)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            found += turn * (body.turning.xx + body.turning.yy + body.turning.zz)
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if not freedom.driven:
                found += (shift if freedom.kind == SHIFT else turn) * freedom.D
    return found


def row_bound(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """What the freedoms of the row's paths would answer from where they are if its load stood across their arms."""
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    force: cython.double = dot(row.f, row.f)
    couple: cython.double = dot(row.m, row.m)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            found += turn_bound(body, row, force)
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                continue
            if freedom.kind == SHIFT:
                found += force * freedom.D
            else:
                swept: Vec3 = cross(freedom.s, sub(row.Q, body.r))
                found += (force * dot(swept, swept) + couple) * freedom.D
    return found


def turn_bound(body: cython.pointer[Body], row: cython.pointer[Closure], force: cython.double) -> cython.double:
    """What a ball's turns would answer to a force in each of three directions at Q, and to the row's couple."""
    arm: Vec3 = sub(row.Q, body.r)
    x: cython.double = inverse_form(body.turning, Vec3(0.0, arm.z, -arm.y))
    y: cython.double = inverse_form(body.turning, Vec3(-arm.z, 0.0, arm.x))
    z: cython.double = inverse_form(body.turning, Vec3(arm.y, -arm.x, 0.0))
    return force * (x + y + z) + inverse_form(body.turning, row.m)


def next_pivot(scene: cython.pointer[Scene]) -> cython.int:
    """The row with most left of it; an earlier one is preferred a little, which keeps the choice steady. -1: none."""
    i: cython.int
    best: cython.int = -1
    most: cython.double = scene.limits.independent
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.rank < 0 and row.pivot > most * scene.limits.preference:
            most = row.pivot
            best = i
    return best


def eliminate_pivot(scene: cython.pointer[Scene], best: cython.int, rank: cython.int) -> cython.void:
    """Row `rank` of the scaled factor, L(rank, row), from the pivot; what it leaves of the rows not yet chosen."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.closure_count
    x: cython.double
    L: cython.p_double = scene.A
    pivot: cython.pointer[Closure] = cython.address(scene.closures[best])
    inverse: cython.double = 1.0 / sqrt(pivot.pivot)
    spread_column(scene, pivot)
    for i in range(n):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.rank < 0:
            x = column_product(scene, row) * row.scale * pivot.scale
            for k in range(rank):
                x -= L[n * k + i] * L[n * k + best]
            L[n * rank + i] = x * inverse
    clear_column(scene, pivot)
    pivot.rank = rank
    for i in range(n):
        other: cython.pointer[Closure] = cython.address(scene.closures[i])
        if other.rank < 0:
            other.pivot -= L[n * rank + i] * L[n * rank + i]


def rank_by_order(scene: cython.pointer[Scene]) -> cython.int:
    """The chosen rows in the order of the scene; how many."""
    i: cython.int
    count: cython.int = 0
    for i in range(scene.closure_count):
        if scene.closures[i].rank >= 0:
            scene.closures[i].rank = count
            scene.selected[count] = i
            count += 1
    return count
