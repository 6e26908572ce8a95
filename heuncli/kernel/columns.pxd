# Made of columns.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add_scaled, scaled
from heuncli.kernel.closures cimport measure_rows, push_closures, residual_of, size_of_answer
from heuncli.kernel.orthogonal cimport answer_of_row
from heuncli.kernel.response cimport configure, respond
from heuncli.kernel.scene cimport APART, SHIFT, Body, Closure, Freedom, Load, Scene
from heuncli.kernel.tree cimport balance, kinematics, push
from libc.math cimport sqrt

cdef Py_ssize_t put(double *out, Py_ssize_t at, Vec3 a) noexcept nogil
cdef Py_ssize_t put_column(Scene *scene, double *out, Py_ssize_t at, bint prescribed) noexcept nogil
cdef void apply_none(Scene *scene) noexcept nogil
cdef void answer_applied(Scene *scene, bint inertial) noexcept nogil
cdef void answer_column(Scene *scene, double *load, double *out, bint inertial) noexcept nogil
cdef void apply_column(Scene *scene, double *load) noexcept nogil
cdef Py_ssize_t answer_causes(Scene *scene, double t, double *y, double *out, Py_ssize_t at) noexcept nogil
cdef void apply_again(Scene *scene, Load *load) noexcept nogil
cdef void leave_prescribed(Scene *scene) noexcept nogil
cdef void prescribe(Scene *scene) noexcept nogil
cdef void bias(Scene *scene, Freedom *freedom, double udot) noexcept nogil
cdef void stand_still(Scene *scene) noexcept nogil
cdef void answer_blow(Scene *scene, double *load, double *jumps, double *out) noexcept nogil
cdef void measure_answers(Scene *scene) noexcept nogil
cdef double unmet(Scene *scene) noexcept nogil
