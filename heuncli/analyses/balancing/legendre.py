"""Polynomials on [-1, 1] by the values at Gauss's nodes: coefficients, integrals, Fourier's integrals.

    f = sum c_n P_n,   c_n = (2n + 1)/2 sum w_j P_n(u_j) f_j,   ∫ P_n e^{-iωu} du = 2 (-i)^n j_n(ω)
j_n: spherical Bessel functions, upwards where ω is larger than n, else downwards (Miller).
"""

from __future__ import annotations

from functools import cache

import numpy as np

from heuncli.results.results import Array

MOST = 16  # nodes; polynomials have as many coefficients
SMALL = 1e-5  # below, j_n is its series of two terms: the third is 1e-21; Miller's recurrence would grow too far
NEWTON = 2  # steps from eigenvalues of Jacobi's matrix to the last digit of a node
LEAST = 1e-150  # with which it begins
BEYOND = 24  # orders above the last from which Miller's recurrence comes down


@cache
def nodes(n: int) -> tuple[Array, Array]:
    """Gauss's nodes and weights on [-1, 1], (n,) each; the weights add up to 2."""
    k = np.arange(1.0, n)
    beside = np.diag(k / np.sqrt(4.0 * k * k - 1.0), 1)
    u = np.linalg.eigvalsh(beside + beside.T)
    u = 0.5 * (u - u[::-1])
    for _ in range(NEWTON):
        own = polynomials(u, n + 1)
        slope = n * (own[:, n - 1] - u * own[:, n]) / (1.0 - u * u)
        u = u - own[:, n] / slope
    own = polynomials(u, n + 1)
    slope = n * (own[:, n - 1] - u * own[:, n]) / (1.0 - u * u)
    return u, 2.0 / ((1.0 - u * u) * slope * slope)


@cache
def transform(n: int) -> Array:
    """The matrix (MOST, n) from values at n nodes to coefficients; those from n on are 0."""
    u, w = nodes(n)
    found = np.zeros((MOST, n))
    k = np.arange(n)
    found[:n] = (k + 0.5)[:, None] * polynomials(u).T[:n] * w
    return found


def polynomials(u: Array, count: int = MOST) -> Array:
    """P_0 ... P_(count - 1) at places (m,), (m, count)."""
    found = np.ones((len(u), count))
    if count > 1:
        found[:, 1] = u
    for n in range(1, count - 1):
        found[:, n + 1] = ((2 * n + 1) * u * found[:, n] - n * found[:, n - 1]) / (n + 1)
    return found


@cache
def integral_matrix() -> Array:
    """The matrix (MOST + 1, MOST) from coefficients to those of the integral from -1 on."""
    found = np.zeros((MOST + 1, MOST))
    found[0, 0] = found[1, 0] = 1.0
    for n in range(1, MOST):
        found[n + 1, n], found[n - 1, n] = 1.0 / (2 * n + 1), -1.0 / (2 * n + 1)
    return found


def fourier_integrals(omega: Array) -> Array:
    """∫ P_n e^{-iωu} du over [-1, 1] at ω >= 0 (m,), complex (m, MOST)."""
    return np.asarray(2.0 * spherical_bessel(omega) * (-1j) ** np.arange(MOST))


def spherical_bessel(x: Array) -> Array:
    """j_0 ... j_(MOST - 1) at x >= 0 (m,), (m, MOST)."""
    found = np.zeros((len(x), MOST))
    small, large = x < SMALL, x > MOST
    middle = ~small & ~large
    found[small], found[middle], found[large] = series(x[small]), downwards(x[middle]), upwards(x[large])
    return found


def series(x: Array) -> Array:
    """j_n by the first two terms of its power series, (m, MOST)."""
    found = np.zeros((len(x), MOST))
    power = np.ones_like(x)
    for n in range(MOST):
        found[:, n] = power * (1.0 - 0.5 * x * x / (2 * n + 3))
        power = power * x / (2 * n + 3)
    return found


def upwards(x: Array) -> Array:
    """j_n by the recurrence from j_0 and j_1 on, (m, MOST): x is to be above n."""
    found = np.zeros((len(x), MOST))
    sine, cosine = np.sin(x), np.cos(x)
    found[:, 0] = sine / x
    found[:, 1] = (found[:, 0] - cosine) / x
    for n in range(1, MOST - 1):
        found[:, n + 1] = (2 * n + 1) / x * found[:, n] - found[:, n - 1]
    return found


def downwards(x: Array) -> Array:
    """j_n by the recurrence from far above down, scaled to the larger of j_0 and j_1, (m, MOST)."""
    found = np.zeros((len(x), MOST))
    above, here, part = np.zeros_like(x), np.full_like(x, LEAST), 1.0 / x
    for n in range(MOST + BEYOND, 0, -1):
        above, here = here, (2 * n + 1) * part * here - above
        if n <= MOST:
            found[:, n - 1] = here
    first = np.sin(x) / x
    second = (first - np.cos(x)) / x
    larger = np.abs(first) > np.abs(second)
    scale = np.where(larger, first, second) / np.where(larger, found[:, 0], found[:, 1])
    return np.asarray(found * scale[:, None])
