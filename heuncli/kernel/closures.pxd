"""Signatures of closures.py for C."""

from heuncli.kernel.algebra cimport (
    Vec3, add, add_cross, add_scaled, centripetal, cross, dot, norm, rotate, rotate_back, scaled, solve, sub,
)
from heuncli.kernel.expressions cimport Jet, jet
from heuncli.kernel.scene cimport Body, Closure, Counter, DOT, GUIDE, Scene
from heuncli.kernel.tree cimport answered, direction_of, push
from libc.math cimport sqrt

cdef struct Carried:
    Vec3 v
    Vec3 centripetal
    Vec3 omega

cdef Carried carried(Scene *scene, int body, Vec3 x) noexcept nogil
cdef Vec3 place_of(Scene *scene, int body, Vec3 q) noexcept nogil
cdef void measure_rows(Scene *scene, double t) noexcept nogil
cdef void guide_row(Scene *scene, Closure *row) noexcept nogil
cdef void dot_row(Scene *scene, Closure *row) noexcept nogil
cdef void rod_row(Scene *scene, Closure *row) noexcept nogil
cdef double acceleration_along(Scene *scene, Closure *row, bint inertial) noexcept nogil
cdef double acceleration_of(Body *body, Closure *row) noexcept nogil
cdef void put_unit_load(Scene *scene, Closure *row, int body, double sign) noexcept nogil
cdef void clear_path(Scene *scene, Closure *row) noexcept nogil
cdef void build_column(Scene *scene, Closure *row) noexcept nogil
cdef void sweep_column(Scene *scene, Closure *row) noexcept nogil
cdef void spread_column(Scene *scene, Closure *row) noexcept nogil
cdef void clear_column(Scene *scene, Closure *row) noexcept nogil
cdef double column_product(Scene *scene, Closure *row) noexcept nogil
cdef double factor_closures(Scene *scene) noexcept nogil
cdef int first_coupled(Scene *scene, int i) noexcept nogil
cdef double eliminate_row(Scene *scene, int i) noexcept nogil
cdef void solve_closures(Scene *scene) noexcept nogil
cdef void push_closures(Scene *scene) noexcept nogil
cdef void count_turns(Scene *scene, double *dy) noexcept nogil
cdef int slack(Scene *scene) noexcept nogil
