"""A step by collocation: the polynomial that meets the equations at the step's nodes (implicit Runge-Kutta methods).

    Z_i = h sum_j a_ij f(t + c_j h, y + Z_j),      z = y + sum_i d_i Z_i
    A^-1 = T L T^-1,  Z = T W:                     (L - h J) dW = h T^-1 F - L W
Newton's iteration with the tangent J of the step's start: L is a real number, and pairs a + ib that are one complex
equation each. It ends where what is left is rounding, by its own contraction, and begins with what the linear equations
would give: a step hangs on its start and its length alone, and is the same to the last bit when it is done again.
The error is that of an embedded formula with the derivative at the start, (g - h J)^-1 (h f_0 + sum_i e_i Z_i), g the
real number of L: the filter keeps stiff parts of it bounded. Hairer, Wanner, Solving ODEs II (1996), IV.8.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, pow

    from heuncli.kernel.dense import clipped
    from heuncli.kernel.jacobian import find_jacobian
    from heuncli.kernel.landing import begin_to_see, see_stage
    from heuncli.kernel.linear import factor_complex, factor_real, solve_complex, solve_real
    from heuncli.kernel.response import evaluate, settle
    from heuncli.kernel.scene import Group, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Collocation, Factors, Method, Newton, Run

    MOST_ITERATIONS = 25


# A step


def collocate(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The stages of a step and its solution z, with its small parts beside it; what `evaluate` says there.

    Where Newton's iteration finds none, newton.solved is 0.
    """
    i: cython.Py_ssize_t
    change: cython.double
    of: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    run.has_interpolant = 0
    newton.elsewhere = 0
    run.evaluations += run.n + 1
    newton.solved = factor_step(scene, of, run) and solve_stages(scene, method, run)
    for i in range(run.n):
        change = change_of(of, run, i)
        run.z[i] = run.y[i] + change
        run.z_carry[i] = change - (run.z[i] - run.y[i])
    trouble: cython.int = evaluate(scene, clipped(run, run.stop), run.z, run.K[method.stages])
    run.evaluations += 1
    if run.seeing:
        see_stage(scene, run, clipped(run, run.stop))
    return trouble


def collocate_to(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    t: cython.double,
    out: cython.p_double,
) -> cython.void:
    """The state at an instant within the step under way, by a step of its own from the same start.

    What was solved for a longer step is for a shorter one; where it is not after all, newton.solved says so.
    """
    i: cython.Py_ssize_t
    h: cython.double = run.h
    K: cython.pp_double = run.K
    of: cython.pointer[Collocation] = cython.address(method.collocation)
    for i in range(run.n):
        run.beside[0][i] = K[0][i]
    run.h = t - run.t
    run.K = run.beside
    run.evaluations += run.n + 1
    if not (factor_step(scene, of, run) and solve_stages(scene, method, run)):
        run.newton.solved = 0
    for i in range(run.n):
        out[i] = run.y[i] + change_of(of, run, i)
    run.h = h
    run.K = K


def change_of(of: cython.pointer[Collocation], run: cython.pointer[Run], i: cython.Py_ssize_t) -> cython.double:
    """sum_k d_k Z_k of a number of the state, with what its digits did not hold; d of Radau's methods is 0, ..., 1."""
    k: cython.Py_ssize_t
    change: cython.double = run.carry[i]
    for k in range(of.stages):
        if of.end[k] != 0.0:
            change += of.end[k] * run.newton.Z[k][i]
    return change


