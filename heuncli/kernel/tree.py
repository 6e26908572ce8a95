"""Trees of bodies: kinematics, and the sweep that factors the mass matrix and solves with it, O(n).

    [n; f] = [A C; C' K] [alpha; a] + [M_branch; f_branch]       what a joint must exert on its branch (kernel/scene.py)
    sum over b of M_ab omegadot_b + h_a = tau_a              (49), corrected, for any number of links: what is solved

A, C, K are the articulated inertia of a branch, its inertia against the acceleration of its joint when all its freedoms
are free to move. A free direction s (a unit turn or a unit shift) is eliminated by U = I s, D = s . U, I <- I - U U' /
D; a ball's three rotations at once, G = A^-1 C, after which neither A nor C is left and only K is passed on: Heun's
absolute angular velocities, as the state of a ball is the attitude and the angular velocity of the body itself.
Articulated inertias: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7.

Gravity enters as the ground's acceleration -g, so `a` always is the acceleration minus g. `inertial` says whether
velocity terms, prescribed accelerations and gravity count: without them the response is that to the loads alone.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.plane import (
    add_zero_accelerations_in_plane,
    balance_in_plane,
    factor_in_plane,
    set_branch_loads_in_plane,
    set_full_branch_loads_in_plane,
    sweep_down_in_plane,
    sweep_up_in_plane,
)


def factor_tree(scene: cython.pointer[Scene]) -> cython.int:
    """Find the articulated inertias, tips to roots. Returns the number of freedoms with no inertia behind them."""
    i: cython.Py_ssize_t
    massless: cython.int = 0
    if scene.flat:
        return factor_in_plane(scene)
    for i in range(scene.body_count):
        scene.bodies[i].C = skew(scene.bodies[i].mc)
        scene.bodies[i].K = scaled_unit_matrix(scene.bodies[i].mass)
    for i in range(scene.artificial_count):
        add_artificial_inertia(scene, cython.address(scene.artificial_inertias[i]))
    for i in range(scene.body_count - 1, -1, -1):
        massless += factor_body(scene, cython.address(scene.bodies[i]))
    return massless


def factor_body(scene: cython.pointer[Scene], body: cython.pointer[Body]) -> cython.int:
    """Reduce the inertia of a branch by its joint's freedoms, add it to the parent. Returns how many are massless."""
    k: cython.Py_ssize_t
    massless: cython.int = 0
    # compare a freedom's inertia with that before any freedom was eliminated: a much smaller rest is rounding
    mass: cython.double = scene.limits.no_inertia * trace(body.K)
    turning: cython.double = scene.limits.no_inertia * trace(body.A)
    if body.ball:
        massless += eliminate_ball(body, turning)
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        if freedom.driven:
            freedom.D = 0.0
        else:
            massless += eliminate_freedom(body, freedom, mass if freedom.kind == SHIFT else turning)
    if body.parent >= 0:
        add_branch(cython.address(scene.bodies[body.parent]), body)
    return massless


def factor_with_loads(scene: cython.pointer[Scene]) -> cython.int:
    """Do `factor_tree`, `set_branch_loads` and `sweep_up` in one pass, while the processor divides."""
    i: cython.Py_ssize_t
    massless: cython.int = 0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.C = skew(body.mc)
        body.K = scaled_unit_matrix(body.mass)
        body.M_branch = sub(body.gyroscopic, body.M_applied)
        body.f_branch = sub(body.centrifugal, body.f_applied)
    for i in range(scene.body_count - 1, -1, -1):
        tip: cython.pointer[Body] = cython.address(scene.bodies[i])
        massless += factor_body(scene, tip)
        sweep_body_up(scene, tip, True)
    return massless


def add_artificial_inertia(scene: cython.pointer[Scene], inertia: cython.pointer[ArtificialInertia]) -> cython.void:
    """Add an artificial inertia n n' to its body's own."""
    body: cython.pointer[Body] = cython.address(scene.bodies[inertia.body])
    inertia.n = scale_vector(scene.artificial_part * inertia.root, rotate(body.R, inertia.axis))
    body.A = sub_square(body.A, inertia.n, scale_vector(-1.0, inertia.n))


