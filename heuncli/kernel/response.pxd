# Made of response.py by headers.py.

from heuncli.kernel.algebra cimport Quaternion, Vec3, dot, slightly_turned, turned
from heuncli.kernel.closures cimport count_turns, demanded, measure_moving_rows, measure_row, push_closures
from heuncli.kernel.loads cimport apply_loads
from heuncli.kernel.orthogonal cimport factor_closures, solve_closures
from heuncli.kernel.scene cimport APART, Body, Closure, Freedom, Lent, Scene
from heuncli.kernel.tree cimport add_zeros, balance, derivative, downward, factor_tree, kinematics, push_lent, put_all_loads, put_loads, upward
from libc.math cimport fabs, sqrt

cdef int configure(Scene *scene, double t) noexcept nogil
cdef void respond(Scene *scene, bint inertial) noexcept nogil
cdef void answer_loads(Scene *scene, bint inertial, bint apart) noexcept nogil
cdef void answer(Scene *scene, bint inertial) noexcept nogil
cdef int weigh_lent(Scene *scene) noexcept nogil
cdef void lend_less(Scene *scene) noexcept nogil
cdef double taken(Scene *scene, Lent *lent) noexcept nogil
cdef double eliminate_lent(Scene *scene, Py_ssize_t j) noexcept nogil
cdef void find_taken(Scene *scene) noexcept nogil
cdef int evaluate(Scene *scene, double t, double *y, double *dy) noexcept nogil
cdef void evaluate_settled(Scene *scene, double t, double *y, double *dy) noexcept nogil
cdef double put_in_motion(Scene *scene, double t, double *y, double *dy) noexcept nogil
cdef void accelerate(Scene *scene, double *y, double *dy, double power) noexcept nogil
cdef double driving_power(Scene *scene) noexcept nogil
cdef double settle(Scene *scene, double t, double *y) noexcept nogil
cdef double settle_evaluated(Scene *scene, double t, double *y) noexcept nogil
cdef double close(Scene *scene, double t, double *y) noexcept nogil
cdef bint must_choose_anew(Scene *scene, double gap) noexcept nogil
cdef void normalise(Scene *scene, double *y) noexcept nogil
cdef void refactor(Scene *scene, double t, double *y) noexcept nogil
cdef double close_gaps(Scene *scene, double t, double *y) noexcept nogil
cdef void correct_rates(Scene *scene, double *y) noexcept nogil
cdef double largest_gap(Scene *scene) noexcept nogil
cdef void take_back(Scene *scene) noexcept nogil
cdef void move(Scene *scene, double *y, bint rates) noexcept nogil
