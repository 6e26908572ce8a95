# Made of chosen.py by headers.py.

from heuncli.kernel.orthogonal cimport list_coupled
from heuncli.kernel.response cimport settle
from heuncli.kernel.scene cimport Closure, Scene
from heuncli.kernel.selection cimport order_all, select_independent_rows

cdef void choose_afresh(Scene *scene, double t, double *y) noexcept nogil
cdef void judge_start(Scene *scene, double t, double *y) noexcept nogil
cdef int chosen_width(Scene *scene) noexcept nogil
cdef void put_chosen(Scene *scene, double *out, Py_ssize_t at) noexcept nogil
cdef void take_chosen(Scene *scene, double *given, Py_ssize_t at) noexcept nogil
