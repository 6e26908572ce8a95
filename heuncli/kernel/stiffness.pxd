"""Signatures of stiffness.py for C."""

from heuncli.kernel.dense cimport Method, Run
from heuncli.kernel.scene cimport Group
from libc.math cimport sqrt

cdef void estimate_swiftness(Method *method, Run *run) noexcept nogil
cdef bint is_held_short(Run *run) noexcept nogil
