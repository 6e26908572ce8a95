"""The one linear map: at a configuration the tree and the closures are factored once, then any load is answered.

    configure   factors of tree and closures at the present kinematics: no loads
    respond     loads on the bodies -> accelerations and multipliers; inertial: with velocity terms, drives and gravity
Accelerations (49), velocity jumps (48), projection onto the closures and single columns of loads
(heuncli/multibody/response.py) are all answers of this map: M V + ... = loads + J' lambda, J V + gamma = 0.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.algebra import Quaternion, Vec3, dot, slightly_turned, turned
    from heuncli.kernel.closures import count_turns, demanded, measure_moving_rows, measure_row, push_closures
    from heuncli.kernel.loads import apply_loads
    from heuncli.kernel.orthogonal import factor_closures, solve_closures
    from heuncli.kernel.pressing import apply_kept, apply_unit, find_pressed, keep_applied, rub, see_pressing
    from heuncli.kernel.scene import APART, Body, Closure, Freedom, Lent, Load, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tree import (
        add_zeros,
        balance,
        derivative,
        downward,
        factor_loaded,
        factor_tree,
        kinematics,
        push_lent,
        put_all_loads,
        put_loads,
        upward,
    )


def configure(scene: cython.pointer[Scene], t: cython.double) -> cython.int:
    """Factors of the tree, the closures, and of what is lent; how many freedoms have no inertia behind them.

    -1 for lost closures.
    """
    i: cython.Py_ssize_t
    idle: cython.int = factor_tree(scene)
    if scene.selected_count:
        for i in range(scene.selected_count):
            measure_row(scene, cython.address(scene.closures[scene.selected[i]]), t)
        scene.pivot = factor_closures(scene)
        if scene.pivot < scene.pivot_of_step:
            scene.pivot_of_step = scene.pivot
        if scene.pivot < 0.0:
            return -1
    if scene.lent_count:
        idle += weigh_lent(scene)
        if scene.limits.own_share < scene.own_share < scene.limits.much_lent:
            lend_less(scene)
    return idle


def respond(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Accelerations and multipliers that answer the loads on the bodies; what is lent takes nothing of them.

    With closures, loads and what the rows demand of the kinematics are kept apart: the answer to loads is then as exact
    as the geometry (orthogonal.py).
    """
    i: cython.Py_ssize_t
    apart: cython.bint = inertial and scene.selected_count > 0
    for i in range(scene.lent_count):
        scene.lents[i].z = 0.0
    answer_loads(scene, inertial, apart)
    if scene.lent_count:
        find_taken(scene)
        answer_loads(scene, inertial, apart)
    if apart:
        add_zeros(scene)


def answer_loads(scene: cython.pointer[Scene], inertial: cython.bint, apart: cython.bint) -> cython.void:
    """What answers given loads of what is lent; apart: less the accelerations if no freedom accelerated."""
    i: cython.Py_ssize_t
    if apart:
        put_all_loads(scene)
    else:
        put_loads(scene, inertial)
    for i in range(scene.selected_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[scene.selected[i]])
        row.demand = demanded(scene, row) if apart else 0.0
    answer(scene, inertial and not apart)


