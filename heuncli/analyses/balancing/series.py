"""Series of a quantity over a cycle: Legendre polynomials on pieces, and its orders (Fourier).

f = sum c_n P_n,   c_n = (2n + 1)/2 sum w_j P_n(u_j) f_j,   ∫ P_n e^{-iωu} du = 2 (-i)^n j_n(ω)
j_n: spherical Bessel functions, by upward recurrence where ω is larger than n, else by downward recurrence (Miller).

Over one turn the orders are 1, 2, ...; over two also the half orders. In a plane every order is two rotating vectors:
    Z = F_1 + i F_2 = sum (P_k e^{ikφ} + N_k e^{-ikφ}),     P_k = ½ (a_1 + i a_2),   N_k = ½ (a_1* + i a_2*)
with F_j = Re sum a_j e^{ikφ}: |P_k| turns with the angle and can be cancelled by a weight on a shaft; |N_k| turns
against it.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

MAX_NODES = 16  # nodes; polynomials have as many coefficients
SMALL = 1e-5  # below, j_n is its series of two terms: the third is 1e-21; Miller's recurrence would grow too far
NEWTON_STEPS = 2  # steps from eigenvalues of Jacobi's matrix to the last digit of a node
MILLER_START = 1e-150  # with which it begins
MILLER_EXTRA_ORDERS = 24  # orders above the last from which Miller's recurrence comes down


@cache
def compute_gauss_nodes(n: int) -> tuple[Array, Array]:
    """Return the Gauss nodes and weights on [-1, 1], (n,) each; the weights add up to 2."""
    k = np.arange(1.0, n)
    off_diagonal = np.diag(k / np.sqrt(4.0 * k * k - 1.0), 1)
    u = np.linalg.eigvalsh(off_diagonal + off_diagonal.T)
    u = 0.5 * (u - u[::-1])
    for _ in range(NEWTON_STEPS):
        P = evaluate_legendre(u, n + 1)
        slope = n * (P[:, n - 1] - u * P[:, n]) / (1.0 - u * u)
        u = u - P[:, n] / slope
    P = evaluate_legendre(u, n + 1)
    slope = n * (P[:, n - 1] - u * P[:, n]) / (1.0 - u * u)
    return u, 2.0 / ((1.0 - u * u) * slope * slope)


@cache
def compute_coefficient_matrix(n: int) -> Array:
    """Return the matrix (MAX_NODES, n) from values at n nodes to coefficients; rows from n on are 0."""
    u, w = compute_gauss_nodes(n)
    found = np.zeros((MAX_NODES, n))
    k = np.arange(n)
    found[:n] = (k + 0.5)[:, None] * evaluate_legendre(u).T[:n] * w
    return found


def evaluate_legendre(u: Array, count: int = MAX_NODES) -> Array:
    """Return P_0 ... P_(count - 1) at places (m,), (m, count)."""
    found = np.ones((len(u), count))
    if count > 1:
        found[:, 1] = u
    for n in range(1, count - 1):
        found[:, n + 1] = ((2 * n + 1) * u * found[:, n] - n * found[:, n - 1]) / (n + 1)
    return found


@cache
def compute_integral_matrix() -> Array:
    """Return the matrix (MAX_NODES + 1, MAX_NODES) from coefficients to those of the integral from -1 on."""
    found = np.zeros((MAX_NODES + 1, MAX_NODES))
    found[0, 0] = found[1, 0] = 1.0
    for n in range(1, MAX_NODES):
        found[n + 1, n], found[n - 1, n] = 1.0 / (2 * n + 1), -1.0 / (2 * n + 1)
    return found


def compute_fourier_integrals(omega: Array) -> Array:
    """Return ∫ P_n e^{-iωu} du over [-1, 1] at ω >= 0 (m,), complex (m, MAX_NODES)."""
    return np.asarray(2.0 * evaluate_bessel(omega) * (-1j) ** np.arange(MAX_NODES))


def evaluate_bessel(x: Array) -> Array:
    """Return j_0 ... j_(MAX_NODES - 1) at x >= 0 (m,), (m, MAX_NODES)."""
    found = np.zeros((len(x), MAX_NODES))
    small, large = x < SMALL, x > MAX_NODES
    middle = ~small & ~large
    found[small], found[middle], found[large] = (
        evaluate_bessel_series(x[small]),
        evaluate_bessel_downward(x[middle]),
        evaluate_bessel_upward(x[large]),
    )
    return found


def evaluate_bessel_series(x: Array) -> Array:
    """Return j_n from the first two terms of its power series, (m, MAX_NODES)."""
    found = np.zeros((len(x), MAX_NODES))
    power = np.ones_like(x)
    for n in range(MAX_NODES):
        found[:, n] = power * (1.0 - 0.5 * x * x / (2 * n + 3))
        power = power * x / (2 * n + 3)
    return found


def evaluate_bessel_upward(x: Array) -> Array:
    """Return j_n by upward recurrence from j_0 and j_1, (m, MAX_NODES); x must exceed n."""
    found = np.zeros((len(x), MAX_NODES))
    sine, cosine = np.sin(x), np.cos(x)
    found[:, 0] = sine / x
    found[:, 1] = (found[:, 0] - cosine) / x
    for n in range(1, MAX_NODES - 1):
        found[:, n + 1] = (2 * n + 1) / x * found[:, n] - found[:, n - 1]
    return found


def evaluate_bessel_downward(x: Array) -> Array:
    """Return j_n by downward recurrence, scaled to the larger of j_0 and j_1, (m, MAX_NODES)."""
    found = np.zeros((len(x), MAX_NODES))
    above, here, part = np.zeros_like(x), np.full_like(x, MILLER_START), 1.0 / x
    for n in range(MAX_NODES + MILLER_EXTRA_ORDERS, 0, -1):
        above, here = here, (2 * n + 1) * part * here - above
        if n <= MAX_NODES:
            found[:, n - 1] = here
    first = np.sin(x) / x
    second = (first - np.cos(x)) / x
    larger = np.abs(first) > np.abs(second)
    scale = np.where(larger, first, second) / np.where(larger, found[:, 0], found[:, 1])
    return np.asarray(found * scale[:, None])


AXES = np.eye(3)


def compute_relative_tail(values: Array, quarter: int, terms: float) -> float:
    """Return the size of the highest orders of values (n, ...) relative to the largest order except the mean; 0 if they
    are rounding.

    terms: size of the terms whose sums the values are
    """
    n = len(values)
    sizes = np.abs(np.fft.rfft(values, axis=0)).reshape(n // 2 + 1, -1)[1:].max(axis=1) * 2.0 / n
    highest = float(sizes[len(sizes) - len(sizes) // quarter :].max())
    return highest / float(sizes.max()) if highest > tolerances.SUM_ROUNDING * terms else 0.0


def make_plane_directions(axis: Array) -> tuple[Array, Array]:
    """Return two directions (3,) that form a right-handed system with the axis: projections of the two world axes that
    follow the one nearest to it.
    """
    k = int(np.argmax(np.round(np.abs(axis), 9)))
    first = AXES[(k + 1) % 3] - (AXES[(k + 1) % 3] @ axis) * axis
    first /= np.sqrt(first @ first)
    return first, np.cross(axis, first)


def compute_rotating_vectors(amplitudes: Array, axis: Array) -> tuple[Array, Array]:
    """Return P and N, complex (m,), of vector amplitudes (m, 3) across an axis: the parts that turn with and against
    the angle.
    """
    first_direction, second_direction = make_plane_directions(axis)
    a, b = amplitudes @ first_direction, amplitudes @ second_direction
    return 0.5 * (a + 1j * b), 0.5 * (a.conj() + 1j * b.conj())
