"""Areas under tables: what a spring has stored whose force is told by one."""

from __future__ import annotations

import math
from array import array

import numpy as np

from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.scene.expressions.curves import COEFFICIENTS
from heuncli.scene.expressions.programs import Expression, TableFunction


def with_areas(law: Expression) -> Expression:
    """The law of one table, whose numbers go on with its area from 0 to each of its knots, (pieces + 1,).

    The kernel finds from them the area to any x (kernel/evaluator.py, area_under).
    """
    (table,) = law.tables
    numbers = array("d", table.numbers)
    numbers.frombytes(areas(table).tobytes())
    return replace(law, tables=(replace(table, numbers=numbers),))


def areas(table: TableFunction) -> Array:
    """From 0 to each knot; of a periodic table from the place in its own range that stands for 0.

    They are summed up outwards from there: what is near 0 is not the difference of large ones.
    """
    n, memory = table.pieces, np.frombuffer(table.numbers)
    period, knots = float(memory[0]), memory[1 : n + 2]
    c = memory[n + 2 :].reshape(-1, COEFFICIENTS).T
    h = np.diff(knots)
    whole = h * (c[0] + h * (c[1] / 2.0 + h * (c[2] / 3.0 + h * c[3] / 4.0)))
    zero, home = home_of(knots, period)

    def up_to(knot: float) -> float:
        """From `zero` to an end of its own piece, or of the table where that is beside it: Gauss, 2 nodes."""
        if not 0 <= home < n:
            return (knot - zero) * table.y[0 if home < 0 else -1]
        middle, half = 0.5 * (zero + knot) - knots[home], 0.5 * (knot - zero)
        values = [np.polyval(c[::-1, home], middle + side * half / math.sqrt(3.0)) for side in (-1.0, 1.0)]
        return float(half * sum(values))

    found = np.empty(n + 1)
    if home < n:
        found[home + 1 :] = up_to(knots[home + 1]) + np.append(0.0, np.cumsum(whole[home + 1 :]))
    if home >= 0:
        found[home::-1] = up_to(knots[home]) - np.append(0.0, np.cumsum(whole[:home][::-1]))
    return found


def home_of(knots: Array, period: float) -> tuple[float, int]:
    """What stands for 0 in a table's own range, and the piece it is in: -1 before a table that ends, n beyond it."""
    last = len(knots) - 2
    zero = 0.0
    if period > 0.0:
        turns = math.floor(-float(knots[0]) / period)
        if -period * turns >= knots[-1]:  # by rounding: it is the first point of the next turn
            turns += 1
        zero = 0.0 - period * turns
    elif not knots[0] <= zero <= knots[-1]:
        return zero, -1 if zero < knots[0] else last + 1
    return zero, min(max(int(np.searchsorted(knots, zero, side="right")) - 1, 0), last)
