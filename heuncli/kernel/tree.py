"""Trees of bodies: kinematics, and the sweep that factors the mass matrix and solves with it, O(n).

    [n; f] = [A C; C' K] [alpha; a] + [M_branch; f_branch]       what a joint must exert on its branch (kernel/scene.py)
    sum over b of M_ab omegadot_b + h_a = tau_a              (49), corrected, for any number of links: what is solved
A, C, K are the articulated inertia of a branch, its inertia against the acceleration of its joint when all its freedoms
give way. A free direction s (a unit turn or a unit shift) is eliminated by U = I s, D = s . U, I <- I - U U' / D; a
ball's three turns at once, G = A^-1 C, after which neither A nor C is left and only K is handed on: Heun's absolute
angular velocities, the state of a ball being the attitude and the angular velocity of the body itself.
Articulated inertias: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7.
Gravity enters as the ground's acceleration -g, so `a` is throughout the acceleration less g. `inertial` says whether
velocity terms, prescribed accelerations and gravity count: without them the answer is that to the loads alone.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.algebra import (
        Mat3,
        Quaternion,
        Vec3,
        add,
        add_both,
        add_cross,
        add_matrix,
        add_scaled,
        add_symmetric,
        add_transformed,
        attitude,
        both_levers,
        cross,
        dot,
        factor,
        lever,
        lever_rows,
        multiple_of_unit,
        product,
        quaternion_rate,
        rotate,
        rotate_back,
        rotation,
        scaled,
        skew,
        solve,
        solve_columns,
        sub,
        sub_dyad,
        sub_product,
        sub_square,
        trace,
        transform,
        turned,
        unit_matrix,
    )
    from heuncli.kernel.directions import direction_of
    from heuncli.kernel.jets import jet
    from heuncli.kernel.paths import run_along
    from heuncli.kernel.plane import (
        add_zeros_in_plane,
        balance_in_plane,
        downward_in_plane,
        factor_in_plane,
        load_all_in_plane,
        load_in_plane,
        move_in_plane,
        upward_in_plane,
    )
    from heuncli.kernel.programs import Jet
    from heuncli.kernel.scene import OF_LOAD, SHIFT, TURN_IN_BODY, TURN_IN_PARENT, Body, Freedom, Lent, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.strains import of_load
    from heuncli.kernel.values import PointMotion


def coordinates(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Coordinates, rates and prescribed accelerations of the scalar freedoms, and the variables of the expressions."""
    i: cython.Py_ssize_t
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if freedom.driven:
            given: Jet = jet(scene.programs, freedom.program, t)
            freedom.q = given.value + freedom.offset
            freedom.u = given.rate
            freedom.udot = given.second
        else:
            freedom.q = y[freedom.q_at]
            freedom.u = y[freedom.u_at]
            freedom.udot = 0.0
    for i in range(scene.counter_count):
        scene.counters[i].counted = y[scene.counters[i].at]
    scene.programs.variables[0] = t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if not variable.is_point:
            of: cython.pointer[Freedom] = cython.address(scene.freedoms[variable.freedom])
            scene.programs.variables[i] = (0.0 if of.still else of.u) if variable.is_rate else of.q


