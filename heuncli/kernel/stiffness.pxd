# Made of stiffness.py by headers.py.

from heuncli.kernel.scene cimport Group
from heuncli.kernel.stepping cimport Method, Run
from libc.math cimport sqrt

cdef void estimate_swiftness(Method *method, Run *run) noexcept nogil
cdef bint is_held_short(Run *run) noexcept nogil
