"""Choose the closure rows that carry the motion: an independent set, by an orthogonal factorisation of J with pivoting.

The rank of the closures is a matter of geometry: masses and velocities do not affect it. J on the tree's freedoms,
island by island; rotations and couples are scaled by the island's length, which makes rows of the order of 1, and those
with longer levers are shortened to that. Redundancy is decided from the same matrix (loads/redundancy/self_stress.py).

Below: the choice made at a pose, saved as numbers, and restored. What is computed at a state depends on it, too:
another set of independent rows agrees to rounding only.
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.closures import add_unit_loads, clear_path, measure_rows
from heuncli.kernel.conditions import condition, condition_count
from heuncli.kernel.declarations import *
from heuncli.kernel.kinematics import update_kinematics
from heuncli.kernel.orthogonal import factor_closures, list_coupled_rows, response_of_sides, set_inertia_roots
from heuncli.kernel.response import project_state
from heuncli.kernel.tree import factor_tree, project_on_freedom

# What a saved choice has of each row, behind its pivot.
ROW_RANK, ROW_SCALE = range(2)
ROW_NUMBERS = 2


def select_independent_rows(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, reset_scales: cython.bint
) -> cython.int:
    """Choose an independent set of rows at y, and factor over it. Returns how many. reset_scales: set the rows' scales
    again, too.
    """
    i: cython.Py_ssize_t
    update_kinematics(scene, t, y)
    measure_rows(scene, t)
    factor_tree(scene)
    set_inertia_roots(scene)
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        # while rows are chosen: 0 may be chosen, -1 not; afterwards its place among the chosen
        row.rank = 0 if row.mode == CARRIES else -1
        set_pose_scale(scene, row, reset_scales)
    order_all(scene, scene.least_row)
    scene.selected_count = 0
    for i in range(scene.closure_count):
        chosen_row: cython.pointer[Closure] = cython.address(scene.closures[i])
        chosen_row.rank = -1
        if chosen_row.selection_order >= 0:
            chosen_row.rank = scene.selected_count
            scene.selected[scene.selected_count] = i
            scene.selected_count += 1
    list_coupled_rows(scene)
    if scene.selected_count:
        scene.pivot_chosen = factor_closures(scene)
        scene.pivot = scene.pivot_chosen
    return scene.selected_count


def order_all(scene: cython.pointer[Scene], threshold: cython.double) -> cython.double:
    """Order the closure rows of all islands by their pivots: rows that may be chosen, and with more than `threshold`
    left. Returns the smallest pivot.
    """
    i: cython.Py_ssize_t
    least_pivot: cython.double = 1.0
    for i in range(scene.island_count):
        pivot: cython.double = order_island_rows(scene, cython.address(scene.islands[i]), threshold)
        if pivot < least_pivot:
            least_pivot = pivot
    return least_pivot


def order_island_rows(
    scene: cython.pointer[Scene], island: cython.pointer[Island], threshold: cython.double
) -> cython.double:
    """Order the rows of one island by their pivots. Returns the smallest pivot."""
    n: cython.int = 0
    least_pivot: cython.double = 1.0
    candidate_count: cython.Py_ssize_t = list_candidates(scene, island)
    while n < island.row_count and n < island.freedom_count:
        best: cython.int = find_next_pivot(scene, candidate_count, threshold)
        if best < 0:
            break
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + best]])
        left: cython.double = sqrt(scene.remainders[best])
        if left < least_pivot:
            least_pivot = left
        row.selection_order = n
        candidate_count = remove_candidate(scene, candidate_count, best)
        eliminate_pivot(scene, island, candidate_count, best, n)
        n += 1
    return least_pivot


def list_candidates(scene: cython.pointer[Scene], island: cython.pointer[Island]) -> cython.Py_ssize_t:
    """Build the rows of an island's J that may be chosen, and list the nonzero ones. Returns how many these are."""
    k: cython.Py_ssize_t
    width: cython.Py_ssize_t = island.freedom_count
    shift: cython.int = part_shift(width)
    count: cython.Py_ssize_t = 0
    for k in range(island.row_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + k]])
        row.selection_order = -1
        if row.rank < 0:
            continue
        build_scaled_row(scene, island, k)
        scene.row_bits[k] = find_reach(scene, list_nonzeros(scene, width * k, 0, width), shift)
        scene.remainders[k] = remaining_square(scene, width, k, 0, shift)
        if scene.remainders[k] != 0.0:
            scene.rows_left[count] = k
            count += 1
    return count


