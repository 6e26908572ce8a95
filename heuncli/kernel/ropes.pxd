"""Signatures of ropes.py for C."""

from heuncli.kernel.dense cimport (
    AGAIN_TO, MOST_LANDINGS, Method, Run, SLACK, STANDS, clipped, interpolate, need_interpolant,
)
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport Closure, Scene
from libc.math cimport fabs

cdef enum:
    HALVINGS = 46             # of a step, down to the rounding of its instants
    POINTS = 8                # into which a part is divided to be looked at

cdef double slackness(Scene *scene, Run *run) noexcept nogil
cdef double slackness_at(Scene *scene, Method *method, Run *run, double x) noexcept nogil
cdef int meet_slack(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double first_slack(Scene *scene, Method *method, Run *run) noexcept nogil
cdef bint is_taut(Scene *scene, Method *method, Run *run, double x0, double x1, double noise) noexcept nogil
