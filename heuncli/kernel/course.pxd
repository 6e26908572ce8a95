# Made of course.py by headers.py.

from heuncli.kernel.dense cimport clipped
from heuncli.kernel.enclosure cimport enclose
from heuncli.kernel.intervals cimport anything
from heuncli.kernel.jets cimport jet
from heuncli.kernel.programs cimport Bounds, Jet, Programs, Span
from heuncli.kernel.scene cimport Freedom, Scene
from heuncli.kernel.stepping cimport Course, Method, Run

cdef void raise_by_x(double *b, int n) noexcept nogil
cdef void raise_by_rest(double *b, int n) noexcept nogil
cdef void differentiate(double *value, double *rate, int n, double length) noexcept nogil
cdef Bounds range_of(double *b, int n, double x0, double x1, double *work) noexcept nogil
cdef int component(Scene *scene, Py_ssize_t i) noexcept nogil
cdef void lay_course(Scene *scene, Run *run, int rows) noexcept nogil
cdef void lay_component(Run *run, int c, int rows, double *b) noexcept nogil
cdef void lay_window(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double instant(Course *course, double x) noexcept nogil
cdef void set_time(Programs *programs, double begin, double end) noexcept nogil
cdef void range_over(Scene *scene, Course *course, Span *ranges, double x0, double x1) noexcept nogil
cdef Span driven_span(Scene *scene, Py_ssize_t i) noexcept nogil
cdef void derivatives_over(Scene *scene, Course *course, Span *ranges, double x0, double x1) noexcept nogil
cdef void stand_at(Scene *scene, Course *course, double x) noexcept nogil
