"""Integrate tables: the energy that a spring stores whose force is given by a table."""

from __future__ import annotations

import math
from array import array

import numpy as np

from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import COEFFICIENTS
from heuncli.scene.expressions.programs import Expression, TableFunction


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
