# Made of integration.py by headers.py.

from heuncli.kernel.chosen cimport chosen_width
from heuncli.kernel.dense cimport clipped
from heuncli.kernel.events cimport PARTS, take_branches, watch_afresh
from heuncli.kernel.expressions cimport FREE, HELD
from heuncli.kernel.following cimport stand_here
from heuncli.kernel.memory cimport Memory
from heuncli.kernel.response cimport evaluate
from heuncli.kernel.scene cimport SHIFT, Body, Freedom, Group, Scene
from heuncli.kernel.stepping cimport Branch, Collocation, Course, Method, Newton, Run
from heuncli.kernel.steps cimport run_steps, take_record
from heuncli.kernel.workspace cimport Workspace

cdef class Integration:
    cdef Workspace workspace
    cdef dict output
    cdef Memory memory
    cdef Run run
    cdef Method method
