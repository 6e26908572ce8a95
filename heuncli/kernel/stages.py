"""The stages of an explicit step; and, where a method has no dense output, steps to the instants asked for within it.

A method is data (integration/methods).
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.dense import clipped, combine, evaluate_stage
    from heuncli.kernel.held import clear_accelerations
    from heuncli.kernel.landing import see_stage
    from heuncli.kernel.scene import Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Method, Run


def take_stages(scene: cython.pointer[Scene], method: cython.pointer[Method], run: cython.pointer[Run]) -> cython.int:
    """The derivatives at the stages of a step of length h from where the run stands; the first is there.

    The least that `evaluate` says of a stage. What is off the closures by a little is accelerated by a lot near a
    singular pose: there the stages are settled.
    """
    s: cython.int
    i: cython.Py_ssize_t
    trouble: cython.int
    worst: cython.int = 0
    y: cython.p_double = run.chart.y
    for s in range(1, method.stages):
        combine(method, s, run.chart.K, run.n, run.stage)
        for i in range(run.n):
            run.stage[i] = y[i] + run.h * run.stage[i]
        trouble = evaluate_stage(scene, method, run, s, run.near)
        if trouble < worst:
            worst = trouble
        if run.seeing:
            see_stage(scene, run, clipped(run, run.t + method.node[s] * run.h))
        clear_accelerations(scene, method, run.K[s], s == 1)
    return worst


def step_to(
    scene: cython.pointer[Scene],
    method: cython.pointer[Method],
    run: cython.pointer[Run],
    t: cython.double,
    out: cython.p_double,
) -> cython.void:
    """The state at an instant within the step under way, by a step of its own from the same start.

    Derivatives go into rows of their own: those of the step under way stay. (No method that takes its steps in a chart
    of attitudes is without dense output.)
    """
    i: cython.Py_ssize_t
    h: cython.double = run.h
    K: cython.pp_double = run.K
    for i in range(run.n):
        run.beside[0][i] = K[0][i]
    run.h = t - run.t
    run.K = run.beside
    run.chart.K = run.beside
    run.evaluations += method.stages - 1
    take_stages(scene, method, run)
    combine(method, method.stages, run.K, run.n, out)
    for i in range(run.n):
        out[i] = run.y[i] + (run.h * out[i] + run.carry[i])
    run.h = h
    run.K = K
    run.chart.K = K
