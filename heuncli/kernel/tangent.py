"""The derivative of the motion along a direction of its state: exact, by the factors that stand at the state.

    M V' - J' lambda = k,  J V' + gamma = 0              with V', lambda as they are at the state
    M dV' - J' dlambda = -d(M V' - J' lambda - k),   J dV' = -d(J V' + gamma)
The right sides are what Newton's and Euler's balance of every branch, and every closure row, change by along the
direction at the accelerations and multipliers of the state (tangent_motion, tangent_loads, tangent_closures); the map
on the left is that of the state, factored once for all directions. A freedom's equation s . F = 0 changes by
s . dF + ds . F, for its direction turns. A ball's is M = 0 of its own body, in absolute angular velocities.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import (
        Quaternion,
        Vec3,
        add,
        add_cross,
        add_scaled,
        cross,
        dot,
        quaternion_rate,
        rotate_back,
        sub,
        turned,
    )
    from heuncli.kernel.closures import push_closures
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.loads import omega_of
    from heuncli.kernel.orthogonal import solve_closures
    from heuncli.kernel.response import evaluate, find_taken
    from heuncli.kernel.scene import (
        SHIFT,
        Body,
        BodyAtState,
        BodyTangent,
        Closure,
        Counter,
        Freedom,
        FreedomTangent,
        Lent,
        Scene,
    )
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.tangent_closures import closures_along
    from heuncli.kernel.tangent_loads import loads_along
    from heuncli.kernel.tangent_motion import move_along, omega_along, swung
    from heuncli.kernel.tangent_pressing import carry_along, press_along
    from heuncli.kernel.tangent_strains import variables_along
    from heuncli.kernel.tangent_tracks import pace_of_along
    from heuncli.kernel.tree import balance, downward, load_along, push_lent


def evaluate_base_state(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, dy: cython.p_double
) -> cython.int:
    """Evaluate the state from which directions are looked at, and keep what stands there; as `evaluate` gives."""
    i: cython.Py_ssize_t
    idle: cython.int = evaluate(scene, t, y, dy)
    if not scene.driven:
        push_closures(scene)
    for i in range(scene.lent_count):
        if is_kept(scene, i):
            lent: cython.pointer[Lent] = cython.address(scene.lents[i])
            on: cython.pointer[Body] = cython.address(scene.bodies[lent.body])
            on.M_applied = add_scaled(on.M_applied, -dot(lent.n, on.alpha), lent.n)
    balance(scene, True)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        at: cython.pointer[BodyAtState] = cython.address(scene.at_state[i])
        at.inertia = turned(body.R, body.inertia)
        at.alpha = body.alpha
        at.a = body.a
        at.M = body.M_joint
        at.f = body.f_joint
    for i in range(scene.freedom_count):
        scene.freedom_tangents[i].udot = scene.freedoms[i].udot
    for i in range(scene.closure_count):
        scene.multipliers[i] = scene.closures[i].multiplier
    return idle


def is_kept(scene: cython.pointer[Scene], j: cython.int) -> cython.bint:
    """Whether a lent inertia is not given back: nothing else holds the spin that it resists (`weigh_lent`)."""
    return scene.own[scene.lent_count * j + j] == 0.0


def change_along(
    scene: cython.pointer[Scene], y: cython.p_double, along: cython.p_double, out: cython.p_double
) -> cython.void:
    """What the state's time derivative changes by along a direction, from the state that stands."""
    move_along(scene, y, along)
    if scene.point_count:
        variables_along(scene)
    keep_along(scene)
    power: cython.double = loads_along(scene)
    closures_along(scene)
    branches_along(scene)
    respond_along(scene)
    if scene.rub_count:
        power += press_along(scene)
        respond_along(scene)
    if scene.driven and scene.work_at >= 0:
        power += drives_along(scene)
    rates_along(scene, y, along, out)
    if scene.work_at >= 0:
        out[scene.work_at] = power


def keep_along(scene: cython.pointer[Scene]) -> cython.void:
    """Of the moment n (n . alpha) that a lent inertia takes which is not given back; n turns with its body."""
    i: cython.Py_ssize_t
    for i in range(scene.lent_count):
        lent: cython.pointer[Lent] = cython.address(scene.lents[i])
        d: cython.pointer[BodyTangent] = cython.address(scene.tangents[lent.body])
        if d.moves and is_kept(scene, i):
            alpha: Vec3 = scene.at_state[lent.body].alpha
            n: Vec3 = swung(scene, lent.body, lent.n)
            d.M = add_scaled(d.M, dot(lent.n, alpha), n)
            d.M = add_scaled(d.M, dot(n, alpha) + dot(lent.n, d.alpha), lent.n)


