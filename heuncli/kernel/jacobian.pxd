"""Structs and signatures of jacobian.py for C."""

from heuncli.kernel.scene cimport Scene
from heuncli.kernel.tangent cimport change_along, stand_at

cdef struct Tangent:          # the tangent of a motion at a state of n numbers, and room for its work
    int n
    double *J                 # d(ydot)/dy by rows
    double *at                # the derivative at the state
    double *beside            # what it changes by along a direction

cdef void find_jacobian(Scene *scene, double t, double *y, Tangent *tangent) noexcept nogil
