"""The door to steps.py, for C."""

from heuncli.kernel.chosen cimport chosen_width
from heuncli.kernel.dense cimport Branch, Collocation, Course, Factors, Method, Newton, Run, clipped
from heuncli.kernel.events cimport PARTS, take_branches, watch_afresh
from heuncli.kernel.expressions cimport FREE, HELD
from heuncli.kernel.following cimport stand_here
from heuncli.kernel.memory cimport Memory
from heuncli.kernel.response cimport evaluate
from heuncli.kernel.scene cimport Body, Freedom, Group, SHIFT, Scene
from heuncli.kernel.steps cimport run_steps, take_record
from heuncli.kernel.workspace cimport Workspace

cdef class Integration:
    cdef Run run
    cdef Method method
    cdef Workspace workspace
    cdef dict output
    cdef Memory memory
    cpdef object take_method(self, dict method)
    cpdef object take_start(self, dict start)
    cpdef object make_chart(self, int n)
    cpdef object make_room(self)
    cpdef object make_branch(self)
    cpdef object make_newton(self, dict method)
    cpdef object take_output(self, dict output)
