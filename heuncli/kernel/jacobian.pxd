"""Structs and signatures of jacobian.py for C."""

from heuncli.kernel.algebra cimport norm
from heuncli.kernel.response cimport evaluate
from heuncli.kernel.scene cimport Body, Freedom, SHIFT, Scene
from libc.math cimport fabs, sqrt

cdef struct Tangent:          # the tangent of a motion at a state of n numbers, and room for its work
    int n
    double *J                 # d(ydot)/dy by rows
    double *at                # the derivative at the state
    double *beside            # and beside it

cdef void find_jacobian(Scene *scene, double t, double *y, Tangent *tangent) noexcept nogil
cdef void vary(Scene *scene, double t, double *y, Tangent *tangent, int j, double size) noexcept nogil
cdef double fastest(Scene *scene) noexcept nogil
cdef double larger(double rate, double u, double acceleration) noexcept nogil
