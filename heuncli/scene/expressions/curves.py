"""Interpolate points by piecewise cubics: straight lines, a smooth spline, or one without overshoot.

Tables may have millions of points, so all points are handled at once in NumPy arrays.

Integrate tables: the energy that a spring stores whose force is given by a table.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression, TableFunction

# Curves

COEFFICIENTS = 4  # a cubic has four


def interpolate_points(
    name: str,
    x: Sequence[float],
    y: Sequence[float],
    interpolation: str,
    outside: str | None,
    period: float | None,
    slopes: Array | None = None,
) -> TableFunction:
    """Make the table through points of ascending x; with a period, the last point equals the first.

    interpolation: linear, or one of SLOPES. Slopes at points that are too close together may be infinite.
    slopes (n,): at the points, if they are known
    """
    x_array, y_array = (column if isinstance(column, array) else array("d", column) for column in (x, y))
    numbers = array("d", bytes(8 * (1 + len(x_array) + COEFFICIENTS * (len(x_array) - 1))))
    number_view = np.frombuffer(numbers)
    number_view[0] = period or 0.0
    number_view[1 : len(x_array) + 1] = x_array
    with np.errstate(all="ignore"):
        compute_cubics(np.frombuffer(x_array), np.frombuffer(y_array), interpolation, period is not None,
               number_view[len(x_array) + 1 :].reshape(-1, COEFFICIENTS), slopes)  # fmt: skip
    kind = 2 if period is not None else 1 if outside == "hold" else 0
    return TableFunction(name, len(x_array) - 1, kind, numbers, x_array, y_array, interpolation)


def compute_cubics(
    x: Array, y: Array, interpolation: str, periodic: bool, coefficients: Array, slopes: Array | None = None
) -> None:
    """Compute the coefficients of the pieces, (n - 1, 4), in powers of the distance from their first point.

    slopes (n,): at the points, if they are known
    """
    h = x[1:] - x[:-1]
    d = coefficients[:, 1]  # the slopes of the straight pieces are stored where those of the curve will be
    np.divide(np.subtract(y[1:], y[:-1], out=d), h, out=d)
    coefficients[:, 0] = y[:-1]
    if interpolation == "linear" and slopes is None:
        return
    d = d.copy()
    if slopes is None:
        slopes = SLOPES[interpolation](x, h, d, periodic) if len(x) > 2 else np.repeat(d, 2)
    a, b = slopes[:-1], slopes[1:]
    coefficients[:, 1] = a
    coefficients[:, 2] = (3.0 * d - 2.0 * a - b) / h
    coefficients[:, 3] = (a + b - 2.0 * d) / (h * h)


def cubic_spline_slopes(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Compute the slopes of the cubic spline with continuous second derivative; not-a-knot ends (de Boor) or
    periodic.
    """
    n = len(x)
    if periodic:
        return periodic_spline_slopes(h, d)
    if n == 3:  # the parabola
        second_difference = (d[1] - d[0]) / (x[2] - x[0])
        return np.array(
            [d[0] - second_difference * h[0], d[0] + second_difference * h[0], d[1] + second_difference * h[1]]
        )
    lower, diagonal, upper, right = (np.zeros(n) for _ in range(4))
    lower[1:-1], diagonal[1:-1], upper[1:-1] = h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3.0 * (h[1:] * d[:-1] + h[:-1] * d[1:])
    span = x[2] - x[0]
    diagonal[0], upper[0] = h[1], span
    right[0] = ((h[0] + 2.0 * span) * h[1] * d[0] + h[0] ** 2 * d[1]) / span
    span = x[-1] - x[-3]
    diagonal[-1], lower[-1] = h[-2], span
    right[-1] = (h[-1] ** 2 * d[-2] + (2.0 * span + h[-1]) * h[-2] * d[-1]) / span
    return solve_tridiagonal(lower, diagonal, upper, right)


