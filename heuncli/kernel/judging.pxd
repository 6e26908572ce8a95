# Made of judging.py by headers.py.

from heuncli.kernel.attitudes cimport weigh_in_chart
from heuncli.kernel.collocation cimport estimate, estimate_again
from heuncli.kernel.dense cimport combine
from heuncli.kernel.scene cimport Group, Scene
from heuncli.kernel.stepping cimport Method, Run
from libc.math cimport fabs, pow, sqrt

cdef enum:
    REACHED = 0, MORE = 1, COLLAPSED = 2, NOT_A_NUMBER = 3, CLOSURES_LOST = 4, ROPE_SLACK = 5, CHATTERING = 6
    STRUCK = 7, LET_GO = 8, TURNED = 9, STIFF = 10, HALF_TURN = 11, UNSOLVED = 12, ACCEPTED = 13, AGAIN = 14

cdef double SAFETY
cdef double LEAST_FACTOR
cdef double MOST_FACTOR
cdef double OUT_OF_REACH
cdef double COARSE_SHARE
cdef double UNSOLVED_ERROR

cdef double norm_of(Run *run, double *x, int begin, int end) noexcept nogil
cdef double step_error(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double group_error(Scene *scene, Method *method, Run *run, int b) noexcept nogil
cdef bint turns_too_far(Scene *scene, Run *run) noexcept nogil
cdef int judge(Scene *scene, Method *method, Run *run, int trouble) noexcept nogil
cdef int judge_given(Method *method, Run *run, int trouble) noexcept nogil
cdef bint takes_rates(Run *run) noexcept nogil
cdef double explicit_error(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double implicit_error(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int dodge(Scene *scene, Run *run, double error, int trouble) noexcept nogil
cdef double singular_noise(Scene *scene, Run *run) noexcept nogil
cdef double growth(Method *method, Run *run) noexcept nogil
