"""Signatures of events.py for C."""

from heuncli.kernel.enclosure cimport enclose, enclose_closely
from heuncli.kernel.expressions cimport ATAN2, Bounds, HELD, HOLD, TAKEN, Jet, Program, Programs, Span, jet, value
from heuncli.kernel.intervals cimport anything, magnitude
from heuncli.kernel.scene cimport Freedom, Scene, Variable, Watch
from libc.math cimport INFINITY, fabs

cdef enum:
    NOTHING, TURNS, UNSEEN, UNDECIDED
    CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, PASSED

cdef enum:
    AS_HELD, TURNED, OPEN

cdef enum:
    LOOKS = 20                # divisions after which a value is taken for seen: a millionth of the step
    PARTS = 60                # of a stretch, in which a load's peak is looked for
    MOST_LOOKS = 1000         # parts looked at for values that bounds do not settle
    MOST_PARTS = 4000         # and in all

cdef struct Course:           # of the coordinates over a stretch of time, for the expressions that hang on them
    int degree                # of their polynomials
    int late                  # 1: events are where they are certain, not where margins are zero
    int slot                  # a branch that turns
    int undecided             # 1: bounds left open whether all values were seen
    double begin              # the instant of x = 0
    double length             # from there to x = 1
    double latest             # the last instant that counts
    double finest             # part of it down to which events are told apart
    double event              # x of the event
    double crossed_by         # an end of a part by which branches have turned ...
    double crossing           # ... and where, somewhere before it
    double jump               # by how much what is watched jumps where branches turn, of its scale
    double **value            # of each variable its coefficients in Bernstein's form over the stretch
    double **rate             # and those of its rate, and of the rate of that
    double **second
    double *work
    double *begins            # of the parts to be looked at
    double *ends
    double *promise           # and what they may hold
    double *before            # branches put aside
    double *turned            # branches behind the event

cdef void forget(Scene *scene) noexcept nogil
cdef void see(Scene *scene) noexcept nogil
cdef double watched(Scene *scene, Watch *watch) noexcept nogil
cdef bint out_of_sight(Scene *scene, Watch *watch, Bounds bounds, double scale) noexcept nogil
cdef int quiet(Scene *scene, double begin, double end) noexcept nogil
cdef Bounds bounds_of(Scene *scene, Watch *watch) noexcept nogil
cdef bint any_doubt(Scene *scene) noexcept nogil
cdef void set_time(Programs *programs, double begin, double end) noexcept nogil
cdef void raise_by_x(double *b, int n) noexcept nogil
cdef void raise_by_rest(double *b, int n) noexcept nogil
cdef void differentiate(double *value, double *rate, int n, double length) noexcept nogil
cdef Bounds range_of(double *b, int n, double x0, double x1, double *work) noexcept nogil
cdef double instant(Course *course, double x) noexcept nogil
cdef void range_over(Scene *scene, Course *course, Span *ranges, double x0, double x1) noexcept nogil
cdef void derivatives_over(Scene *scene, Course *course, Span *ranges, double x0, double x1) noexcept nogil
cdef void stand_at(Scene *scene, Course *course, double x) noexcept nogil
cdef int doubt_over(Scene *scene, Course *course, double x0, double x1) noexcept nogil
cdef Bounds closer(Scene *scene, Course *course, Watch *watch, double x0, double x1) noexcept nogil
cdef void scale_watches(Scene *scene, Course *course) noexcept nogil
cdef Bounds over_part(Scene *scene, Course *course, Watch *watch, double x0, double x1) noexcept nogil
cdef void look_for_peak(Scene *scene, Course *course, Watch *watch) noexcept nogil
cdef int branches_at(Scene *scene, Course *course, double x) noexcept nogil
cdef bint changed_at(Scene *scene, Course *course, double x) noexcept nogil
cdef bint is_open(Scene *scene, Course *course, double x) noexcept nogil
cdef double beyond_rounding(Scene *scene, Course *course, double x, double end) noexcept nogil
cdef int look_at_turn(Scene *scene, Course *course, double x0, double x1) noexcept nogil
cdef double turns_at_once(Scene *scene, Course *course) noexcept nogil
cdef int first_event(Scene *scene, Course *course) noexcept nogil
cdef double crossing_in(Scene *scene, Course *course, double x0, double x1, double width) noexcept nogil
cdef double division(Scene *scene, Course *course, double x0, double x1, int found) noexcept nogil
cdef void find_angles(Scene *scene) noexcept nogil
cdef void follow_angles(Scene *scene, Course *course) noexcept nogil
cdef void take_branches(Scene *scene, double *branches) noexcept nogil
