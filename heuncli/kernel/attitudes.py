"""Charts of attitudes by Rodrigues' numbers, kappa = tan(theta / 2) about the axis, in place of quaternions in a step.

    R(kappa) = 1 + 2 (hat + hat^2) / (1 + kappa^2),   as a quaternion (1, kappa) / sqrt(1 + kappa^2)
    sigma = W kappadot = 2 (kappadot + kappa x kappadot) / (1 + kappa^2)                 (42), (43), world axes
    kappadot = W^-1 sigma = (sigma + kappa (kappa . sigma) - kappa x sigma) / 2          the same, inverted
    kappaddot = W^-1 sigmadot + [2 kappa . kappadot / (1 + kappa^2)] kappadot            no. 20, Lagrange's form

Global: R = R(kappa) all along, the unknowns kappa and kappadot; at a half turn kappa is infinite. Re-centred: R =
R(kappa) R_0 from the start of each step, the unknowns kappa and sigma; kappa is small. The state, (quaternion, angular
velocity), is kept at the ends of the steps: a chart stands within a step only, in the places of the state (the fourth
number of an attitude is then 0). y is the state at the step's start throughout.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import atan2, fabs, sqrt

    from heuncli.kernel.algebra import Quaternion, Vec3, add_cross, add_scaled, cross, dot, norm, scaled, sub
    from heuncli.kernel.scene import Body, Scene
    from heuncli.kernel.shadow import cython

    # How a method holds attitudes.
    QUATERNION, GLOBAL, RECENTRED = range(3)


def centre(attitude: cython.int, y: cython.p_double, at: cython.Py_ssize_t) -> Quaternion:
    """The attitude that kappa is counted from: that of the axes, of the sign that lets q go on, or the step's start."""
    if attitude == RECENTRED:
        return Quaternion(y[at], y[at + 1], y[at + 2], y[at + 3])
    return Quaternion(-1.0 if y[at] < 0.0 else 1.0, 0.0, 0.0, 0.0)


def kappa_of(q: Quaternion, c: Quaternion) -> Vec3:
    """Rodrigues' numbers of the turn from c to q: vector over scalar part of q c*."""
    v: Vec3 = Vec3(q.x, q.y, q.z)
    w: Vec3 = Vec3(c.x, c.y, c.z)
    turn: Vec3 = sub(add_scaled(scaled(c.w, v), -q.w, w), cross(v, w))
    return scaled(1.0 / (q.w * c.w + dot(v, w)), turn)


def turn_quaternion(kappa: Vec3, c: Quaternion) -> Quaternion:
    """c turned by kappa: (1, kappa) c / sqrt(1 + kappa^2)."""
    w: Vec3 = Vec3(c.x, c.y, c.z)
    v: Vec3 = add_cross(add_scaled(w, c.w, kappa), kappa, w)
    part: cython.double = 1.0 / sqrt(1.0 + dot(kappa, kappa))
    return Quaternion(part * (c.w - dot(kappa, w)), part * v.x, part * v.y, part * v.z)


def rate_of(kappa: Vec3, sigma: Vec3) -> Vec3:
    """W^-1 sigma: the rate of kappa for an angular velocity."""
    along: Vec3 = add_scaled(sigma, dot(kappa, sigma), kappa)
    return scaled(0.5, sub(along, cross(kappa, sigma)))


def spin_of(kappa: Vec3, rate: Vec3) -> Vec3:
    """W kappadot: the angular velocity for a rate of kappa."""
    return scaled(2.0 / (1.0 + dot(kappa, kappa)), add_cross(rate, kappa, rate))


def second_of(kappa: Vec3, rate: Vec3, sigmadot: Vec3) -> Vec3:
    """W^-1 sigmadot + [2 kappa . kappadot / (1 + kappa^2)] kappadot: the second derivative of kappa."""
    return add_scaled(rate_of(kappa, sigmadot), 2.0 * dot(kappa, rate) / (1.0 + dot(kappa, kappa)), rate)


def vector_at(x: cython.p_double, at: cython.Py_ssize_t) -> Vec3:
    """Three numbers of a state."""
    return Vec3(x[at], x[at + 1], x[at + 2])


def put_vector(x: cython.p_double, at: cython.Py_ssize_t, a: Vec3) -> cython.void:
    """Put three numbers into a state."""
    x[at] = a.x
    x[at + 1] = a.y
    x[at + 2] = a.z


def kappa_at(attitude: cython.int, y: cython.p_double, state: cython.p_double, at: cython.Py_ssize_t) -> Vec3:
    """Rodrigues' numbers of a body's attitude in a state."""
    return kappa_of(Quaternion(state[at], state[at + 1], state[at + 2], state[at + 3]), centre(attitude, y, at))


