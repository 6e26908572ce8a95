"""Combine the stages of a step, and evaluate its dense output: the state between its ends.

A method is data (integration/methods): rows of (stage, coefficient).
"""

from __future__ import annotations

from heuncli.kernel.attitudes import chart_slopes, half_turn_rate, leave_chart
from heuncli.kernel.declarations import *
from heuncli.kernel.response import evaluate, project_state

# Rows of the interpolating polynomial: the cubic, and what accelerations at both ends add to it.
CHANGE, START_SLOPE, END_SLOPE, START_BEND, END_BEND = range(5)
HERMITE_ROWS = 3  # those of the cubic, which every method has


def combine_stages(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, n: cython.int, result: cython.p_double
) -> cython.void:
    """Sum the stages times the row's coefficients: result = sum over stages of coefficient times K.

    As many components at a time as fit into registers; if the last ones are fewer, some earlier ones are computed again
    with them.
    """
    i: cython.Py_ssize_t = 0
    j: cython.Py_ssize_t
    while i < n:
        if n >= 8:
            i = i if i + 8 <= n else n - 8
            combine_eight_components(method, row, K, i, result)
            i += 8
        elif n >= 4:
            i = i if i + 4 <= n else n - 4
            combine_four_components(method, row, K, i, result)
            i += 4
        else:
            a: cython.double = 0.0
            for j in range(method.begin[row], method.begin[row + 1]):
                a += method.coefficient[j] * K[method.stage[j]][i]
            result[i] = a
            i += 1


def combine_four_components(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, i: cython.Py_ssize_t, result: cython.p_double
) -> cython.void:
    """Combine four components from i on."""
    j: cython.Py_ssize_t
    a: cython.double = 0.0
    b: cython.double = 0.0
    c: cython.double = 0.0
    d: cython.double = 0.0
    for j in range(method.begin[row], method.begin[row + 1]):
        factor: cython.double = method.coefficient[j]
        k: cython.p_double = K[method.stage[j]]
        a += factor * k[i]
        b += factor * k[i + 1]
        c += factor * k[i + 2]
        d += factor * k[i + 3]
    result[i] = a
    result[i + 1] = b
    result[i + 2] = c
    result[i + 3] = d


def combine_eight_components(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, i: cython.Py_ssize_t, result: cython.p_double
) -> cython.void:
    """Combine eight components from i on."""
    j: cython.Py_ssize_t
    a: cython.double = 0.0
    b: cython.double = 0.0
    c: cython.double = 0.0
    d: cython.double = 0.0
    e: cython.double = 0.0
    f: cython.double = 0.0
    g: cython.double = 0.0
    h: cython.double = 0.0
    for j in range(method.begin[row], method.begin[row + 1]):
        factor: cython.double = method.coefficient[j]
        k: cython.p_double = K[method.stage[j]]
        a += factor * k[i]
        b += factor * k[i + 1]
        c += factor * k[i + 2]
        d += factor * k[i + 3]
        e += factor * k[i + 4]
        f += factor * k[i + 5]
        g += factor * k[i + 6]
        h += factor * k[i + 7]
    result[i] = a
    result[i + 1] = b
    result[i + 2] = c
    result[i + 3] = d
    result[i + 4] = e
    result[i + 5] = f
    result[i + 6] = g
    result[i + 7] = h


def clip_time(run: cython.pointer[Run], t: cython.double) -> cython.double:
    """Limit an instant to the piece: after its end other branches of the expressions hold."""
    return run.before_end if t > run.before_end else t


def evaluate_stage(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    s: cython.int,
    is_near_singular: cython.bint,
) -> cython.int:
    """Find the derivative at stage s, in `run.stage`, which is projected first if the step comes near a singular pose.

    Returns what `evaluate` returns. A stage in a chart of attitudes is converted to a state first.
    """
    rate: cython.double
    t: cython.double = clip_time(run, run.t + method.node[s] * run.h)
    if method.attitude:
        leave_chart(scene, method.attitude, run.y, run.stage)
    if is_near_singular:
        project_state(scene, t, run.stage)
    trouble: cython.int = evaluate(scene, t, run.stage, run.K[s])
    if method.attitude:
        store_chart_slopes(scene, method, run, run.stage, s)
        if not run.following:
            rate = half_turn_rate(scene, run.stage, run.chart.angles_left)
            if rate > run.chart.approach_rate:
                run.chart.approach_rate = rate
    return trouble


def store_chart_slopes(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    state: cython.p_double,
    s: cython.int,
) -> cython.void:
    """Store the derivative at a state, of stage s, in the chart of attitudes."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.chart.K[s][i] = run.K[s][i]
    chart_slopes(scene, method.attitude, run.y, state, run.K[s], run.chart.K[s])


def build_hermite(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Build the first rows of the interpolating polynomial: the cubic with the values and derivatives at both ends."""
    i: cython.Py_ssize_t
    change: cython.double
    last: cython.p_double = run.chart.K[method.stages]
    first: cython.p_double = run.chart.K[0]
    y: cython.p_double = run.chart.y
    z: cython.p_double = run.chart.z
    for i in range(run.n):
        change = z[i] - y[i]
        run.dense[CHANGE][i] = change
        run.dense[START_SLOPE][i] = run.h * first[i] - change
        run.dense[END_SLOPE][i] = 2.0 * change - run.h * (last[i] + first[i])


