"""Select the orders of a quantity over a cycle: all up to the last significant one, and those requested.

Of smooth quantities all orders up to rounding are selected, by equally spaced nodes. Quantities with jumps or kinks
have infinitely many orders; they decrease as
    |a_k| <= 2/L (sum of jumps / k + (sum of bends + ∫|F''|) / k²)
so from some order on none reaches a ten-thousandth of the largest.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import CycleNodes, PieceNodes
from heuncli.analyses.balancing.series import MAX_NODES, evaluate_legendre
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask

FIRST_ORDERS = 64  # orders that are always computed
# doublings of the number of orders, after which two in a row without a significant order end the search
MIN_DOUBLINGS = 4
MAX_ORDERS = 10_000  # per turn
MAX_WORK = 4_000_000  # orders times pieces
SLOPE_PLACES = 33  # places of a piece at which its slopes are computed


@record
class OrderSelection:
    """Requested orders per turn; None: all significant ones.

    noise: error of every order in addition to that of the nodes
    """

    requested: tuple[float, ...] | None = None
    noise: float = 0.0

    def select_orders(self, nodes: CycleNodes, values: Array, threshold: float) -> Indices:
        """Return the orders of values (n, c) to compute, whole numbers per cycle, ascending from 1.

        threshold: smaller values count as 0
        """
        last = nodes.last_order
        if last is None:
            assert isinstance(nodes, PieceNodes)
            last = find_last_order(nodes, values, threshold)
        requested = [] if self.requested is None else [order * nodes.turns for order in self.requested]
        extra = [round(k) for k in requested if abs(k - round(k)) < tolerances.SAME_VALUE]
        return np.unique(np.concatenate([np.arange(1, last + 1), np.array(extra, dtype=int)]))

    def are_requested(self, orders: Indices, turns: int) -> Mask:
        """Return which of the orders per cycle are requested, (m,)."""
        if self.requested is None:
            return np.zeros(len(orders), dtype=bool)
        requested = np.array(self.requested) * turns
        return np.asarray((np.abs(orders[:, None] - requested) < tolerances.SAME_VALUE).any(axis=1))


ALL_ORDERS = OrderSelection()


def find_last_order(nodes: PieceNodes, values: Array, threshold: float) -> int:
    """Return the last order per cycle of values (n, c) that reaches a ten-thousandth of the largest, or the last
    allowed.

    threshold: smaller values count as 0
    """
    last_allowed = min(MAX_ORDERS * nodes.turns, max(MAX_WORK // len(nodes.begins), FIRST_ORDERS))
    decay = compute_decay(nodes, values)
    first, largest, fastest_wave = 1, threshold, find_fastest_wave(nodes, values)
    sizes = [np.zeros(0)]
    while first <= last_allowed:
        orders = np.arange(first, min(max(2 * first, FIRST_ORDERS), last_allowed) + 1)
        sizes.append(np.sqrt(np.sum(np.abs(nodes.compute_amplitudes(values, orders)) ** 2, axis=1)))
        largest = max(largest, float(sizes[-1].max()))
        first = int(orders[-1]) + 1
        significance = max(tolerances.LISTED_ORDER * largest, threshold)
        is_negligible = [float(size.max(initial=0.0)) <= significance for size in sizes[-2:]]
        if decay.bound_orders(first / nodes.turns) <= significance or (
            len(sizes) > MIN_DOUBLINGS and all(is_negligible) and first > 2.0 * fastest_wave
        ):
            break
    significant = np.flatnonzero(np.concatenate(sizes) > max(tolerances.LISTED_ORDER * largest, threshold))
    return max(int(significant[-1]) + 1 if len(significant) else 0, FIRST_ORDERS)


def find_fastest_wave(nodes: PieceNodes, values: Array) -> float:
    """Return the order per cycle of the fastest significant wave that the polynomials show."""
    coefficients = nodes.compute_coefficients(values)
    width = nodes.ends - nodes.begins
    shares = np.abs(coefficients).max(axis=2) * (width / nodes.length)[:, None]
    is_significant = shares > tolerances.LISTED_ORDER * shares.sum(axis=0).max(initial=0.0)
    degree = (is_significant * np.arange(MAX_NODES)).max(axis=1)
    return float((degree * 2.0 / width).max()) * nodes.turns


def bound_higher_orders(nodes: CycleNodes, values: Array, order: float) -> float:
    """Bound the orders above a given one (per turn); 0 for equally spaced nodes."""
    if not isinstance(nodes, PieceNodes):
        return 0.0
    return compute_decay(nodes, values).bound_orders(order)


class OrderDecay(NamedTuple):
    """How fast orders per turn decrease: the factors of 1/order, from jumps, and of 1/order², from bends."""

    jumps: float
    bends: float

    def bound_orders(self, order: float) -> float:
        """Bound the amplitudes of an order and of all above it."""
        return self.jumps / order + self.bends / order**2


def compute_decay(nodes: PieceNodes, values: Array) -> OrderDecay:
    """Return the decay of the orders: 2/L times the sum of jumps, and of slope changes at breaks with ∫|F''|."""
    coefficients = nodes.compute_coefficients(values)
    jumps = np.sqrt(np.sum(nodes.compute_jumps(coefficients) ** 2, axis=1)).sum()
    half = 0.5 * (nodes.ends - nodes.begins)
    slopes = np.einsum("mn,pnc->pmc", compute_legendre_slopes(), coefficients) / half[:, None, None]
    inner_bends = np.sqrt(np.sum(np.diff(slopes, axis=1) ** 2, axis=2)).sum()
    break_bends = slopes[:, 0] - np.roll(slopes[:, -1], 1, axis=0)
    bends = inner_bends + np.sqrt(np.sum(break_bends**2, axis=1)).sum()
    return OrderDecay(2.0 / nodes.length * float(jumps), 2.0 / nodes.length * float(bends))


@cache
def compute_legendre_slopes() -> Array:
    """Return the slopes of P_0 ... at equally spaced places of [-1, 1], (SLOPE_PLACES, MAX_NODES)."""
    u = np.linspace(-1.0, 1.0, SLOPE_PLACES)
    P = evaluate_legendre(u)
    slopes = np.zeros_like(P)
    for n in range(1, MAX_NODES):
        slopes[:, n] = n * P[:, n - 1] + u * slopes[:, n - 1]
    return slopes
