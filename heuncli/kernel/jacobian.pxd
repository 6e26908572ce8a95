"""Structs and signatures of jacobian.py for C."""

from heuncli.kernel.columns cimport put
from heuncli.kernel.scene cimport BodyTangent, Scene
from heuncli.kernel.tangent cimport change_along, stand_at
from heuncli.kernel.tangent_closures cimport row_along
from heuncli.kernel.tangent_motion cimport move_along

cdef struct Tangent:          # the tangent of a motion at a state of n numbers, and room for its work
    int n
    double *J                 # d(ydot)/dy by rows
    double *at                # the derivative at the state
    double *beside            # what it changes by along a direction

cdef void find_jacobian(Scene *scene, double t, double *y, Tangent *tangent) noexcept nogil
cdef void find_motions(Scene *scene, double *y, Py_ssize_t n, double *out) noexcept nogil
