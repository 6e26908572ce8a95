"""The tangent of the motion: J = d(ydot)/dy at a state, one direction of the state after the other, exact (tangent.py).

ydot is that of `evaluate`: the chosen closure rows stay chosen, held branches of expressions stay held, and the four
numbers of a ball joint's attitude are varied one by one as they are.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.tangent import differentiate_state, evaluate_base_state
from heuncli.kernel.tangent_closures import row_tangent
from heuncli.kernel.tangent_motion import differentiate_motion


def find_jacobian(
    scene: cython.pointer[Scene], t: cython.double, y: cython.p_double, tangent: cython.pointer[Tangent]
) -> cython.void:
    """Write J to tangent.J and the derivative at the state to tangent.at; the accelerations are lost."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    n: cython.Py_ssize_t = tangent.n
    evaluate_base_state(scene, t, y, tangent.derivative)
    for j in range(n):
        scene.direction[j] = 0.0
        tangent.change[j] = 0.0
    for j in range(n):
        scene.direction[j] = 1.0
        differentiate_state(scene, y, scene.direction, tangent.change)
        scene.direction[j] = 0.0
        for i in range(n):
            tangent.J[n * i + j] = tangent.change[i]


def find_motions(
    scene: cython.pointer[Scene], y: cython.p_double, n: cython.Py_ssize_t, buffer: cython.p_double
) -> cython.void:
    """Write the changes of bodies and of the rates of closure rows, one direction of the base state after the other.

    Of each body turn, r, omega and v (of the joint point); then of each row its rate, 0 if it is not chosen.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    offset: cython.Py_ssize_t = 0
    for j in range(n):
        scene.direction[j] = 0.0
    for j in range(n):
        scene.direction[j] = 1.0
        differentiate_motion(scene, y, scene.direction)
        scene.direction[j] = 0.0
        for i in range(scene.body_count):
            d: cython.pointer[BodyTangent] = cython.address(scene.tangents[i])
            offset = write_vector(buffer, write_vector(buffer, offset, d.turn), d.r)
            offset = write_vector(buffer, write_vector(buffer, offset, d.omega), d.v)
        for i in range(scene.closure_count):
            buffer[offset + i] = 0.0
        for i in range(scene.selected_count):
            buffer[offset + scene.selected[i]] = row_tangent(
                scene, cython.address(scene.closures[scene.selected[i]])
            ).rate
        offset += scene.closure_count
