"""Named points that expressions use, over an interval of time: where they are, and how far they may move.

Over a part of length T a place lies between its values at both ends, extended by the effect of the largest acceleration
A:

    |x(t) - chord| <= A T^2 / 8,     |v(t) - v(nearer end)| <= A T / 2

A is bounded from the roots to the tips by magnitudes alone, of the freedoms' rates u and their rates over the part,

    Omega = Omega_p + sum |u|,   Alpha = Alpha_p + sum (|udot| + Omega |u|)
    A = A_p + (Alpha_p + Omega_p^2) l + 2 Omega_p w + wdot       at the joint point, l: the arm, w: the shifts' speed

so that the bounds become as tight as the parts are short, whatever turns in them. Variables of loads depend on two
bodies (load_ranges.py). Points at an instant are those of the state there, exactly; they are evaluated on separate
bodies, because those of the scene may be in use.
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.attitudes import GLOBAL, leave_chart
from heuncli.kernel.bernstein import (
    PARABOLA_END,
    PARABOLA_MIDDLE,
    PARABOLA_START,
    bound_polynomial,
    convert_rows,
    differentiate,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.enclosure import enclose
from heuncli.kernel.intervals import all_numbers, magnitude
from heuncli.kernel.kinematics import locate_point, set_coordinates, update_kinematics
from heuncli.kernel.load_ranges import bound_acceleration, bound_load_variable, bounds_between, evaluate_load_end

# At an instant


def swap_bodies(scene: cython.pointer[Scene]) -> cython.void:
    """Exchange the scene's bodies and freedoms with the spare ones."""
    bodies: cython.pointer[Body] = scene.bodies
    freedoms: cython.pointer[Freedom] = scene.freedoms
    scene.bodies = scene.spare_bodies
    scene.freedoms = scene.spare_freedoms
    scene.spare_bodies = bodies
    scene.spare_freedoms = freedoms


