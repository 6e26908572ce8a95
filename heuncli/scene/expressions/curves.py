"""Functions given by points, as piecewise cubics: straight lines, a smooth spline, or one without overshoot.

Tables may have millions of points: what is told of each of them is told of all at once, in NumPy's arrays.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.expressions.programs import TableFunction

COEFFICIENTS = 4  # of a cubic


def fit(
    name: str, x: Sequence[float], y: Sequence[float], interpolation: str, outside: str | None, period: float | None
) -> TableFunction:
    """The table through points of ascending x; with a period the last point is the first one again.

    interpolation: linear, or one of SLOPES.
    Slopes of points that lie too close together may come out infinite.
    """
    xs, ys = (column if isinstance(column, array) else array("d", column) for column in (x, y))
    numbers = array("d", bytes(8 * (1 + len(xs) + COEFFICIENTS * (len(xs) - 1))))
    memory = np.frombuffer(numbers)
    memory[0] = period or 0.0
    memory[1 : len(xs) + 1] = xs
    with np.errstate(all="ignore"):
        cubics(np.frombuffer(xs), np.frombuffer(ys), interpolation, period is not None,
               memory[len(xs) + 1 :].reshape(-1, COEFFICIENTS))  # fmt: skip
    kind = 2 if period is not None else 1 if outside == "hold" else 0
    return TableFunction(name, len(xs) - 1, kind, numbers, xs, ys, interpolation)


def cubics(x: Array, y: Array, interpolation: str, periodic: bool, out: Array) -> None:
    """Coefficients of the pieces, (n - 1, 4), each from its first point on."""
    h = x[1:] - x[:-1]
    d = out[:, 1]  # the slopes of the straight pieces stand where those of the curve will
    np.divide(np.subtract(y[1:], y[:-1], out=d), h, out=d)
    out[:, 0] = y[:-1]
    if interpolation == "linear":
        return
    d = d.copy()
    slopes = SLOPES[interpolation](x, h, d, periodic) if len(x) > 2 else np.repeat(d, 2)
    a, b = slopes[:-1], slopes[1:]
    out[:, 1] = a
    out[:, 2] = (3.0 * d - 2.0 * a - b) / h
    out[:, 3] = (a + b - 2.0 * d) / (h * h)


def spline(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Slopes at the points of the cubic with continuous second derivative; not-a-knot ends (de Boor) or periodic."""
    n = len(x)
    if periodic:
        return closed_spline(h, d)
    if n == 3:  # the parabola
        bend = (d[1] - d[0]) / (x[2] - x[0])
        return np.array([d[0] - bend * h[0], d[0] + bend * h[0], d[1] + bend * h[1]])
    lower, diagonal, upper, right = (np.zeros(n) for _ in range(4))
    lower[1:-1], diagonal[1:-1], upper[1:-1] = h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3.0 * (h[1:] * d[:-1] + h[:-1] * d[1:])
    span = x[2] - x[0]
    diagonal[0], upper[0] = h[1], span
    right[0] = ((h[0] + 2.0 * span) * h[1] * d[0] + h[0] ** 2 * d[1]) / span
    span = x[-1] - x[-3]
    diagonal[-1], lower[-1] = h[-2], span
    right[-1] = (h[-1] ** 2 * d[-2] + (2.0 * span + h[-1]) * h[-2] * d[-1]) / span
    return tridiagonal(lower, diagonal, upper, right)


def natural_spline(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Slopes at the points of the cubic with continuous second derivative, which is 0 at the ends (natural)."""
    lower, diagonal, upper, right = (np.zeros(len(x)) for _ in range(4))
    lower[1:-1], diagonal[1:-1], upper[1:-1] = h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3.0 * (h[1:] * d[:-1] + h[:-1] * d[1:])
    diagonal[[0, -1]], upper[0], lower[-1] = 2.0, 1.0, 1.0  # of a piece 2 a + b = 3 d, where its bend begins with 0
    right[0], right[-1] = 3.0 * d[0], 3.0 * d[-1]
    return tridiagonal(lower, diagonal, upper, right)


def closed_spline(h: Array, d: Array) -> Array:
    """Slopes of the periodic spline; the cyclic system by one change of rank one (Sherman and Morrison)."""
    n = len(h)
    if n == 2:
        return two_pieces(h, d)
    before, d_before = np.roll(h, 1), np.roll(d, 1)
    diagonal = 2.0 * (before + h)
    right = 3.0 * (h * d_before + before * d)
    corner, other = h[0], before[-1]  # of row 0 left of its diagonal, of the last row right of it
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[-1] -= corner * other / gamma
    ends = np.zeros(n)
    ends[0], ends[-1] = gamma, other
    a = tridiagonal(h, diagonal, before, right)
    b = tridiagonal(h, diagonal, before, ends)
    share = (a[0] + corner * a[-1] / gamma) / (1.0 + b[0] + corner * b[-1] / gamma)
    slopes = a - share * b
    return np.append(slopes, slopes[0])


def two_pieces(h: Array, d: Array) -> Array:
    """Slopes of the periodic spline of two pieces, in which either point has the other on both sides."""
    total = h[0] + h[1]
    r0, r1 = 3.0 * (h[0] * d[1] + h[1] * d[0]), 3.0 * (h[1] * d[0] + h[0] * d[1])
    s0 = (2.0 * r0 - r1) / (3.0 * total)
    s1 = (2.0 * r1 - r0) / (3.0 * total)
    return np.array([s0, s1, s0])


def tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Solution of a tridiagonal system by elimination, row by row: Python's numbers, in memory of eight bytes each."""
    n = len(diagonal)
    c, r = array("d", bytes(8 * n)), array("d", bytes(8 * n))
    before = last = 0.0
    rows = zip(lower.data, diagonal.data, upper.data, right.data, strict=True)
    for i, (left, middle, after, value) in enumerate(rows):
        if i:
            pivot = middle - left * before
            before, last = after / pivot, (value - left * last) / pivot
        else:
            before, last = after / middle, value / middle
        c[i], r[i] = before, last
    for i in range(n - 2, -1, -1):
        last = r[i] - c[i] * last
        r[i] = last
    return np.frombuffer(r)


def monotone(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Slopes without overshoot (Fritsch and Butland: weighted harmonic means of the secants)."""
    middle = means(h[:-1], h[1:], d[:-1], d[1:])
    if periodic:
        ends = means(h[-1:], h[:1], d[-1:], d[:1])
        return np.concatenate([ends, middle, ends])
    return np.concatenate([[outer(h[0], h[1], d[0], d[1])], middle, [outer(h[-1], h[-2], d[-1], d[-2])]])


def means(h0: Array, h1: Array, d0: Array, d1: Array) -> Array:
    """Slopes between pieces: 0 at a peak, else the harmonic mean."""
    w0, w1 = 2.0 * h1 + h0, h1 + 2.0 * h0
    return np.where(d0 * d1 <= 0.0, 0.0, (w0 + w1) / (w0 / d0 + w1 / d1))


def outer(h0: float, h1: float, d0: float, d1: float) -> float:
    """Slope at an end: of the parabola through three points, held back where it would overshoot."""
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if slope * d0 <= 0.0:
        return 0.0
    return 3.0 * d0 if d0 * d1 <= 0.0 and abs(slope) > 3.0 * abs(d0) else slope


SLOPES: dict[str, Callable[[Array, Array, Array, bool], Array]] = {
    "cubic": spline, "natural": natural_spline, "pchip": monotone,
}  # fmt: skip