def remove_candidate(
    scene: cython.pointer[Scene], candidate_count: cython.Py_ssize_t, best: cython.int
) -> cython.Py_ssize_t:
    """Remove one row from the candidates. Returns how many are left."""
    j: cython.Py_ssize_t
    count: cython.Py_ssize_t = 0
    for j in range(candidate_count):
        if scene.rows_left[j] != best:
            scene.rows_left[count] = scene.rows_left[j]
            count += 1
    return count


def build_scaled_row(scene: cython.pointer[Scene], island: cython.pointer[Island], k: cython.Py_ssize_t) -> cython.void:
    """Build row k of the island's J: rotations and couples scaled by its length, the row shortened to 1 if it is
    longer.
    """
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = island.freedom_count
    velocity: cython.int
    square: cython.double = 0.0
    J: cython.p_double = scene.J
    row: cython.pointer[Closure] = cython.address(scene.closures[scene.indices[island.rows + k]])
    for i in range(n):
        scene.velocity_vector[scene.indices[island.freedoms + i]] = 0.0
    spread_jacobian_row(scene, row)
    for i in range(n):
        velocity = scene.indices[island.freedoms + i]
        J[n * k + i] = (
            scene.velocity_vector[velocity] * scene.velocity_scale[velocity] * row.unit_load_size
            if scene.inertia_root[velocity] > 0.0
            else 0.0
        )
        square += J[n * k + i] * J[n * k + i]
    if square > 1.0:
        square = 1.0 / sqrt(square)
        for i in range(n):
            J[n * k + i] *= square


