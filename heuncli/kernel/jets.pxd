"""Signatures of jets.py for C."""

from heuncli.kernel.expressions cimport (
    ABS, ADD, ASIN, ATAN, ATAN2, CONST, COS, COSH, DIV, EXP, EXTENDED, FREE, HELD, HOLD, HYPOT, INTEGRAL, JUMP, KNOT, LOG,
    LT, MAX, MIN, MUL, NEG, PERIODIC, POW, POWER, SIN, SINH, SQRT, STEP, SUB, TABLE, TAN, TANH, UNLESS, VAR, Expressions,
    Jet, Program, Programs, Table, compare, exponential, in_range, integral, integrated, length, on_branch, piece,
    piece_counted, piecewise, power, real_power, table_at, takes_two, trigonometric, where,
)
from libc.math cimport NAN, atan2, cos, cosh, floor, log, sin, sinh, sqrt

cdef Jet jet(Programs *programs, Program program, double t) noexcept nogil
cdef double slope(Programs *programs, Program program, double *slopes) noexcept nogil