def natural_spline_slopes(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Compute the slopes of the cubic spline with continuous second derivative that is 0 at the ends (natural)."""
    lower, diagonal, upper, right = (np.zeros(len(x)) for _ in range(4))
    lower[1:-1], diagonal[1:-1], upper[1:-1] = h[1:], 2.0 * (h[:-1] + h[1:]), h[:-1]
    right[1:-1] = 3.0 * (h[1:] * d[:-1] + h[:-1] * d[1:])
    diagonal[[0, -1]], upper[0], lower[-1] = 2.0, 1.0, 1.0  # second derivative 0 at the start of a piece: 2 a + b = 3 d
    right[0], right[-1] = 3.0 * d[0], 3.0 * d[-1]
    return solve_tridiagonal(lower, diagonal, upper, right)


def periodic_spline_slopes(h: Array, d: Array) -> Array:
    """Compute the slopes of the periodic spline; the cyclic system is solved by a rank-one update (Sherman and
    Morrison).
    """
    n = len(h)
    if n == 2:
        return two_piece_spline_slopes(h, d)
    previous_h, previous_d = np.roll(h, 1), np.roll(d, 1)
    diagonal = 2.0 * (previous_h + h)
    right = 3.0 * (h * previous_d + previous_h * d)
    corner, opposite_corner = h[0], previous_h[-1]  # corners of the cyclic matrix: in row 0, and in the last row
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[-1] -= corner * opposite_corner / gamma
    ends = np.zeros(n)
    ends[0], ends[-1] = gamma, opposite_corner
    a = solve_tridiagonal(h, diagonal, previous_h, right)
    b = solve_tridiagonal(h, diagonal, previous_h, ends)
    share = (a[0] + corner * a[-1] / gamma) / (1.0 + b[0] + corner * b[-1] / gamma)
    slopes = a - share * b
    return np.append(slopes, slopes[0])


def two_piece_spline_slopes(h: Array, d: Array) -> Array:
    """Compute the slopes of the periodic spline of two pieces, in which each point has the other on both sides."""
    total = h[0] + h[1]
    r0, r1 = 3.0 * (h[0] * d[1] + h[1] * d[0]), 3.0 * (h[1] * d[0] + h[0] * d[1])
    s0 = (2.0 * r0 - r1) / (3.0 * total)
    s1 = (2.0 * r1 - r0) / (3.0 * total)
    return np.array([s0, s1, s0])


def solve_tridiagonal(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """Solve a tridiagonal system by elimination, row by row, with Python's numbers, in memory of eight bytes each."""
    n = len(diagonal)
    c, r = array("d", bytes(8 * n)), array("d", bytes(8 * n))
    upper_ratio = solution = 0.0
    rows = zip(lower.data, diagonal.data, upper.data, right.data, strict=True)
    for i, (left, middle, upper_value, value) in enumerate(rows):
        if i:
            pivot = middle - left * upper_ratio
            upper_ratio, solution = upper_value / pivot, (value - left * solution) / pivot
        else:
            upper_ratio, solution = upper_value / middle, value / middle
        c[i], r[i] = upper_ratio, solution
    for i in range(n - 2, -1, -1):
        solution = r[i] - c[i] * solution
        r[i] = solution
    return np.frombuffer(r)


def monotone_slopes(x: Array, h: Array, d: Array, periodic: bool) -> Array:
    """Compute slopes without overshoot (Fritsch and Butland: weighted harmonic means of the secants)."""
    inner_slopes = harmonic_mean_slopes(h[:-1], h[1:], d[:-1], d[1:])
    if periodic:
        ends = harmonic_mean_slopes(h[-1:], h[:1], d[-1:], d[:1])
        return np.concatenate([ends, inner_slopes, ends])
    return np.concatenate([[end_slope(h[0], h[1], d[0], d[1])], inner_slopes, [end_slope(h[-1], h[-2], d[-1], d[-2])]])


def harmonic_mean_slopes(h0: Array, h1: Array, d0: Array, d1: Array) -> Array:
    """Compute the slopes between pieces: 0 at a peak, else the weighted harmonic mean."""
    w0, w1 = 2.0 * h1 + h0, h1 + 2.0 * h0
    return np.where(d0 * d1 <= 0.0, 0.0, (w0 + w1) / (w0 / d0 + w1 / d1))


def end_slope(h0: float, h1: float, d0: float, d1: float) -> float:
    """Compute the slope at an end: that of the parabola through three points, limited where it would overshoot."""
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    if slope * d0 <= 0.0:
        return 0.0
    return 3.0 * d0 if d0 * d1 <= 0.0 and abs(slope) > 3.0 * abs(d0) else slope


SLOPES: dict[str, Callable[[Array, Array, Array, bool], Array]] = {
    "cubic": cubic_spline_slopes, "natural": natural_spline_slopes, "pchip": monotone_slopes,
}  # fmt: skip


# Areas


def append_areas(law: Expression) -> Expression:
    """Append to a table law the area from 0 to each of its knots, (pieces + 1,).

    The kernel finds from them the area to any x (kernel/evaluator.py, area_under).
    """
    (table,) = law.tables
    numbers = array("d", table.numbers)
    numbers.frombytes(compute_areas(table).tobytes())
    return replace(law, tables=(replace(table, numbers=numbers),))


def compute_areas(table: TableFunction) -> Array:
    """Compute the areas from 0 to each knot; of a periodic table, from the place in its own range that corresponds to
    0.

    They are summed outward from there, so that a value near 0 is not the difference of large ones.
    """
    piece_count, numbers = table.pieces, np.frombuffer(table.numbers)
    period, knots = float(numbers[0]), numbers[1 : piece_count + 2]
    coefficients = numbers[piece_count + 2 :].reshape(-1, COEFFICIENTS).T
    lengths = np.diff(knots)
    piece_areas = lengths * (
        coefficients[0]
        + lengths * (coefficients[1] / 2.0 + lengths * (coefficients[2] / 3.0 + lengths * coefficients[3] / 4.0))
    )
    zero, zero_piece = locate_zero(knots, period)

    def area_to_knot(knot: float) -> float:
        """Integrate from `zero` to an end of its piece, or of the table if it lies outside, by 2-point Gauss
        quadrature.
        """
        if not 0 <= zero_piece < piece_count:
            return (knot - zero) * table.y[0 if zero_piece < 0 else -1]
        middle, half = 0.5 * (zero + knot) - knots[zero_piece], 0.5 * (knot - zero)
        values = [
            np.polyval(coefficients[::-1, zero_piece], middle + side * half / math.sqrt(3.0)) for side in (-1.0, 1.0)
        ]
        return float(half * sum(values))

    knot_areas = np.empty(piece_count + 1)
    if zero_piece < piece_count:
        knot_areas[zero_piece + 1 :] = area_to_knot(knots[zero_piece + 1]) + np.append(
            0.0, np.cumsum(piece_areas[zero_piece + 1 :])
        )
    if zero_piece >= 0:
        knot_areas[zero_piece::-1] = area_to_knot(knots[zero_piece]) - np.append(
            0.0, np.cumsum(piece_areas[:zero_piece][::-1])
        )
    return knot_areas


def locate_zero(knots: Array, period: float) -> tuple[float, int]:
    """Find the place of 0 in a table's own range, and its piece: -1 before a table that ends, n behind it."""
    last = len(knots) - 2
    zero = 0.0
    if period > 0.0:
        periods = math.floor(-float(knots[0]) / period)
        if -period * periods >= knots[-1]:  # by rounding it is the first point of the next period
            periods += 1
        zero = 0.0 - period * periods
    elif not knots[0] <= zero <= knots[-1]:
        return zero, -1 if zero < knots[0] else last + 1
    return zero, min(max(int(np.searchsorted(knots, zero, side="right")) - 1, 0), last)
