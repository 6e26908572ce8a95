"""A step's stages combined, and its dense output: what happens between its ends.

A method is data (integration/methods): rows of (stage, coefficient).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.attitudes import chart_slopes, leave_chart, nearing
    from heuncli.kernel.response import evaluate, settle
    from heuncli.kernel.scene import Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Method, Run

    # What a step tried comes to.
    STANDS, AGAIN_TO, TURNS_OVER, CHATTERS = range(4)
    MOST_LANDINGS = 6  # on one event: each finds its place to the square of the error of the one before


def combine(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, n: cython.int, out: cython.p_double
) -> cython.void:
    """out = sum over stages of the row's coefficients times K, as many components at a time as stay in registers.

    Where the last are fewer, earlier ones are made again beside them.
    """
    i: cython.Py_ssize_t = 0
    j: cython.Py_ssize_t
    while i < n:
        if n >= 8:
            i = i if i + 8 <= n else n - 8
            combine_eight(method, row, K, i, out)
            i += 8
        elif n >= 4:
            i = i if i + 4 <= n else n - 4
            combine_four(method, row, K, i, out)
            i += 4
        else:
            a: cython.double = 0.0
            for j in range(method.begin[row], method.begin[row + 1]):
                a += method.coefficient[j] * K[method.stage[j]][i]
            out[i] = a
            i += 1


def combine_four(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, i: cython.Py_ssize_t, out: cython.p_double
) -> cython.void:
    """Four components from i on."""
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
    out[i] = a
    out[i + 1] = b
    out[i + 2] = c
    out[i + 3] = d


def combine_eight(
    method: cython.pointer[Method], row: cython.int, K: cython.pp_double, i: cython.Py_ssize_t, out: cython.p_double
) -> cython.void:
    """Eight components from i on."""
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
    out[i] = a
    out[i + 1] = b
    out[i + 2] = c
    out[i + 3] = d
    out[i + 4] = e
    out[i + 5] = f
    out[i + 6] = g
    out[i + 7] = h


def clipped(run: cython.pointer[Run], t: cython.double) -> cython.double:
    """An instant of the piece: beyond its end other branches of the expressions hold."""
    return run.before_end if t > run.before_end else t


def evaluate_stage(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    s: cython.int,
    near: cython.bint,
) -> cython.int:
    """The derivative at stage s, in `run.stage`, which is settled first where the step comes near to a singular pose.

    Answers what `evaluate` says. What was taken in a chart of attitudes is made a state for it.
    """
    rate: cython.double
    t: cython.double = clipped(run, run.t + method.node[s] * run.h)
    if method.attitude:
        leave_chart(scene, method.attitude, run.y, run.stage)
    if near:
        settle(scene, t, run.stage)
    trouble: cython.int = evaluate(scene, t, run.stage, run.K[s])
    if method.attitude:
        enter_slopes(scene, method, run, run.stage, s)
        if not run.following:
            rate = nearing(scene, run.stage, run.chart.ways)
            if rate > run.chart.nearing:
                run.chart.nearing = rate
    return trouble


def enter_slopes(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    state: cython.p_double,
    s: cython.int,
) -> cython.void:
    """The derivative at a state, of stage s, in the chart of attitudes."""
    i: cython.Py_ssize_t
    for i in range(run.n):
        run.chart.K[s][i] = run.K[s][i]
    chart_slopes(scene, method.attitude, run.y, state, run.K[s], run.chart.K[s])


def hermite(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The first rows of the interpolating polynomial: the cubic with the values and derivatives at both ends."""
    i: cython.Py_ssize_t
    change: cython.double
    last: cython.p_double = run.chart.K[method.stages]
    first: cython.p_double = run.chart.K[0]
    y: cython.p_double = run.chart.y
    z: cython.p_double = run.chart.z
    for i in range(run.n):
        change = z[i] - y[i]
        run.dense[0][i] = change
        run.dense[1][i] = run.h * first[i] - change
        run.dense[2][i] = 2.0 * change - run.h * (last[i] + first[i])


