"""Multipliers of the closures and what they make of the freedoms, by an orthogonal factorisation: no squares.

    M = L^-T D L^-1 by the sweep, D of the freedoms;  B = D^(-1/2) E,  its columns e_r of the independent rows
    B = Q R;   x = D^(-1/2) e  ->  x + B lambda,   B'(x + B lambda) = -demand
    y = -R^-T demand,  lambda = R^-1 (y - Q'x),    x <- x + Q (y - Q'x)
A = B'B = J M^-1 J' has the square of B's condition, its Cholesky factor no digit left where B has half of them. Loads
come in through Q'x, which divides by R once; what the rows demand is divided twice, as it must be. R by Householder's
reflectors 1 - 2 v v' / v'v, one column after the other, each over the freedoms that it and earlier rows meet; the pivot
is the largest entry left, which keeps what light and heavy bodies share (Cox and Higham, BIT 38 (1998) 34-50).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.algebra import Vec3, from_half, half_solve, roots
    from heuncli.kernel.closures import build_column, clear_path, put_unit_load, size_of_demand, sweep_column
    from heuncli.kernel.plane_rows import spread_in_plane
    from heuncli.kernel.scene import Body, Closure, Freedom, Scene
    from heuncli.kernel.shadow import cython


def factor_closures(scene: cython.pointer[Scene]) -> cython.double:
    """R and the reflectors over the independent rows; the least pivot.

    A pivot is what is left of a row by the earlier ones, squared, relative to what it could answer when the rows were
    chosen: a row that vanishes counts. -1 where nothing is left.
    """
    i: cython.Py_ssize_t
    pivot: cython.double
    least: cython.double = 1.0
    take_roots(scene)
    for i in range(scene.answer_count):
        scene.taken[i] = 0
    for i in range(scene.selected_count):
        pivot = eliminate_row(scene, i)
        if pivot < least:
            least = pivot
    return least


def take_roots(scene: cython.pointer[Scene]) -> cython.void:
    """D^(-1/2) of all freedoms, a ball's three turns by the factors of its inertia."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t
    if scene.flat:
        for k in range(scene.freedom_count):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            scene.root[freedom.answer_at] = sqrt(freedom.D)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        at = body.answer_at
        if body.ball:
            r: Vec3 = roots(body.turning)
            scene.root[at] = r.x
            scene.root[at + 1] = r.y
            scene.root[at + 2] = r.z
            at += 3
        for k in range(body.first_freedom, body.end_freedom):
            scene.root[at] = sqrt(scene.freedoms[k].D)
            at += 1


def halve(scene: cython.pointer[Scene], body: cython.pointer[Body], x: cython.p_double) -> cython.void:
    """x <- D^(-1/2) x on the freedoms of one body."""
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = body.answer_at
    if body.ball:
        root: Vec3 = Vec3(scene.root[at], scene.root[at + 1], scene.root[at + 2])
        turns: Vec3 = half_solve(body.turning, root, Vec3(x[at], x[at + 1], x[at + 2]))
        x[at] = turns.x
        x[at + 1] = turns.y
        x[at + 2] = turns.z
        at += 3
    for k in range(at, at + body.end_freedom - body.first_freedom):
        x[k] *= scene.root[k]


def add_doubled(scene: cython.pointer[Scene], body: cython.pointer[Body], x: cython.p_double) -> cython.void:
    """e <- e + D^(1/2) x on the freedoms of one body; what has no D answers nothing."""
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t = body.answer_at
    if body.ball:
        if scene.root[at] > 0.0:
            root: Vec3 = Vec3(scene.root[at], scene.root[at + 1], scene.root[at + 2])
            turns: Vec3 = from_half(body.turning, root, Vec3(x[at], x[at + 1], x[at + 2]))
            scene.e[at] += turns.x
            scene.e[at + 1] += turns.y
            scene.e[at + 2] += turns.z
        at += 3
    for k in range(at, at + body.end_freedom - body.first_freedom):
        if scene.root[k] > 0.0:
            scene.e[k] += x[k] / scene.root[k]


def answer_of_sides(
    scene: cython.pointer[Scene], whole: cython.pointer[Closure], row: cython.pointer[Closure]
) -> cython.double:
    """e . D^-1 e of the row's load on one of its two bodies alone, and on the other; whole: what it is a part of."""
    found: cython.double = answer_of_side(scene, whole, row, row.b, 1.0)
    return found + answer_of_side(scene, whole, row, row.a, -1.0)


def answer_of_side(
    scene: cython.pointer[Scene],
    whole: cython.pointer[Closure],
    row: cython.pointer[Closure],
    body: cython.int,
    sign: cython.double,
) -> cython.double:
    """e . D^-1 e of the row's load on one body."""
    clear_path(scene, whole)
    put_unit_load(scene, row, body, sign)
    sweep_column(scene, whole)
    spread_column(scene, whole)
    return answer_of_spread(scene, whole)


