"""Signatures of stages.py for C."""

from heuncli.kernel.dense cimport Method, Run, combine, evaluate_stage
from heuncli.kernel.landing cimport see_stage
from heuncli.kernel.scene cimport Scene

cdef int take_stages(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void step_to(Scene *scene, Method *method, Run *run, double t, double *out) noexcept nogil
