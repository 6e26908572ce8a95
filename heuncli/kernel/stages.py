"""The stages of an explicit step; and, if a method has no dense output, steps to requested instants within it.

A method is data (integration/methods).
"""

from __future__ import annotations

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
