# Made of selection.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add, add_cross, cross, dot, inverse_form, sub
from heuncli.kernel.closures cimport clear_path, measure_rows, put_unit_load
from heuncli.kernel.orthogonal cimport answer_of_side, factor_closures, list_coupled, take_roots
from heuncli.kernel.scene cimport CARRIES, SHIFT, Body, Closure, Freedom, Island, Scene
from heuncli.kernel.tree cimport factor_tree, kinematics, load_along
from libc.math cimport fabs, sqrt

cdef int select_independent_rows(Scene *scene, double t, double *y, bint afresh) noexcept nogil
cdef double order_all(Scene *scene, double least) noexcept nogil
cdef double order_rows(Scene *scene, Island *island, double least) noexcept nogil
cdef void scaled_row(Scene *scene, Island *island, Py_ssize_t k) noexcept nogil
cdef void jacobian_row(Scene *scene, Closure *row) noexcept nogil
cdef double square_left(Scene *scene, Island *island, Py_ssize_t k, Py_ssize_t n) noexcept nogil
cdef int next_pivot(Scene *scene, Island *island, Py_ssize_t n, double least) noexcept nogil
cdef void take_out(Scene *scene, Island *island, Py_ssize_t best, Py_ssize_t n) noexcept nogil
cdef void scale_pose(Scene *scene, Closure *row, bint afresh) noexcept nogil
cdef double row_bound(Scene *scene, Closure *row) noexcept nogil
cdef double turn_bound(Body *body, Closure *row, double force) noexcept nogil