def evaluate_variables(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """Evaluate the variables of the expressions at a state; the bodies stay as they are."""
    if scene.point_count == 0:
        set_coordinates(scene, t, y)
        return
    swap_bodies(scene)
    update_kinematics(scene, t, y)
    swap_bodies(scene)


def interpolate_course(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.void:
    """Write the state at x of the interval to points.at."""
    i: cython.Py_ssize_t
    points: cython.pointer[PointCourse] = cython.address(course.points)
    for i in range(points.n):
        points.state[i] = bound_polynomial(points.states[i], course.degree, x, x, course.work).low
    if points.interval_chart:
        leave_chart(scene, points.interval_chart, points.origin, points.state)


def set_point_variables_at(
    scene: cython.pointer[Scene], course: cython.pointer[Course], t: cython.double, x: cython.double
) -> cython.void:
    """Set the variables to their values at x of the interval, which is the instant t."""
    interpolate_course(scene, course, x)
    evaluate_variables(scene, t, course.points.state)


def has_far_turn(scene: cython.pointer[Scene], duration: cython.double) -> cython.bint:
    """Return whether a point's body turns so far in an interval that the stages do not show where its points went."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
            if body_turns_far(scene, load.a, duration) or body_turns_far(scene, load.b, duration):
                return True
            if load.kind == ROPE and rope_has_far_turn(scene, load, duration):
                return True
        elif variable.is_point and body_turns_far(scene, variable.body, duration):
            return True
    return False


def rope_has_far_turn(scene: cython.pointer[Scene], load: cython.pointer[Load], duration: cython.double) -> cython.bint:
    """Return whether a body that a rope passes turns that far."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        if body_turns_far(scene, scene.parts[i].a, duration) or body_turns_far(scene, scene.parts[i].b, duration):
            return True
    return False


def body_turns_far(scene: cython.pointer[Scene], body: cython.int, duration: cython.double) -> cython.bint:
    """Return whether a body turns that far."""
    return body >= 0 and not norm(scene.bodies[body].omega) * duration <= scene.limits.seen_turn


# Laying their course


def build_state_course(run: cython.pointer[Run], rows: cython.int) -> cython.void:
    """Set all components of the state over the trial step from some rows of its interpolating polynomial."""
    i: cython.Py_ssize_t
    points: cython.pointer[PointCourse] = cython.address(run.course.points)
    points.interval_chart = points.chart
    for i in range(points.n):
        convert_rows(run.chart.y[i], run.dense, rows, i, points.states[i])


def build_state_window(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], half: cython.double
) -> cython.void:
    """Set all components of the state about the end of the trial step: coordinates as parabolas, others as lines."""
    i: cython.Py_ssize_t
    bend: cython.double
    points: cython.pointer[PointCourse] = cython.address(run.course.points)
    last: cython.p_double = run.K[method.stages]
    points.interval_chart = 0
    for i in range(points.n):
        points.states[i][PARABOLA_START] = run.z[i] - half * last[i]
        points.states[i][PARABOLA_MIDDLE] = run.z[i]
        points.states[i][PARABOLA_END] = run.z[i] + half * last[i]
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            bend = 0.5 * half * half * last[freedom.u_at]
            b: cython.p_double = points.states[freedom.q_at]
            b[PARABOLA_START] = b[PARABOLA_START] + bend
            b[PARABOLA_MIDDLE] = b[PARABOLA_MIDDLE] - bend
            b[PARABOLA_END] = b[PARABOLA_END] + bend


# Bounds over a part


def bound_point_variables(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
    rates: cython.bint,
) -> cython.void:
    """Bound the variables that belong to points between x0 and x1; or, with `rates`, their rates and the rates of
    those.
    """
    i: cython.Py_ssize_t
    points: cython.pointer[PointCourse] = cython.address(course.points)
    T: cython.double = (x1 - x0) * course.length
    bound_bodies(scene, course, x0, x1)
    for i in range(scene.variable_count):
        points.saved_variables[i] = scene.programs.variables[i]
    evaluate_part_end(scene, course, x0, points.first_place, points.first_rate)
    evaluate_part_end(scene, course, x1, points.last_place, points.last_rate)
    for i in range(scene.variable_count):
        scene.programs.variables[i] = points.saved_variables[i]
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if not variable.is_point:
            continue
        if variable.is_point == OF_LOAD:
            ranges[i] = bound_load_variable(scene, points, i, T, ranges[i].value, rates)
            continue
        A: cython.double = bound_acceleration(points, variable.body, variable.q)
        bend: cython.double = 0.125 * A * T * T + point_rounding(scene, points, variable, False)
        drift: cython.double = 0.5 * A * T + point_rounding(scene, points, variable, True)
        place: Bounds = bounds_between(points.first_place[i], points.last_place[i], bend)
        rate: Bounds = bounds_between(points.first_rate[i], points.last_rate[i], drift)
        second: Bounds = Bounds(-A, A)
        if rates and variable.is_rate:
            ranges[i] = Span(ranges[i].value, second, all_numbers())
        elif rates:
            ranges[i] = Span(ranges[i].value, rate, second)
        else:
            ranges[i] = Span(rate if variable.is_rate else place, all_numbers(), all_numbers())


def evaluate_part_end(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x: cython.double,
    places: cython.p_double,
    rates: cython.p_double,
) -> cython.void:
    """Evaluate the variables that belong to points, and their rates, at x of the interval."""
    i: cython.Py_ssize_t
    t: cython.double = course.begin + x * course.length
    interpolate_course(scene, course, x)
    swap_bodies(scene)
    update_kinematics(scene, course.latest if t > course.latest else t, course.points.state)
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            evaluate_load_end(scene, i, places, rates)
        elif variable.is_point:
            point: PointMotion = locate_point(scene, variable.body, variable.q)
            places[i] = dot(variable.direction, point.x) + variable.offset
            rates[i] = dot(variable.direction, point.v)
    swap_bodies(scene)


def point_rounding(
    scene: cython.pointer[Scene],
    points: cython.pointer[PointCourse],
    variable: cython.pointer[Variable],
    of_rate: cython.bint,
) -> cython.double:
    """Return the rounding error of a point's place or velocity, from the terms that it is the sum of."""
    i: cython.Py_ssize_t = variable.body
    if i < 0:
        return 0.0
    arm: cython.double = norm(variable.q)
    if of_rate:
        return scene.limits.rounding * (points.speed[i] + points.angular_velocity[i] * arm)
    return scene.limits.rounding * (points.reach[i] + arm + fabs(variable.offset))


def bound_bodies(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.void:
    """Bound how fast bodies turn and their joint points move between x0 and x1, from the roots to the tips."""
    i: cython.Py_ssize_t
    t0: cython.double = course.begin + x0 * course.length
    t1: cython.double = course.begin + x1 * course.length
    t0 = course.latest if t0 > course.latest else t0
    t1 = course.latest if t1 > course.latest else t1
    scene.programs.ranges[0] = Span(Bounds(t0, t1), Bounds(1.0, 1.0), Bounds(0.0, 0.0))
    for i in range(scene.body_count):
        bound_joint_point(scene, course, i, x0, x1)
        bound_turning(scene, course, i, x0, x1)


def bound_joint_point(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    i: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Bound distance, speed and acceleration of a body's joint point."""
    k: cython.Py_ssize_t
    body: cython.pointer[Body] = cython.address(scene.bodies[i])
    points: cython.pointer[PointCourse] = cython.address(course.points)
    arm: cython.double = norm(body.joint_in_parent)
    speed: cython.double = 0.0
    pull: cython.double = 0.0
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == SHIFT:
            bounds: Jet = bound_freedom(scene, course, k, x0, x1)
            if scene.freedoms[k].pieces:
                freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
                bent: cython.double = freedom.bend * bounds.rate * bounds.rate
                bounds = Jet(freedom.reach, freedom.slope * bounds.rate, freedom.slope * bounds.second + bent)
            arm += bounds.value
            speed += bounds.rate
            pull += bounds.second
    points.reach[i] = arm
    points.speed[i] = speed
    points.acceleration[i] = pull
    if body.parent >= 0:
        p: cython.Py_ssize_t = body.parent
        spin: cython.double = points.angular_velocity[p]
        points.reach[i] = points.reach[p] + arm
        points.speed[i] = points.speed[p] + spin * arm + speed
        points.acceleration[i] = (
            points.acceleration[p] + (points.angular_acceleration[p] + spin * spin) * arm + 2.0 * spin * speed + pull
        )


def bound_turning(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    i: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Bound angular velocity and angular acceleration of a body."""
    k: cython.Py_ssize_t
    body: cython.pointer[Body] = cython.address(scene.bodies[i])
    points: cython.pointer[PointCourse] = cython.address(course.points)
    points.angular_velocity[i] = points.angular_velocity[body.parent] if body.parent >= 0 else 0.0
    points.angular_acceleration[i] = points.angular_acceleration[body.parent] if body.parent >= 0 else 0.0
    if body.ball:
        bound_ball(course, body, i, x0, x1)
        return
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind != SHIFT:
            bounds: Jet = bound_freedom(scene, course, k, x0, x1)
            # parallel axes do not turn each other
            points.angular_acceleration[i] += bounds.second + (
                0.0 if scene.flat else points.angular_velocity[i] * bounds.rate
            )
            points.angular_velocity[i] += bounds.rate


def bound_ball(
    course: cython.pointer[Course],
    body: cython.pointer[Body],
    i: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Bound a body whose angular velocity is in the state; in the global chart the rate of kappa is there.

    omega = 2 (kappadot + kappa x kappadot) / (1 + kappa^2):   |omega| <= 2 |kappadot|, |alpha| <= 2 |kappaddot| + 2
    |kappadot|^2
    """
    c: cython.Py_ssize_t
    spin: cython.double = 0.0
    twist: cython.double = 0.0
    points: cython.pointer[PointCourse] = cython.address(course.points)
    for c in range(body.rate_at, body.rate_at + 3):
        bounds: Jet = bound_component(course, c, x0, x1)
        spin += bounds.value * bounds.value
        twist += bounds.rate * bounds.rate
    points.angular_velocity[i] = sqrt(spin)
    points.angular_acceleration[i] = sqrt(twist)
    if points.interval_chart == GLOBAL:
        points.angular_acceleration[i] = 2.0 * points.angular_acceleration[i] + 2.0 * spin
        points.angular_velocity[i] = 2.0 * points.angular_velocity[i]


def bound_freedom(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    k: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> Jet:
    """Bound the magnitudes of a freedom's coordinate, rate and acceleration."""
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
    if freedom.driven:
        drive: Span = enclose(scene.programs, freedom.program)
        return Jet(magnitude(drive.value).high, magnitude(drive.rate).high, magnitude(drive.second).high)
    rate: Jet = bound_component(course, freedom.u_at, x0, x1)
    place: cython.double = 0.0
    if freedom.kind == SHIFT:
        q: cython.p_double = course.points.states[freedom.q_at]
        place = magnitude(bound_polynomial(q, course.degree, x0, x1, course.work)).high
    return Jet(place, rate.value, rate.rate)


def bound_component(course: cython.pointer[Course], c: cython.Py_ssize_t, x0: cython.double, x1: cython.double) -> Jet:
    """Bound the magnitudes of a component of the state and of its rate; the second derivative is not needed."""
    n: cython.int = course.degree
    slopes: cython.p_double = course.points.slopes
    b: cython.p_double = course.points.states[c]
    differentiate(b, slopes, n, course.length)
    return Jet(
        magnitude(bound_polynomial(b, n, x0, x1, course.work)).high,
        magnitude(bound_polynomial(slopes, n - 1, x0, x1, course.work)).high,
        0.0,
    )
