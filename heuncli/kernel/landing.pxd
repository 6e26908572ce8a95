"""Signatures of landing.py for C."""

from heuncli.kernel.dense cimport Method, Run, clipped, hermite, interpolant, interpolate
from heuncli.kernel.events cimport (
    BRANCH_IN_DOUBT, CLEAR, Course, NOTHING, TURNS, UNSEEN, differentiate, first_event, forget, instant, quiet,
    raise_by_rest, raise_by_x, see, take_branches,
)
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport Closure, Freedom, Scene, Variable
from heuncli.kernel.tree cimport coordinates
from libc.math cimport fabs

cdef enum:
    STANDS, AGAIN_TO, SLACK, CHATTERS

cdef enum:
    MOST_LANDINGS = 6         # on one event: each finds its place to the square of the error of the one before
    ROPE_HALVINGS = 46        # of a step where a rope goes slack: the rounding of its instants
    POINTS = 8                # of a part that is looked at for it
    FLURRY = 16               # events that gather at an instant

cdef void begin_to_see(Scene *scene, Run *run) noexcept nogil
cdef void see_stage(Scene *scene, Run *run) noexcept nogil
cdef int meet(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int meet_branches(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void need_interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int shorten(Scene *scene, Run *run, int found) noexcept nogil
cdef int land_on(Scene *scene, Run *run) noexcept nogil
cdef double one_instant(Scene *scene, Run *run) noexcept nogil
cdef bint in_flurry(Scene *scene, Run *run) noexcept nogil
cdef bint gathered(Scene *scene, Run *run, double t) noexcept nogil
cdef void lay_course(Scene *scene, Run *run, int rows) noexcept nogil
cdef void lay_component(Run *run, int c, int rows, double *b) noexcept nogil
cdef void lay_window(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double slackness(Scene *scene, Run *run) noexcept nogil
cdef double slackness_at(Scene *scene, Method *method, Run *run, double x) noexcept nogil
cdef int meet_slack(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double first_slack(Scene *scene, Method *method, Run *run) noexcept nogil
cdef bint is_taut(Scene *scene, Method *method, Run *run, double x0, double x1, double noise) noexcept nogil