def kinematics(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Attitudes, joint points, velocities (46) and velocity terms of all bodies at y; clears the applied loads."""
    coordinates(scene, t, y)
    if scene.flat:
        move_in_plane(scene)
    else:
        move_in_space(scene, y)
    if scene.point_count:
        put_points(scene)


def put_points(scene: cython.pointer[Scene]) -> cython.void:
    """The variables that are places and velocities of points, or of what loads act between, as the bodies stand."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            scene.programs.variables[i] = of_load(scene, variable)
        elif variable.is_point:
            there: PointMotion = point_of(scene, variable.body, variable.q)
            if variable.is_rate:
                scene.programs.variables[i] = dot(variable.direction, there.v)
            else:
                scene.programs.variables[i] = dot(variable.direction, there.x) + variable.offset


def move_in_space(scene: cython.pointer[Scene], y: cython.p_double) -> cython.void:
    """Attitudes, joint points, velocities and velocity terms from the freedoms and the attitudes in y."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        hang(scene, body)
        if body.ball:
            at: cython.Py_ssize_t = body.attitude_at
            body.R = attitude(Quaternion(y[at], y[at + 1], y[at + 2], y[at + 3]))
            at = body.rate_at
            body.omega = Vec3(y[at], y[at + 1], y[at + 2])
        else:
            orient(scene, body)
        velocity_terms(body)


def hang(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Joint point, its velocity and its velocity terms, from the parent and the shifts of the joint.

    r = r_p + l,  v = v_p + omega_p x l + w,  a - a_p - alpha_p x l = omega_p x (omega_p x l + 2 w) + wdot, w = sum u s
    Along a path s = r' turns with the coordinate: wdot = udot r' + u^2 r''.
    """
    k: cython.Py_ssize_t
    sliding: Vec3 = Vec3(0.0, 0.0, 0.0)
    pushed: Vec3 = sliding
    body.arm = direction_of(scene, body.parent, body.joint_in_parent)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.pieces:
            body.arm = add(body.arm, run_along(scene, body.parent, freedom))
            sliding = add_scaled(sliding, freedom.u, freedom.s)
            pushed = add_scaled(add_scaled(pushed, freedom.udot, freedom.s), freedom.u * freedom.u, freedom.curved)
        elif freedom.kind == SHIFT:
            freedom.s = direction_of(scene, body.parent, freedom.direction)
            body.arm = add_scaled(body.arm, freedom.q, freedom.s)
            sliding = add_scaled(sliding, freedom.u, freedom.s)
            pushed = add_scaled(pushed, freedom.udot, freedom.s)
    if body.parent < 0:
        body.r = body.arm
        body.v = sliding
        body.a_bias = pushed
        return
    parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
    swept: Vec3 = cross(parent.omega, body.arm)
    body.r = add(parent.r, body.arm)
    body.v = add(add(parent.v, swept), sliding)
    body.a_bias = add(cross(parent.omega, add_scaled(swept, 2.0, sliding)), pushed)


def orient(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.void:
    """Attitude and angular velocity of a body on single axes: turns of the parent, the frame, turns of the body."""
    k: cython.Py_ssize_t
    body.alpha_bias = Vec3(0.0, 0.0, 0.0)
    if body.parent < 0:
        body.R = unit_matrix()
        body.omega = Vec3(0.0, 0.0, 0.0)
    else:
        parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
        body.R = parent.R
        body.omega = parent.omega
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_PARENT:
            turn(body, cython.address(scene.freedoms[k]))
    if body.framed:
        body.R = product(body.R, body.frame)
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == TURN_IN_BODY:
            turn(body, cython.address(scene.freedoms[k]))


def turn(body: cython.pointer[Body], freedom: cython.pointer[Freedom]) -> cython.void:
    """A turn about an axis s: alpha_bias += omega x s u + s udot, omega += s u, R <- R Rot."""
    freedom.s = rotate(body.R, freedom.direction)
    spin: Vec3 = scaled(freedom.u, freedom.s)
    body.alpha_bias = add(body.alpha_bias, add_scaled(cross(body.omega, spin), freedom.udot, freedom.s))
    body.omega = add(body.omega, spin)
    body.R = product(body.R, rotation(freedom.direction, freedom.q))


def velocity_terms(body: cython.pointer[Body]) -> cython.void:
    """Inertia and first moment in world axes; omega x J omega and omega x (omega x m c), the bias h of (49)."""
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    body.mc = rotate(body.R, body.first_moment)
    body.A = turned(body.R, body.inertia)
    body.gyroscopic = cross(body.omega, transform(body.A, body.omega))
    body.centrifugal = cross(body.omega, cross(body.omega, body.mc))
    body.M_applied = zero
    body.f_applied = zero


def point_of(scene: cython.pointer[Scene], body: cython.int, q: Vec3) -> PointMotion:
    """Place and velocity of a body's point, given from its joint point in its axes; a ground point as it is."""
    if body < 0:
        return PointMotion(q, Vec3(0.0, 0.0, 0.0))
    on: cython.pointer[Body] = cython.address(scene.bodies[body])
    arm: Vec3 = rotate(on.R, q)
    return PointMotion(add(arm, on.r), add(cross(on.omega, arm), on.v))


def push(scene: cython.pointer[Scene], body: cython.int, at: Vec3, force: Vec3, moment: Vec3) -> cython.void:
    """Put a force at a place, and a moment, on a body; the ground takes them silently."""
    if body >= 0:
        on: cython.pointer[Body] = cython.address(scene.bodies[body])
        on.M_applied = add(on.M_applied, add_cross(moment, sub(at, on.r), force))
        on.f_applied = add(on.f_applied, force)


def factor_tree(scene: cython.pointer[Scene]) -> cython.int:
    """Articulated inertias, from the tips to the roots, reduced by every freedom that is not driven.

    Gives the number of freedoms with no inertia behind them.
    """
    i: cython.Py_ssize_t
    idle: cython.int = 0
    if scene.flat:
        return factor_in_plane(scene)
    for i in range(scene.body_count):
        scene.bodies[i].C = skew(scene.bodies[i].mc)
        scene.bodies[i].K = multiple_of_unit(scene.bodies[i].mass)
    for i in range(scene.lent_count):
        lend(scene, cython.address(scene.lents[i]))
    for i in range(scene.body_count - 1, -1, -1):
        idle += factor_body(scene, cython.address(scene.bodies[i]))
    return idle


def factor_body(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.int:
    """Reduce the inertia of a branch by its joint's freedoms and hand it to the parent; how many have none behind."""
    k: cython.Py_ssize_t
    idle: cython.int = 0
    # a freedom's inertia is nothing beside that before any freedom was taken out: what is left of it is rounding
    mass: cython.double = scene.limits.no_inertia * trace(body.K)
    turning: cython.double = scene.limits.no_inertia * trace(body.A)
    if body.ball:
        idle += eliminate_ball(body, turning)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.driven:
            freedom.D = 0.0
        else:
            idle += eliminate(body, freedom, mass if freedom.kind == SHIFT else turning)
    if body.parent >= 0:
        add_branch(cython.address(scene.bodies[body.parent]), body)
    return idle


def factor_loaded(scene: cython.pointer[Scene]) -> cython.int:
    """`factor_tree`, `put_loads` and `upward` in one climb, where nothing needs the factors before the loads.

    What a body asks of its joint is added up while the processor divides for the next body's factors.
    """
    i: cython.Py_ssize_t
    idle: cython.int = 0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.C = skew(body.mc)
        body.K = multiple_of_unit(body.mass)
        body.M_branch = sub(body.gyroscopic, body.M_applied)
        body.f_branch = sub(body.centrifugal, body.f_applied)
    for i in range(scene.body_count - 1, -1, -1):
        own: cython.pointer[Body] = cython.address(scene.bodies[i])
        idle += factor_body(scene, own)
        answer_body(scene, own, True)
    return idle


def lend(scene: cython.pointer[Scene], lent: cython.pointer[Lent]) -> cython.void:
    """Add a lent inertia n n' to its body's own."""
    body: cython.pointer[Body] = cython.address(scene.bodies[lent.body])
    lent.n = scaled(scene.lent_part * lent.root, rotate(body.R, lent.axis))
    body.A = sub_square(body.A, lent.n, scaled(-1.0, lent.n))


def eliminate_ball(body: cython.pointer[Body], least: cython.double) -> cython.int:
    """All turns at once: A = L D L', G = A^-1 C, K <- K - C' G; 1 where that moves nothing, `least` of inertia."""
    body.turning = factor(body.A, least)
    body.G = solve_columns(body.turning, body.C)
    if body.parent >= 0 or body.end_freedom > body.first_freedom:
        body.K = sub_product(body.K, body.C, body.G)
    return body.turning.zz == 0.0


def eliminate(body: cython.pointer[Body], freedom: cython.pointer[Freedom], least: cython.double) -> cython.int:
    """One direction: U = I s, D = s . U, I <- I - U U' / D; 1 where it moves no more than `least`."""
    s: Vec3 = freedom.s
    D: cython.double
    if freedom.kind == SHIFT:
        freedom.U_shift = transform(body.K, s)
        freedom.U_turn = Vec3(0.0, 0.0, 0.0) if body.ball else rotate(body.C, s)
        D = dot(s, freedom.U_shift)
    else:
        freedom.U_turn = transform(body.A, s)
        freedom.U_shift = rotate_back(body.C, s)
        D = dot(s, freedom.U_turn)
    freedom.D = 1.0 / D if D > least else 0.0
    along: Vec3 = scaled(freedom.D, freedom.U_shift)
    body.K = sub_square(body.K, along, freedom.U_shift)
    if not body.ball:
        body.C = sub_dyad(body.C, freedom.U_turn, along)
        body.A = sub_square(body.A, freedom.U_turn, scaled(freedom.D, freedom.U_turn))
    return freedom.D == 0.0


def load_along(freedom: cython.pointer[Freedom], M: Vec3, f: Vec3) -> cython.double:
    """What a moment and a force do along a freedom: s . M of a turn, s . f of a shift."""
    return dot(freedom.s, f if freedom.kind == SHIFT else M)


def add_branch(parent: cython.pointer[Body], body: cython.pointer[Body]) -> cython.void:
    """The branch hangs at the arm l: K += K_b, C += C_b + L K_b, A += A_b + C_b L' + L C_b' + L K_b L', L = hat(l).

    Behind a ball neither A_b nor C_b is left.
    """
    lK: Mat3 = lever(body.arm, body.K)
    parent.K = add_symmetric(parent.K, body.K)
    if not body.ball:
        parent.A = add_symmetric(parent.A, add_both(body.A, lever_rows(body.arm, body.C)))
        parent.C = add_matrix(parent.C, body.C)
    parent.A = add_symmetric(parent.A, both_levers(body.arm, lK))
    parent.C = add_matrix(parent.C, lK)


def put_loads(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """What each body asks of its joint: its velocity terms less the applied loads and what is lent to it takes."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    if scene.flat:
        load_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.M_branch = sub(body.gyroscopic if inertial else zero, body.M_applied)
        body.f_branch = sub(body.centrifugal if inertial else zero, body.f_applied)
    for i in range(scene.lent_count):
        push_lent(scene, cython.address(scene.lents[i]))


def put_all_loads(scene: cython.pointer[Scene]) -> cython.void:
    """What each body asks of its joint if no freedom accelerates, gravity and inertia among it; less applied loads.

    Leaves those accelerations in alpha_zero and a_zero. What the freedoms then answer is an answer to loads alone.
    """
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    if scene.flat:
        load_all_in_plane(scene)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.alpha_zero = zero
        body.a_zero = body.a_bias
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            body.a_zero = add(add_cross(parent.a_zero, parent.alpha_zero, body.arm), body.a_bias)
            if not body.ball:
                body.alpha_zero = parent.alpha_zero
        if not body.ball:
            body.alpha_zero = add(body.alpha_zero, body.alpha_bias)
        body.alpha = body.alpha_zero
        body.a = sub(body.a_zero, scene.gravity)
        newton_euler(body, True)
        body.M_branch = body.M_joint
        body.f_branch = body.f_joint
    for i in range(scene.lent_count):
        push_lent(scene, cython.address(scene.lents[i]))


def add_zeros(scene: cython.pointer[Scene]) -> cython.void:
    """The accelerations that answer all loads, and those if no freedom accelerated, gravity taken off."""
    i: cython.Py_ssize_t
    if scene.flat:
        add_zeros_in_plane(scene)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.alpha = add(body.alpha, body.alpha_zero)
        body.a = add(body.a, sub(body.a_zero, scene.gravity))


def push_lent(scene: cython.pointer[Scene], lent: cython.pointer[Lent]) -> cython.void:
    """Put what a lent inertia takes, z n, on its body."""
    body: cython.pointer[Body] = cython.address(scene.bodies[lent.body])
    body.M_branch = add_scaled(body.M_branch, -lent.z, lent.n)


def upward(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From what stands in M_branch and f_branch, and velocity terms, to e, which the freedoms answer; tips to roots."""
    i: cython.Py_ssize_t
    if scene.flat:
        upward_in_plane(scene, inertial)
        return
    for i in range(scene.body_count - 1, -1, -1):
        answer_body(scene, cython.address(scene.bodies[i]), inertial)


def answer_body(scene: cython.pointer[Scene], body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """What the freedoms of a body's joint answer of its branch's loads; the rest goes to the parent."""
    k: cython.Py_ssize_t
    if body.ball:
        at: cython.Py_ssize_t = body.answer_at
        scene.e[at] = -body.M_branch.x
        scene.e[at + 1] = -body.M_branch.y
        scene.e[at + 2] = -body.M_branch.z
        body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        scene.e[freedom.answer_at] = answered(body, freedom)
    if body.parent >= 0:
        pass_up(cython.address(scene.bodies[body.parent]), body, inertial)


def answered(body: cython.pointer[Body], freedom: cython.pointer[Freedom]) -> cython.double:
    """The load e = -s . (M or f) that a freedom answers; what it gives way to goes on: M += U e / D, f likewise."""
    if freedom.driven:
        return 0.0
    e: cython.double = -load_along(freedom, body.M_branch, body.f_branch)
    body.M_branch = add_scaled(body.M_branch, e * freedom.D, freedom.U_turn)
    body.f_branch = add_scaled(body.f_branch, e * freedom.D, freedom.U_shift)
    return e


def pass_up(parent: cython.pointer[Body], body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """Hand the branch's loads, with what its velocity terms ask for, to the parent at the arm l."""
    moment: Vec3 = body.M_branch
    force: Vec3 = body.f_branch
    if inertial:
        force = add(force, transform(body.K, body.a_bias))
        if not body.ball:
            moment = add(moment, rotate(body.C, body.a_bias))
            force = add(force, rotate_back(body.C, body.alpha_bias))
            moment = add_transformed(moment, body.A, body.alpha_bias)
    if not body.ball:
        parent.M_branch = add(parent.M_branch, moment)
    parent.M_branch = add(parent.M_branch, cross(body.arm, force))
    parent.f_branch = add(parent.f_branch, force)


def downward(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From e to the accelerations of freedoms and bodies, roots to tips."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    if scene.flat:
        downward_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: Vec3 = Vec3(0.0, 0.0, 0.0)
        a: Vec3 = scaled(-1.0, scene.gravity) if inertial else alpha
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            alpha = parent.alpha
            a = add_cross(parent.a, alpha, body.arm)
        if inertial:
            a = add(a, body.a_bias)
            if not body.ball:
                alpha = add(alpha, body.alpha_bias)
        for k in range(body.end_freedom - 1, body.first_freedom - 1, -1):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                continue
            carried: cython.double = dot(freedom.U_shift, a)
            if not body.ball:
                carried += dot(freedom.U_turn, alpha)
            freedom.udot = freedom.D * (scene.e[freedom.answer_at] - carried)
            if freedom.kind == SHIFT:
                a = add_scaled(a, freedom.udot, freedom.s)
            else:
                alpha = add_scaled(alpha, freedom.udot, freedom.s)
        if body.ball:
            at: cython.Py_ssize_t = body.answer_at
            alpha = solve(body.turning, Vec3(scene.e[at], scene.e[at + 1], scene.e[at + 2]))
            alpha = sub(alpha, rotate(body.G, a))
        body.alpha = alpha
        body.a = a


def derivative(
    scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double
) -> cython.void:
    """The state's time derivative dy, from the accelerations found; power: of what has no potential."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            at = body.attitude_at
            rate: Quaternion = quaternion_rate(Quaternion(y[at], y[at + 1], y[at + 2], y[at + 3]), body.omega)
            dy[at] = rate.w
            dy[at + 1] = rate.x
            dy[at + 2] = rate.y
            dy[at + 3] = rate.z
            at = body.rate_at
            dy[at] = body.alpha.x
            dy[at + 1] = body.alpha.y
            dy[at + 2] = body.alpha.z
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            dy[freedom.q_at] = freedom.u
            dy[freedom.u_at] = freedom.udot
    if scene.work_at >= 0:
        dy[scene.work_at] = power


def balance(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Joint loads from the accelerations found and the applied loads, by Newton's and Euler's laws, tips to roots.

    Independent of the factored inertias: what of it lies in a free direction is the sweep's rounding error.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    if scene.flat:
        balance_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        newton_euler(cython.address(scene.bodies[i]), inertial)
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_joint = add(parent.M_joint, add(body.M_joint, cross(body.arm, body.f_joint)))
            parent.f_joint = add(parent.f_joint, body.f_joint)
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                freedom.drive = load_along(freedom, body.M_joint, body.f_joint)


def newton_euler(body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """What moves one body by itself, less the applied loads: the lost forces (57), (58) of the whole body, reversed.

    M = R (J alpha + omega x J omega) + m c x a,   f = m a + alpha x m c + omega x (omega x m c)
    About its joint point, J in the body's axes.
    """
    spin: Vec3 = transform(body.inertia, rotate_back(body.R, body.alpha))
    force: Vec3 = add_scaled(cross(body.alpha, body.mc), body.mass, body.a)
    if inertial:
        omega: Vec3 = rotate_back(body.R, body.omega)
        spin = add(spin, cross(omega, transform(body.inertia, omega)))
        force = add(force, body.centrifugal)
    moment: Vec3 = add(rotate(body.R, spin), cross(body.mc, body.a))
    body.M_joint = sub(moment, body.M_applied)
    body.f_joint = sub(force, body.f_applied)
