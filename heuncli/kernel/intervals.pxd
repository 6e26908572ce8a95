# Made of intervals.py by headers.py.

from heuncli.kernel.expressions cimport length
from heuncli.kernel.programs cimport Bounds
from libc.math cimport INFINITY, NAN, acos, asin, atan, atan2, cos, cosh, exp, fabs, floor, log, pow, sin, sinh, sqrt, tan, tanh

cdef double down(double x) noexcept nogil
cdef double up(double x) noexcept nogil
cdef double sum_below(double a, double b) noexcept nogil
cdef double sum_above(double a, double b) noexcept nogil
cdef double product_error(double a, double b, double p) noexcept nogil
cdef double product_below(double a, double b) noexcept nogil
cdef double product_above(double a, double b) noexcept nogil
cdef double quotient_below(double a, double b) noexcept nogil
cdef double quotient_above(double a, double b) noexcept nogil
cdef double less(double f) noexcept nogil
cdef double more(double f) noexcept nogil
cdef Bounds point(double x) noexcept nogil
cdef Bounds anything() noexcept nogil
cdef Bounds nothing() noexcept nogil
cdef bint is_nothing(Bounds a) noexcept nogil
cdef bint is_zero(Bounds a) noexcept nogil
cdef Bounds hull(Bounds a, Bounds b) noexcept nogil
cdef Bounds meet(Bounds a, Bounds b) noexcept nogil
cdef Bounds negative(Bounds a) noexcept nogil
cdef Bounds magnitude(Bounds a) noexcept nogil
cdef Bounds plus(Bounds a, Bounds b) noexcept nogil
cdef Bounds minus(Bounds a, Bounds b) noexcept nogil
cdef Bounds times(Bounds a, Bounds b) noexcept nogil
cdef Bounds outward(double low, double high) noexcept nogil
cdef Bounds exact_times(Bounds a, Bounds b) noexcept nogil
cdef Bounds scaled(double s, Bounds a) noexcept nogil
cdef Bounds squared(Bounds a) noexcept nogil
cdef Bounds over(Bounds a, Bounds b) noexcept nogil
cdef double power_below(double x, int n) noexcept nogil
cdef double power_above(double x, int n) noexcept nogil
cdef Bounds to_whole(Bounds a, int n) noexcept nogil
cdef Bounds to_number(Bounds a, double n) noexcept nogil
cdef double power_over(double x, double n) noexcept nogil
cdef Bounds to_power(Bounds a, Bounds b) noexcept nogil
cdef Bounds root(Bounds a) noexcept nogil
cdef double root_of(double x, int upward) noexcept nogil
cdef bint comes_to(Bounds a, double phase, double period) noexcept nogil
cdef Bounds within_one(Bounds a) noexcept nogil
cdef Bounds sine(Bounds a) noexcept nogil
cdef Bounds cosine(Bounds a) noexcept nogil
cdef Bounds tangent(Bounds a) noexcept nogil
cdef Bounds arcsine(Bounds a) noexcept nogil
cdef Bounds arccosine(Bounds a) noexcept nogil
cdef Bounds arctangent(Bounds a) noexcept nogil
cdef bint off_the_cut(Bounds y, Bounds x) noexcept nogil
cdef Bounds angle(Bounds y, Bounds x) noexcept nogil
cdef Bounds distance(Bounds a, Bounds b) noexcept nogil
cdef Bounds hyperbolic_sine(Bounds a) noexcept nogil
cdef Bounds hyperbolic_cosine(Bounds a) noexcept nogil
cdef Bounds hyperbolic_tangent(Bounds a) noexcept nogil
cdef Bounds exponential_of(Bounds a) noexcept nogil
cdef Bounds logarithm(Bounds a) noexcept nogil
