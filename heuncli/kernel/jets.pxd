# Made of jets.py by headers.py.

from heuncli.kernel.expressions cimport ABS, ADD, ASIN, ATAN, ATAN2, CONST, COS, COSH, DIV, EXP, EXTENDED, FREE, HELD, HOLD, HYPOT, INTEGRAL, JUMP, KNOT, LOG, LT, MAX, MIN, MUL, NEG, PERIODIC, POW, POWER, SIN, SINH, SQRT, STEP, SUB, TABLE, TAN, TANH, UNLESS, VAR, Expressions, compare, exponential, in_range, integral, integrated, length, on_branch, piece, piece_counted, piecewise, power, real_power, table_at, takes_two, trigonometric, where
from heuncli.kernel.programs cimport Jet, Program, Programs, Table
from libc.math cimport NAN, atan2, cos, cosh, floor, log, sin, sinh, sqrt

cdef Jet jet(Programs *programs, Program program, double t) noexcept nogil
cdef double slope(Programs *programs, Program program, double *slopes) noexcept nogil
cdef Jet jet_along(Programs *programs, Program program, double t, double *slopes) noexcept nogil
cdef Jet moving(Programs *programs, int k, double t, double *slopes) noexcept nogil
cdef Jet jet_of_integral(Programs *programs, Py_ssize_t at, int k, Jet t) noexcept nogil
cdef Jet jet_held(Programs *programs, Py_ssize_t at, int k, Py_ssize_t height, Jet b) noexcept nogil
cdef Jet jet_on_branch(Programs *programs, Py_ssize_t at, double branch, Jet a, Jet b) noexcept nogil
cdef double slope_of_piece(double *c, Table table, double counted, double x) noexcept nogil
cdef Jet constant(double f) noexcept nogil
cdef Jet chain(Jet u, double f, double df, double ddf) noexcept nogil
cdef Jet jet_of_two(int op, Jet a, Jet b) noexcept nogil
cdef Jet jet_of_product(Jet a, Jet b) noexcept nogil
cdef Jet jet_of_quotient(Jet a, Jet b) noexcept nogil
cdef Jet jet_of_power(Jet a, Jet b) noexcept nogil
cdef double scaled_power(double c, double x, double y) noexcept nogil
cdef Jet jet_of_angle(Jet a, Jet b) noexcept nogil
cdef Jet jet_of_length(Jet a, Jet b) noexcept nogil
cdef Jet jet_of_one(int op, Jet u, int n) noexcept nogil
cdef Jet jet_of_piecewise(int op, Jet u, int n) noexcept nogil
cdef Jet jet_of_trigonometric(int op, Jet u) noexcept nogil
cdef Jet jet_of_exponential(int op, Jet u) noexcept nogil
cdef Jet jet_of_table(int op, double *c, Table table, Jet u) noexcept nogil