def eliminate_ball(body: cython.pointer[Body], min_inertia: cython.double) -> cython.int:
    """Eliminate all rotations: A = L D L', G = A^-1 C, K <- K - C' G. Returns 1 if that moves no inertia."""
    body.A_factors = factor(body.A, min_inertia)
    body.G = solve_columns(body.A_factors, body.C)
    if body.parent >= 0 or body.end_freedom > body.first_freedom:
        body.K = sub_product(body.K, body.C, body.G)
    return body.A_factors.zz == 0.0


def eliminate_freedom(
    body: cython.pointer[Body], freedom: cython.pointer[Freedom], min_inertia: cython.double
) -> cython.int:
    """Eliminate one direction: U = I s, D = s . U, I <- I - U U' / D. Returns 1 if D is not above `min_inertia`."""
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
    freedom.D = 1.0 / D if D > min_inertia else 0.0
    scaled_force: Vec3 = scale_vector(freedom.D, freedom.U_shift)
    body.K = sub_square(body.K, scaled_force, freedom.U_shift)
    if not body.ball:
        body.C = sub_dyad(body.C, freedom.U_turn, scaled_force)
        body.A = sub_square(body.A, freedom.U_turn, scale_vector(freedom.D, freedom.U_turn))
    return freedom.D == 0.0


def project_on_freedom(freedom: cython.pointer[Freedom], M: Vec3, f: Vec3) -> cython.double:
    """Project a moment and a force on a freedom: s . M of a turn, s . f of a shift."""
    return dot(freedom.s, f if freedom.kind == SHIFT else M)


def add_branch(parent: cython.pointer[Body], body: cython.pointer[Body]) -> cython.void:
    """Add the branch at the arm l: K += K_b, C += C_b + L K_b, A += A_b + C_b L' + L C_b' + L K_b L', L = hat(l).

    Behind a ball neither A_b nor C_b is left.
    """
    lK: Mat3 = lever(body.arm, body.K)
    parent.K = add_symmetric(parent.K, body.K)
    if not body.ball:
        parent.A = add_symmetric(parent.A, add_symmetric_part(body.A, lever_rows(body.arm, body.C)))
        parent.C = add_matrix(parent.C, body.C)
    parent.A = add_symmetric(parent.A, both_levers(body.arm, lK))
    parent.C = add_matrix(parent.C, lK)


