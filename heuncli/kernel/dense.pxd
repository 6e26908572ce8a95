# Made of dense.py by headers.py.

from heuncli.kernel.attitudes cimport chart_slopes, leave_chart, nearing
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport Freedom, Scene
from heuncli.kernel.stepping cimport Method, Run

cdef enum:
    STANDS = 0, AGAIN_TO = 1, TURNS_OVER = 2, CHATTERS = 3
    MOST_LANDINGS = 6

cdef void combine(Method *method, int row, double **K, int n, double *out) noexcept nogil
cdef double clipped(Run *run, double t) noexcept nogil
cdef int evaluate_stage(Scene *scene, Method *method, Run *run, int s, bint near) noexcept nogil
cdef void enter_slopes(Scene *scene, Method *method, Run *run, double *state, int s) noexcept nogil
cdef void hermite(Method *method, Run *run) noexcept nogil
cdef void quintic(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void through_stages(Method *method, Run *run) noexcept nogil
cdef void need_interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void interpolate(Scene *scene, Method *method, Run *run, double x, double *out) noexcept nogil
