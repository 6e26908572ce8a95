"""Dense linear equations, real and complex: A = P' L U by rows, with the largest entry of each column as its pivot.

Matrices are flat by rows, n numbers each; complex ones are two, for real and imaginary parts. Zero entries are skipped:
coordinates depend on few others. Golub, Van Loan, Matrix Computations (2013), 3.4.
"""

from __future__ import annotations

from math import fabs

from heuncli.kernel.declarations import *

# Real


def factor_real(A: cython.p_double, n: cython.int, pivots: cython.p_int) -> cython.bint:
    """Factor A in place into L (its diagonal 1) and U, U's diagonal inverted, and store which row each pivot came from.

    Returns False if A is singular or contains NaN.
    """
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    factor: cython.double
    for k in range(n):
        i = find_real_pivot(A, n, k)
        pivots[k] = i
        exchange_rows(A, n, i, k)
        if not fabs(A[n * k + k]) > 0.0:
            return False
        A[n * k + k] = 1.0 / A[n * k + k]
        for i in range(k + 1, n):
            factor = A[n * i + k]
            if factor != 0.0:
                factor = factor * A[n * k + k]
                A[n * i + k] = factor
                for j in range(k + 1, n):
                    A[n * i + j] = A[n * i + j] - factor * A[n * k + j]
    return True


def find_real_pivot(A: cython.p_double, n: cython.int, k: cython.int) -> cython.int:
    """Return the row from k on with the largest entry in column k."""
    i: cython.int
    pivot_row: cython.int = k
    for i in range(k + 1, n):
        if fabs(A[n * i + k]) > fabs(A[n * pivot_row + k]):
            pivot_row = i
    return pivot_row


def exchange_rows(A: cython.p_double, n: cython.int, i: cython.int, k: cython.int) -> cython.void:
    """Exchange rows i and k of A."""
    j: cython.Py_ssize_t
    entry: cython.double
    if i != k:
        for j in range(n):
            entry = A[n * k + j]
            A[n * k + j] = A[n * i + j]
            A[n * i + j] = entry


def solve_real(A: cython.p_double, n: cython.int, pivots: cython.p_int, x: cython.p_double) -> cython.void:
    """x <- A^-1 x, by the factors."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    u: cython.double
    permute_vector(x, pivots, n)
    for i in range(1, n):
        u = x[i]
        for j in range(i):
            u -= A[n * i + j] * x[j]
        x[i] = u
    for i in range(n - 1, -1, -1):
        u = x[i]
        for j in range(i + 1, n):
            u -= A[n * i + j] * x[j]
        x[i] = u * A[n * i + i]


def permute_vector(x: cython.p_double, pivots: cython.p_int, n: cython.int) -> cython.void:
    """Permute a right-hand side as the rows were exchanged."""
    k: cython.Py_ssize_t
    entry: cython.double
    for k in range(n):
        entry = x[k]
        x[k] = x[pivots[k]]
        x[pivots[k]] = entry


# Complex


def factor_complex(A: cython.p_double, B: cython.p_double, n: cython.int, pivots: cython.p_int) -> cython.bint:
    """Factor A + i B in place into L and U, as `factor_real` does."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    k: cython.Py_ssize_t
    a: cython.double
    b: cython.double
    u: cython.double
    v: cython.double
    square: cython.double
    for k in range(n):
        i = find_complex_pivot(A, B, n, k)
        pivots[k] = i
        exchange_rows(A, n, i, k)
        exchange_rows(B, n, i, k)
        a = A[n * k + k]
        b = B[n * k + k]
        square = a * a + b * b
        if not square > 0.0:
            return False
        u = a / square
        v = -b / square
        A[n * k + k] = u
        B[n * k + k] = v
        for i in range(k + 1, n):
            if A[n * i + k] != 0.0 or B[n * i + k] != 0.0:
                a = A[n * i + k] * u - B[n * i + k] * v
                b = A[n * i + k] * v + B[n * i + k] * u
                A[n * i + k] = a
                B[n * i + k] = b
                for j in range(k + 1, n):
                    A[n * i + j] = A[n * i + j] - (a * A[n * k + j] - b * B[n * k + j])
                    B[n * i + j] = B[n * i + j] - (a * B[n * k + j] + b * A[n * k + j])
    return True


def find_complex_pivot(A: cython.p_double, B: cython.p_double, n: cython.int, k: cython.int) -> cython.int:
    """Return the row from k on with the largest entry in column k, by the sum of its parts' magnitudes."""
    i: cython.int
    pivot_row: cython.int = k
    for i in range(k + 1, n):
        if fabs(A[n * i + k]) + fabs(B[n * i + k]) > fabs(A[n * pivot_row + k]) + fabs(B[n * pivot_row + k]):
            pivot_row = i
    return pivot_row


def solve_complex(
    A: cython.p_double,
    B: cython.p_double,
    n: cython.int,
    pivots: cython.p_int,
    x: cython.p_double,
    y: cython.p_double,
) -> cython.void:
    """x + i y <- (A + i B)^-1 (x + i y), by the factors."""
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    u: cython.double
    v: cython.double
    permute_vector(x, pivots, n)
    permute_vector(y, pivots, n)
    for i in range(1, n):
        u = x[i]
        v = y[i]
        for j in range(i):
            u -= A[n * i + j] * x[j] - B[n * i + j] * y[j]
            v -= A[n * i + j] * y[j] + B[n * i + j] * x[j]
        x[i] = u
        y[i] = v
    for i in range(n - 1, -1, -1):
        u = x[i]
        v = y[i]
        for j in range(i + 1, n):
            u -= A[n * i + j] * x[j] - B[n * i + j] * y[j]
            v -= A[n * i + j] * y[j] + B[n * i + j] * x[j]
        x[i] = u * A[n * i + i] - v * B[n * i + i]
        y[i] = u * B[n * i + i] + v * A[n * i + i]