def branches_along(scene: cython.pointer[Scene]) -> cython.void:
    """ds . F of every freedom; and what the arms of the branches change by makes of the moments of their loads."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if not scene.tangents[i].moves:
            continue
        at: cython.pointer[BodyAtState] = cython.address(scene.at_state[i])
        if body.parent >= 0:
            on: cython.pointer[BodyTangent] = cython.address(scene.tangents[body.parent])
            on.M = add_cross(on.M, scene.tangents[i].arm, at.f)
        for k in range(body.first_freedom, body.end_freedom):
            d: cython.pointer[FreedomTangent] = cython.address(scene.freedom_tangents[k])
            d.load = dot(d.s, at.f if scene.freedoms[k].kind == SHIFT else at.M)


def respond_along(scene: cython.pointer[Scene]) -> cython.void:
    """Accelerations and multipliers that answer the change; what is lent takes nothing of them."""
    i: cython.Py_ssize_t
    for i in range(scene.lent_count):
        scene.lents[i].z = 0.0
    answer_along(scene)
    if scene.lent_count:
        find_taken(scene)
        answer_along(scene)


def answer_along(scene: cython.pointer[Scene]) -> cython.void:
    """Accelerations and multipliers that answer the change, the loads of what is lent given."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        scene.bodies[i].M_branch = scene.tangents[i].M
        scene.bodies[i].f_branch = scene.tangents[i].f
    for i in range(scene.lent_count):
        push_lent(scene, cython.address(scene.lents[i]))
    upward_along(scene)
    if scene.selected_count:
        solve_closures(scene)
    downward(scene, False)


def upward_along(scene: cython.pointer[Scene]) -> cython.void:
    """From what stands in M_branch and f_branch, and ds . F, to e, which the freedoms answer; tips to roots."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            at: cython.Py_ssize_t = body.answer_at
            scene.e[at] = -body.M_branch.x
            scene.e[at + 1] = -body.M_branch.y
            scene.e[at + 2] = -body.M_branch.z
            body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            scene.e[freedom.answer_at] = answered_along(body, freedom, scene.freedom_tangents[k].load)
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            moment: Vec3 = cross(body.arm, body.f_branch)
            if not body.ball:
                moment = add(moment, body.M_branch)
            parent.M_branch = add(parent.M_branch, moment)
            parent.f_branch = add(parent.f_branch, body.f_branch)


def answered_along(body: cython.pointer[Body], freedom: cython.pointer[Freedom], load: cython.double) -> cython.double:
    """The load e = -s . dF - ds . F that a freedom answers; what it gives way to goes on, as in `answered`."""
    if freedom.driven:
        return 0.0
    e: cython.double = -load_along(freedom, body.M_branch, body.f_branch) - load
    body.M_branch = add_scaled(body.M_branch, e * freedom.D, freedom.U_turn)
    body.f_branch = add_scaled(body.f_branch, e * freedom.D, freedom.U_shift)
    return e


def drives_along(scene: cython.pointer[Scene]) -> cython.double:
    """What the power of all drives changes by: their rates are given, their loads change with those of the joints."""
    i: cython.Py_ssize_t
    power: cython.double = 0.0
    carry_along(scene)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            power += (freedom.drive + scene.freedom_tangents[i].load) * freedom.u
    for i in range(scene.closure_count):
        row: cython.pointer[Closure] = cython.address(scene.closures[i])
        if row.program.count:
            power += row.multiplier * row.prescribed_rate
    return power


def rates_along(
    scene: cython.pointer[Scene], y: cython.p_double, along: cython.p_double, out: cython.p_double
) -> cython.void:
    """What the derivatives of attitudes, coordinates, counted angles and rates change by."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            k = body.attitude_at
            q: Quaternion = quaternion_rate(Quaternion(y[k], y[k + 1], y[k + 2], y[k + 3]), scene.tangents[i].omega)
            dq: Quaternion = quaternion_rate(Quaternion(along[k], along[k + 1], along[k + 2], along[k + 3]), body.omega)
            out[k] = q.w + dq.w
            out[k + 1] = q.x + dq.x
            out[k + 2] = q.y + dq.y
            out[k + 3] = q.z + dq.z
            k = body.rate_at
            out[k] = body.alpha.x
            out[k + 1] = body.alpha.y
            out[k + 2] = body.alpha.z
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            out[freedom.q_at] = scene.freedom_tangents[i].u
            out[freedom.u_at] = freedom.udot
    for i in range(scene.counter_count):
        counter: cython.pointer[Counter] = cython.address(scene.counters[i])
        if counter.track:
            out[counter.at] = pace_of_along(scene, cython.address(scene.closures[counter.track - 1]))
            continue
        n: Vec3 = direction_of(scene, counter.a, counter.axis)
        change: Vec3 = sub(omega_along(scene, counter.b), omega_along(scene, counter.a))
        turn: Vec3 = sub(omega_of(scene, counter.b), omega_of(scene, counter.a))
        out[counter.at] = dot(n, change) + dot(swung(scene, counter.a, n), turn)
