"""Multipliers of the closures and their effect on the freedoms, by an orthogonal factorisation: nothing is squared.

    M = L^-T D L^-1 by the sweep, D of the freedoms;  B = D^(-1/2) E,  its columns e_r of the independent rows
    B = Q R;   x = D^(-1/2) e  ->  x + B lambda,   B'(x + B lambda) = -demand
    y = -R^-T demand,  lambda = R^-1 (y - Q'x),    x <- x + Q (y - Q'x)

A = B'B = J M^-1 J' has the square of B's condition number: its Cholesky factor has no digit left where B has half of
them. Loads enter through Q'x, which is divided by R once; the rows' demands are divided twice, as they must be. R is
found by Householder reflectors 1 - 2 v v' / v'v, one column after the other, each over the freedoms of it and of
earlier rows; the pivot is the largest entry left, which preserves what light and heavy bodies share (Cox and Higham,
BIT 38 (1998) 34-50).
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.closures import (
    add_unit_load,
    build_column,
    clear_path,
    size_of_required_acceleration,
    sweep_column,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.plane_rows import spread_row_in_plane


def factor_closures(scene: cython.pointer[Scene]) -> cython.double:
    """Find R and the reflectors over the independent rows. Returns the smallest pivot.

    A pivot is what earlier rows leave of a row, squared, relative to its response when the rows were chosen: so a row
    that vanishes counts. -1 if nothing is left.
    """
    i: cython.Py_ssize_t
    pivot: cython.double
    least: cython.double = 1.0
    set_inertia_roots(scene)
    for i in range(scene.velocity_count):
        scene.is_pivot[i] = 0
    for i in range(scene.selected_count):
        pivot = eliminate_row(scene, i)
        if pivot < least:
            least = pivot
    return least


def set_inertia_roots(scene: cython.pointer[Scene]) -> cython.void:
    """Set D^(-1/2) of all freedoms; for a ball's three rotations from the factors of its inertia."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    if scene.flat:
        for k in range(scene.freedom_count):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            scene.inertia_root[freedom.velocity_at] = sqrt(freedom.D)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        offset = body.velocity_at
        if body.ball:
            r: Vec3 = inverse_diagonal_roots(body.A_factors)
            write_vector(scene.inertia_root, offset, r)
            offset += 3
        for k in range(body.first_freedom, body.end_freedom):
            scene.inertia_root[offset] = sqrt(scene.freedoms[k].D)
            offset += 1


def scale_by_roots(scene: cython.pointer[Scene], body: cython.pointer[Body], x: cython.p_double) -> cython.void:
    """x <- D^(-1/2) x on the freedoms of one body."""
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t = body.velocity_at
    if body.ball:
        root: Vec3 = read_vector(scene.inertia_root, offset)
        turns: Vec3 = half_solve(body.A_factors, root, read_vector(x, offset))
        write_vector(x, offset, turns)
        offset += 3
    for k in range(offset, offset + body.end_freedom - body.first_freedom):
        x[k] *= scene.inertia_root[k]


def add_unscaled(scene: cython.pointer[Scene], body: cython.pointer[Body], x: cython.p_double) -> cython.void:
    """e <- e + D^(1/2) x on the freedoms of one body; freedoms without D do not respond."""
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t = body.velocity_at
    if body.ball:
        if scene.inertia_root[offset] > 0.0:
            root: Vec3 = read_vector(scene.inertia_root, offset)
            turns: Vec3 = undo_half_solve(body.A_factors, root, read_vector(x, offset))
            scene.e[offset] += turns.x
            scene.e[offset + 1] += turns.y
            scene.e[offset + 2] += turns.z
        offset += 3
    for k in range(offset, offset + body.end_freedom - body.first_freedom):
        if scene.inertia_root[k] > 0.0:
            scene.e[k] += x[k] / scene.inertia_root[k]


def response_of_sides(
    scene: cython.pointer[Scene], whole: cython.pointer[Closure], row: cython.pointer[Closure]
) -> cython.double:
    """Return e . D^-1 e of the row's load on one of its two bodies alone, plus that on the other; whole: the row it is
    a part of.
    """
    total: cython.double = response_of_side(scene, whole, row, row.b, 1.0)
    return total + response_of_side(scene, whole, row, row.a, -1.0)


def response_of_side(
    scene: cython.pointer[Scene],
    whole: cython.pointer[Closure],
    row: cython.pointer[Closure],
    body: cython.int,
    sign: cython.double,
) -> cython.double:
    """Return e . D^-1 e of the row's load on one body."""
    clear_path(scene, whole)
    add_unit_load(scene, row, body, sign)
    sweep_column(scene, whole)
    spread_column(scene, whole)
    return response_of_spread(scene, whole)


