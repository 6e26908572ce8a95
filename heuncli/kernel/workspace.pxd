"""Signatures of workspace.py for C."""

from heuncli.kernel.algebra cimport Mat3, Vec3, add, add_cross
from heuncli.kernel.chosen cimport choose_afresh
from heuncli.kernel.closures cimport clear_path, measure_rows, push_closures, put_unit_load
from heuncli.kernel.expressions cimport Expressions
from heuncli.kernel.memory cimport Memory
from heuncli.kernel.response cimport configure, evaluate, must_choose_anew, respond, settle
from heuncli.kernel.scene cimport Body, Closure, Counter, Freedom, Lent, Limits, Load, Scene, Variable
from heuncli.kernel.selection cimport select_independent_rows
from heuncli.kernel.tree cimport balance, kinematics, load_along

cdef struct Instants:         # states to recover, and room for the work
    Py_ssize_t count
    Py_ssize_t n
    Py_ssize_t width
    bint afresh
    double *times
    double *states
    double *out
    double *y
    double *dy

cdef Py_ssize_t put(double *out, Py_ssize_t at, Vec3 a) noexcept nogil
cdef Py_ssize_t put_matrix(double *out, Py_ssize_t at, Mat3 R) noexcept nogil
cdef Py_ssize_t put_body(double *out, Py_ssize_t at, Body *body) noexcept nogil
cdef Py_ssize_t put_load(double *out, Py_ssize_t at, Load *load) noexcept nogil
cdef Py_ssize_t put_row(double *out, Py_ssize_t at, Closure *row) noexcept nogil
cdef Py_ssize_t put_answers(Scene *scene, double *out, Py_ssize_t at) noexcept nogil
cdef int recover_state(Scene *scene, double t, double *y, double *dy, bint afresh) noexcept nogil
cdef void recover_states(Scene *scene, Instants *instants) noexcept nogil
cdef void answer_column(Scene *scene, double *load, double *out, bint inertial) noexcept nogil
cdef void carry(Scene *scene, double *multipliers, double *out) noexcept nogil
cdef void jacobian_row(Scene *scene, Closure *row, double *out) noexcept nogil

cdef class Workspace:
    cdef Scene scene
    cdef Expressions expressions
    cdef Memory memory
    cpdef object take_tables(self, dict tables)
    cpdef object take_arrays(self, object indices, Py_ssize_t column_count)
