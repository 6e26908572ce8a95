"""Named points that expressions use, over a stretch of time: where they are, and how far they may be from there.

A place runs over a part of length T between its values at both ends, but for what the largest acceleration A adds:

    |x(t) - chord| <= A T^2 / 8,     |v(t) - v(nearer end)| <= A T / 2

A is bounded from the roots to the tips by magnitudes alone, of the freedoms' rates u and of theirs over the part,

    Omega = Omega_p + sum |u|,   Alpha = Alpha_p + sum (|udot| + Omega |u|)
    A = A_p + (Alpha_p + Omega_p^2) l + 2 Omega_p w + wdot       at the joint point, l: the arm, w: the shifts' speed

so that parts are told apart as closely as they are divided, whatever turns in them. What loads act between hangs on two
bodies (load_ranges). Points at an instant are those of
the state there, exactly; they are looked at on bodies of their own, for those of the scene may be in use.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.algebra import dot, norm
    from heuncli.kernel.attitudes import GLOBAL, leave_chart
    from heuncli.kernel.bernstein import differentiate, of_rows, range_of
    from heuncli.kernel.enclosure import enclose
    from heuncli.kernel.intervals import anything, magnitude
    from heuncli.kernel.load_ranges import between, load_at_end, range_of_load
    from heuncli.kernel.motion_bounds import bound_acceleration
    from heuncli.kernel.programs import Bounds, Jet, Span
    from heuncli.kernel.scene import OF_LOAD, ROPE, SHIFT, Body, Freedom, Load, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Course, Method, Orbits, Run
    from heuncli.kernel.tree import coordinates, kinematics, point_of
    from heuncli.kernel.values import PointMotion

# At an instant


def swap_bodies(scene: cython.pointer[Scene]) -> cython.void:
    """The bodies beside take the place of the scene's, or give it back."""
    bodies: cython.pointer[Body] = scene.bodies
    freedoms: cython.pointer[Freedom] = scene.freedoms
    scene.bodies = scene.bodies_beside
    scene.freedoms = scene.freedoms_beside
    scene.bodies_beside = bodies
    scene.freedoms_beside = freedoms


def look_at(scene: cython.pointer[Scene], t: cython.double, y: cython.p_double) -> cython.void:
    """The variables of the expressions at a state; the bodies stay as they are."""
    if scene.point_count == 0:
        coordinates(scene, t, y)
        return
    swap_bodies(scene)
    kinematics(scene, t, y)
    swap_bodies(scene)


def put_state(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.void:
    """The state at x of the stretch, into `at`."""
    i: cython.Py_ssize_t
    points: cython.pointer[Orbits] = cython.address(course.points)
    for i in range(points.n):
        points.at[i] = range_of(points.states[i], course.degree, x, x, course.work).low
    if points.charted:
        leave_chart(scene, points.charted, points.origin, points.at)


def stand_points(
    scene: cython.pointer[Scene], course: cython.pointer[Course], t: cython.double, x: cython.double
) -> cython.void:
    """The variables at x of the stretch, which is the instant t."""
    put_state(scene, course, x)
    look_at(scene, t, course.points.at)


def turned_far(scene: cython.pointer[Scene], length: cython.double) -> cython.bint:
    """Whether a point's body turns by more in a stretch of time than what stages see of its places can tell."""
    i: cython.Py_ssize_t
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            load: cython.pointer[Load] = cython.address(scene.loads[variable.load])
            if turns_far(scene, load.a, length) or turns_far(scene, load.b, length):
                return True
            if load.kind == ROPE and rope_turns_far(scene, load, length):
                return True
        elif variable.is_point and turns_far(scene, variable.body, length):
            return True
    return False


def rope_turns_far(scene: cython.pointer[Scene], load: cython.pointer[Load], length: cython.double) -> cython.bint:
    """Whether a body that a rope passes turns by so much."""
    i: cython.Py_ssize_t
    for i in range(load.part, load.part + load.part_count):
        if turns_far(scene, scene.parts[i].a, length) or turns_far(scene, scene.parts[i].b, length):
            return True
    return False


def turns_far(scene: cython.pointer[Scene], body: cython.int, length: cython.double) -> cython.bint:
    """Whether a body turns by so much."""
    return body >= 0 and not norm(scene.bodies[body].omega) * length <= scene.limits.seen_turn


# Laying their course


def lay_states(run: cython.pointer[Run], rows: cython.int) -> cython.void:
    """All components of the state over the step tried, by some rows of its interpolating polynomial."""
    i: cython.Py_ssize_t
    points: cython.pointer[Orbits] = cython.address(run.course.points)
    points.charted = points.chart
    for i in range(points.n):
        of_rows(run.chart.y[i], run.dense, rows, i, points.states[i])


def lay_states_about_end(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], half: cython.double
) -> cython.void:
    """All components of the state about the end of the step tried: coordinates are parabolas, the others straight."""
    i: cython.Py_ssize_t
    bend: cython.double
    points: cython.pointer[Orbits] = cython.address(run.course.points)
    last: cython.p_double = run.K[method.stages]
    points.charted = 0
    for i in range(points.n):
        points.states[i][0] = run.z[i] - half * last[i]
        points.states[i][1] = run.z[i]
        points.states[i][2] = run.z[i] + half * last[i]
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            bend = 0.5 * half * half * last[freedom.u_at]
            b: cython.p_double = points.states[freedom.q_at]
            b[0] = b[0] + bend
            b[1] = b[1] - bend
            b[2] = b[2] + bend