def build_quintic(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Build the polynomial that also has the accelerations at both ends, where they are known: two more rows than the
    cubic.

    The cubic's second derivatives are 2 (F2 - F1) and -2 (F1 + 2 F2); x^2 (1-x)^2 has 2 at both ends, x^3 (1-x)^2 0, 2.
    """
    i: cython.Py_ssize_t
    q: cython.Py_ssize_t
    square: cython.double = run.h * run.h
    build_hermite(method, run)
    for i in range(run.n):
        run.dense[START_BEND][i] = run.dense[END_BEND][i] = 0.0
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            q = freedom.q_at
            first: cython.double = run.K[0][freedom.u_at]
            last: cython.double = run.K[method.stages][freedom.u_at]
            run.dense[START_BEND][q] = 0.5 * square * first + run.dense[START_SLOPE][q] - run.dense[END_SLOPE][q]
            run.dense[END_BEND][q] = (
                0.5 * square * last
                + run.dense[START_SLOPE][q]
                + 2.0 * run.dense[END_SLOPE][q]
                - run.dense[START_BEND][q]
            )


def build_explicit_interpolant(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Build the interpolating polynomial over the step y -> z of an explicit method, in nested form: its rows of
    coefficients.
    """
    s: cython.int
    i: cython.Py_ssize_t
    y: cython.p_double = run.chart.y
    for s in range(method.stages + 1, method.stages + 1 + method.extra):
        combine_stages(method, s, run.chart.K, run.n, run.stage)
        for i in range(run.n):
            run.stage[i] = y[i] + run.h * run.stage[i]
        is_near_singular: cython.bint = scene.closure_count > 0 and scene.pivot_of_step < scene.limits.near_singular
        evaluate_stage(scene, method, run, s, is_near_singular)
    run.evaluations += method.extra
    build_hermite(method, run)
    for s in range(method.dense_rows):
        combine_stages(
            method,
            method.stages + 1 + method.extra + method.estimates + s,
            run.chart.K,
            run.n,
            run.dense[HERMITE_ROWS + s],
        )
        for i in range(run.n):
            run.dense[HERMITE_ROWS + s][i] *= run.h


def build_collocation_interpolant(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Build the polynomial through the stages that were solved for, with the derivatives at both ends of the step."""
    s: cython.int
    build_hermite(method, run)
    for s in range(method.dense_rows):
        row: cython.int = method.stages + 1 + method.extra + method.estimates + s
        combine_stages(method, row, run.newton.polynomial_rows, run.n, run.dense[HERMITE_ROWS + s])


def ensure_interpolant(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Build the interpolating polynomial of the trial step unless it exists."""
    if not run.has_interpolant:
        if run.determined:
            build_quintic(scene, method, run)
        elif method.implicit:
            build_collocation_interpolant(method, run)
        else:
            build_explicit_interpolant(scene, method, run)
        run.has_interpolant = 1


def interpolate(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x: cython.double,
    result: cython.p_double,
) -> cython.void:
    """Find the state at the fraction x of the step."""
    evaluate_polynomial(run.dense, 0, HERMITE_ROWS + method.dense_rows, run.chart.y, run.n, x, result)
    if method.attitude:
        leave_chart(scene, method.attitude, run.y, result)


def evaluate_polynomial(
    rows: cython.pp_double,
    first: cython.Py_ssize_t,
    count: cython.int,
    y: cython.p_double,
    n: cython.Py_ssize_t,
    x: cython.double,
    result: cython.p_double,
) -> cython.void:
    """Evaluate y + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + ...)))), with `count` rows F of n components from the
    first on.

    Four components at a time, as in `combine_stages`.
    """
    i: cython.Py_ssize_t = 0
    k: cython.int
    while i < n and n >= 4:
        i = i if i + 4 <= n else n - 4
        a: cython.double = 0.0
        b: cython.double = 0.0
        c: cython.double = 0.0
        d: cython.double = 0.0
        for k in range(count - 1, -1, -1):
            factor: cython.double = x if k % 2 == 0 else 1.0 - x
            row: cython.p_double = rows[first + k]
            a = (a + row[i]) * factor
            b = (b + row[i + 1]) * factor
            c = (c + row[i + 2]) * factor
            d = (d + row[i + 3]) * factor
        result[i] = y[i] + a
        result[i + 1] = y[i + 1] + b
        result[i + 2] = y[i + 2] + c
        result[i + 3] = y[i + 3] + d
        i += 4
    while i < n:
        a = 0.0
        for k in range(count - 1, -1, -1):
            a = (a + rows[first + k][i]) * (x if k % 2 == 0 else 1.0 - x)
        result[i] = y[i] + a
        i += 1


def record_course(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Record the polynomial of the step, if it has one, for instants that are requested later.

    The polynomial alone is no state if the step was taken in a chart of attitudes, or if its instants must be solved
    for.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    span: cython.p_double = run.track.spans[run.track.step_count]
    count: cython.Py_ssize_t = HERMITE_ROWS + method.dense_rows
    first: cython.Py_ssize_t = (count + 1) * run.track.step_count
    span[HAS_COURSE] = run.has_interpolant and not (method.by_step or method.attitude or run.determined)
    span[STEP_START] = run.t
    span[STEP_LENGTH] = run.h
    if span[HAS_COURSE]:
        for i in range(run.n):
            run.track.courses[first][i] = run.y[i]
            for k in range(count):
                run.track.courses[first + 1 + k][i] = run.dense[k][i]