def factor_step(scene: cython.pointer[Scene], of: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.bint:
    """The tangent at the start, and the factors of L - h J; False where there are none."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    n: cython.Py_ssize_t = run.n
    newton: cython.pointer[Newton] = cython.address(run.newton)
    J: cython.p_double = newton.tangent.J
    find_jacobian(scene, clipped(run, run.t), run.y, cython.address(newton.tangent))
    for k in range(of.pair_count):
        pair: cython.pointer[Factors] = cython.address(newton.pairs[k])
        for i in range(n * n):
            pair.A[i] = -run.h * J[i]
            pair.B[i] = 0.0
        for i in range(n):
            pair.A[n * i + i] += of.parts[2 * k]
            pair.B[n * i + i] = of.parts[2 * k + 1]
        if not factor_complex(pair.A, pair.B, run.n, pair.pivots):
            return False
    if of.real > 0.0:
        for i in range(n * n):
            newton.real.A[i] = -run.h * J[i]
        for i in range(n):
            newton.real.A[n * i + i] += of.real
        return factor_real(newton.real.A, run.n, newton.real.pivots)
    return True


# Newton's iteration


def solve_stages(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.bint:
    """Z and W, and the derivatives at the stages; False where the iteration does not contract.

    It ends where its next correction would be rounding, or where corrections do not become smaller any more.
    """
    k: cython.int
    size: cython.double
    before: cython.double = 0.0
    best: cython.double = 1.0
    ratio: cython.double
    begin_stages(method, run)
    for k in range(MOST_ITERATIONS):
        evaluate_stages(scene, method, run)
        size = correct(method, run)
        if size == 0.0 or size != size:
            return size == 0.0
        ratio = size / before if before > 0.0 else 0.5
        before = size
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
        if k > 2 and ratio < 1.0 and size * pow(ratio, MOST_ITERATIONS - k) > scene.limits.newton_noise:
            return False
    return False


def is_noise(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run], size: cython.double
) -> cython.bint:
    """Whether corrections that do not become smaller any more are so small that they may be rounding."""
    if size <= scene.limits.newton_noise and (run.following or method.fixed):
        return True
    if method.fixed:
        return False  # there is no tolerance to be a part of
    return size <= scene.limits.newton_part * run.control.tolerance or size <= scene.limits.newton_rounding


def begin_stages(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """W and Z as equations with the tangent of the start and nothing else give them; the sizes to measure by."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    sum: cython.double
    of: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for k in range(of.stages):
        sum = 0.0
        for j in range(of.stages):
            sum += of.into[of.stages * k + j]
        for i in range(run.n):
            newton.W[k][i] = 0.0
            newton.step[k][i] = run.h * sum * run.K[0][i]
    solve_blocks(of, run)
    add_step(of, run)
    newton.rate = newton.reach = 0.0
    measure_by(run, run.y)
    for k in range(of.stages):
        measure_by(run, newton.Z[k])
    if newton.reach < 1.0:
        newton.reach = 1.0


def measure_by(run: cython.pointer[Run], x: cython.p_double) -> cython.void:
    """Corrections are measured by the largest coordinate and the largest rate."""
    b: cython.int
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for b in range(run.group_count):
        if b != run.energy_group:
            group: cython.pointer[Group] = cython.address(run.groups[b])
            newton.reach = find_largest_by_weight(run, x, group.coordinates, group.rates, newton.reach)
            newton.rate = find_largest_by_weight(run, x, group.rates, group.end, newton.rate)


def find_largest_by_weight(
    run: cython.pointer[Run], x: cython.p_double, begin: cython.int, end: cython.int, found: cython.double
) -> cython.double:
    """The largest of some components by their weights, or what is given; what is no number counts."""
    i: cython.Py_ssize_t
    for i in range(begin, end):
        if found == found and not fabs(x[i] * run.weights[i]) <= found:
            found = fabs(x[i] * run.weights[i])
    return found


def evaluate_stages(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The derivatives at y + Z; what is seen of the step is seen at these stages."""
    i: cython.Py_ssize_t
    k: cython.int
    t: cython.double
    newton: cython.pointer[Newton] = cython.address(run.newton)
    if run.seeing:
        begin_to_see(scene, run)
    for k in range(1, method.stages):
        for i in range(run.n):
            run.stage[i] = run.y[i] + newton.Z[k - 1][i]
        t = clipped(run, run.t + method.node[k] * run.h)
        if run.near:
            settle(scene, t, run.stage)
        evaluate(scene, t, run.stage, run.K[k])
        if run.seeing:
            see_stage(scene, run, t)
    run.evaluations += method.stages - 1


def correct(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.double:
    """One correction of W and Z; its size."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    a: cython.double
    b: cython.double
    u: cython.double
    of: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    first: cython.int = 1 if of.real > 0.0 else 0
    for k in range(of.stages):
        for i in range(run.n):
            u = 0.0
            for j in range(of.stages):
                u += of.into[of.stages * k + j] * run.K[j + 1][i]
            newton.step[k][i] = run.h * u
    if first:
        for i in range(run.n):
            newton.step[0][i] -= of.real * newton.W[0][i]
    for k in range(of.pair_count):
        a = of.parts[2 * k]
        b = of.parts[2 * k + 1]
        j = first + 2 * k
        for i in range(run.n):
            newton.step[j][i] -= a * newton.W[j][i] - b * newton.W[j + 1][i]
            newton.step[j + 1][i] -= b * newton.W[j][i] + a * newton.W[j + 1][i]
    solve_blocks(of, run)
    add_step(of, run)
    return size_of_step(of, run)


def solve_blocks(of: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.void:
    """What stands in newton.step <- (L - h J)^-1 of it."""
    k: cython.int
    newton: cython.pointer[Newton] = cython.address(run.newton)
    first: cython.int = 1 if of.real > 0.0 else 0
    if first:
        solve_real(newton.real.A, run.n, newton.real.pivots, newton.step[0])
    for k in range(of.pair_count):
        pair: cython.pointer[Factors] = cython.address(newton.pairs[k])
        solve_complex(pair.A, pair.B, run.n, pair.pivots, newton.step[first + 2 * k], newton.step[first + 2 * k + 1])


def add_step(of: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.void:
    """W <- W + dW, Z = T W."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    j: cython.Py_ssize_t
    u: cython.double
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for k in range(of.stages):
        for i in range(run.n):
            newton.W[k][i] += newton.step[k][i]
    for k in range(of.stages):
        for i in range(run.n):
            u = 0.0
            for j in range(of.stages):
                u += of.back[of.stages * k + j] * newton.W[j][i]
            newton.Z[k][i] = u


def size_of_step(of: cython.pointer[Collocation], run: cython.pointer[Run]) -> cython.double:
    """The largest part of a correction, of the largest coordinate and the largest rate."""
    b: cython.int
    k: cython.Py_ssize_t
    found: cython.double = 0.0
    newton: cython.pointer[Newton] = cython.address(run.newton)
    moved: cython.double = 0.0
    for k in range(of.stages):
        for b in range(run.group_count):
            if b != run.energy_group:
                group: cython.pointer[Group] = cython.address(run.groups[b])
                moved = find_largest_by_weight(run, newton.step[k], group.coordinates, group.rates, moved)
                found = find_largest_by_weight(run, newton.step[k], group.rates, group.end, found)
    if found > 0.0 or found != found:
        found = found / newton.rate if newton.rate > 0.0 else 1e300
    moved = moved / newton.reach
    return moved if moved > found else found


# Its error


def estimate(method: cython.pointer[Method], run: cython.pointer[Run], first: cython.p_double) -> cython.void:
    """The error of the step by its length into run.fine, as a step's error is measured; first: f at its start."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    u: cython.double
    of: cython.pointer[Collocation] = cython.address(method.collocation)
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for i in range(run.n):
        u = run.h * first[i]
        for k in range(of.stages):
            u += of.error[k] * newton.Z[k][i]
        newton.error[i] = u
    solve_real(newton.real.A, run.n, newton.real.pivots, newton.error)
    for i in range(run.n):
        run.fine[i] = newton.error[i] / run.h


def estimate_again(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.void:
    """The error filtered twice: once is too little of a stiff part where the start is off its slow motion."""
    i: cython.Py_ssize_t
    newton: cython.pointer[Newton] = cython.address(run.newton)
    for i in range(run.n):
        run.stage[i] = run.y[i] + newton.error[i]
    evaluate(scene, clipped(run, run.t), run.stage, newton.tangent.beside)
    run.evaluations += 1
    newton.elsewhere = 1
    estimate(method, run, newton.tangent.beside)
