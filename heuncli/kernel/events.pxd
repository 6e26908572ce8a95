# Made of events.py by headers.py.

from heuncli.kernel.course cimport derivatives_over, instant, range_over, set_time, stand_at
from heuncli.kernel.enclosure cimport enclose, enclose_closely
from heuncli.kernel.expressions cimport ATAN2, HELD, HOLD, TAKEN, value
from heuncli.kernel.intervals cimport anything, magnitude
from heuncli.kernel.jets cimport jet
from heuncli.kernel.programs cimport Bounds, Program, Programs, Span
from heuncli.kernel.scene cimport Scene, Watch
from heuncli.kernel.stepping cimport Course
from libc.math cimport INFINITY, fabs

cdef enum:
    NOTHING = 0, TURNS = 1, UNSEEN = 2, UNDECIDED = 3, CLEAR = 4, BRANCH_IN_DOUBT = 5, VALUE_IN_DOUBT = 6, PASSED = 7
    AS_HELD = 0, TURNED = 1, OPEN = 2
    LOOKS = 20, PARTS = 60, MOST_LOOKS = 1000, MOST_PARTS = 4000

cdef void forget(Scene *scene) noexcept nogil
cdef void watch_afresh(Scene *scene) noexcept nogil
cdef void see(Scene *scene) noexcept nogil
cdef double watched(Scene *scene, Watch *watch) noexcept nogil
cdef double largest_seen(Watch *watch) noexcept nogil
cdef bint out_of_sight(Scene *scene, Watch *watch, Bounds bounds, double scale) noexcept nogil
cdef int quiet(Scene *scene, double begin, double end) noexcept nogil
cdef Bounds bounds_of(Scene *scene, Watch *watch) noexcept nogil
cdef void clear_doubts(Scene *scene) noexcept nogil
cdef bint any_doubt(Scene *scene) noexcept nogil
cdef bint is_resting(Course *course, Py_ssize_t i, double x) noexcept nogil
cdef bint moving_doubt(Scene *scene, Course *course, double x) noexcept nogil
cdef int doubt_over(Scene *scene, Course *course, double x0, double x1) noexcept nogil
cdef Bounds closer(Scene *scene, Course *course, Watch *watch, double x0, double x1) noexcept nogil
cdef void scale_watches(Scene *scene, Course *course) noexcept nogil
cdef Bounds over_part(Scene *scene, Course *course, Watch *watch, double x0, double x1) noexcept nogil
cdef void look_for_peak(Scene *scene, Course *course, Watch *watch) noexcept nogil
cdef void take_afresh(Scene *scene, Course *course) noexcept nogil
cdef int branches_at(Scene *scene, Course *course, double x) noexcept nogil
cdef bint changed_at(Scene *scene, Course *course, double x) noexcept nogil
cdef double jump_at(Scene *scene, Course *course) noexcept nogil
cdef bint is_open(Scene *scene, Course *course, double x) noexcept nogil
cdef double beyond_rounding(Scene *scene, Course *course, double x, double end) noexcept nogil
cdef double turns_at_once(Scene *scene, Course *course) noexcept nogil
cdef int first_event(Scene *scene, Course *course) noexcept nogil
cdef int look_at_turn(Scene *scene, Course *course, double x0, double x1) noexcept nogil
cdef bint pass_over(Scene *scene, Course *course, double x0, double x1) noexcept nogil
cdef bint moves_off(Scene *scene, Course *course, double x) noexcept nogil
cdef double crossing_in(Scene *scene, Course *course, double x0, double x1, double width) noexcept nogil
cdef double division(Scene *scene, Course *course, double x0, double x1, int found) noexcept nogil
cdef void find_angles(Scene *scene) noexcept nogil
cdef void follow_angles(Scene *scene, Course *course) noexcept nogil
cdef void take_branches(Scene *scene, double *branches) noexcept nogil
