"""Charts of attitudes by Rodrigues parameters, kappa = tan(theta / 2) about the axis, instead of quaternions within a
step.

    R(kappa) = 1 + 2 (hat + hat^2) / (1 + kappa^2),   as a quaternion (1, kappa) / sqrt(1 + kappa^2)
    sigma = W kappadot = 2 (kappadot + kappa x kappadot) / (1 + kappa^2)                 (42), (43), world axes
    kappadot = W^-1 sigma = (sigma + kappa (kappa . sigma) - kappa x sigma) / 2          the same, inverted
    kappaddot = W^-1 sigmadot + [2 kappa . kappadot / (1 + kappa^2)] kappadot            no. 20, Lagrange's form

The global chart has R = R(kappa) throughout and the unknowns kappa and kappadot; at a half turn kappa is infinite. The
re-centred chart has R = R(kappa) R_0 from the start of each step and the unknowns kappa and sigma; kappa stays small.
Between steps the state holds (quaternion, angular velocity): a chart is used within a step only, in the places of the
state (the fourth number of an attitude is then 0). Throughout this module y is the state at the start of the step.
"""

from __future__ import annotations

from math import atan2, fabs, sqrt

from heuncli.kernel.declarations import *

# How a method holds attitudes.
QUATERNION, GLOBAL, RECENTRED = range(3)


def chart_centre(chart: cython.int, y: cython.p_double, offset: cython.Py_ssize_t) -> Quaternion:
    """Return the attitude at which kappa is zero: the start of the step, or the world axes with the sign that keeps q
    continuous.
    """
    if chart == RECENTRED:
        return read_quaternion(y, offset)
    return Quaternion(-1.0 if y[offset] < 0.0 else 1.0, 0.0, 0.0, 0.0)


def kappa_of(q: Quaternion, c: Quaternion) -> Vec3:
    """Return the Rodrigues parameters of the rotation from c to q: vector over scalar part of q c*."""
    v: Vec3 = Vec3(q.x, q.y, q.z)
    w: Vec3 = Vec3(c.x, c.y, c.z)
    turn: Vec3 = sub(add_scaled(scale_vector(c.w, v), -q.w, w), cross(v, w))
    return scale_vector(1.0 / (q.w * c.w + dot(v, w)), turn)


def rotate_quaternion(kappa: Vec3, c: Quaternion) -> Quaternion:
    """Rotate c by kappa: (1, kappa) c / sqrt(1 + kappa^2)."""
    w: Vec3 = Vec3(c.x, c.y, c.z)
    v: Vec3 = add_cross(add_scaled(w, c.w, kappa), kappa, w)
    part: cython.double = 1.0 / sqrt(1.0 + dot(kappa, kappa))
    return Quaternion(part * (c.w - dot(kappa, w)), part * v.x, part * v.y, part * v.z)


def kappa_rate(kappa: Vec3, sigma: Vec3) -> Vec3:
    """W^-1 sigma: the rate of kappa for the angular velocity sigma."""
    along: Vec3 = add_scaled(sigma, dot(kappa, sigma), kappa)
    return scale_vector(0.5, sub(along, cross(kappa, sigma)))


def angular_velocity(kappa: Vec3, rate: Vec3) -> Vec3:
    """W kappadot: the angular velocity for a rate of kappa."""
    return scale_vector(2.0 / (1.0 + dot(kappa, kappa)), add_cross(rate, kappa, rate))


def kappa_acceleration(kappa: Vec3, rate: Vec3, sigmadot: Vec3) -> Vec3:
    """W^-1 sigmadot + [2 kappa . kappadot / (1 + kappa^2)] kappadot: the second derivative of kappa."""
    return add_scaled(kappa_rate(kappa, sigmadot), 2.0 * dot(kappa, rate) / (1.0 + dot(kappa, kappa)), rate)


def read_kappa(chart: cython.int, y: cython.p_double, state: cython.p_double, offset: cython.Py_ssize_t) -> Vec3:
    """Return the Rodrigues parameters of a body's attitude in a state."""
    return kappa_of(
        read_quaternion(state, offset),
        chart_centre(chart, y, offset),
    )


def enter_chart(
    scene: cython.pointer[Scene],
    chart: cython.int,
    y: cython.p_double,
    state: cython.p_double,
    result: cython.p_double,
) -> cython.void:
    """Convert a state's attitudes, and in the global chart their rates, to the chart; leave all else in `result`
    unchanged.
    """
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = read_kappa(chart, y, state, body.attitude_at)
            write_vector(result, body.attitude_at, kappa)
            result[body.attitude_at + 3] = 0.0
            if chart == GLOBAL:
                write_vector(result, body.rate_at, kappa_rate(kappa, read_vector(state, body.rate_at)))


