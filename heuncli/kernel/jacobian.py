"""The tangent of the motion: J = d(ydot)/dy at a state, by differences of `evaluate`.

As `evaluate` gives them: the closure rows chosen stay chosen, branches of expressions that are held stay held, and the
four numbers of a ball's attitude are varied as they stand, each on its own. A number is varied by the root of the
rounding, of itself or of what it may be: an angle of 1, a shift of the scene's size, a rate of the fastest.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.algebra import norm
    from heuncli.kernel.response import evaluate
    from heuncli.kernel.scene import SHIFT, Body, Freedom, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Tangent


def find_jacobian(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, tangent: cython.pointer[Tangent]
) -> cython.void:
    """J into tangent.J; y stays. What the kernel knows of a pose is afterwards that of another one beside it."""
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    pivot: cython.double = scene.pivot
    least: cython.double = scene.pivot_of_step
    for i in range(tangent.n * tangent.n):
        tangent.J[i] = 0.0
    evaluate(scene, t, y, tangent.at)
    turning: cython.double = fastest(scene)
    shifting: cython.double = turning * scene.size
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            for k in range(4):
                vary(scene, t, y, tangent, body.attitude_at + k, 1.0)
            for k in range(3):
                vary(scene, t, y, tangent, body.rate_at + k, turning)
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        if not freedom.driven:
            shifts: cython.bint = freedom.kind == SHIFT
            vary(scene, t, y, tangent, freedom.q_at, scene.size if shifts else 1.0)
            vary(scene, t, y, tangent, freedom.u_at, shifting if shifts else turning)
    for i in range(scene.counter_count):
        vary(scene, t, y, tangent, scene.counters[i].at, 1.0)
    scene.pivot = pivot
    scene.pivot_of_step = least


def vary(
    scene: cython.pointer[Scene],
    t: cython.double,
    y: cython.p_double,
    tangent: cython.pointer[Tangent],
    j: cython.int,
    size: cython.double,
) -> cython.void:
    """Column j of J: what a small change of y[j], a part of its size, makes of the derivative at y."""
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = tangent.n
    kept: cython.double = y[j]
    step: cython.double = scene.limits.varied * (size if size > fabs(kept) else fabs(kept))
    y[j] = kept + step
    step = y[j] - kept  # as it is after rounding
    evaluate(scene, t, y, tangent.beside)
    y[j] = kept
    for i in range(n):
        tangent.J[n * i + j] = (tangent.beside[i] - tangent.at[i]) / step


def fastest(scene: cython.pointer[Scene]) -> cython.double:
    """The largest rate, or root of an acceleration, of what was evaluated last [1/s]; 1 where all is at rest."""
    i: cython.Py_ssize_t
    part: cython.double
    rate: cython.double = 0.0
    for i in range(scene.body_count):
        body: cython.pointer[Body] = cython.address(scene.bodies[i])
        if body.ball:
            rate = larger(rate, norm(body.omega), norm(body.alpha))
    for i in range(scene.freedom_count):
        freedom: cython.pointer[Freedom] = cython.address(scene.freedoms[i])
        part = 1.0 / scene.size if freedom.kind == SHIFT else 1.0
        rate = larger(rate, part * fabs(freedom.u), part * fabs(freedom.udot))
    return rate if rate > 0.0 else 1.0


def larger(rate: cython.double, u: cython.double, acceleration: cython.double) -> cython.double:
    """The largest of two rates and the root of an acceleration, as far as they are numbers."""
    root: cython.double = sqrt(acceleration)
    if u > rate:
        rate = u
    return root if rate < root < 1e150 else rate