def spread_jacobian_row(scene: cython.pointer[Scene], row: cython.pointer[Closure]) -> cython.void:
    """Spread J of one row over the freedoms of its path (a ball's rotations about the world's axes).

    The rate of the row's gap for each freedom: the unit load's moment about its axis, or force along it; zero for a
    driven freedom.
    """
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    x: cython.p_double = scene.velocity_vector
    clear_path(scene, row)
    add_unit_loads(scene, row, -1.0)
    for n in range(row.path, row.path + row.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        offset = body.velocity_at
        if body.ball:
            write_vector(x, offset, body.M_branch)
            offset += 3
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            x[offset] = 0.0 if freedom.driven else project_on_freedom(freedom, body.M_branch, body.f_branch)
            offset += 1
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_branch = add(parent.M_branch, add_cross(body.M_branch, body.arm, body.f_branch))
            parent.f_branch = add(parent.f_branch, body.f_branch)


def remaining_square(
    scene: cython.pointer[Scene],
    width: cython.Py_ssize_t,
    k: cython.Py_ssize_t,
    begin: cython.Py_ssize_t,
    shift: cython.int,
) -> cython.double:
    """Return the square of row k from direction `begin` on, over the parts where it is not zero: what as many rows
    chosen before leave of it.
    """
    i: cython.Py_ssize_t
    end: cython.Py_ssize_t
    square: cython.double = 0.0
    offset: cython.Py_ssize_t = width * k
    if shift == 0:
        for i in range(begin, width):
            square += scene.J[offset + i] * scene.J[offset + i]
        return square
    while begin < width:
        end = ((begin >> shift) + 1) << shift
        if end > width:
            end = width
        if scene.row_bits[k] & (1 << (begin >> shift)):
            for i in range(begin, end):
                square += scene.J[offset + i] * scene.J[offset + i]
        begin = end
    return square


def find_next_pivot(
    scene: cython.pointer[Scene], candidate_count: cython.Py_ssize_t, threshold: cython.double
) -> cython.int:
    """Return the row with the largest remainder, -1 if there is none; an earlier one is slightly preferred, so that the
    choice is stable.
    """
    j: cython.Py_ssize_t
    k: cython.int
    best: cython.int = -1
    most: cython.double = threshold * threshold / scene.limits.preference
    for j in range(candidate_count):
        k = scene.rows_left[j]
        if scene.remainders[k] > most * scene.limits.preference:
            most = scene.remainders[k]
            best = k
    return best


def eliminate_pivot(
    scene: cython.pointer[Scene],
    island: cython.pointer[Island],
    candidate_count: cython.Py_ssize_t,
    best: cython.Py_ssize_t,
    n: cython.Py_ssize_t,
) -> cython.void:
    """Reflect what is left of the pivot row onto the n-th direction, and all candidates with it.

    A loop involves few of the freedoms: only where the pivot row is not zero there is anything to reflect, and a row
    that is zero there stays as it is.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    width: cython.Py_ssize_t = island.freedom_count
    J: cython.p_double = scene.J
    v: cython.Py_ssize_t = width * best
    x: cython.double
    left: cython.double = sqrt(scene.remainders[best])
    reflector: cython.double = 1.0 / (scene.remainders[best] + left * fabs(J[v + n]))
    J[v + n] += left if J[v + n] > 0.0 else -left
    nonzero_count: cython.Py_ssize_t = list_nonzeros(scene, v, n, width)
    shift: cython.int = part_shift(width)
    reach: cython.int = find_reach(scene, nonzero_count, shift)
    for j in range(candidate_count):
        k = scene.rows_left[j]
        offset = width * k
        x = 0.0
        if scene.row_bits[k] & reach:
            for i in range(nonzero_count):
                x += J[v + scene.pivot_row_velocities[i]] * J[offset + scene.pivot_row_velocities[i]]
        if x != 0.0:
            x *= reflector
            for i in range(nonzero_count):
                J[offset + scene.pivot_row_velocities[i]] -= x * J[v + scene.pivot_row_velocities[i]]
            scene.row_bits[k] |= reach
        if x != 0.0 or J[offset + n] != 0.0:
            scene.remainders[k] = remaining_square(scene, width, k, n + 1, shift)


def list_nonzeros(
    scene: cython.pointer[Scene], v: cython.Py_ssize_t, n: cython.Py_ssize_t, width: cython.Py_ssize_t
) -> cython.Py_ssize_t:
    """List the freedoms from the n-th on for which the row of J at v is not zero, ascending. Returns how many."""
    i: cython.Py_ssize_t
    count: cython.Py_ssize_t = 0
    for i in range(n, width):
        if scene.J[v + i] != 0.0:
            scene.pivot_row_velocities[count] = i
            count += 1
    return count


# An island's freedoms are divided into at most 31 equal parts; row_bits has a bit for each part in which a row has an
# entry, so that rows without a common bit need not be multiplied.
def part_shift(width: cython.Py_ssize_t) -> cython.int:
    """Return the power of 2 of the size of an island's parts: at most 31, the bits of an int without its sign."""
    shift: cython.int = 0
    while (width - 1) >> shift > 30:
        shift += 1
    return shift


def find_reach(scene: cython.pointer[Scene], nonzero_count: cython.Py_ssize_t, shift: cython.int) -> cython.int:
    """Return in which parts of an island's freedoms the listed ones lie, one bit a part: rows without a common bit
    share none.
    """
    i: cython.Py_ssize_t
    reach: cython.int = 0
    for i in range(nonzero_count):
        reach |= 1 << (scene.pivot_row_velocities[i] >> shift)
    return reach


def set_pose_scale(
    scene: cython.pointer[Scene], row: cython.pointer[Closure], reset_scales: cython.bint
) -> cython.void:
    """Set the row's scale in the motion, 1 / sqrt(r); without reset_scales it can only become smaller.

    r is the larger of the response of its two sides, each alone so that they do not cancel, and a part (row_across) of
    the response if its load were perpendicular to its arms.
    """
    i: cython.Py_ssize_t
    bound: cython.double = 0.0
    sides: cython.double = 0.0
    for i in range(condition_count(row)):
        part: cython.pointer[Closure] = condition(scene, row, i)
        bound += part.factor * part.factor * bound_row_response(scene, row, part)
        sides += part.factor * part.factor * response_of_sides(scene, row, part)
    bound *= scene.limits.row_across
    if sides > bound:
        bound = sides
    scale: cython.double = 1.0 / sqrt(bound) if bound > 0.0 else 0.0
    if reset_scales or scale < row.pose_scale:
        row.pose_scale = scale


def bound_row_response(
    scene: cython.pointer[Scene], whole: cython.pointer[Closure], row: cython.pointer[Closure]
) -> cython.double:
    """Return the response of the freedoms of a row's paths if its load were perpendicular to their arms.

    row: the row itself, or one of the parts that the whole is the sum of
    """
    n: cython.Py_ssize_t
    k: cython.Py_ssize_t
    total: cython.double = 0.0
    force: cython.double = dot(row.f, row.f)
    couple: cython.double = dot(row.m, row.m)
    for n in range(whole.path, whole.path + whole.path_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[scene.indices[n]])
        if body.ball:
            total += bound_ball_response(body, row, force)
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                continue
            if freedom.kind == SHIFT:
                total += force * freedom.D
            else:
                swept: Vec3 = cross(freedom.s, sub(row.Q, body.r))
                total += (force * dot(swept, swept) + couple) * freedom.D
    return total


def bound_ball_response(
    body: cython.pointer[Body], row: cython.pointer[Closure], force: cython.double
) -> cython.double:
    """Return the response of a ball's rotations to a force in each direction at Q, and to the row's couple."""
    arm: Vec3 = sub(row.Q, body.r)
    x: cython.double = inverse_form(body.A_factors, Vec3(0.0, arm.z, -arm.y))
    y: cython.double = inverse_form(body.A_factors, Vec3(-arm.z, 0.0, arm.x))
    z: cython.double = inverse_form(body.A_factors, Vec3(arm.y, -arm.x, 0.0))
    return force * (x + y + z) + inverse_form(body.A_factors, row.m)


# The choice at a pose


def choose_rows_again(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Choose the rows at a pose and reset the measure of how independent they are; nothing of earlier poses remains."""
    scene.pivot = 1.0
    scene.pivot_chosen = 1.0
    select_independent_rows(scene, t, y, True)


def set_row_threshold(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Set what must be left of a row for it to be chosen, from the gap and the rows at the start.

    On the way through a singular pose a row is left out where rounding would contribute more to it than the pose does.
    A scene that is already as near to a singular pose at its start keeps its rows.
    """
    scene.least_row = scene.limits.independent
    select_independent_rows(scene, t, y, True)
    feigned: cython.double = scene.rank_of_gap * project_state(scene, t, y)  # what the gap may feign of a row
    if feigned > scene.least_row:
        scene.least_row = feigned
        select_independent_rows(scene, t, y, True)
    threshold: cython.double = scene.limits.passing_of_start * order_all(scene, 0.0)
    if threshold > scene.limits.passing:
        threshold = scene.limits.passing
    if threshold > scene.least_row:
        scene.least_row = threshold


def choice_width(scene: cython.pointer[Scene]) -> cython.int:
    """Return how many numbers a saved choice has."""
    return 1 + ROW_NUMBERS * scene.closure_count


def save_choice(scene: cython.pointer[Scene], buffer: cython.p_double, offset: cython.Py_ssize_t) -> cython.void:
    """Write the choice: the smallest pivot when it was made; for each row its rank (-1: left out) and its scale."""
    i: cython.Py_ssize_t
    offset = write_number(buffer, offset, scene.pivot_chosen)
    for i in range(scene.closure_count):
        offset = write_number(buffer, offset, scene.closures[i].rank)
        offset = write_number(buffer, offset, scene.closures[i].pose_scale)


def restore_choice(
    scene: cython.pointer[Scene], saved_choice: cython.p_double, offset: cython.Py_ssize_t
) -> cython.void:
    """Restore a saved choice; the next factorisation uses its rows."""
    i: cython.int
    rank: cython.int
    scene.pivot = 1.0
    scene.pivot_chosen = saved_choice[offset]
    scene.selected_count = 0
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        rank = int(saved_choice[offset + 1 + ROW_NUMBERS * i + ROW_RANK])
        row.rank = rank
        row.pose_scale = saved_choice[offset + 1 + ROW_NUMBERS * i + ROW_SCALE]
        if rank >= 0:
            scene.selected[rank] = i
            scene.selected_count += 1
    list_coupled_rows(scene)