def leave_chart(scene: cython.pointer[Scene], chart: cython.int, y: cython.p_double, x: cython.p_double) -> cython.void:
    """Convert numbers of the chart back to a state, in place."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            offset: cython.Py_ssize_t = body.attitude_at
            kappa: Vec3 = read_vector(x, offset)
            q: Quaternion = rotate_quaternion(kappa, chart_centre(chart, y, offset))
            write_quaternion(x, offset, q)
            if chart == GLOBAL:
                write_vector(x, body.rate_at, angular_velocity(kappa, read_vector(x, body.rate_at)))


def drop_small_parts(scene: cython.pointer[Scene], chart: cython.int, carry: cython.p_double) -> cython.void:
    """Clear the compensation terms of chart numbers, which do not belong to the state's own numbers."""
    i: cython.Py_ssize_t
    zero: Vec3 = Vec3(0.0, 0.0, 0.0)
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            write_vector(carry, body.attitude_at, zero)
            carry[body.attitude_at + 3] = 0.0
            if chart == GLOBAL:
                write_vector(carry, body.rate_at, zero)


def chart_slopes(
    scene: cython.pointer[Scene],
    chart: cython.int,
    y: cython.p_double,
    state: cython.p_double,
    dy: cython.p_double,
    result: cython.p_double,
) -> cython.void:
    """Convert the derivative dy at a state to the chart's derivatives; leave all else in `result` unchanged."""
    i: cython.Py_ssize_t
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = read_kappa(chart, y, state, body.attitude_at)
            rate: Vec3 = kappa_rate(kappa, read_vector(state, body.rate_at))
            write_vector(result, body.attitude_at, rate)
            result[body.attitude_at + 3] = 0.0
            if chart == GLOBAL:
                write_vector(result, body.rate_at, kappa_acceleration(kappa, rate, read_vector(dy, body.rate_at)))


def scale_chart_errors(
    scene: cython.pointer[Scene], chart: cython.int, x: cython.p_double, error: cython.p_double
) -> cython.void:
    """Scale the errors of a global chart's numbers to errors of attitude and rate at x.

    W turns an error of kappa into a rotation of at most 2 / sqrt(1 + kappa^2) times it, so that attitudes meet the
    tolerance. The error of kappadot is measured by its own size, like that of any number; what W makes of it is a
    limitation of the chart.
    """
    i: cython.Py_ssize_t
    square: cython.double
    if chart != GLOBAL:
        return
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            kappa: Vec3 = read_vector(x, body.attitude_at)
            square = 1.0 + dot(kappa, kappa)
            write_vector(
                error, body.attitude_at, scale_vector(1.0 / sqrt(square), read_vector(error, body.attitude_at))
            )
            write_vector(error, body.rate_at, scale_vector(2.0 / square, read_vector(error, body.rate_at)))


# How far it is to a half turn


def measure_turns_left(
    scene: cython.pointer[Scene], chart: cython.int, y: cython.p_double, turns_left: cython.p_double
) -> cython.void:
    """Find, at the start of a step, the smallest rotation that makes each body's kappa infinite [rad].

    For an attitude of angle theta, where cos(theta / 2) is the quaternion's scalar part, pi - theta is left.
    """
    i: cython.Py_ssize_t
    w: cython.double
    v: cython.double
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        w = 1.0
        v = 0.0
        if body.ball and chart == GLOBAL:
            w = fabs(y[body.attitude_at])
            v = norm(read_vector(y, body.attitude_at + 1))
        turns_left[i] = 2.0 * atan2(w, v)


def half_turn_rate(scene: cython.pointer[Scene], state: cython.p_double, turns_left: cython.p_double) -> cython.double:
    """Return the largest ratio of a body's angular velocity to its distance from a half turn [1/s]: theta grows no
    faster than |sigma|.
    """
    i: cython.Py_ssize_t
    rate: cython.double
    largest: cython.double = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            rate = norm(read_vector(state, body.rate_at)) / turns_left[i]
            if not rate <= largest:
                largest = rate
    return largest


def find_half_turn(scene: cython.pointer[Scene], chart: cython.int, y: cython.p_double) -> cython.int:
    """Return 1 + the number of the body that is at a half turn of the global chart; 0 if none is."""
    i: cython.Py_ssize_t
    offset: cython.Py_ssize_t
    if chart == GLOBAL:
        for i in range(scene.body_count):
            offset = scene.bodies[i].attitude_at
            if scene.bodies[i].ball and not fabs(y[offset]) > scene.limits.half_turn * norm(read_vector(y, offset + 1)):
                return i + 1
    return 0