def answer_of_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """e_r . D^-1 e_r."""
    spread_row(scene, row)
    return answer_of_spread(scene, row)


def answer_of_spread(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """e . D^-1 e of the column that is spread."""
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    x: cython.double
    for k in range(row.answer_count):
        x = scene.spread[scene.indices[row.answers + k]]
        found += x * x
    return found


def spread_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """The row's column of B, spread over all freedoms."""
    if scene.flat:
        spread_in_plane(scene, row)
        return
    build_column(scene, row)
    spread_column(scene, row)


def spread_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """The row's column of B from e_r as it is built, spread over all freedoms."""
    k: cython.Py_ssize_t
    for k in range(row.filled_count):
        scene.spread[scene.indices[row.answers + k]] = 0.0
    for k in range(row.answer_count):
        scene.spread[scene.indices[row.answers + k]] = scene.columns[row.column + k]
    for k in range(row.path, row.path + row.path_count):
        halve(scene, cython.address(scene.bodies[scene.indices[k]]), scene.spread)


def reflect(scene: cython.pointer[Scene], row: cython.pointer[Closure], x: cython.p_double) -> cython.void:
    """x <- (1 - 2 v v' / v'v) x by the row's reflector v."""
    k: cython.Py_ssize_t
    along: cython.double = 0.0
    v: cython.p_double = scene.columns
    for k in range(row.column, row.column + row.support_count):
        along += v[k] * x[scene.support[k]]
    if along == 0.0:
        return
    along *= row.reflector
    for k in range(row.column, row.column + row.support_count):
        x[scene.support[k]] -= along * v[k]


def list_coupled(scene: cython.pointer[Scene]) -> cython.void:
    """Of each independent row the places of the earlier ones that fill it, ascending."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        row.coupled_count = 0
        for k in range(row.couplings, row.couplings + row.coupling_count):
            rank: cython.int = scene.closures[scene.indices[k]].rank
            if 0 <= rank < i:
                scene.coupled[row.couplings + row.coupled_count] = rank
                row.coupled_count += 1


def eliminate_row(scene: cython.pointer[Scene], i: cython.int) -> cython.double:
    """Row i of R' and the reflector that ends its column; its pivot."""
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    rank: cython.int
    R: cython.p_double = scene.R
    row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
    spread_row(scene, row)
    scene.envelope[i] = i
    if row.coupled_count:
        begin_row(scene, i, scene.coupled[row.couplings])
    for k in range(row.couplings, row.couplings + row.coupled_count):
        rank = scene.coupled[k]
        earlier: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[rank]])
        reflect(scene, earlier, scene.spread)
        R[m * i + rank] = scene.spread[earlier.pivot_at]
    left: cython.double = make_reflector(scene, row)
    if left == 0.0:
        R[m * i + i] = 1.0
        return -1.0
    R[m * i + i] = 1.0 / left
    return left * left * row.pose_scale * row.pose_scale


def begin_row(scene: cython.pointer[Scene], i: cython.Py_ssize_t, first: cython.int) -> cython.void:
    """Row i of R' begins at the first independent row that fills it."""
    k: cython.Py_ssize_t
    scene.envelope[i] = first
    for k in range(first, i):
        scene.R[scene.selected_count * i + k] = 0.0


