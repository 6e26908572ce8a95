# Made of orthogonal.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, from_half, half_solve, roots
from heuncli.kernel.closures cimport build_column, clear_path, put_unit_load, size_of_demand, sweep_column
from heuncli.kernel.plane_rows cimport spread_in_plane
from heuncli.kernel.scene cimport Body, Closure, Freedom, Scene
from libc.math cimport fabs, sqrt

cdef double factor_closures(Scene *scene) noexcept nogil
cdef void take_roots(Scene *scene) noexcept nogil
cdef void halve(Scene *scene, Body *body, double *x) noexcept nogil
cdef void add_doubled(Scene *scene, Body *body, double *x) noexcept nogil
cdef double answer_of_side(Scene *scene, Closure *row, int body, double sign) noexcept nogil
cdef double answer_of_row(Scene *scene, Closure *row) noexcept nogil
cdef double answer_of_spread(Scene *scene, Closure *row) noexcept nogil
cdef void spread_row(Scene *scene, Closure *row) noexcept nogil
cdef void spread_column(Scene *scene, Closure *row) noexcept nogil
cdef void reflect(Scene *scene, Closure *row, double *x) noexcept nogil
cdef void list_coupled(Scene *scene) noexcept nogil
cdef double eliminate_row(Scene *scene, int i) noexcept nogil
cdef void begin_row(Scene *scene, Py_ssize_t i, int first) noexcept nogil
cdef double make_reflector(Scene *scene, Closure *row) noexcept nogil
cdef void solve_closures(Scene *scene) noexcept nogil
cdef void meet_demands(Scene *scene) noexcept nogil
cdef void divide(Scene *scene, double *y) noexcept nogil
cdef void divide_back(Scene *scene, double *y) noexcept nogil
cdef void doubt_multipliers(Scene *scene) noexcept nogil
cdef double grown(double x, double by) noexcept nogil
cdef double size_of_loads(Scene *scene) noexcept nogil
cdef double size_of_multipliers(Scene *scene) noexcept nogil
