"""Functions given by points, as piecewise cubics: straight lines, a smooth spline, or one without overshoot."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from heuncli.expressions.programs import Table

Floats = Sequence[float]


def fit(name: str, x: Floats, y: Floats, interpolation: str, outside: str | None, period: float | None) -> Table:
    """The table through points of ascending x; with a period the last point is the first one again."""
    slopes = SLOPES[interpolation](x, y, period is not None) if len(x) > 2 else [secants(x, y)[0]] * 2
    numbers = [period or 0.0, *x]
    for i, d in enumerate(secants(x, y)):
        h = x[i + 1] - x[i]
        if interpolation == "linear":
            numbers += (y[i], d, 0.0, 0.0)
        else:
            a, b = slopes[i], slopes[i + 1]
            numbers += (y[i], a, (3.0 * d - 2.0 * a - b) / h, (a + b - 2.0 * d) / (h * h))
    kind = 2 if period is not None else 1 if outside == "hold" else 0
    return Table(name, len(x) - 1, kind, tuple(numbers), tuple(x), tuple(y), interpolation)


def secants(x: Floats, y: Floats) -> list[float]:
    """Slopes of the straight pieces."""
    return [(y[i + 1] - y[i]) / (x[i + 1] - x[i]) for i in range(len(x) - 1)]


def spline(x: Floats, y: Floats, periodic: bool) -> list[float]:
    """Slopes at the points of the cubic with continuous second derivative; not-a-knot ends (de Boor) or periodic."""
    d, n = secants(x, y), len(x)
    h = [x[i + 1] - x[i] for i in range(n - 1)]
    if periodic:
        return closed_spline(h, d)
    if n == 3:  # the parabola
        bend = (d[1] - d[0]) / (x[2] - x[0])
        return [d[0] - bend * h[0], d[0] + bend * h[0], d[1] + bend * h[1]]
    lower, diagonal, upper, right = [0.0] * n, [0.0] * n, [0.0] * n, [0.0] * n
    for i in range(1, n - 1):
        lower[i], diagonal[i], upper[i] = h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1]
        right[i] = 3.0 * (h[i] * d[i - 1] + h[i - 1] * d[i])
    span = x[2] - x[0]
    diagonal[0], upper[0] = h[1], span
    right[0] = ((h[0] + 2.0 * span) * h[1] * d[0] + h[0] ** 2 * d[1]) / span
    span = x[-1] - x[-3]
    diagonal[-1], lower[-1] = h[-2], span
    right[-1] = (h[-1] ** 2 * d[-2] + (2.0 * span + h[-1]) * h[-2] * d[-1]) / span
    return tridiagonal(lower, diagonal, upper, right)


def closed_spline(h: Floats, d: Floats) -> list[float]:
    """Slopes of the periodic spline; the cyclic system by one change of rank one (Sherman and Morrison)."""
    n = len(h)
    if n == 2:
        return two_pieces(h, d)
    before = [h[i - 1] for i in range(n)]
    diagonal = [2.0 * (before[i] + h[i]) for i in range(n)]
    right = [3.0 * (h[i] * d[i - 1] + before[i] * d[i]) for i in range(n)]
    corner, other = h[0], before[-1]  # of row 0 left of its diagonal, of the last row right of it
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[-1] -= corner * other / gamma
    lower, upper = list(h), before
    a = tridiagonal(lower, diagonal, upper, right)
    b = tridiagonal(lower, diagonal, upper, [gamma, *([0.0] * (n - 2)), other])
    share = (a[0] + corner * a[-1] / gamma) / (1.0 + b[0] + corner * b[-1] / gamma)
    slopes = [p - share * q for p, q in zip(a, b, strict=True)]
    return [*slopes, slopes[0]]


def two_pieces(h: Floats, d: Floats) -> list[float]:
    """Slopes of the periodic spline of two pieces, in which either point has the other on both sides."""
    total = h[0] + h[1]
    r0, r1 = 3.0 * (h[0] * d[1] + h[1] * d[0]), 3.0 * (h[1] * d[0] + h[0] * d[1])
    s0 = (2.0 * r0 - r1) / (3.0 * total)
    s1 = (2.0 * r1 - r0) / (3.0 * total)
    return [s0, s1, s0]


def tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, right: Floats) -> list[float]:
    """Solution of a tridiagonal system by elimination."""
    n = len(diagonal)
    c, r = [0.0] * n, [0.0] * n
    c[0], r[0] = upper[0] / diagonal[0], right[0] / diagonal[0]
    for i in range(1, n):
        pivot = diagonal[i] - lower[i] * c[i - 1]
        c[i], r[i] = upper[i] / pivot, (right[i] - lower[i] * r[i - 1]) / pivot
    for i in range(n - 2, -1, -1):
        r[i] -= c[i] * r[i + 1]
    return r


def monotone(x: Floats, y: Floats, periodic: bool) -> list[float]:
    """Slopes without overshoot (Fritsch and Butland: weighted harmonic means of the secants)."""
    d, n = secants(x, y), len(x)
    h = [x[i + 1] - x[i] for i in range(n - 1)]

    def inner(h0: float, h1: float, d0: float, d1: float) -> float:
        if d0 * d1 <= 0.0:
            return 0.0
        w0, w1 = 2.0 * h1 + h0, h1 + 2.0 * h0
        return (w0 + w1) / (w0 / d0 + w1 / d1)

    middle = [inner(h[i - 1], h[i], d[i - 1], d[i]) for i in range(1, n - 1)]
    if periodic:
        ends = inner(h[-1], h[0], d[-1], d[0])
        return [ends, *middle, ends]
    return [outer(h[0], h[1], d[0], d[1]), *middle, outer(h[-1], h[-2], d[-1], d[-2])]


def outer(h0: float, h1: float, d0: float, d1: float) -> float:
    """Slope at an end: of the parabola through three points, held back where it would overshoot."""
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if slope * d0 <= 0.0:
        return 0.0
    return 3.0 * d0 if d0 * d1 <= 0.0 and abs(slope) > 3.0 * abs(d0) else slope


SLOPES: dict[str, Callable[[Floats, Floats, bool], list[float]]] = {
    "linear": lambda x, y, periodic: [0.0] * len(x),
    "cubic": spline,
    "pchip": monotone,
}