def make_reflector(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """The reflector that leaves of a column one entry where it is largest, and that entry; 0 where nothing is left.

    It is kept where it is not zero: the pivots of earlier rows drop out, so that loops in a row stay apart.
    """
    k: cython.Py_ssize_t
    answer: cython.int
    x: cython.double
    square: cython.double = 0.0
    largest: cython.double = 0.0
    at: cython.Py_ssize_t = -1
    n: cython.Py_ssize_t = row.column
    for k in range(row.answers, row.answers + row.filled_count):
        answer = scene.indices[k]
        x = scene.spread[answer]
        if x == 0.0 or scene.taken[answer]:
            continue
        scene.columns[n] = x
        scene.support[n] = answer
        square += x * x
        if fabs(x) > largest:
            largest = fabs(x)
            at = n
        n += 1
    row.support_count = n - row.column
    row.reflector = 0.0
    row.pivot_at = scene.indices[row.answers]
    if at < 0:
        row.support_count = 0
        return 0.0
    length: cython.double = sqrt(square)
    left: cython.double = -length if scene.columns[at] > 0.0 else length
    scene.columns[at] -= left
    row.reflector = 1.0 / (square + length * largest)
    row.pivot_at = scene.support[at]
    scene.taken[row.pivot_at] = 1
    return left


def solve_closures(scene: cython.pointer[Scene]) -> cython.void:
    """The multipliers that meet what the rows demand, and what they add to the loads e that the freedoms answer."""
    i: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    x: cython.p_double = scene.spread
    y: cython.p_double = scene.y
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = 0.0
    scene.load_size = size_of_loads(scene)
    for i in range(m):
        reflect(scene, cython.address(scene.closures[scene.selected[i]]), x)
    meet_demands(scene)
    for i in range(m):
        y[i] -= x[scene.closures[scene.selected[i]].pivot_at]
    for i in range(scene.answer_count):
        x[i] = 0.0
    for i in range(m):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        x[row.pivot_at] = y[i]
    divide_back(scene, y)
    for i in range(m):
        scene.closures[scene.selected[i]].multiplier = y[i]
    for i in range(m - 1, -1, -1):
        reflect(scene, cython.address(scene.closures[scene.selected[i]]), x)
    if scene.flat:
        for i in range(scene.answer_count):
            if scene.root[i] > 0.0:
                scene.e[i] += x[i] / scene.root[i]
        return
    for i in range(scene.body_count):
        add_doubled(scene, cython.address(scene.bodies[i]), x)


def meet_demands(scene: cython.pointer[Scene]) -> cython.void:
    """y = -R^-T demand."""
    i: cython.Py_ssize_t
    for i in range(scene.selected_count):
        scene.y[i] = -scene.closures[scene.selected[i]].demand
    divide(scene, scene.y)


def divide(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """y <- R^-T y."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    x: cython.double
    for i in range(m):
        x = y[i]
        for k in range(scene.envelope[i], i):
            x -= scene.R[m * i + k] * y[k]
        y[i] = x * scene.R[m * i + i]


def divide_back(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """y <- R^-1 y."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    for i in range(m - 1, -1, -1):
        y[i] *= scene.R[m * i + i]
        for k in range(scene.envelope[i], i):
            y[k] -= scene.R[m * i + k] * y[i]


def doubt_multipliers(scene: cython.pointer[Scene]) -> cython.void:
    """What rounding may make of the multipliers: |R^-1| (rounding of x and of B lambda + |R^-T| rounding of demands).

    Signs that let the solutions grow stand for absolute values (LINPACK's estimate of a condition).
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    z: cython.double
    y: cython.p_double = scene.y
    R: cython.p_double = scene.R
    rounding: cython.double = scene.limits.rounding
    loads: cython.double = rounding * (scene.load_size + size_of_multipliers(scene))
    for i in range(scene.closure_count):
        scene.closures[i].doubt = 0.0
    for i in range(m):
        z = 0.0
        for k in range(scene.envelope[i], i):
            z -= R[m * i + k] * y[k]
        y[i] = grown(z, rounding * size_of_demand(scene, cython.address(scene.closures[scene.selected[i]])))
        y[i] *= R[m * i + i]
    for i in range(m):
        y[i] = fabs(y[i]) + loads
    for i in range(m):
        scene.closures[scene.selected[i]].doubt = 0.0
    for i in range(m - 1, -1, -1):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        row.doubt = grown(row.doubt, y[i]) * R[m * i + i]
        for k in range(scene.envelope[i], i):
            scene.closures[scene.selected[k]].doubt -= R[m * i + k] * row.doubt
    for i in range(m):
        scene.closures[scene.selected[i]].doubt = fabs(scene.closures[scene.selected[i]].doubt)


def grown(x: cython.double, by: cython.double) -> cython.double:
    """x with `by` added to its magnitude."""
    return x + by if x > 0.0 else x - by


def size_of_loads(scene: cython.pointer[Scene]) -> cython.double:
    """x = D^(-1/2) e, spread over all freedoms; |x|."""
    i: cython.Py_ssize_t
    square: cython.double = 0.0
    if scene.flat:
        for i in range(scene.answer_count):
            scene.spread[i] = scene.root[i] * scene.e[i]
            square += scene.spread[i] * scene.spread[i]
        return sqrt(square)
    for i in range(scene.answer_count):
        scene.spread[i] = scene.e[i]
    for i in range(scene.body_count):
        halve(scene, cython.address(scene.bodies[i]), scene.spread)
    for i in range(scene.answer_count):
        square += scene.spread[i] * scene.spread[i]
    return sqrt(square)


def size_of_multipliers(scene: cython.pointer[Scene]) -> cython.double:
    """Sum of |b_r| |lambda_r|, the parts of B lambda."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    square: cython.double
    found: cython.double = 0.0
    for i in range(m):
        square = 1.0 / (scene.R[m * i + i] * scene.R[m * i + i])
        for k in range(scene.envelope[i], i):
            square += scene.R[m * i + k] * scene.R[m * i + k]
        found += sqrt(square) * fabs(scene.closures[scene.selected[i]].multiplier)
    return found
