# Made of collocation.py by headers.py.

from heuncli.kernel.dense cimport clipped
from heuncli.kernel.jacobian cimport find_jacobian
from heuncli.kernel.landing cimport begin_to_see, see_stage
from heuncli.kernel.linear cimport factor_complex, factor_real, solve_complex, solve_real
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport Group, Scene
from heuncli.kernel.stepping cimport Collocation, Factors, Method, Newton, Run
from libc.math cimport fabs, pow

cdef enum:
    MOST_ITERATIONS = 25

cdef int collocate(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void collocate_to(Scene *scene, Method *method, Run *run, double t, double *out) noexcept nogil
cdef double change_of(Collocation *of, Run *run, Py_ssize_t i) noexcept nogil
cdef bint factor_step(Scene *scene, Collocation *of, Run *run) noexcept nogil
cdef bint solve_stages(Scene *scene, Method *method, Run *run) noexcept nogil
cdef bint is_noise(Scene *scene, Method *method, Run *run, double size) noexcept nogil
cdef void begin_stages(Method *method, Run *run) noexcept nogil
cdef void measure_by(Run *run, double *x) noexcept nogil
cdef double farthest(Run *run, double *x, int begin, int end, double found) noexcept nogil
cdef void evaluate_stages(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double correct(Method *method, Run *run) noexcept nogil
cdef void solve_blocks(Collocation *of, Run *run) noexcept nogil
cdef void add_step(Collocation *of, Run *run) noexcept nogil
cdef double size_of_step(Collocation *of, Run *run) noexcept nogil
cdef void estimate(Method *method, Run *run, double *first) noexcept nogil
cdef void estimate_again(Scene *scene, Method *method, Run *run) noexcept nogil
