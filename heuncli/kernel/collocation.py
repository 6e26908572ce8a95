"""A step by collocation: the polynomial that satisfies the equations at the step's nodes (implicit Runge-Kutta
methods).

    Z_i = h sum_j a_ij f(t + c_j h, y + Z_j),      z = y + sum_i d_i Z_i
    A^-1 = T L T^-1,  Z = T W:                     (L - h J) dW = h T^-1 F - L W

Newton's iteration uses the tangent J of the step's start. L is a real number and pairs a + ib, each of which is one
complex equation. The iteration ends, judged by its own contraction, where only rounding is left; it begins with the
solution of the linear equations. So a step depends on its start and its length only, and is the same to the last bit
when it is repeated. The error is that of an embedded formula with the derivative at the start, (g - h J)^-1 (h f_0 +
sum_i e_i Z_i), g the real number of L: the filter keeps stiff parts of it bounded. Hairer, Wanner, Solving ODEs II
(1996), IV.8.
"""

from __future__ import annotations

from math import fabs, pow

from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time
from heuncli.kernel.landing import begin_step_extremes, record_stage
from heuncli.kernel.linear import factor_complex, factor_real, solve_complex, solve_real
from heuncli.kernel.response import evaluate, project_state
from heuncli.kernel.tangent import find_jacobian

MAX_NEWTON_ITERATIONS = 25
NO_SCALE = 1e300  # size of a correction of rates where there is no rate to compare it with


# A step