# Bounds over a part


def range_points(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
    rates: cython.bint,
) -> cython.void:
    """Ranges between x0 and x1 of the variables that are of points; or of their rates, and of the rates of those."""
    i: cython.Py_ssize_t
    points: cython.pointer[Orbits] = cython.address(course.points)
    T: cython.double = (x1 - x0) * course.length
    bound_bodies(scene, course, x0, x1)
    for i in range(scene.variable_count):
        points.kept[i] = scene.programs.variables[i]
    end_of_part(scene, course, x0, points.first_place, points.first_rate)
    end_of_part(scene, course, x1, points.last_place, points.last_rate)
    for i in range(scene.variable_count):
        scene.programs.variables[i] = points.kept[i]
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if not variable.is_point:
            continue
        if variable.is_point == OF_LOAD:
            ranges[i] = range_of_load(scene, points, i, T, ranges[i].value, rates)
            continue
        A: cython.double = bound_acceleration(points, variable.body, variable.q)
        bend: cython.double = 0.125 * A * T * T + rounding_of(scene, points, variable, False)
        drift: cython.double = 0.5 * A * T + rounding_of(scene, points, variable, True)
        place: Bounds = between(points.first_place[i], points.last_place[i], bend)
        rate: Bounds = between(points.first_rate[i], points.last_rate[i], drift)
        second: Bounds = Bounds(-A, A)
        if rates and variable.is_rate:
            ranges[i] = Span(ranges[i].value, second, anything())
        elif rates:
            ranges[i] = Span(ranges[i].value, rate, second)
        else:
            ranges[i] = Span(rate if variable.is_rate else place, anything(), anything())


def end_of_part(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    x: cython.double,
    places: cython.p_double,
    rates: cython.p_double,
) -> cython.void:
    """Places and their rates at x of the stretch, of the variables that are of points."""
    i: cython.Py_ssize_t
    t: cython.double = course.begin + x * course.length
    put_state(scene, course, x)
    swap_bodies(scene)
    kinematics(scene, course.latest if t > course.latest else t, course.points.at)
    for i in range(1, scene.variable_count):
        variable: cython.pointer[Variable] = cython.address(scene.variables[i])
        if variable.is_point == OF_LOAD:
            load_at_end(scene, i, places, rates)
        elif variable.is_point:
            there: PointMotion = point_of(scene, variable.body, variable.q)
            places[i] = dot(variable.direction, there.x) + variable.offset
            rates[i] = dot(variable.direction, there.v)
    swap_bodies(scene)


def rounding_of(
    scene: cython.pointer[Scene],
    points: cython.pointer[Orbits],
    variable: cython.pointer[Variable],
    of_rate: cython.bint,
) -> cython.double:
    """By how much rounding leaves a point's place or velocity open: that of the terms it is the sum of."""
    i: cython.Py_ssize_t = variable.body
    if i < 0:
        return 0.0
    arm: cython.double = norm(variable.q)
    if of_rate:
        return scene.limits.rounding * (points.speed[i] + points.spin[i] * arm)
    return scene.limits.rounding * (points.reach[i] + arm + fabs(variable.offset))


