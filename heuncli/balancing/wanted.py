"""Which orders are told: those that are asked for, else as many as count.

Of what is smooth all up to rounding, by even nodes. What jumps or bends has orders without end; they fall as
    |a_k| <= 2/L (sum of jumps / k + (sum of bends + ∫|F''|) / k²)
so that from some order on none is a ten-thousandth of the largest.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from heuncli import tolerances
from heuncli.balancing.legendre import MOST, polynomials
from heuncli.balancing.nodes import Nodes, PieceNodes
from heuncli.records import record
from heuncli.results import Array, Indices, Mask

IN_TABLE = 1e-4  # of the largest order: smaller ones do not stand in a table unless they are asked for
AT_FIRST = 64
MOST_ORDERS, MOST_WORK = 10_000, 4_000_000  # a turn; orders times pieces
LOOKED_AT = 33  # places of a piece by which it is told how it bends


@record
class WantedOrders:
    """Orders that are asked for, counted per turn; None: as many as count. noise: what all are off by besides."""

    asked: tuple[float, ...] | None = None
    noise: float = 0.0

    def of(self, nodes: Nodes, values: Array) -> Indices:
        """The orders of values (n, c) that are looked at, whole numbers a cycle, ascending, from 1 on."""
        if nodes.last_order is not None:
            found = np.arange(1, nodes.last_order + 1)
        else:
            assert isinstance(nodes, PieceNodes)
            found = np.arange(1, last_that_counts(nodes, values) + 1)
        asked = [] if self.asked is None else [order * nodes.turns for order in self.asked]
        more = [round(k) for k in asked if abs(k - round(k)) < tolerances.SAME_VALUE]
        return np.unique(np.concatenate([found, np.array(more, dtype=int)]))

    def are_asked(self, orders: Indices, turns: int) -> Mask:
        """Which of some orders a cycle are asked for, (m,)."""
        if self.asked is None:
            return np.zeros(len(orders), dtype=bool)
        own = np.array(self.asked) * turns
        return np.asarray((np.abs(orders[:, None] - own) < tolerances.SAME_VALUE).any(axis=1))


ANY = WantedOrders()


def last_that_counts(nodes: PieceNodes, values: Array) -> int:
    """The last order a cycle of values (n, c) that may be a ten-thousandth of the largest, or the last that is told."""
    most = min(MOST_ORDERS * nodes.turns, max(MOST_WORK // len(nodes.begins), AT_FIRST))
    sizes = np.abs(nodes.amplitudes(values, np.arange(1, AT_FIRST + 1)))
    largest = float(np.sqrt(np.sum(sizes**2, axis=1)).max())
    jumps, bends = fall(nodes, values)
    least = IN_TABLE * largest
    if not least > 0.0:
        return AT_FIRST
    root = 0.5 * (jumps + math.sqrt(jumps * jumps + 4.0 * least * bends)) / least  # of least k² - jumps k - bends = 0
    return int(min(max(math.ceil(root * nodes.turns), AT_FIRST), most))


def left_beyond(nodes: Nodes, values: Array, order: float) -> float:
    """What orders beyond one (a turn) may come to at most; 0 of even nodes."""
    if not isinstance(nodes, PieceNodes):
        return 0.0
    jumps, bends = fall(nodes, values)
    return jumps / order + bends / order**2


def fall(nodes: PieceNodes, values: Array) -> tuple[float, float]:
    """What falls with the order, and with its square: 2/L times the sums of jumps, and of bends with ∫|F''|."""
    own = nodes.coefficients(values)
    jumps = np.sqrt(np.sum(nodes.jumps(own) ** 2, axis=1)).sum()
    half = 0.5 * (nodes.ends - nodes.begins)
    slopes = np.einsum("mn,pnc->pmc", slopes_at(), own) / half[:, None, None]
    inner = np.sqrt(np.sum(np.diff(slopes, axis=1) ** 2, axis=2)).sum()
    between = slopes[:, 0] - np.roll(slopes[:, -1], 1, axis=0)
    bends = inner + np.sqrt(np.sum(between**2, axis=1)).sum()
    return 2.0 / nodes.length * float(jumps), 2.0 / nodes.length * float(bends)


@cache
def slopes_at() -> Array:
    """The slopes of P_0 ... at even places of [-1, 1], (LOOKED_AT, MOST)."""
    u = np.linspace(-1.0, 1.0, LOOKED_AT)
    P = polynomials(u)
    found = np.zeros_like(P)
    for n in range(1, MOST):
        found[:, n] = n * P[:, n - 1] + u * found[:, n - 1]
    return found
