# Made of stages.py by headers.py.

from heuncli.kernel.dense cimport combine, evaluate_stage
from heuncli.kernel.landing cimport see_stage
from heuncli.kernel.scene cimport Scene
from heuncli.kernel.stepping cimport Method, Run

cdef int take_stages(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void step_to(Scene *scene, Method *method, Run *run, double t, double *out) noexcept nogil
