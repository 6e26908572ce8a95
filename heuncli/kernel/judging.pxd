"""Signatures of judging.py for C."""

from heuncli.kernel.algebra cimport norm
from heuncli.kernel.attitudes cimport nearing, weigh_in_chart
from heuncli.kernel.collocation cimport estimate, estimate_again
from heuncli.kernel.dense cimport Method, Run, combine
from heuncli.kernel.scene cimport Group, Scene
from heuncli.kernel.tree cimport coordinates
from libc.math cimport fabs, pow, sqrt

cdef enum:
    REACHED, MORE, COLLAPSED, NOT_A_NUMBER, CLOSURES_LOST, ROPE_SLACK, CHATTERING, STRUCK, LET_GO, TURNED, STIFF
    HALF_TURN, UNSOLVED
    ACCEPTED, AGAIN

cdef double SAFETY, LEAST_FACTOR, MOST_FACTOR, OUT_OF_REACH, COARSE_SHARE, UNSOLVED_ERROR

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
