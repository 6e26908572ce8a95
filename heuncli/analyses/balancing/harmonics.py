"""Orders of a quantity that is periodic over a cycle: order k is amplitude · cos(k φ - phase), φ the cycle's angle, per
turn.

Over one turn the orders are 1, 2, ...; over two also the half orders. In a plane every order is two rotating vectors:
    Z = F_1 + i F_2 = sum (P_k e^{ikφ} + N_k e^{-ikφ}),     P_k = ½ (a_1 + i a_2),   N_k = ½ (a_1* + i a_2*)
with F_j = Re sum a_j e^{ikφ}: |P_k| turns with the angle and can be cancelled by a weight on a shaft; |N_k| turns
against it.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array

AXES = np.eye(3)


def relative_tail(values: Array, quarter: int, terms: float) -> float:
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
