"""The course of the coordinates that expressions hang on, over a stretch of time: polynomials in Bernstein's form.

    q(x) = sum_k b_k C(n, k) x^k (1 - x)^(n - k),    min b_k <= q(x) <= max b_k  for 0 <= x <= 1,

and over any part of the stretch between the coefficients of that part (de Casteljau). A stretch is a step with its
dense output, or a window about its end. Driven coordinates have their own programs, and the bounds of those.
Farouki, Rajan, On the numerical condition of polynomials in Bernstein form (1987).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.bernstein import differentiate, of_rows, range_of
    from heuncli.kernel.dense import clipped
    from heuncli.kernel.enclosure import enclose
    from heuncli.kernel.intervals import anything
    from heuncli.kernel.jets import jet
    from heuncli.kernel.points import lay_states, lay_states_about_end, range_points, stand_points
    from heuncli.kernel.programs import Bounds, Jet, Programs, Span
    from heuncli.kernel.scene import Freedom, Scene, Variable
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Course, Method, Run


# Laying a course


def component(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> cython.int:
    """Where a variable stands in the state; -1: it is driven; -2: it is of a point."""
    if scene.variables[i].is_point:
        return -2
    of: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
    return of.u_at if scene.variables[i].is_rate else of.q_at


def is_still(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> cython.bint:
    """Whether a variable is a rate that a closed contact holds at 0."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    return not variable.is_point and variable.is_rate and scene.freedoms[variable.freedom].still


def rest(course: cython.pointer[Course], i: cython.Py_ssize_t) -> cython.void:
    """A variable is 0 all along."""
    k: cython.int
    for k in range(course.degree + 1):
        course.value[i][k] = 0.0
        course.rate[i][k] = 0.0
        course.second[i][k] = 0.0


def lay_course(scene: cython.pointer[Scene], run: cython.pointer[Run], rows: cython.int) -> cython.void:
    """The coordinates over the step tried, by some rows of its interpolating polynomial, in Bernstein's form."""
    i: cython.Py_ssize_t
    at: cython.int
    course: cython.pointer[Course] = cython.address(run.course)
    course.begin = run.t
    course.length = run.h
    course.latest = clipped(run, run.stop)
    course.late = run.late
    course.finest = scene.limits.finest
    course.degree = rows
    if scene.point_count:
        lay_states(run, rows)
    for i in range(1, scene.variable_count):
        at = component(scene, i)
        if is_still(scene, i):
            rest(course, i)
        elif at >= 0:
            of_rows(run.y[at], run.dense, rows, at, course.value[i])
            differentiate(course.value[i], course.rate[i], rows, run.h)
            differentiate(course.rate[i], course.second[i], rows - 1, run.h)


def lay_window(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The coordinates about the end of the step tried, by their derivatives there: parabolas."""
    i: cython.Py_ssize_t
    at: cython.int
    a: cython.double
    u: cython.double
    half: cython.double = scene.limits.window * run.h
    course: cython.pointer[Course] = cython.address(run.course)
    last: cython.p_double = run.K[method.stages]
    course.begin = run.stop - half
    course.length = 2.0 * half
    course.latest = run.before_end
    course.late = run.late
    course.finest = scene.limits.window * scene.limits.window * scene.limits.window  # of the step, a rounding
    course.degree = 2
    if scene.point_count:
        lay_states_about_end(scene, method, run, half)
    for i in range(1, scene.variable_count):
        at = component(scene, i)
        if is_still(scene, i):
            rest(course, i)
            continue
        if at < 0:
            continue
        u = last[at]
        a = 0.0 if scene.variables[i].is_rate else last[scene.freedoms[scene.variables[i].freedom].u_at]
        b: cython.p_double = course.value[i]
        # through z at the middle, with u and a there
        b[0] = run.z[at] - u * half + 0.5 * a * half * half
        b[1] = run.z[at] - 0.5 * a * half * half
        b[2] = run.z[at] + u * half + 0.5 * a * half * half
        differentiate(b, course.rate[i], 2, course.length)
        differentiate(course.rate[i], course.second[i], 1, course.length)


# Looking along it


def instant(course: cython.pointer[Course], x: cython.double) -> cython.double:
    """The instant at x of the stretch, not beyond the last one that counts."""
    t: cython.double = course.begin + x * course.length
    return course.latest if t > course.latest else t


def set_time(programs: cython.pointer[Programs], begin: cython.double, end: cython.double) -> cython.void:
    """The time runs from begin to end."""
    programs.ranges[0] = Span(Bounds(begin, end), Bounds(1.0, 1.0), Bounds(0.0, 0.0))


def range_over(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Ranges of the time and of all variables between x0 and x1; driven ones by their own programs."""
    i: cython.Py_ssize_t
    set_time(scene.programs, instant(course, x0), instant(course, x1))
    ranges[0] = scene.programs.ranges[0]
    for i in range(1, scene.variable_count):
        if component(scene, i) == -1:
            ranges[i] = driven_span(scene, i)
        elif component(scene, i) >= 0:
            ranges[i] = Span(range_of(course.value[i], course.degree, x0, x1, course.work), anything(), anything())
    if scene.point_count:
        range_points(scene, course, ranges, x0, x1, False)


def driven_span(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> Span:
    """A driven variable over the time as it is ranged."""
    of: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
    given: Span = enclose(scene.programs, of.program)
    if scene.variables[i].is_rate:
        return Span(given.rate, given.second, anything())
    shifted: Bounds = Bounds(given.value.low + of.offset, given.value.high + of.offset)
    return Span(shifted, given.rate, given.second)


def bound_derivatives(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Ranges of the rates of the variables over a part of the stretch, and of the rates of those."""
    i: cython.Py_ssize_t
    n: cython.int = course.degree
    for i in range(1, scene.variable_count):
        if component(scene, i) >= 0:
            ranges[i] = Span(
                ranges[i].value,
                range_of(course.rate[i], n - 1, x0, x1, course.work),
                range_of(course.second[i], n - 2, x0, x1, course.work),
            )
    if scene.point_count:
        range_points(scene, course, ranges, x0, x1, True)


def stand_at(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.void:
    """The variables at x of the stretch."""
    i: cython.Py_ssize_t
    at: cython.double = instant(course, x)
    if scene.point_count:
        stand_points(scene, course, at, x)
    scene.programs.variables[0] = at
    for i in range(1, scene.variable_count):
        if component(scene, i) == -1:
            of: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
            given: Jet = jet(scene.programs, of.program, at)
            scene.programs.variables[i] = given.rate if scene.variables[i].is_rate else given.value + of.offset
        elif component(scene, i) >= 0:
            scene.programs.variables[i] = range_of(course.value[i], course.degree, x, x, course.work).low
