"""Signatures of slopes.py for C."""

from heuncli.kernel.expressions cimport (
    ABS, ATAN2, CONST, Expressions, FREE, HELD, HOLD, INTEGRAL, JUMP, Jet, KNOT, LT, MAX, MIN, PERIODIC, Program, Programs, SQRT,
    TABLE, Table, UNLESS, VAR, chain, compare, constant, integral, integrated, jet_of_angle, jet_of_one, jet_of_table,
    jet_of_two, on_branch, table_at, takes_two, value,
)
from heuncli.kernel.memory cimport Memory
from libc.math cimport NAN, floor

cdef double slope(Programs *programs, Program program, double *slopes) noexcept nogil
cdef Jet jet_along(Programs *programs, Program program, double *slopes) noexcept nogil
cdef Jet jet_on_branch(Programs *programs, Py_ssize_t at, double branch, Jet a, Jet b) noexcept nogil
cdef double slope_of_piece(double *c, Table table, double counted, double x) noexcept nogil
