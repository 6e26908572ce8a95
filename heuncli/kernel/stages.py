"""The stages of an explicit step; and, if a method has no dense output, steps to requested instants within it.

A method is data (motion/integration/methods). The stages also show whether stability, and not accuracy, limits the
steps. The last two stages of an explicit method are at the same instant, the end of the step, and differ by errors in
which the fastest decay or oscillation dominates. So the quotient of their derivatives,

    h |lambda|  ~  h |f(z) - f(g)| / |z - g|,

is the estimate of the tangent's largest eigenvalue by one step of the power method; rates are multiplied by h, which
makes them changes of coordinates in a step. If accuracy decides, it is well below the boundary of the method's
stability; if stability does, the step size control keeps it there.

Hairer, Wanner, Solving Ordinary Differential Equations II (1996), IV.2.
"""

from __future__ import annotations

from math import sqrt

from heuncli.kernel.contact_rounding import clear_accelerations
from heuncli.kernel.declarations import *
from heuncli.kernel.dense import clip_time, combine_stages, evaluate_stage
from heuncli.kernel.landing import record_stage


def evaluate_explicit_stages(
    scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]
) -> cython.int:
    """Find the derivatives at the stages of a step of length h from the present state; the first is known.

    Returns the smallest value that `evaluate` returned. Near a singular pose a small gap causes large accelerations:
    there the stages are projected.
    """
    s: cython.int
    i: cython.Py_ssize_t
    trouble: cython.int
    worst: cython.int = 0
    y: cython.p_double = run.chart.y
    for s in range(1, method.stages):
        combine_stages(method, s, run.chart.K, run.n, run.stage)
        for i in range(run.n):
            run.stage[i] = y[i] + run.h * run.stage[i]
        trouble = evaluate_stage(scene, method, run, s, run.projects_stages)
        if trouble < worst:
            worst = trouble
        if run.sees_stages:
            record_stage(scene, run, clip_time(run, run.t + method.node[s] * run.h))
        clear_accelerations(scene, method, run.K[s], s == 1)
    return worst


def step_to_instant(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    t: cython.double,
    result: cython.p_double,
) -> cython.void:
    """Find the state at an instant within the present step, by a step of its own from the same start.

    Its derivatives have rows of their own: those of the present step stay. (All methods that use a chart of attitudes
    have dense output.)
    """
    i: cython.Py_ssize_t
    h: cython.double = run.h
    K: cython.pp_double = run.K
    for i in range(run.n):
        run.side_stages[0][i] = K[0][i]
    run.h = t - run.t
    run.K = run.side_stages
    run.chart.K = run.side_stages
    run.evaluations += method.stages - 1
    evaluate_explicit_stages(scene, method, run)
    combine_stages(method, method.stages, run.K, run.n, result)
    for i in range(run.n):
        result[i] = run.y[i] + (run.h * result[i] + run.carry[i])
    run.h = h
    run.K = K
    run.chart.K = K


def estimate_stiffness(method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.void:
    """Estimate h |lambda| of the trial step, whose last stage is still in `stage`."""
    b: cython.int
    i: cython.Py_ssize_t
    w: cython.double
    x: cython.double
    changes: cython.double = 0.0
    distance: cython.double = 0.0
    end: cython.p_double = run.K[method.stages]
    last: cython.p_double = run.K[method.stages - 1]
    for b in range(run.group_count):
        if b != run.energy_group:  # work has no say in the motion
            group: cython.pointer[Group] = cython.address(run.groups[b])
            for i in range(group.coordinates, group.end):
                w = run.weights[i]
                if i >= group.rates:
                    w *= run.h
                x = w * (run.z[i] - run.stage[i])
                distance += x * x
                x = w * (end[i] - last[i])
                changes += x * x
    run.stiffness.swiftness = run.h * sqrt(changes / distance) if distance > 0.0 else 0.0


def is_stability_limited(run: cython.pointer[Run]) -> cython.bint:
    """Return whether enough of the steps done were at the stability boundary; several in a row that were not reset the
    count.

    If loads may be stiff, also after some steps, and each time that their number has doubled: what saturates, as
    friction does, is driven back and forth by a coarse tolerance, and no quotient shows it.
    """
    if run.stiffness.total_limit and run.steps >= run.stiffness.total_limit:
        run.stiffness.total_limit = 2 * run.steps
        return True
    if run.projects_stages or run.ends_piece:
        return False  # its length says nothing
    if run.stiffness.swiftness > run.stiffness.stable:
        run.stiffness.steps += 1
        run.stiffness.easy_steps = 0
    else:
        run.stiffness.easy_steps += 1
        if run.stiffness.easy_steps >= run.stiffness.easy_limit:
            run.stiffness.steps = 0
    if run.stiffness.steps < run.stiffness.short_limit:
        return False
    run.stiffness.steps = 0
    return True