def quintic(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The polynomial with the accelerations at both ends too, where they are known; beside the cubic two more rows.

    The cubic's second derivatives are 2 (F2 - F1) and -2 (F1 + 2 F2); x^2 (1-x)^2 has 2 at both ends, x^3 (1-x)^2 0, 2.
    """
    i: cython.Py_ssize_t
    q: cython.Py_ssize_t
    square: cython.double = run.h * run.h
    hermite(method, run)
    for i in range(run.n):
        run.dense[3][i] = run.dense[4][i] = 0.0
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            q = freedom.q_at
            first: cython.double = run.K[0][freedom.u_at]
            last: cython.double = run.K[method.stages][freedom.u_at]
            run.dense[3][q] = 0.5 * square * first + run.dense[1][q] - run.dense[2][q]
            run.dense[4][q] = 0.5 * square * last + run.dense[1][q] + 2.0 * run.dense[2][q] - run.dense[3][q]


def interpolant(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The interpolating polynomial over the step y -> z, in nested form: its rows of coefficients."""
    s: cython.int
    i: cython.Py_ssize_t
    y: cython.p_double = run.chart.y
    for s in range(method.stages + 1, method.stages + 1 + method.extra):
        combine(method, s, run.chart.K, run.n, run.stage)
        for i in range(run.n):
            run.stage[i] = y[i] + run.h * run.stage[i]
        near: cython.bint = scene.closure_count > 0 and scene.pivot_of_step < scene.limits.near_singular
        evaluate_stage(scene, method, run, s, near)
    run.evaluations += method.extra
    hermite(method, run)
    for s in range(method.dense_rows):
        combine(method, method.stages + 1 + method.extra + method.estimates + s, run.chart.K, run.n, run.dense[3 + s])
        for i in range(run.n):
            run.dense[3 + s][i] *= run.h


def through_stages(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The polynomial through the stages that were solved for, with the derivatives at both ends of the step."""
    s: cython.int
    hermite(method, run)
    for s in range(method.dense_rows):
        row: cython.int = method.stages + 1 + method.extra + method.estimates + s
        combine(method, row, run.newton.known, run.n, run.dense[3 + s])


def need_interpolant(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The interpolating polynomial of the step tried, made once."""
    if not run.has_interpolant:
        if run.determined:
            quintic(scene, method, run)
        elif method.implicit:
            through_stages(method, run)
        else:
            interpolant(scene, method, run)
        run.has_interpolant = 1


def interpolate(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    x: cython.double,
    out: cython.p_double,
) -> cython.void:
    """State at the fraction x of the step."""
    polynomial(run.dense, 0, 3 + method.dense_rows, run.chart.y, run.n, x, out)
    if method.attitude:
        leave_chart(scene, method.attitude, run.y, out)


def polynomial(
    rows: cython.pp_double,
    first: cython.Py_ssize_t,
    count: cython.int,
    y: cython.p_double,
    n: cython.Py_ssize_t,
    x: cython.double,
    out: cython.p_double,
) -> cython.void:
    """y + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + ...)))), of so many rows F of n components from the first on.

    Four components at a time, as in `combine`.
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
        out[i] = y[i] + a
        out[i + 1] = y[i + 1] + b
        out[i + 2] = y[i + 2] + c
        out[i + 3] = y[i + 3] + d
        i += 4
    while i < n:
        a = 0.0
        for k in range(count - 1, -1, -1):
            a = (a + rows[first + k][i]) * (x if k % 2 == 0 else 1.0 - x)
        out[i] = y[i] + a
        i += 1


def put_course(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """The polynomial of the step, if it has made one, is put down: of instants that are asked later, too.

    What holds in a chart of attitudes, or solves for its instants, is no state by its polynomial alone.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    span: cython.p_double = run.track.spans[run.track.done]
    count: cython.Py_ssize_t = 3 + method.dense_rows
    first: cython.Py_ssize_t = (count + 1) * run.track.done
    span[0] = run.has_interpolant and not (method.by_step or method.attitude or run.determined)
    span[1] = run.t
    span[2] = run.h
    if span[0]:
        for i in range(run.n):
            run.track.courses[first][i] = run.y[i]
            for k in range(count):
                run.track.courses[first + 1 + k][i] = run.dense[k][i]
