"""The tangent of the motion: J = d(ydot)/dy at a state, a direction of the state after the other, exact (tangent.py).

As `evaluate` gives ydot: the closure rows chosen stay chosen, branches of expressions that are held stay held, and the
four numbers of a ball's attitude are varied as they stand, each on its own.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from heuncli.kernel.columns import put
    from heuncli.kernel.scene import BodyTangent, Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.stepping import Tangent
    from heuncli.kernel.tangent import change_along, evaluate_base_state
    from heuncli.kernel.tangent_closures import row_along
    from heuncli.kernel.tangent_motion import move_along


def find_jacobian(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, tangent: cython.pointer[Tangent]
) -> cython.void:
    """J into tangent.J, the derivative at the state into tangent.at; accelerations have to be found anew afterwards."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = tangent.n
    evaluate_base_state(scene, t, y, tangent.at)
    for j in range(n):
        scene.along[j] = 0.0
        tangent.beside[j] = 0.0
    for j in range(n):
        scene.along[j] = 1.0
        change_along(scene, y, scene.along, tangent.beside)
        scene.along[j] = 0.0
        for i in range(n):
            tangent.J[n * i + j] = tangent.beside[i]


def find_motions(
    scene: cython.pointer[Scene], y: cython.p_double, n: cython.Py_ssize_t, out: cython.p_double
) -> cython.void:
    """What bodies and the rates of closure rows change by, a direction of the state that stands after the other.

    Of each body turn, r, omega and v (of the joint point); then of each row its rate, 0 where it is not chosen.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    for j in range(n):
        scene.along[j] = 0.0
    for j in range(n):
        scene.along[j] = 1.0
        move_along(scene, y, scene.along)
        scene.along[j] = 0.0
        for i in range(scene.body_count):
            d: cython.pointer[BodyTangent] = cython.address(scene.tangents[i])
            at = put(out, put(out, at, d.turn), d.r)
            at = put(out, put(out, at, d.omega), d.v)
        for i in range(scene.closure_count):
            out[at + i] = 0.0
        for i in range(scene.selected_count):
            out[at + scene.selected[i]] = row_along(scene, cython.address(scene.closures[scene.selected[i]])).rate
        at += scene.closure_count
