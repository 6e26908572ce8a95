# Made of closures.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add, add_cross, add_scaled, centripetal, cross, dot, norm, rotate, rotate_back, scaled, sub
from heuncli.kernel.jets cimport jet
from heuncli.kernel.plane_rows cimport demanded_in_plane, measure_in_plane
from heuncli.kernel.programs cimport Jet
from heuncli.kernel.scene cimport DOT, GUIDE, TURN, Body, Carried, Closure, Counter, Scene
from heuncli.kernel.tree cimport answered, direction_of, push
from libc.math cimport fabs

cdef Carried carried(Scene *scene, int body, Vec3 x) noexcept nogil
cdef Vec3 place_of(Scene *scene, int body, Vec3 q) noexcept nogil
cdef void measure_rows(Scene *scene, double t) noexcept nogil
cdef void measure_moving_rows(Scene *scene, double t) noexcept nogil
cdef void measure_row(Scene *scene, Closure *row, double t) noexcept nogil
cdef void guide_row(Scene *scene, Closure *row) noexcept nogil
cdef void dot_row(Scene *scene, Closure *row) noexcept nogil
cdef void turn_row(Scene *scene, Closure *row) noexcept nogil
cdef void rod_row(Scene *scene, Closure *row) noexcept nogil
cdef double demanded(Scene *scene, Closure *row) noexcept nogil
cdef double along_row(Closure *row, Vec3 r, Vec3 a, Vec3 alpha) noexcept nogil
cdef double residual_of(Scene *scene, Closure *row) noexcept nogil
cdef double acceleration_of(Scene *scene, Closure *row) noexcept nogil
cdef double size_of_demand(Scene *scene, Closure *row) noexcept nogil
cdef double size_of_answer(Scene *scene, Closure *row) noexcept nogil
cdef double size_of_terms(Body *body, Closure *row, Vec3 a, Vec3 alpha) noexcept nogil
cdef void put_unit_load(Scene *scene, Closure *row, int body, double sign) noexcept nogil
cdef void clear_path(Scene *scene, Closure *row) noexcept nogil
cdef void build_column(Scene *scene, Closure *row) noexcept nogil
cdef void sweep_column(Scene *scene, Closure *row) noexcept nogil
cdef void push_closures(Scene *scene) noexcept nogil
cdef void count_turns(Scene *scene, double *dy) noexcept nogil
