"""Which orders are told: those that are asked for, else as many as count.

Of what is smooth all up to rounding, by even nodes. What jumps or bends has orders without end; they fall as
    |a_k| <= 2/L (sum of jumps / k + (sum of bends + ∫|F''|) / k²)
so that from some order on none is a ten-thousandth of the largest.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from heuncli.analyses.balancing.legendre import MOST, polynomials
from heuncli.analyses.balancing.nodes import CycleNodes, PieceNodes
from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask

IN_TABLE = 1e-4  # of the largest order: smaller ones do not stand in a table unless they are asked for
AT_FIRST = 64
SURE = 4  # doublings of how many orders were looked at, from which on two in a row without one that counts end the look
MOST_ORDERS, MOST_WORK = 10_000, 4_000_000  # a turn; orders times pieces
LOOKED_AT = 33  # places of a piece by which it is told how it bends


@record
class WantedOrders:
    """Orders that are asked for, counted per turn; None: as many as count. noise: what all are off by besides."""

    asked: tuple[float, ...] | None = None
    noise: float = 0.0

    def of(self, nodes: CycleNodes, values: Array, least: float) -> Indices:
        """The orders of values (n, c) that are looked at, whole numbers a cycle, ascending, from 1 on.

        least: what is below is none.
        """
        last = nodes.last_order
        if last is None:
            assert isinstance(nodes, PieceNodes)
            last = last_that_counts(nodes, values, least)
        asked = [] if self.asked is None else [order * nodes.turns for order in self.asked]
        more = [round(k) for k in asked if abs(k - round(k)) < tolerances.SAME_VALUE]
        return np.unique(np.concatenate([np.arange(1, last + 1), np.array(more, dtype=int)]))

    def are_asked(self, orders: Indices, turns: int) -> Mask:
        """Which of some orders a cycle are asked for, (m,)."""
        if self.asked is None:
            return np.zeros(len(orders), dtype=bool)
        own = np.array(self.asked) * turns
        return np.asarray((np.abs(orders[:, None] - own) < tolerances.SAME_VALUE).any(axis=1))


ANY = WantedOrders()


def last_that_counts(nodes: PieceNodes, values: Array, none: float) -> int:
    """The last order a cycle of values (n, c) that is a ten-thousandth of the largest, or the last that is told.

    none: what is below is none.
    """
    most = min(MOST_ORDERS * nodes.turns, max(MOST_WORK // len(nodes.begins), AT_FIRST))
    jumps, bends = fall(nodes, values)
    first, largest, band = 1, none, last_wave(nodes, values)
    sizes = [np.zeros(0)]
    while first <= most:
        orders = np.arange(first, min(max(2 * first, AT_FIRST), most) + 1)
        sizes.append(np.sqrt(np.sum(np.abs(nodes.amplitudes(values, orders)) ** 2, axis=1)))
        largest = max(largest, float(sizes[-1].max()))
        first = int(orders[-1]) + 1
        k, least = first / nodes.turns, max(IN_TABLE * largest, none)
        faint = [float(size.max(initial=0.0)) <= least for size in sizes[-2:]]
        if jumps / k + bends / k**2 <= least or (len(sizes) > SURE and all(faint) and first > 2.0 * band):
            break
    counts = np.flatnonzero(np.concatenate(sizes) > max(IN_TABLE * largest, none))
    return max(int(counts[-1]) + 1 if len(counts) else 0, AT_FIRST)


def last_wave(nodes: PieceNodes, values: Array) -> float:
    """The order a cycle of the fastest wave that the polynomials show, of those that count."""
    own = nodes.coefficients(values)
    width = nodes.ends - nodes.begins
    shares = np.abs(own).max(axis=2) * (width / nodes.length)[:, None]
    counts = shares > IN_TABLE * shares.sum(axis=0).max(initial=0.0)
    degree = (counts * np.arange(MOST)).max(axis=1)
    return float((degree * 2.0 / width).max()) * nodes.turns


def left_beyond(nodes: CycleNodes, values: Array, order: float) -> float:
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
