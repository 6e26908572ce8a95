"""Orders of what comes back with a cycle: order k is amplitude · cos(k φ - phase), φ the cycle's angle, per turn.

Over one turn the orders are 1, 2, ...; over two also the half ones. In a plane every order is two vectors that turn:
    Z = F_1 + i F_2 = sum (P_k e^{ikφ} + N_k e^{-ikφ}),     P_k = ½ (a_1 + i a_2),   N_k = ½ (a_1* + i a_2*)
of F_j = Re sum a_j e^{ikφ}: |P_k| turns with the angle, and a weight on a shaft takes it; |N_k| against.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

AXES = np.eye(3)


def tail(values: Array, quarter: int, terms: float) -> float:
    """How large the highest orders of values (n, ...) are against the largest but the mean; 0 of what is rounding.

    terms: what the values are sums of.
    """
    n = len(values)
    sizes = np.abs(np.fft.rfft(values, axis=0)).reshape(n // 2 + 1, -1)[1:].max(axis=1) * 2.0 / n
    highest = float(sizes[len(sizes) - len(sizes) // quarter :].max())
    return highest / float(sizes.max()) if highest > tolerances.SUM_ROUNDING * terms else 0.0


def plane_across(axis: Array) -> tuple[Array, Array]:
    """Two directions (3,) with the axis right-handed: of the world's axes the next two after the one nearest to it."""
    k = int(np.argmax(np.round(np.abs(axis), 9)))
    first = AXES[(k + 1) % 3] - (AXES[(k + 1) % 3] @ axis) * axis
    first /= np.sqrt(first @ first)
    return first, np.cross(axis, first)


def turning_vectors(amplitudes: Array, axis: Array) -> tuple[Array, Array]:
    """P and N, complex (m,), of vectors' amplitudes (m, 3) across an axis: what turns with the angle, and against."""
    first, second = plane_across(axis)
    a, b = amplitudes @ first, amplitudes @ second
    return 0.5 * (a + 1j * b), 0.5 * (a.conj() + 1j * b.conj())
