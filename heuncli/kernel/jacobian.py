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
    from heuncli.kernel.scene import Scene
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Tangent
    from heuncli.kernel.tangent import change_along, stand_at


def find_jacobian(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, tangent: cython.pointer[Tangent]
) -> cython.void:
    """J into tangent.J, the derivative at the state into tangent.at; accelerations have to be found anew afterwards."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = tangent.n
    stand_at(scene, t, y, tangent.at)
    for j in range(n):
        scene.along[j] = 0.0
        tangent.beside[j] = 0.0
    for j in range(n):
        scene.along[j] = 1.0
        change_along(scene, y, scene.along, tangent.beside)
        scene.along[j] = 0.0
        for i in range(n):
            tangent.J[n * i + j] = tangent.beside[i]