def set_branch_loads(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Set the load that each body needs from its joint: velocity terms minus applied and artificial loads."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    if scene.flat:
        set_branch_loads_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.M_branch = sub(body.gyroscopic if inertial else zero, body.M_applied)
        body.f_branch = sub(body.centrifugal if inertial else zero, body.f_applied)
    for i in range(scene.artificial_count):
        push_artificial_load(scene, cython.address(scene.artificial_inertias[i]))


def set_full_branch_loads(scene: cython.pointer[Scene]) -> cython.void:
    """Set the load that each body needs from its joint if no freedom accelerates, gravity and inertia included.

    Leaves those accelerations in alpha_zero and a_zero. The response of the freedoms is then one to loads alone.
    """
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    if scene.flat:
        set_full_branch_loads_in_plane(scene)
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
        balance_body(body, True)
        body.M_branch = body.M_joint
        body.f_branch = body.f_joint
    for i in range(scene.artificial_count):
        push_artificial_load(scene, cython.address(scene.artificial_inertias[i]))


def add_zero_accelerations(scene: cython.pointer[Scene]) -> cython.void:
    """Add the accelerations if no freedom accelerated, minus gravity, to those that respond to the loads."""
    i: cython.Py_ssize_t
    if scene.flat:
        add_zero_accelerations_in_plane(scene)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        body.alpha = add(body.alpha, body.alpha_zero)
        body.a = add(body.a, sub(body.a_zero, scene.gravity))


def push_artificial_load(scene: cython.pointer[Scene], inertia: cython.pointer[ArtificialInertia]) -> cython.void:
    """Take the load z n of an artificial inertia off its body."""
    body: cython.pointer[Body] = cython.address(scene.bodies[inertia.body])
    body.M_branch = add_scaled(body.M_branch, -inertia.z, inertia.n)


def sweep_up(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From M_branch, f_branch and velocity terms find e, the loads on the freedoms; tips to roots."""
    i: cython.Py_ssize_t
    if scene.flat:
        sweep_up_in_plane(scene, inertial)
        return
    for i in range(scene.body_count - 1, -1, -1):
        sweep_body_up(scene, cython.address(scene.bodies[i]), inertial)


def sweep_body_up(scene: cython.pointer[Scene], body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """Find the loads of a branch on the freedoms of its body's joint; pass the rest to the parent."""
    k: cython.Py_ssize_t
    if body.ball:
        offset: cython.Py_ssize_t = body.velocity_at
        write_vector(scene.e, offset, scale_vector(-1.0, body.M_branch))
        body.f_branch = sub(body.f_branch, rotate_back(body.G, body.M_branch))
    for k in range(body.first_freedom, body.end_freedom):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
        scene.e[freedom.velocity_at] = eliminate_load(body, freedom)
    if body.parent >= 0:
        pass_load_to_parent(cython.address(scene.bodies[body.parent]), body, inertial)


def eliminate_load(body: cython.pointer[Body], freedom: cython.pointer[Freedom]) -> cython.double:
    """Return the load e = -s . (M or f) on a freedom, and take its effect off the branch: M += U e / D, f likewise."""
    if freedom.driven:
        return 0.0
    e: cython.double = -project_on_freedom(freedom, body.M_branch, body.f_branch)
    body.M_branch = add_scaled(body.M_branch, e * freedom.D, freedom.U_turn)
    body.f_branch = add_scaled(body.f_branch, e * freedom.D, freedom.U_shift)
    return e


def pass_load_to_parent(parent: cython.pointer[Body], body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """Add the branch's loads, with its velocity terms, to the parent at the arm l."""
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


def sweep_down(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """From e find the accelerations of freedoms and bodies, roots to tips."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    if scene.flat:
        sweep_down_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        alpha: Vec3 = Vec3(0.0, 0.0, 0.0)
        a: Vec3 = scale_vector(-1.0, scene.gravity) if inertial else alpha
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
            base_load: cython.double = dot(freedom.U_shift, a)
            if not body.ball:
                base_load += dot(freedom.U_turn, alpha)
            freedom.udot = freedom.D * (scene.e[freedom.velocity_at] - base_load)
            if freedom.kind == SHIFT:
                a = add_scaled(a, freedom.udot, freedom.s)
            else:
                alpha = add_scaled(alpha, freedom.udot, freedom.s)
        if body.ball:
            offset: cython.Py_ssize_t = body.velocity_at
            alpha = solve(body.A_factors, read_vector(scene.e, offset))
            alpha = sub(alpha, rotate(body.G, a))
        body.alpha = alpha
        body.a = a


def write_derivative(
    scene: cython.pointer[Scene], y: cython.p_double, dy: cython.p_double, power: cython.double
) -> cython.void:
    """Write the state's time derivative dy from the accelerations found; power: of what has no potential."""
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            offset = body.attitude_at
            rate: Quaternion = quaternion_rate(read_quaternion(y, offset), body.omega)
            write_quaternion(dy, offset, rate)
            offset = body.rate_at
            write_vector(dy, offset, body.alpha)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            dy[freedom.q_at] = freedom.u
            dy[freedom.u_at] = freedom.udot
    if scene.work_at >= 0:
        dy[scene.work_at] = power


def balance_joints(scene: cython.pointer[Scene], inertial: cython.bint) -> cython.void:
    """Find the joint loads from the accelerations found and the applied loads, by Newton's and Euler's laws, tips to
    roots.

    Independent of the factored inertias: the component in a free direction is the sweep's rounding error.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    if scene.flat:
        balance_in_plane(scene, inertial)
        return
    for i in range(scene.body_count):
        balance_body(cython.address(scene.bodies[i]), inertial)
    for i in range(scene.body_count - 1, -1, -1):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.parent >= 0:
            parent: cython.pointer[Body] = cython.address(scene.bodies[body.parent])
            parent.M_joint = add(parent.M_joint, add(body.M_joint, cross(body.arm, body.f_joint)))
            parent.f_joint = add(parent.f_joint, body.f_joint)
        for k in range(body.first_freedom, body.end_freedom):
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
            if freedom.driven:
                freedom.drive = project_on_freedom(freedom, body.M_joint, body.f_joint)


def balance_body(body: cython.pointer[Body], inertial: cython.bint) -> cython.void:
    """Find the load that moves one body: the lost forces (57), (58) of the whole body, reversed; minus applied loads.

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
