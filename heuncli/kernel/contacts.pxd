# Made of contacts.py by headers.py.

from heuncli.kernel.algebra cimport norm
from heuncli.kernel.closures cimport measure_row
from heuncli.kernel.dense cimport AGAIN_TO, MOST_LANDINGS, STANDS, TURNS_OVER, clipped, interpolate, need_interpolant
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport APART, CARRIES, LEANS, Closure, Contact, Scene
from heuncli.kernel.stepping cimport Method, Run
from heuncli.kernel.tree cimport kinematics
from libc.math cimport fabs

cdef enum:
    HALVINGS = 46, POINTS = 8, MOST_LOOKS = 400

cdef double margin(Scene *scene, Contact *contact) noexcept nogil
cdef void measure_open(Scene *scene, double t) noexcept nogil
cdef void start_contacts(Scene *scene, double t) noexcept nogil
cdef void see_start(Scene *scene) noexcept nogil
cdef void see_contacts(Scene *scene, double t) noexcept nogil
cdef bint pushed_at_once(Scene *scene, Run *run) noexcept nogil
cdef bint opened_by_others(Scene *scene, Run *run) noexcept nogil
cdef int turned_over(Scene *scene, Run *run) noexcept nogil
cdef int set_levels(Scene *scene, Run *run) noexcept nogil
cdef bint closes_early(Contact *contact, double reach) noexcept nogil
cdef void stand_within(Scene *scene, Method *method, Run *run, double x, int doubt) noexcept nogil
cdef int meet_contacts(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double where_closed(Scene *scene, Method *method, Run *run, double x) noexcept nogil
cdef double first_contact(Scene *scene, Method *method, Run *run, int doubt) noexcept nogil
cdef bint is_above(Scene *scene, Run *run) noexcept nogil
cdef bint is_clear(Scene *scene, Method *method, Run *run, double x0, double x1, int doubt) noexcept nogil
cdef void follow(Scene *scene, Contact *contact, int i) noexcept nogil