def enter_chart(
    scene: cython.pointer[Scene],
    attitude: cython.int,
    y: cython.p_double,
    state: cython.p_double,
    out: cython.p_double,
) -> cython.void:
    """The attitudes of a state, and globally their rates, in the chart; all else of `out` is left as it is."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = kappa_at(attitude, y, state, body.attitude_at)
            put_vector(out, body.attitude_at, kappa)
            out[body.attitude_at + 3] = 0.0
            if attitude == GLOBAL:
                put_vector(out, body.rate_at, rate_of(kappa, vector_at(state, body.rate_at)))


def leave_chart(
    scene: cython.pointer[Scene], attitude: cython.int, y: cython.p_double, x: cython.p_double
) -> cython.void:
    """Numbers of the chart made a state again, in their places."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            at: cython.Py_ssize_t = body.attitude_at
            kappa: Vec3 = vector_at(x, at)
            q: Quaternion = turn_quaternion(kappa, centre(attitude, y, at))
            x[at] = q.w
            x[at + 1] = q.x
            x[at + 2] = q.y
            x[at + 3] = q.z
            if attitude == GLOBAL:
                put_vector(x, body.rate_at, spin_of(kappa, vector_at(x, body.rate_at)))


def drop_small_parts(scene: cython.pointer[Scene], attitude: cython.int, carry: cython.p_double) -> cython.void:
    """The parts that digits of the chart's numbers did not hold are none of the state's."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            put_vector(carry, body.attitude_at, zero)
            carry[body.attitude_at + 3] = 0.0
            if attitude == GLOBAL:
                put_vector(carry, body.rate_at, zero)


def chart_slopes(
    scene: cython.pointer[Scene],
    attitude: cython.int,
    y: cython.p_double,
    state: cython.p_double,
    dy: cython.p_double,
    out: cython.p_double,
) -> cython.void:
    """The chart's derivatives at a state with the derivative dy; all else of `out` is left as it is."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = kappa_at(attitude, y, state, body.attitude_at)
            rate: Vec3 = rate_of(kappa, vector_at(state, body.rate_at))
            put_vector(out, body.attitude_at, rate)
            out[body.attitude_at + 3] = 0.0
            if attitude == GLOBAL:
                put_vector(out, body.rate_at, second_of(kappa, rate, vector_at(dy, body.rate_at)))


def weigh_in_chart(
    scene: cython.pointer[Scene], attitude: cython.int, x: cython.p_double, error: cython.p_double
) -> cython.void:
    """Errors of a global chart's numbers by their sizes at x, of kappadot at most (1 + kappa^2) / 2 of the rate.

    W shows an error of kappa as one of at most 2 / sqrt(1 + kappa^2): measured so, attitudes keep the tolerance. The
    error of kappadot is taken by its own size, as the error of any number: what W makes of it is the chart's failing.
    """
    i: cython.Py_ssize_t
    square: cython.double
    if attitude != GLOBAL:
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = vector_at(x, body.attitude_at)
            square = 1.0 + dot(kappa, kappa)
            put_vector(error, body.attitude_at, scaled(1.0 / sqrt(square), vector_at(error, body.attitude_at)))
            put_vector(error, body.rate_at, scaled(2.0 / square, vector_at(error, body.rate_at)))


# How far it is to a half turn


def measure_ways(
    scene: cython.pointer[Scene], attitude: cython.int, y: cython.p_double, ways: cython.p_double
) -> cython.void:
    """The least turn that makes each body's kappa infinite, at a step's start [rad].

    Of a turn theta, cos(theta / 2) being the quaternion's scalar part, there are pi - theta left.
    """
    i: cython.Py_ssize_t
    w: cython.double
    v: cython.double
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        w = 1.0
        v = 0.0
        if body.ball and attitude == GLOBAL:
            w = fabs(y[body.attitude_at])
            v = norm(vector_at(y, body.attitude_at + 1))
        ways[i] = 2.0 * atan2(w, v)


def nearing(scene: cython.pointer[Scene], state: cython.p_double, ways: cython.p_double) -> cython.double:
    """Largest angular velocity of any body, by its way to a half turn [1/s]: theta grows no faster than |sigma|."""
    i: cython.Py_ssize_t
    rate: cython.double
    largest: cython.double = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            rate = norm(vector_at(state, body.rate_at)) / ways[i]
            if not rate <= largest:
                largest = rate
    return largest


def at_half_turn(scene: cython.pointer[Scene], attitude: cython.int, y: cython.p_double) -> cython.int:
    """1 + the body that is at a half turn of the global chart; 0: none."""
    i: cython.Py_ssize_t
    at: cython.Py_ssize_t
    if attitude == GLOBAL:
        for i in range(scene.body_count):
            at = scene.bodies[i].attitude_at
            if scene.bodies[i].ball and not fabs(y[at]) > scene.limits.half_turn * norm(vector_at(y, at + 1)):
                return i + 1
    return 0