def collocate(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """Compute the stages of a step and its solution z with its small parts. Returns what `evaluate` returns at the end.

    Sets newton.has_stages to 0 if Newton's iteration does not converge.
    """
    i: cython.Py_ssize_t
    change: cython.double
    formula: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    run.has_interpolant = 0
    newton.is_evaluated_elsewhere = 0
    run.evaluations += run.n + 1
    newton.has_stages = factor_step(scene, formula, run) and solve_stages(scene, method, run)
    for i in range(run.n):
        change = sum_stages(formula, run, i)
        run.z[i] = run.y[i] + change
        run.z_carry[i] = change - (run.z[i] - run.y[i])
    trouble: cython.int = evaluate(scene, clip_time(run, run.stop), run.z, run.K[method.stages])
    run.evaluations += 1
    if run.sees_stages:
        record_stage(scene, run, clip_time(run, run.stop))
    return trouble


def collocate_to(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    t: cython.double,
    result: cython.p_double,
) -> cython.void:
    """Compute the state at an instant within the present step, by a step of its own from the same start.

    If the longer step could be solved, the shorter one can; if not after all, newton.solved is set to 0.
    """
    i: cython.Py_ssize_t
    h: cython.double = run.h
    K: cython.pp_double = run.K
    formula: cython.pointer[Collocation] = cython.address(method.collocation)
    for i in range(run.n):
        run.side_stages[0][i] = K[0][i]
    run.h = t - run.t
    run.K = run.side_stages
    run.evaluations += run.n + 1
    if not (factor_step(scene, formula, run) and solve_stages(scene, method, run)):
        run.newton.has_stages = 0
    for i in range(run.n):
        result[i] = run.y[i] + sum_stages(formula, run, i)
    run.h = h
    run.K = K


def sum_stages(formula: cython.pointer[Collocation], run: cython.pointer[Run], i: cython.Py_ssize_t) -> cython.double:
    """Return sum_k d_k Z_k of one number of the state plus its compensation; d of Radau's methods is 0, ..., 1."""
    k: cython.Py_ssize_t
    change: cython.double = run.carry[i]
    for k in range(formula.stages):
        if formula.end[k] != 0.0:
            change += formula.end[k] * run.newton.Z[k][i]
    return change


def factor_step(
    scene: cython.pointer[Scene], formula: cython.pointer[Collocation], run: cython.pointer[Run]
) -> cython.bint:
    """Find the tangent at the start and factor L - h J. Returns whether it could be factored."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = run.n
    newton: cython.pointer[Newton] = cython.address(run.newton)
    J: cython.p_double = newton.tangent.J
    find_jacobian(scene, clip_time(run, run.t), run.y, cython.address(newton.tangent))
    for k in range(formula.pair_count):
        pair: cython.pointer[Factors] = cython.address(newton.pairs[k])
        for i in range(n * n):
            pair.A[i] = -run.h * J[i]
            pair.B[i] = 0.0
        for i in range(n):
            pair.A[n * i + i] += formula.parts[2 * k]
            pair.B[n * i + i] = formula.parts[2 * k + 1]
        if not factor_complex(pair.A, pair.B, run.n, pair.pivots):
            return False
    if formula.real > 0.0:
        for i in range(n * n):
            newton.real.A[i] = -run.h * J[i]
        for i in range(n):
            newton.real.A[n * i + i] += formula.real
        return factor_real(newton.real.A, run.n, newton.real.pivots)
    return True


# Newton's iteration


def solve_stages(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.bint:
    """Solve for Z and W and the derivatives at the stages. Returns False if the iteration does not contract.

    It ends where its next correction would be rounding, or where corrections do not become smaller any more.
    """
    k: cython.int
    size: cython.double
    previous_size: cython.double = 0.0
    best: cython.double = 1.0
    ratio: cython.double
    begin_stages(method, run)
    for k in range(MAX_NEWTON_ITERATIONS):
        evaluate_stages(scene, method, run)
        size = correct_stages(method, run)
        if size == 0.0 or size != size:
            return size == 0.0
        ratio = size / previous_size if previous_size > 0.0 else 0.5
        previous_size = size
        if k == 0:
            continue
        if ratio < best:
            best = ratio
        if size * ratio <= (1.0 - ratio) * scene.limits.newton_ends:
            return True
        if size <= scene.limits.newton_rounding and ratio > scene.limits.newton_stalls * best:
            return True  # it contracted before: this is noise
        if ratio >= 1.0 and (k > 2 or ratio > scene.limits.newton_diverges):
            return is_noise(scene, method, run, size)
        if k > 2 and ratio < 1.0 and size * pow(ratio, MAX_NEWTON_ITERATIONS - k) > scene.limits.newton_noise:
            return False
    return False


def is_noise(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], size: cython.double
) -> cython.bint:
    """Return whether corrections that do not become smaller any more are so small that they may be rounding."""
    if size <= scene.limits.newton_noise and (run.following or method.fixed):
        return True
    if method.fixed:
        return False  # there is no tolerance to be a part of
    return size <= scene.limits.newton_part * run.control.tolerance or size <= scene.limits.newton_rounding


def begin_stages(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Start W and Z with the solution of the linear equations at the start, and find the sizes that corrections are
    compared with.
    """
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    row_sum: cython.double
    formula: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for k in range(formula.stages):
        row_sum = 0.0
        for j in range(formula.stages):
            row_sum += formula.T_inverse[formula.stages * k + j]
        for i in range(run.n):
            newton.W[k][i] = 0.0
            newton.step[k][i] = run.h * row_sum * run.K[0][i]
    solve_blocks(formula, run)
    add_correction(formula, run)
    newton.rate = newton.reach = 0.0
    update_reference_sizes(run, run.y)
    for k in range(formula.stages):
        update_reference_sizes(run, newton.Z[k])
    if newton.reach < 1.0:
        newton.reach = 1.0


def update_reference_sizes(run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """Update the largest coordinate and the largest rate, with which corrections are compared."""
    b: cython.int
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for b in range(run.group_count):
        if b != run.energy_group:
            group: cython.pointer[Group] = cython.address(run.groups[b])
            newton.reach = find_largest_weighted(run, x, group.coordinates, group.rates, newton.reach)
            newton.rate = find_largest_weighted(run, x, group.rates, group.end, newton.rate)


def find_largest_weighted(
    run: cython.pointer[Run], x: cython.p_double, begin: cython.int, end: cython.int, largest: cython.double
) -> cython.double:
    """Return the largest weighted magnitude of some components, or `largest`; NaN counts as largest."""
    i: cython.Py_ssize_t
    for i in range(begin, end):
        if largest == largest and not fabs(x[i] * run.weights[i]) <= largest:
            largest = fabs(x[i] * run.weights[i])
    return largest


def evaluate_stages(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """Evaluate the derivatives at y + Z; watched values are recorded at these stages."""
    i: cython.Py_ssize_t
    k: cython.int
    t: cython.double
    newton: cython.pointer[Newton] = cython.address(run.newton)
    if run.sees_stages:
        begin_step_extremes(scene, run)
    for k in range(1, method.stages):
        for i in range(run.n):
            run.stage[i] = run.y[i] + newton.Z[k - 1][i]
        t = clip_time(run, run.t + method.node[k] * run.h)
        if run.projects_stages:
            project_state(scene, t, run.stage)
        evaluate(scene, t, run.stage, run.K[k])
        if run.sees_stages:
            record_stage(scene, run, t)
    run.evaluations += method.stages - 1


def correct_stages(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.double:
    """Correct W and Z once and return the size of the correction."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    a: cython.double
    b: cython.double
    u: cython.double
    formula: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    first: cython.int = 1 if formula.real > 0.0 else 0
    for k in range(formula.stages):
        for i in range(run.n):
            u = 0.0
            for j in range(formula.stages):
                u += formula.T_inverse[formula.stages * k + j] * run.K[j + 1][i]
            newton.step[k][i] = run.h * u
    if first:
        for i in range(run.n):
            newton.step[0][i] -= formula.real * newton.W[0][i]
    for k in range(formula.pair_count):
        a = formula.parts[2 * k]
        b = formula.parts[2 * k + 1]
        j = first + 2 * k
        for i in range(run.n):
            newton.step[j][i] -= a * newton.W[j][i] - b * newton.W[j + 1][i]
            newton.step[j + 1][i] -= b * newton.W[j][i] + a * newton.W[j + 1][i]
    solve_blocks(formula, run)
    add_correction(formula, run)
    return size_of_correction(formula, run)


def solve_blocks(formula: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.void:
    """Replace newton.step by (L - h J)^-1 newton.step."""
    k: cython.int
    newton: cython.pointer[Newton] = cython.address(run.newton)
    first: cython.int = 1 if formula.real > 0.0 else 0
    if first:
        solve_real(newton.real.A, run.n, newton.real.pivots, newton.step[0])
    for k in range(formula.pair_count):
        pair: cython.pointer[Factors] = cython.address(newton.pairs[k])
        solve_complex(pair.A, pair.B, run.n, pair.pivots, newton.step[first + 2 * k], newton.step[first + 2 * k + 1])


def add_correction(formula: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.void:
    """W <- W + dW, Z = T W."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    u: cython.double
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for k in range(formula.stages):
        for i in range(run.n):
            newton.W[k][i] += newton.step[k][i]
    for k in range(formula.stages):
        for i in range(run.n):
            u = 0.0
            for j in range(formula.stages):
                u += formula.T[formula.stages * k + j] * newton.W[j][i]
            newton.Z[k][i] = u


def size_of_correction(formula: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.double:
    """Return the size of a correction, relative to the largest coordinate and the largest rate."""
    b: cython.int
    k: cython.Py_ssize_t
    rate_part: cython.double = 0.0
    newton: cython.pointer[Newton] = cython.address(run.newton)
    coordinate_part: cython.double = 0.0
    for k in range(formula.stages):
        for b in range(run.group_count):
            if b != run.energy_group:
                group: cython.pointer[Group] = cython.address(run.groups[b])
                coordinate_part = find_largest_weighted(
                    run, newton.step[k], group.coordinates, group.rates, coordinate_part
                )
                rate_part = find_largest_weighted(run, newton.step[k], group.rates, group.end, rate_part)
    if rate_part > 0.0 or rate_part != rate_part:
        rate_part = rate_part / newton.rate if newton.rate > 0.0 else NO_SCALE
    coordinate_part = coordinate_part / newton.reach
    return coordinate_part if coordinate_part > rate_part else rate_part


# Its error


def estimate_error(
    method: cython.pointer[Method], run: cython.pointer[Run], derivative: cython.p_double
) -> cython.void:
    """Write the error of the step, divided by its length, to run.fine; derivative: f at the start."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    u: cython.double
    formula: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for i in range(run.n):
        u = run.h * derivative[i]
        for k in range(formula.stages):
            u += formula.error[k] * newton.Z[k][i]
        newton.error[i] = u
    solve_real(newton.real.A, run.n, newton.real.pivots, newton.error)
    for i in range(run.n):
        run.fine[i] = newton.error[i] / run.h


def refine_error(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Filter the error a second time: once is not enough for a stiff part if the start is off its slow motion."""
    i: cython.Py_ssize_t
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for i in range(run.n):
        run.stage[i] = run.y[i] + newton.error[i]
    evaluate(scene, clip_time(run, run.t), run.stage, newton.tangent.change)
    run.evaluations += 1
    newton.is_evaluated_elsewhere = 1
    estimate_error(method, run, newton.tangent.change)
