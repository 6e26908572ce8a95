"""Which closure rows carry the motion: an independent set, by an orthogonal factorisation of J with pivoting.

The rank of the closures is a matter of geometry: neither masses nor squares have a say in it. J on the tree's freedoms,
island by island; turns and couples by the island's length, which makes rows of the order of 1, and those with longer
levers are shortened to that. The verdicts judge the same matrix (loads/redundancy/self_stress.py).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.algebra import Vec3, add, add_cross, cross, dot, inverse_form, sub
    from heuncli.kernel.closures import clear_path, measure_rows, put_unit_loads
    from heuncli.kernel.conditions import condition, condition_count
    from heuncli.kernel.orthogonal import answer_of_sides, factor_closures, list_coupled, take_roots
    from heuncli.kernel.scene import CARRIES, SHIFT, Body, Closure, Freedom, Island, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import factor_tree, kinematics, load_along


def select_independent_rows(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, afresh: cython.bint
) -> cython.int:
    """Choose an independent set of rows at y, and factor over it; how many. afresh: nearness starts anew, too."""
    i: cython.Py_ssize_t
    kinematics(scene, t, y)
    measure_rows(scene, t)
    factor_tree(scene)
    take_roots(scene)
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        row.rank = 0 if row.mode == CARRIES else -1
        scale_pose(scene, row, afresh)
    order_all(scene, scene.least_row)
    scene.selected_count = 0
    for i in range(scene.closure_count):
        one: cython.pointer[Closure] = cython.address(scene.closures[i])
        one.rank = -1
        if one.chosen >= 0:
            one.rank = scene.selected_count
            scene.selected[scene.selected_count] = i
            scene.selected_count += 1
    list_coupled(scene)
    if scene.selected_count:
        scene.pivot_chosen = factor_closures(scene)
        scene.pivot = scene.pivot_chosen
    return scene.selected_count


def order_all(scene: cython.pointer[Scene], least: cython.double) -> cython.double:
    """Put the rows in the order of their pivots, those with a rank and more than `least` left; the least pivot."""
    i: cython.Py_ssize_t
    found: cython.double = 1.0
    for i in range(scene.island_count):
        pivot: cython.double = order_rows(scene, cython.address(scene.islands[i]), least)
        if pivot < found:
            found = pivot
    return found


def order_rows(scene: cython.pointer[Scene], island: cython.pointer[Island], least: cython.double) -> cython.double:
    """Put the rows of one island in the order of their pivots; the least pivot."""
    n: cython.int = 0
    found: cython.double = 1.0
    standing: cython.Py_ssize_t = stand(scene, island)
    while n < island.row_count and n < island.freedom_count:
        best: cython.int = next_pivot(scene, standing, least)
        if best < 0:
            break
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + best]])
        left: cython.double = sqrt(scene.left[best])
        if left < found:
            found = left
        row.chosen = n
        standing = without(scene, standing, best)
        take_out(scene, island, standing, best, n)
        n += 1
    return found


def stand(scene: cython.pointer[Scene], island: cython.pointer[Island]) -> cython.Py_ssize_t:
    """The rows of an island's J that have a rank, and those of them that have more than nothing; how many these are."""
    k: cython.Py_ssize_t
    width: cython.Py_ssize_t = island.freedom_count
    found: cython.Py_ssize_t = 0
    for k in range(island.row_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + k]])
        row.chosen = -1
        if row.rank < 0:
            continue
        scaled_row(scene, island, k)
        scene.left[k] = square_left(scene, island, k, 0)
        scene.reach[k] = reach_of(scene, list_filled(scene, width * k, 0, width), width)
        if scene.left[k] != 0.0:
            scene.standing[found] = k
            found += 1
    return found


def without(scene: cython.pointer[Scene], standing: cython.Py_ssize_t, best: cython.int) -> cython.Py_ssize_t:
    """One row no longer stands; how many are left."""
    j: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    for j in range(standing):
        if scene.standing[j] != best:
            scene.standing[found] = scene.standing[j]
            found += 1
    return found


def scaled_row(scene: cython.pointer[Scene], island: cython.pointer[Island], k: cython.Py_ssize_t) -> cython.void:
    """Row k of the island's J: turns and couples by its length, the row shortened to 1 if it is longer."""
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = island.freedom_count
    answer: cython.int
    square: cython.double = 0.0
    J: cython.p_double = scene.J
    row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + k]])
    for i in range(n):
        scene.spread[scene.indices[island.freedoms + i]] = 0.0
    jacobian_row(scene, row)
    for i in range(n):
        answer = scene.indices[island.freedoms + i]
        J[n * k + i] = scene.spread[answer] * scene.measure[answer] * row.measure if scene.root[answer] > 0.0 else 0.0
        square += J[n * k + i] * J[n * k + i]
    if square > 1.0:
        square = 1.0 / sqrt(square)
        for i in range(n):
            J[n * k + i] *= square


