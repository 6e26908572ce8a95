# Made of workspace.py by headers.py.

from heuncli.kernel.algebra cimport Mat3, Vec3
from heuncli.kernel.chosen cimport choose_afresh, judge_start
from heuncli.kernel.closures cimport acceleration_of, measure_rows, push_closures, size_of_answer
from heuncli.kernel.columns cimport answer_blow, answer_causes, answer_column, measure_answers, put, unmet
from heuncli.kernel.events cimport find_angles
from heuncli.kernel.expressions cimport FREE, HELD, TAKEN, Expressions
from heuncli.kernel.jacobian cimport find_jacobian, find_motions
from heuncli.kernel.memory cimport Memory
from heuncli.kernel.orthogonal cimport doubt_multipliers
from heuncli.kernel.response cimport configure, evaluate, must_choose_anew, settle
from heuncli.kernel.scene cimport APART, CARRIES, LEANS, Body, BodyAtState, BodyTangent, Closure, Contact, Counter, Freedom, FreedomTangent, Instants, Island, Lent, Limits, Load, Scene, Variable, Watch
from heuncli.kernel.selection cimport jacobian_row, order_all, select_independent_rows
from heuncli.kernel.stepping cimport Tangent
from heuncli.kernel.tree cimport balance, factor_tree, kinematics

cdef Py_ssize_t put_matrix(double *out, Py_ssize_t at, Mat3 R) noexcept nogil
cdef Py_ssize_t put_body(double *out, Py_ssize_t at, Body *body) noexcept nogil
cdef Py_ssize_t put_load(double *out, Py_ssize_t at, Load *load) noexcept nogil
cdef Py_ssize_t put_row(Scene *scene, double *out, Py_ssize_t at, Closure *row) noexcept nogil
cdef Py_ssize_t put_answers(Scene *scene, double *out, Py_ssize_t at) noexcept nogil
cdef int recover_state(Scene *scene, double t, double *y, double *dy, bint afresh) noexcept nogil
cdef void judge_closures(Scene *scene, double t) noexcept nogil
cdef bint take_holding(Scene *scene, double *holding, Py_ssize_t at) noexcept nogil
cdef void recover_states(Scene *scene, Instants *instants) noexcept nogil
cdef void carry(Scene *scene, double *multipliers, double *out) noexcept nogil
cdef void put_jacobian(Scene *scene, double *out) noexcept nogil

cdef class Workspace:
    cdef Expressions expressions
    cdef Memory memory
    cdef int opening
    cdef Scene scene
    cdef object put_motions(self, double *y, double *dy, dict more)
