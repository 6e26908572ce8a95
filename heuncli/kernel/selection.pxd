"""Signatures of selection.py for C."""

from heuncli.kernel.algebra cimport Vec3, cross, dot, inverse_form, sub
from heuncli.kernel.closures cimport (
    build_column, clear_column, clear_path, column_product, factor_closures, measure_rows, put_unit_load,
    spread_column, sweep_column,
)
from heuncli.kernel.scene cimport Body, Closure, Freedom, SHIFT, Scene
from heuncli.kernel.tree cimport factor_tree, kinematics
from libc.math cimport sqrt

cdef int select_independent_rows(Scene *scene, double t, double *y, bint afresh) noexcept nogil
cdef void scale_row(Scene *scene, Closure *row, bint afresh) noexcept nogil
cdef double answer_of_one_side(Scene *scene, Closure *row, int body, double sign) noexcept nogil
cdef double own_answer(Scene *scene, Closure *row) noexcept nogil
cdef double largest_answer(Scene *scene, Closure *row) noexcept nogil
cdef double row_bound(Scene *scene, Closure *row) noexcept nogil
cdef double turn_bound(Body *body, Closure *row, double force2) noexcept nogil
cdef int next_pivot(Scene *scene) noexcept nogil
cdef void eliminate_pivot(Scene *scene, int best, int rank) noexcept nogil
cdef int rank_by_order(Scene *scene) noexcept nogil