def jacobian_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """J of one row, spread over the freedoms of its path (a ball's turns about the world's axes).

    The rate of the row's gap for each freedom: the unit load's moment about its axis, or force along it; what is driven
    or moves nothing gives nothing.
    """
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t
    x: cython.p_double = scene.spread
    clear_path(scene, row)
    put_unit_loads(scene, row, -1.0)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        at = body.answer_at
        if body.ball:
            x[at] = body.M_branch.x
            x[at + 1] = body.M_branch.y
            x[at + 2] = body.M_branch.z
            at += 3
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            x[at] = 0.0 if freedom.driven else load_along(freedom, body.M_branch, body.f_branch)
            at += 1
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_branch = add(parent.M_branch, add_cross(body.M_branch, body.arm, body.f_branch))
            parent.f_branch = add(parent.f_branch, body.f_branch)


def square_left(
    scene: cython.pointer[Scene], island: cython.pointer[Island], k: cython.Py_ssize_t, n: cython.Py_ssize_t
) -> cython.double:
    """Square of what the n rows chosen before have left of row k."""
    i: cython.Py_ssize_t
    found: cython.double = 0.0
    width: cython.Py_ssize_t = island.freedom_count
    for i in range(n, width):
        found += scene.J[width * k + i] * scene.J[width * k + i]
    return found


def next_pivot(scene: cython.pointer[Scene], standing: cython.Py_ssize_t, least: cython.double) -> cython.int:
    """The row with most left of it; an earlier one is preferred a little, which keeps the choice steady. -1: none."""
    j: cython.Py_ssize_t
    k: cython.int
    best: cython.int = -1
    most: cython.double = least * least / scene.limits.preference
    for j in range(standing):
        k = scene.standing[j]
        if scene.left[k] > most * scene.limits.preference:
            most = scene.left[k]
            best = k
    return best


def take_out(
    scene: cython.pointer[Scene],
    island: cython.pointer[Island],
    standing: cython.Py_ssize_t,
    best: cython.Py_ssize_t,
    n: cython.Py_ssize_t,
) -> cython.void:
    """Reflect what is left of the pivot row onto the n-th direction, and all rows that stand with it.

    A loop meets few of the freedoms: only where the pivot row has something is there anything to reflect, and a row
    that has nothing there stays as it is, and as much is left of it.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t
    width: cython.Py_ssize_t = island.freedom_count
    J: cython.p_double = scene.J
    v: cython.Py_ssize_t = width * best
    x: cython.double
    left: cython.double = sqrt(scene.left[best])
    reflector: cython.double = 1.0 / (scene.left[best] + left * fabs(J[v + n]))
    J[v + n] += left if J[v + n] > 0.0 else -left
    filled: cython.Py_ssize_t = list_filled(scene, v, n, width)
    reach: cython.int = reach_of(scene, filled, width)
    for j in range(standing):
        k = scene.standing[j]
        at = width * k
        x = 0.0
        if scene.reach[k] & reach:
            for i in range(filled):
                x += J[v + scene.filled[i]] * J[at + scene.filled[i]]
        if x != 0.0:
            x *= reflector
            for i in range(filled):
                J[at + scene.filled[i]] -= x * J[v + scene.filled[i]]
            scene.reach[k] |= reach
        if x != 0.0 or J[at + n] != 0.0:
            scene.left[k] = square_left(scene, island, k, n + 1)


def list_filled(
    scene: cython.pointer[Scene], v: cython.Py_ssize_t, n: cython.Py_ssize_t, width: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """The freedoms from the n-th on that the row of J at v has something of, ascending; how many."""
    i: cython.Py_ssize_t
    found: cython.Py_ssize_t = 0
    for i in range(n, width):
        if scene.J[v + i] != 0.0:
            scene.filled[found] = i
            found += 1
    return found


def reach_of(scene: cython.pointer[Scene], filled: cython.Py_ssize_t, width: cython.Py_ssize_t) -> cython.int:
    """In which parts of an island's freedoms the freedoms listed lie, a bit a part: rows apart in that share none."""
    i: cython.Py_ssize_t
    found: cython.int = 0
    for i in range(filled):
        found |= 1 << (31 * scene.filled[i] // width)  # as many parts as an int has bits beside its sign
    return found


def scale_pose(scene: cython.pointer[Scene], row: cython.pointer[Closure], afresh: cython.bint) -> cython.void:
    """The row's scale in the motion: what its two sides answer, each alone, which no cancelling between them can make
    small, and at least a part of what it could answer across its arms."""
    i: cython.Py_ssize_t
    bound: cython.double = 0.0
    sides: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        bound += part.factor * part.factor * row_bound(scene, row, part)
        sides += part.factor * part.factor * answer_of_sides(scene, row, part)
    bound *= scene.limits.across
    if sides > bound:
        bound = sides
    near: cython.double = 1.0 / sqrt(bound) if bound > 0.0 else 0.0
    if afresh or near < row.pose_scale:
        row.pose_scale = near


def row_bound(
    scene: cython.pointer[Scene], whole: cython.pointer[Closure], row: cython.pointer[Closure]
) -> cython.double:
    """What the freedoms of a row's paths would answer from where they are if its load stood across their arms.

    row: the one itself, or one of the parts that the whole is the sum of.
    """
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    force: cython.double = dot(row.f, row.f)
    couple: cython.double = dot(row.m, row.m)
    for n in range(whole.path, whole.path + whole.path_count):
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