def response_of_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """e_r . D^-1 e_r."""
    spread_row(scene, row)
    return response_of_spread(scene, row)


def response_of_spread(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Return e . D^-1 e of the column that is spread."""
    k: cython.Py_ssize_t
    total: cython.double = 0.0
    x: cython.double
    for k in range(row.velocity_count):
        x = scene.velocity_vector[scene.indices[row.velocities + k]]
        total += x * x
    return total


def spread_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Spread the row's column of B over all freedoms."""
    if scene.flat:
        spread_row_in_plane(scene, row)
        return
    build_column(scene, row)
    spread_column(scene, row)


def spread_column(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Spread the row's column of B, from e_r as it is built, over all freedoms."""
    k: cython.Py_ssize_t
    for k in range(row.filled_count):
        scene.velocity_vector[scene.indices[row.velocities + k]] = 0.0
    for k in range(row.velocity_count):
        scene.velocity_vector[scene.indices[row.velocities + k]] = scene.columns[row.column + k]
    for k in range(row.path, row.path + row.path_count):
        scale_by_roots(scene, cython.address(scene.bodies[scene.indices[k]]), scene.velocity_vector)


def apply_reflector(scene: cython.pointer[Scene], row: cython.pointer[Closure], x: cython.p_double) -> cython.void:
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


def list_coupled_rows(scene: cython.pointer[Scene]) -> cython.void:
    """List for each independent row the ranks of the earlier ones that fill it, ascending."""
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
    """Find row i of R' and the reflector that ends its column. Returns its pivot."""
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
        apply_reflector(scene, earlier, scene.velocity_vector)
        R[m * i + rank] = scene.velocity_vector[earlier.pivot_velocity]
    left: cython.double = make_reflector(scene, row)
    if left == 0.0:
        R[m * i + i] = 1.0
        return -1.0
    R[m * i + i] = 1.0 / left
    return left * left * row.pose_scale * row.pose_scale


def begin_row(scene: cython.pointer[Scene], i: cython.Py_ssize_t, first: cython.int) -> cython.void:
    """Begin row i of R' at the first independent row that fills it."""
    k: cython.Py_ssize_t
    scene.envelope[i] = first
    for k in range(first, i):
        scene.R[scene.selected_count * i + k] = 0.0


def make_reflector(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.double:
    """Make the reflector that leaves one entry of a column, where it is largest; return that entry, 0 if nothing is
    left.

    Only its nonzero entries are stored: the pivots of earlier rows drop out, so that loops in a chain stay separate.
    """
    k: cython.Py_ssize_t
    velocity: cython.int
    x: cython.double
    square: cython.double = 0.0
    largest: cython.double = 0.0
    pivot_position: cython.Py_ssize_t = -1
    n: cython.Py_ssize_t = row.column
    for k in range(row.velocities, row.velocities + row.filled_count):
        velocity = scene.indices[k]
        x = scene.velocity_vector[velocity]
        if x == 0.0 or scene.is_pivot[velocity]:
            continue
        scene.columns[n] = x
        scene.support[n] = velocity
        square += x * x
        if fabs(x) > largest:
            largest = fabs(x)
            pivot_position = n
        n += 1
    row.support_count = n - row.column
    row.reflector = 0.0
    row.pivot_velocity = scene.indices[row.velocities]
    if pivot_position < 0:
        row.support_count = 0
        return 0.0
    length: cython.double = sqrt(square)
    left: cython.double = -length if scene.columns[pivot_position] > 0.0 else length
    scene.columns[pivot_position] -= left
    row.reflector = 1.0 / (square + length * largest)
    row.pivot_velocity = scene.support[pivot_position]
    scene.is_pivot[row.pivot_velocity] = 1
    return left


def solve_closures(scene: cython.pointer[Scene]) -> cython.void:
    """Find the multipliers that meet the rows' demands, and add their effect to the loads e on the freedoms."""
    i: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    x: cython.p_double = scene.velocity_vector
    y: cython.p_double = scene.row_vector
    for i in range(scene.closure_count):
        scene.closures[i].multiplier = 0.0
    scene.load_size = size_of_loads(scene)
    for i in range(m):
        apply_reflector(scene, cython.address(scene.closures[scene.selected[i]]), x)
    solve_demands(scene)
    for i in range(m):
        y[i] -= x[scene.closures[scene.selected[i]].pivot_velocity]
    for i in range(scene.velocity_count):
        x[i] = 0.0
    for i in range(m):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        x[row.pivot_velocity] = y[i]
    solve_backward(scene, y)
    for i in range(m):
        scene.closures[scene.selected[i]].multiplier = y[i]
    for i in range(m - 1, -1, -1):
        apply_reflector(scene, cython.address(scene.closures[scene.selected[i]]), x)
    if scene.flat:
        for i in range(scene.velocity_count):
            if scene.inertia_root[i] > 0.0:
                scene.e[i] += x[i] / scene.inertia_root[i]
        return
    for i in range(scene.body_count):
        add_unscaled(scene, cython.address(scene.bodies[i]), x)


def solve_demands(scene: cython.pointer[Scene]) -> cython.void:
    """y = -R^-T demand."""
    i: cython.Py_ssize_t
    for i in range(scene.selected_count):
        scene.row_vector[i] = -scene.closures[scene.selected[i]].demand
    solve_forward(scene, scene.row_vector)


def solve_forward(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
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


def solve_backward(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """y <- R^-1 y."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    for i in range(m - 1, -1, -1):
        y[i] *= scene.R[m * i + i]
        for k in range(scene.envelope[i], i):
            y[k] -= scene.R[m * i + k] * y[i]


def estimate_multiplier_doubt(scene: cython.pointer[Scene]) -> cython.void:
    """Estimate the rounding error of the multipliers: |R^-1| (rounding of x and of B lambda + |R^-T| rounding of
    demands).

    Instead of absolute values the signs are chosen that let the solutions grow (LINPACK's estimate of a condition
    number).
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    z: cython.double
    y: cython.p_double = scene.row_vector
    R: cython.p_double = scene.R
    rounding: cython.double = scene.limits.rounding
    loads: cython.double = rounding * (scene.load_size + size_of_multipliers(scene))
    for i in range(scene.closure_count):
        scene.closures[i].multiplier_error = 0.0
    for i in range(m):
        z = 0.0
        for k in range(scene.envelope[i], i):
            z -= R[m * i + k] * y[k]
        y[i] = grow_magnitude(
            z, rounding * size_of_required_acceleration(scene, cython.address(scene.closures[scene.selected[i]]))
        )
        y[i] *= R[m * i + i]
    for i in range(m):
        y[i] = fabs(y[i]) + loads
    for i in range(m):
        scene.closures[scene.selected[i]].multiplier_error = 0.0
    for i in range(m - 1, -1, -1):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        row.multiplier_error = grow_magnitude(row.multiplier_error, y[i]) * R[m * i + i]
        for k in range(scene.envelope[i], i):
            scene.closures[scene.selected[k]].multiplier_error -= R[m * i + k] * row.multiplier_error
    for i in range(m):
        scene.closures[scene.selected[i]].multiplier_error = fabs(scene.closures[scene.selected[i]].multiplier_error)


def grow_magnitude(x: cython.double, increment: cython.double) -> cython.double:
    """x with `increment` added to its magnitude."""
    return x + increment if x > 0.0 else x - increment


def size_of_loads(scene: cython.pointer[Scene]) -> cython.double:
    """Set x = D^(-1/2) e, spread over all freedoms, and return |x|."""
    i: cython.Py_ssize_t
    square: cython.double = 0.0
    if scene.flat:
        for i in range(scene.velocity_count):
            scene.velocity_vector[i] = scene.inertia_root[i] * scene.e[i]
            square += scene.velocity_vector[i] * scene.velocity_vector[i]
        return sqrt(square)
    for i in range(scene.velocity_count):
        scene.velocity_vector[i] = scene.e[i]
    for i in range(scene.body_count):
        scale_by_roots(scene, cython.address(scene.bodies[i]), scene.velocity_vector)
    for i in range(scene.velocity_count):
        square += scene.velocity_vector[i] * scene.velocity_vector[i]
    return sqrt(square)


def size_of_multipliers(scene: cython.pointer[Scene]) -> cython.double:
    """Return the sum of |b_r| |lambda_r|, the parts of B lambda."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    m: cython.Py_ssize_t = scene.selected_count
    square: cython.double
    total: cython.double = 0.0
    for i in range(m):
        square = 1.0 / (scene.R[m * i + i] * scene.R[m * i + i])
        for k in range(scene.envelope[i], i):
            square += scene.R[m * i + k] * scene.R[m * i + k]
        total += sqrt(square) * fabs(scene.closures[scene.selected[i]].multiplier)
    return total
