# Made of attitudes.py by headers.py.

from heuncli.kernel.algebra cimport Quaternion, Vec3, add_cross, add_scaled, cross, dot, norm, scaled, sub
from heuncli.kernel.scene cimport Body, Scene
from libc.math cimport atan2, fabs, sqrt

cdef enum:
    QUATERNION = 0, GLOBAL = 1, RECENTRED = 2

cdef Quaternion centre(int attitude, double *y, Py_ssize_t at) noexcept nogil
cdef Vec3 kappa_of(Quaternion q, Quaternion c) noexcept nogil
cdef Quaternion turned_by(Vec3 kappa, Quaternion c) noexcept nogil
cdef Vec3 rate_of(Vec3 kappa, Vec3 sigma) noexcept nogil
cdef Vec3 spin_of(Vec3 kappa, Vec3 rate) noexcept nogil
cdef Vec3 second_of(Vec3 kappa, Vec3 rate, Vec3 sigmadot) noexcept nogil
cdef Vec3 vector_at(double *x, Py_ssize_t at) noexcept nogil
cdef void put_vector(double *x, Py_ssize_t at, Vec3 a) noexcept nogil
cdef Vec3 kappa_at(int attitude, double *y, double *state, Py_ssize_t at) noexcept nogil
cdef void enter_chart(Scene *scene, int attitude, double *y, double *state, double *out) noexcept nogil
cdef void leave_chart(Scene *scene, int attitude, double *y, double *x) noexcept nogil
cdef void drop_small_parts(Scene *scene, int attitude, double *carry) noexcept nogil
cdef void chart_slopes(Scene *scene, int attitude, double *y, double *state, double *dy, double *out) noexcept nogil
cdef void weigh_in_chart(Scene *scene, int attitude, double *x, double *error) noexcept nogil
cdef void measure_ways(Scene *scene, int attitude, double *y, double *ways) noexcept nogil
cdef double nearing(Scene *scene, double *state, double *ways) noexcept nogil
cdef int at_half_turn(Scene *scene, int attitude, double *y) noexcept nogil
