"""Polynomials in Bernstein's form on [0, 1]: sum_k b_k C(n, k) x^k (1 - x)^(n - k) lies between the least and most b_k.

Farouki, Rajan, On the numerical condition of polynomials in Bernstein form (1987).
"""

from __future__ import annotations

from heuncli.kernel.declarations import *

# The coefficients of a parabola: the values at its ends, and the place where the tangents there meet.
PARABOLA_START, PARABOLA_MIDDLE, PARABOLA_END = range(3)


def multiply_by_x(b: cython.p_double, n: cython.int) -> cython.void:
    """Multiply a polynomial of degree n by x; the result has degree n + 1."""
    k: cython.int
    for k in range(n + 1, 0, -1):
        b[k] = b[k - 1] * k / (n + 1)
    b[0] = 0.0


def multiply_by_one_minus_x(b: cython.p_double, n: cython.int) -> cython.void:
    """Multiply a polynomial of degree n by 1 - x; the result has degree n + 1."""
    k: cython.int
    for k in range(n + 1):
        b[k] = b[k] * (n + 1 - k) / (n + 1)
    b[n + 1] = 0.0


def differentiate(value: cython.p_double, rate: cython.p_double, n: cython.int, duration: cython.double) -> cython.void:
    """Find the time derivative of a polynomial of degree n over an interval of some duration [s]."""
    k: cython.int
    for k in range(n):
        rate[k] = n * (value[k + 1] - value[k]) / duration


def bound_polynomial(
    b: cython.p_double, n: cython.int, x0: cython.double, x1: cython.double, work: cython.p_double
) -> Bounds:
    """Bound a polynomial of degree n between x0 and x1 by its coefficients over that part (de Casteljau)."""
    i: cython.int
    k: cython.int
    x: cython.double
    bounds: Bounds
    for k in range(n + 1):
        work[k] = b[k]
    for i in range(1, n + 1):  # its right part, from x0
        for k in range(n + 1 - i):
            work[k] = work[k] + x0 * (work[k + 1] - work[k])
    if x1 > x0:
        x = (x1 - x0) / (1.0 - x0) if x0 < 1.0 else 0.0
        for i in range(1, n + 1):  # the left part of that
            for k in range(n, i - 1, -1):
                work[k] = work[k - 1] + x * (work[k] - work[k - 1])
    bounds = Bounds(work[0], work[0])
    if x1 > x0:
        for k in range(1, n + 1):
            if work[k] < bounds.low:
                bounds.low = work[k]
            if work[k] > bounds.high:
                bounds.high = work[k]
    return bounds


def convert_rows(
    y: cython.double, dense: cython.pp_double, rows: cython.int, column: cython.Py_ssize_t, b: cython.p_double
) -> cython.void:
    """Convert one column of an interpolating polynomial's rows, y + x (F0 + (1 - x) (F1 + x (F2 + ...))), to Bernstein
    form.
    """
    k: cython.int
    i: cython.int
    n: cython.int = 0
    b[0] = 0.0
    for k in range(rows - 1, -1, -1):
        for i in range(n + 1):
            b[i] = b[i] + dense[k][column]
        if k % 2 == 0:
            multiply_by_x(b, n)
        else:
            multiply_by_one_minus_x(b, n)
        n += 1
    for i in range(n + 1):
        b[i] = y + b[i]