def bound_bodies(
    scene: cython.pointer[Scene], course: cython.pointer[Course], x0: cython.double, x1: cython.double
) -> cython.void:
    """How fast bodies may turn and their joint points move between x0 and x1, from the roots to the tips."""
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
    """Of a body's joint point: how far it is, how fast, and how fast that changes."""
    k: cython.Py_ssize_t
    body: cython.pointer[Body] = cython.address(scene.bodies[i])
    points: cython.pointer[Orbits] = cython.address(course.points)
    arm: cython.double = norm(body.joint_in_parent)
    speed: cython.double = 0.0
    pull: cython.double = 0.0
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind == SHIFT:
            most: Jet = most_of(scene, course, k, x0, x1)
            if scene.freedoms[k].pieces:
                freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
                bent: cython.double = freedom.bend * most.rate * most.rate
                most = Jet(freedom.reach, freedom.slope * most.rate, freedom.slope * most.second + bent)
            arm += most.value
            speed += most.rate
            pull += most.second
    points.reach[i] = arm
    points.speed[i] = speed
    points.pull[i] = pull
    if body.parent >= 0:
        p: cython.Py_ssize_t = body.parent
        spin: cython.double = points.spin[p]
        points.reach[i] = points.reach[p] + arm
        points.speed[i] = points.speed[p] + spin * arm + speed
        points.pull[i] = points.pull[p] + (points.twist[p] + spin * spin) * arm + 2.0 * spin * speed + pull


def bound_turning(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    i: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Of a body: how fast it turns, and how fast that changes."""
    k: cython.Py_ssize_t
    body: cython.pointer[Body] = cython.address(scene.bodies[i])
    points: cython.pointer[Orbits] = cython.address(course.points)
    points.spin[i] = points.spin[body.parent] if body.parent >= 0 else 0.0
    points.twist[i] = points.twist[body.parent] if body.parent >= 0 else 0.0
    if body.ball:
        bound_ball(course, body, i, x0, x1)
        return
    for k in range(body.first_freedom, body.end_freedom):
        if scene.freedoms[k].kind != SHIFT:
            most: Jet = most_of(scene, course, k, x0, x1)
            # axes that are all parallel turn nothing about each other
            points.twist[i] += most.second + (0.0 if scene.flat else points.spin[i] * most.rate)
            points.spin[i] += most.rate


def bound_ball(
    course: cython.pointer[Course],
    body: cython.pointer[Body],
    i: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Of a body whose angular velocity is in the state; in the global chart the rate of kappa is there.

    omega = 2 (kappadot + kappa x kappadot) / (1 + kappa^2):   |omega| <= 2 |kappadot|,
    |alpha| <= 2 |kappaddot| + 2 |kappadot|^2
    """
    c: cython.Py_ssize_t
    spin: cython.double = 0.0
    twist: cython.double = 0.0
    points: cython.pointer[Orbits] = cython.address(course.points)
    for c in range(body.rate_at, body.rate_at + 3):
        most: Jet = most_of_component(course, c, x0, x1)
        spin += most.value * most.value
        twist += most.rate * most.rate
    points.spin[i] = sqrt(spin)
    points.twist[i] = sqrt(twist)
    if points.charted == GLOBAL:
        points.twist[i] = 2.0 * points.twist[i] + 2.0 * spin
        points.spin[i] = 2.0 * points.spin[i]


def most_of(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    k: cython.Py_ssize_t,
    x0: cython.double,
    x1: cython.double,
) -> Jet:
    """The largest magnitudes of a freedom's coordinate, rate and acceleration."""
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[k])
    if freedom.driven:
        given: Span = enclose(scene.programs, freedom.program)
        shifted: Bounds = Bounds(given.value.low + freedom.offset, given.value.high + freedom.offset)
        return Jet(magnitude(shifted).high, magnitude(given.rate).high, magnitude(given.second).high)
    rate: Jet = most_of_component(course, freedom.u_at, x0, x1)
    place: cython.double = 0.0
    if freedom.kind == SHIFT:
        q: cython.p_double = course.points.states[freedom.q_at]
        place = magnitude(range_of(q, course.degree, x0, x1, course.work)).high
    return Jet(place, rate.value, rate.rate)


def most_of_component(
    course: cython.pointer[Course], c: cython.Py_ssize_t, x0: cython.double, x1: cython.double
) -> Jet:
    """The largest magnitudes of a component of the state and of its rate; the second is not asked for."""
    n: cython.int = course.degree
    slopes: cython.p_double = course.points.slopes
    b: cython.p_double = course.points.states[c]
    differentiate(b, slopes, n, course.length)
    return Jet(
        magnitude(range_of(b, n, x0, x1, course.work)).high,
        magnitude(range_of(slopes, n - 1, x0, x1, course.work)).high,
        0.0,
    )
