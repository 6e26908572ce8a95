"""The course of the coordinates that expressions depend on, over an interval of time: polynomials in Bernstein form.

    q(x) = sum_k b_k C(n, k) x^k (1 - x)^(n - k),    min b_k <= q(x) <= max b_k  for 0 <= x <= 1,

and over any part of the interval between the coefficients of that part (de Casteljau). An interval is a step with its
dense output, or a window about its end. Driven coordinates have their own programs and the bounds of those. Farouki,
Rajan, On the numerical condition of polynomials in Bernstein form (1987).
"""

from __future__ import annotations

from heuncli.kernel.bernstein import (
    PARABOLA_END,
    PARABOLA_MIDDLE,
    PARABOLA_START,
    bound_polynomial,
    convert_rows,
    differentiate,
)
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time
from heuncli.kernel.enclosure import enclose
from heuncli.kernel.intervals import all_numbers
from heuncli.kernel.jets import jet
from heuncli.kernel.points import (
    bound_point_variables,
    build_state_course,
    build_state_window,
    set_point_variables_at,
)

# Laying a course


def state_component(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> cython.int:
    """Return the index of a variable in the state; -1 if it is driven; -2 if it belongs to a point."""
    if scene.variables[i].is_point:
        return -2
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
    return freedom.u_at if scene.variables[i].is_rate else freedom.q_at


def is_still(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> cython.bint:
    """Return whether a variable is a rate that a closed contact keeps at 0."""
    variable: cython.pointer[Variable] = cython.address(scene.variables[i])
    return not variable.is_point and variable.is_rate and scene.freedoms[variable.freedom].is_held


def set_zero_course(course: cython.pointer[Course], i: cython.Py_ssize_t) -> cython.void:
    """Set a variable to 0 over the whole course."""
    k: cython.int
    for k in range(course.degree + 1):
        course.value[i][k] = 0.0
        course.rate[i][k] = 0.0
        course.second[i][k] = 0.0


def build_step_course(scene: cython.pointer[Scene], run: cython.pointer[Run], rows: cython.int) -> cython.void:
    """Set the coordinates over the trial step, in Bernstein form, from some rows of its interpolating polynomial."""
    i: cython.Py_ssize_t
    column: cython.int
    course: cython.pointer[Course] = cython.address(run.course)
    course.begin = run.t
    course.length = run.h
    course.latest = clip_time(run, run.stop)
    course.late = run.late
    course.finest = scene.limits.finest
    course.degree = rows
    if scene.point_count:
        build_state_course(run, rows)
    for i in range(1, scene.variable_count):
        column = state_component(scene, i)
        if is_still(scene, i):
            set_zero_course(course, i)
        elif column >= 0:
            convert_rows(run.y[column], run.dense, rows, column, course.value[i])
            differentiate(course.value[i], course.rate[i], rows, run.h)
            differentiate(course.rate[i], course.second[i], rows - 1, run.h)


def build_end_window(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Set the coordinates about the end of the trial step as parabolas, from their derivatives there."""
    i: cython.Py_ssize_t
    column: cython.int
    a: cython.double
    u: cython.double
    half: cython.double = scene.limits.window * run.h
    course: cython.pointer[Course] = cython.address(run.course)
    last: cython.p_double = run.K[method.stages]
    course.begin = run.stop - half
    course.length = 2.0 * half
    course.latest = run.before_end
    course.late = run.late
    course.finest = scene.limits.window * scene.limits.window * scene.limits.window  # relative to the step: rounding
    course.degree = 2
    if scene.point_count:
        build_state_window(scene, method, run, half)
    for i in range(1, scene.variable_count):
        column = state_component(scene, i)
        if is_still(scene, i):
            set_zero_course(course, i)
            continue
        if column < 0:
            continue
        u = last[column]
        a = 0.0 if scene.variables[i].is_rate else last[scene.freedoms[scene.variables[i].freedom].u_at]
        b: cython.p_double = course.value[i]
        # through z at the middle, with u and a there
        b[PARABOLA_START] = run.z[column] - u * half + 0.5 * a * half * half
        b[PARABOLA_MIDDLE] = run.z[column] - 0.5 * a * half * half
        b[PARABOLA_END] = run.z[column] + u * half + 0.5 * a * half * half
        differentiate(b, course.rate[i], 2, course.length)
        differentiate(course.rate[i], course.second[i], 1, course.length)


# Looking along it


def course_instant(course: cython.pointer[Course], x: cython.double) -> cython.double:
    """Return the instant at x of the interval, not after the last one that counts."""
    t: cython.double = course.begin + x * course.length
    return course.latest if t > course.latest else t


def set_time_range(programs: cython.pointer[Programs], begin: cython.double, end: cython.double) -> cython.void:
    """Set the range of the time from begin to end."""
    programs.ranges[0] = Span(Bounds(begin, end), Bounds(1.0, 1.0), Bounds(0.0, 0.0))


def bound_variables(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Bound the time and all variables between x0 and x1; driven ones by their own programs."""
    i: cython.Py_ssize_t
    set_time_range(scene.programs, course_instant(course, x0), course_instant(course, x1))
    ranges[0] = scene.programs.ranges[0]
    for i in range(1, scene.variable_count):
        if state_component(scene, i) == -1:
            ranges[i] = bound_driven_variable(scene, i)
        elif state_component(scene, i) >= 0:
            ranges[i] = Span(
                bound_polynomial(course.value[i], course.degree, x0, x1, course.work), all_numbers(), all_numbers()
            )
    if scene.point_count:
        bound_point_variables(scene, course, ranges, x0, x1, False)


def bound_driven_variable(scene: cython.pointer[Scene], i: cython.Py_ssize_t) -> Span:
    """Bound a driven variable over the present range of the time."""
    freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
    drive: Span = enclose(scene.programs, freedom.program)
    if scene.variables[i].is_rate:
        return Span(drive.rate, drive.second, all_numbers())
    return Span(drive.value, drive.rate, drive.second)


def bound_derivatives(
    scene: cython.pointer[Scene],
    course: cython.pointer[Course],
    ranges: cython.pointer[Span],
    x0: cython.double,
    x1: cython.double,
) -> cython.void:
    """Bound the rates of the variables over a part of the interval, and the rates of those."""
    i: cython.Py_ssize_t
    n: cython.int = course.degree
    for i in range(1, scene.variable_count):
        if state_component(scene, i) >= 0:
            ranges[i] = Span(
                ranges[i].value,
                bound_polynomial(course.rate[i], n - 1, x0, x1, course.work),
                bound_polynomial(course.second[i], n - 2, x0, x1, course.work),
            )
    if scene.point_count:
        bound_point_variables(scene, course, ranges, x0, x1, True)


def set_variables(scene: cython.pointer[Scene], course: cython.pointer[Course], x: cython.double) -> cython.void:
    """Set the variables to their values at x of the interval."""
    i: cython.Py_ssize_t
    time: cython.double = course_instant(course, x)
    if scene.point_count:
        set_point_variables_at(scene, course, time, x)
    scene.programs.variables[0] = time
    for i in range(1, scene.variable_count):
        if state_component(scene, i) == -1:
            freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[scene.variables[i].freedom])
            drive: Jet = jet(scene.programs, freedom.program, time)
            scene.programs.variables[i] = drive.rate if scene.variables[i].is_rate else drive.value
        elif state_component(scene, i) >= 0:
            scene.programs.variables[i] = bound_polynomial(course.value[i], course.degree, x, x, course.work).low
