# Made of enclosure.py by headers.py.

from heuncli.kernel.expressions cimport ABS, ADD, ASIN, ATAN, ATAN2, CONST, COS, COSH, DIV, EQ, EXP, EXTENDED, GE, GT, HELD, HOLD, HYPOT, INTEGRAL, JUMP, KNOT, LE, LOG, LT, MAX, MIN, MUL, NE, NEG, PERIODIC, POW, POWER, SIGN, SIN, SINH, SQRT, STEP, SUB, TABLE, TAN, TANH, UNLESS, VAR, Expressions, angle_on, integral, integrated, piece, piece_counted, side_of_cut, summed_at, table_at, takes_two
from heuncli.kernel.intervals cimport angle, anything, arccosine, arcsine, arctangent, cosine, distance, exact_times, exponential_of, hull, hyperbolic_cosine, hyperbolic_sine, hyperbolic_tangent, is_nothing, is_zero, less, logarithm, magnitude, meet, minus, more, negative, nothing, off_the_cut, over, plus, point, root, scaled, sine, squared, tangent, times, to_number, to_power, to_whole
from heuncli.kernel.programs cimport Bounds, Program, Programs, Span, Table
from libc.math cimport INFINITY, fabs, floor, sqrt

cdef Span enclose(Programs *programs, Program program) noexcept nogil
cdef Span enclose_closely(Programs *programs, Program program) noexcept nogil
cdef Bounds closer(Bounds a, Bounds b) noexcept nogil
cdef Span run_on(Programs *programs, Span *ranges, Program program, int height, Span x) noexcept nogil
cdef Span still(Bounds a) noexcept nogil
cdef Span loose(Bounds a) noexcept nogil
cdef Span no_span() noexcept nogil
cdef bint stands_still(Span u) noexcept nogil
cdef Bounds known(Bounds a) noexcept nogil
cdef Span chained(Span u, Bounds f, Bounds df, Bounds ddf) noexcept nogil
cdef Span either(Span a, Span b) noexcept nogil
cdef int compared(int op, Bounds a, Bounds b) noexcept nogil
cdef Span truth(int holds) noexcept nogil
cdef Span span_of_two(int op, Span a, Span b) noexcept nogil
cdef Span span_of_product(Span a, Span b) noexcept nogil
cdef Span span_of_quotient(Span a, Span b) noexcept nogil
cdef Span span_of_power(Span a, Span b) noexcept nogil
cdef Span span_of_angle(Bounds value, Span y, Span x) noexcept nogil
cdef Span span_of_distance(Span a, Span b) noexcept nogil
cdef Span span_of_chosen(int op, Span a, Span b) noexcept nogil
cdef int second_is_taken(int op, Bounds a, Bounds b) noexcept nogil
cdef Span span_of_one(int op, Span u, int n) noexcept nogil
cdef Span span_of_piecewise(int op, Span u, int n) noexcept nogil
cdef Span turned(Span u) noexcept nogil
cdef Span span_of_circular(int op, Span u) noexcept nogil
cdef Span span_of_exponential(int op, Span u) noexcept nogil
cdef Span span_of_table(int op, double *c, Table table, Span u) noexcept nogil
cdef Span beyond_table(double *c, Table table, bint before) noexcept nogil
cdef Span pieces_in_turn(double *c, Table table, Bounds a) noexcept nogil
cdef Span pieces_met(double *c, Table table, Bounds inside, int begin, int end) noexcept nogil
cdef Span joined(Span a, Span b) noexcept nogil
cdef Span bent(Span pieces) noexcept nogil
cdef Span cubic(double *c, Py_ssize_t i, Bounds h) noexcept nogil
cdef Bounds cubic_at(double *c, Py_ssize_t i, double h) noexcept nogil
cdef Bounds slope_at(double *c, Py_ssize_t i, double h) noexcept nogil
cdef Bounds with_extreme(Bounds value, double *c, Py_ssize_t i, Bounds h, double x) noexcept nogil
cdef Bounds widened(Bounds a, double size) noexcept nogil
cdef Span span_of_integral(Programs *programs, Span *ranges, Py_ssize_t at, int k) noexcept nogil
cdef Bounds integral_at(Programs *programs, Span *ranges, Py_ssize_t at, int k, double t) noexcept nogil
cdef Span span_on_branch(Programs *programs, int k, Py_ssize_t at, Span a, Span b) noexcept nogil
cdef bint may_change(Programs *programs, Py_ssize_t at, double branch, Bounds a, Bounds b) noexcept nogil
cdef Span angle_above(Span y, Span x) noexcept nogil
cdef Span span_of_piece(double *c, Table table, double counted, Span u) noexcept nogil
cdef object set_ranges(Expressions expressions, Py_ssize_t start, Py_ssize_t count, Span *into, object ranges)
cdef tuple numbers_of(Span u)