def answer(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Accelerations and multipliers that answer what stands in M_branch and f_branch, and what the rows demand."""
    upward(scene, inertial)
    scene.load_size = 0.0
    if scene.selected_count:
        solve_closures(scene)
    downward(scene, inertial)


def weigh_lent(scene: cython.pointer[Scene]) -> cython.int:
    """1 - T, T_ij = n_i . alpha of the answer to n_j alone, and its Cholesky factor; how many motions nothing holds.

    Lent inertia takes z = n . alpha of the loads. Returned as loads of their own they make z = z_0 + T z, with z_0 what
    the loads alone would give: so the answer is that of the bodies as they are, for any inertia lent. The eigenvalues
    of 1 - T are the shares that the bodies' own inertia has in what moves; where nothing can move they are 1.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.lent_count
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    loose: cython.int = 0
    x: cython.double
    scene.own_share = 1.0
    for i in range(scene.closure_count):
        scene.closures[i].demand = 0.0
    for j in range(n):
        for i in range(scene.body_count):
            scene.bodies[i].M_branch = zero
            scene.bodies[i].f_branch = zero
        scene.lents[j].z = 1.0
        push_lent(scene, cython.address(scene.lents[j]))
        answer(scene, False)
        for i in range(j, n):
            scene.own[n * i + j] = (1.0 if i == j else 0.0) - taken(scene, cython.address(scene.lents[i]))
    for j in range(n):
        x = eliminate_lent(scene, j)
        if x < scene.own_share:
            scene.own_share = x
        loose += x <= scene.limits.own_share
    return loose


def lend_less(scene: cython.pointer[Scene]) -> cython.void:
    """Factors anew with as much less lent as halves the digits that 1 - T loses; the share and the pivot stay."""
    i: cython.Py_ssize_t
    share: cython.double = scene.own_share
    pivot: cython.double = scene.pivot
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.A = turned(body.R, body.inertia)
    scene.lent_part = sqrt(sqrt(share))
    factor_tree(scene)
    if scene.selected_count:
        factor_closures(scene)
    weigh_lent(scene)
    scene.lent_part = 1.0
    scene.own_share = share
    scene.pivot = pivot


def taken(scene: cython.pointer[Scene], lent: cython.pointer[Lent]) -> cython.double:
    """n . alpha at the accelerations found."""
    return dot(lent.n, scene.bodies[lent.body].alpha)


def eliminate_lent(scene: cython.pointer[Scene], j: cython.Py_ssize_t) -> cython.double:
    """Column j of the Cholesky factor of 1 - T (diagonal inverted, zero where next to nothing is left); its pivot."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.lent_count
    x: cython.double
    pivot: cython.double = scene.own[n * j + j]
    for k in range(j):
        pivot -= scene.own[n * j + k] * scene.own[n * j + k]
    scene.own[n * j + j] = 1.0 / sqrt(pivot) if pivot > scene.limits.own_share else 0.0
    for i in range(j + 1, n):
        x = scene.own[n * i + j]
        for k in range(j):
            x -= scene.own[n * i + k] * scene.own[n * j + k]
        scene.own[n * i + j] = x * scene.own[n * j + j]
    return pivot


def find_taken(scene: cython.pointer[Scene]) -> cython.void:
    """z = (1 - T)^-1 z_0 from the accelerations that the loads alone give."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = scene.lent_count
    z: cython.double
    for i in range(n):
        z = taken(scene, cython.address(scene.lents[i]))
        for k in range(i):
            z -= scene.own[n * i + k] * scene.lents[k].z
        scene.lents[i].z = z * scene.own[n * i + i]
    for i in range(n - 1, -1, -1):
        z = scene.lents[i].z
        for k in range(i + 1, n):
            z -= scene.own[n * k + i] * scene.lents[k].z
        scene.lents[i].z = z * scene.own[n * i + i]


def evaluate(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double) -> cython.int:
    """Time derivative dy of the state y at t; as `configure` gives, for what has no inertia or cannot be closed."""
    idle: cython.int
    power: cython.double = put_in_motion(scene, t, y, dy)
    if is_open(scene):
        idle = factor_loaded(scene)
        scene.load_size = 0.0
        downward(scene, True)
        tell(scene, y, dy, power)
    else:
        idle = configure(scene, t)
        accelerate(scene, y, dy, power)
    return idle


def is_open(scene: cython.pointer[Scene]) -> cython.bint:
    """Whether a tree in space stands alone: loads need no factors before they are added up."""
    return not (scene.flat or scene.closure_count or scene.lent_count or scene.rub_count)


def evaluate_settled(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.void:
    """The derivative of what `settle` has just left; in the plane its factors stand: only rates have changed since."""
    i: cython.Py_ssize_t
    if not scene.flat or scene.selected_count == 0:
        evaluate(scene, t, y, dy)
        return
    power: cython.double = put_in_motion(scene, t, y, dy)
    for i in range(scene.selected_count):
        measure_row(scene, cython.address(scene.closures[scene.selected[i]]), t)
    if scene.pivot < scene.pivot_of_step:
        scene.pivot_of_step = scene.pivot
    accelerate(scene, y, dy, power)


def put_in_motion(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.double:
    """Kinematics and applied loads at y, rates of counted angles; power of what has no potential [W]."""
    kinematics(scene, t, y)
    count_turns(scene, dy)
    return apply_loads(scene) if scene.load_count else 0.0


def accelerate(
    scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double
) -> cython.void:
    """The time derivative by the factors that stand."""
    if scene.rub_count:
        power += press(scene)
    respond(scene, True)
    tell(scene, y, dy, power)


def tell(scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double) -> cython.void:
    """The time derivative of the accelerations found.

    Where something is driven the joint loads are found too, for the work of the drives.
    """
    if scene.driven:
        push_closures(scene)
        balance(scene, True)
        power += driving_power(scene)
    derivative(scene, y, dy, power)


def answer_applied(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """What answers the loads on the bodies; inertial: with velocity terms, prescribed accelerations and gravity."""
    respond(scene, inertial)
    push_closures(scene)
    balance(scene, inertial)


def press(scene: cython.pointer[Scene]) -> cython.double:
    """Find what presses where friction hangs on that, by the factors that stand, and apply that friction; its power."""
    k: cython.Py_ssize_t
    power: cython.double = 0.0
    keep_applied(scene)
    answer_applied(scene, True)
    see_pressing(scene, 0)
    for k in range(scene.rub_count):
        apply_unit(scene, k)
        answer_applied(scene, False)
        see_pressing(scene, k + 1)
    find_pressed(scene)
    apply_kept(scene)
    for k in range(scene.rub_count):
        load: cython.pointer[Load] = cython.address(scene.loads[scene.rubs[k]])
        rub(scene, load, load.pressed)
        load.value *= load.pressed
        load.power *= load.pressed
        power += load.power
    return power


def driving_power(scene: cython.pointer[Scene]) -> cython.double:
    """Power of all drives [W]."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            power += freedom.drive * freedom.u
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.program.count:
            power += row.multiplier * row.prescribed_rate
    return power


def settle(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Bring y onto the unit quaternions and the closures, positions and rates; the gap left over all rows [m]."""
    normalise(scene, y)
    if scene.closure_count == 0:
        return 0.0
    kinematics(scene, t, y)
    if scene.selected_count:
        factor_tree(scene)
        measure_moving_rows(scene, t)
        scene.pivot = factor_closures(scene)
        return close(scene, t, y)
    measure_moving_rows(scene, t)
    return largest_gap(scene)  # rows that nothing answers may still open, in a singular pose say


def settle_evaluated(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Settle the state that `evaluate` saw last: in the plane, where nothing is a ball, its factors stand."""
    if not scene.flat or scene.selected_count == 0:
        return settle(scene, t, y)
    measure_moving_rows(scene, t)
    return close(scene, t, y)


def close(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Positions, then rates, onto the closures, by the factors that stand; leaves those of the positions reached."""
    gap: cython.double = close_gaps(scene, t, y)
    correct_rates(scene, y)
    if scene.pivot < scene.limits.near_singular:  # there the rows turn with the rates' own correction: once more
        refactor(scene, t, y)
        correct_rates(scene, y)
    return gap


def must_choose_anew(scene: cython.pointer[Scene], gap: cython.double) -> cython.bint:
    """Whether a row that was left out opens, or the chosen ones come near to depending on each other."""
    return not gap <= scene.limits.reopened * scene.size or scene.pivot < scene.limits.pivot_drop * scene.pivot_chosen


def normalise(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """Quaternions back to length 1."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    s: cython.double
    for i in range(scene.body_count):
        if scene.bodies[i].ball:
            k = scene.bodies[i].attitude_at
            s = 1.0 / sqrt(y[k] * y[k] + y[k + 1] * y[k + 1] + y[k + 2] * y[k + 2] + y[k + 3] * y[k + 3])
            y[k] *= s
            y[k + 1] *= s
            y[k + 2] *= s
            y[k + 3] *= s


def refactor(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Kinematics, rows and factors at y."""
    kinematics(scene, t, y)
    measure_moving_rows(scene, t)
    factor_tree(scene)
    scene.pivot = factor_closures(scene)


def close_gaps(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.double:
    """Newton's steps of least motion, in the measure of M, until the gaps are rounding; the largest gap left [m].

    Near a singular pose the rows turn with every small move: there a step must at least halve the gap.
    """
    n: cython.int
    before: cython.double
    r: cython.Py_ssize_t
    gap: cython.double = largest_gap(scene)
    for n in range(5):
        if gap <= scene.limits.closed * scene.size:
            break
        before = gap
        for r in range(scene.closure_count):
            scene.closures[r].demand = scene.closures[r].gap
        take_back(scene)
        move(scene, y, False)
        refactor(scene, t, y)
        gap = largest_gap(scene)
        if scene.pivot < scene.limits.near_singular:
            if gap > 0.5 * before:
                break
        elif gap <= scene.limits.nearly_closed * scene.size:
            break
    return gap


def correct_rates(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """The least change of the velocities, in the measure of M, that meets the rates of all rows."""
    r: cython.Py_ssize_t
    for r in range(scene.closure_count):
        scene.closures[r].demand = scene.closures[r].rate
    take_back(scene)
    move(scene, y, True)


def largest_gap(scene: cython.pointer[Scene]) -> cython.double:
    """Largest gap of all closed rows [m], the turning ones by their weight."""
    r: cython.Py_ssize_t
    largest: cython.double = 0.0
    gap: cython.double
    for r in range(scene.closure_count):
        gap = fabs(scene.closures[r].gap) * scene.closures[r].weight
        if scene.closures[r].mode != APART and not gap <= largest:
            largest = gap
    return largest


def take_back(scene: cython.pointer[Scene]) -> cython.void:
    """The least motion, in the measure of M, that takes back what the rows demand: an answer to no load at all."""
    i: cython.Py_ssize_t
    for i in range(scene.answer_count):
        scene.e[i] = 0.0
    solve_closures(scene)
    downward(scene, False)


def move(scene: cython.pointer[Scene], y: cython.p_double, rates: cython.bint) -> cython.void:
    """Add the answer found (small turns and shifts) to the coordinates of the state, or to its velocities."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball and rates:
            k = body.rate_at
            y[k] += body.alpha.x
            y[k + 1] += body.alpha.y
            y[k + 2] += body.alpha.z
        elif body.ball:
            k = body.attitude_at
            q: Quaternion = slightly_turned(Quaternion(y[k], y[k + 1], y[k + 2], y[k + 3]), body.alpha)
            y[k] = q.w
            y[k + 1] = q.x
            y[k + 2] = q.y
            y[k + 3] = q.z
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            y[freedom.u_at if rates else freedom.q_at] += freedom.udot
