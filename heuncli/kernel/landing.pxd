# Made of landing.py by headers.py.

from heuncli.kernel.contacts cimport meet_contacts, see_contacts, see_start, start_contacts
from heuncli.kernel.course cimport instant, lay_course, lay_window
from heuncli.kernel.dense cimport AGAIN_TO, CHATTERS, MOST_LANDINGS, STANDS, clipped, hermite, need_interpolant
from heuncli.kernel.events cimport BRANCH_IN_DOUBT, CLEAR, NOTHING, TURNS, UNSEEN, first_event, forget, jump_at, quiet, see, take_branches
from heuncli.kernel.response cimport evaluate
from heuncli.kernel.scene cimport Scene
from heuncli.kernel.stepping cimport Course, Method, Run
from heuncli.kernel.tree cimport coordinates
from libc.math cimport fabs

cdef enum:
    FLURRY = 16

cdef void begin_to_see(Scene *scene, Run *run) noexcept nogil
cdef void see_stage(Scene *scene, Run *run) noexcept nogil
cdef int meet(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int meet_branches(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int shorten(Scene *scene, Run *run, int found) noexcept nogil
cdef int land_on(Scene *scene, Run *run) noexcept nogil
cdef double one_instant(Scene *scene, Run *run) noexcept nogil
cdef bint in_flurry(Scene *scene, Run *run) noexcept nogil
cdef bint gathered(Scene *scene, Run *run, double t) noexcept nogil
