# Made of expressions.py by headers.py.

from heuncli.kernel.programs cimport Bounds, Instruction, Jet, Program, Programs, Span, Table
from libc.math cimport NAN, acos, asin, atan, atan2, cos, cosh, exp, fabs, floor, log, pow, sin, sinh, sqrt, tan, tanh

cdef enum:
    CONST = 0, VAR = 1
    ADD = 2, SUB = 3, MUL = 4, DIV = 5, POW = 6, ATAN2 = 7, HYPOT = 8, MIN = 9, MAX = 10
    NEG = 11, POWER = 12, ABS = 13, SIGN = 14, STEP = 15
    SIN = 16, COS = 17, TAN = 18, ASIN = 19, ACOS = 20, ATAN = 21
    SINH = 22, COSH = 23, TANH = 24, EXP = 25, LOG = 26, SQRT = 27
    TABLE = 28, KNOT = 29, JUMP = 30, UNLESS = 31
    LT = 32, LE = 33, GT = 34, GE = 35, EQ = 36, NE = 37
    HOLD = 38, INTEGRAL = 39
    NODES = 8
    FREE = 0, HELD = 1, TAKEN = 2
    REFUSED = 0, EXTENDED = 1, PERIODIC = 2

cdef double value(Programs *programs, Program program) noexcept nogil
cdef double of_two(int op, double a, double b) noexcept nogil
cdef double compare(int op, double a, double b) noexcept nogil
cdef double of_one(int op, double a, int n) noexcept nogil
cdef double piecewise(int op, double a, int n) noexcept nogil
cdef double trigonometric(int op, double a) noexcept nogil
cdef double exponential(int op, double a) noexcept nogil
cdef double power(double x, int n) noexcept nogil
cdef double real_power(double x, double y) noexcept nogil
cdef double length(double a, double b) noexcept nogil
cdef double without_branches(Programs *programs, Program program) noexcept nogil
cdef int takes_two(int op) noexcept nogil
cdef void take_branch(Programs *programs, int k, Py_ssize_t at, double a, double b) noexcept nogil
cdef double on_branch(Programs *programs, Py_ssize_t at, double branch, double a, double b) noexcept nogil
cdef double angle_on(double branch, double y, double x) noexcept nogil
cdef double side_of_cut(double y) noexcept nogil
cdef Table table_at(Programs *programs, Py_ssize_t at, Py_ssize_t k) noexcept nogil
cdef double of_table(int op, double *c, Table table, double x) noexcept nogil
cdef double in_range(double *c, Table table, double x) noexcept nogil
cdef int piece(double *c, Table table, double x) noexcept nogil
cdef double piece_counted(double *c, Table table, double x) noexcept nogil
cdef double of_piece(double *c, Table table, double counted, double x) noexcept nogil
cdef Program integrated(Programs *programs, Py_ssize_t at) noexcept nogil
cdef Table summed_at(Programs *programs, Py_ssize_t at, Py_ssize_t k) noexcept nogil
cdef double integral(Programs *programs, Py_ssize_t at, Py_ssize_t k, double t) noexcept nogil
cdef size_t where(object memory)

cdef class Expressions:
    cdef dict counts
    cdef Py_ssize_t variables
    cdef Py_ssize_t held
    cdef Programs programs
    cdef tuple memory
