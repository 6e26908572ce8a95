"""Orders of a cycle's force, moment and torque: which of them are reported, and the verdict on each.

Of smooth quantities all orders up to rounding are selected, by equally spaced nodes. Quantities with jumps or kinks
have infinitely many orders; they decrease as
    |a_k| <= 2/L (sum of jumps / k + (sum of bends + ∫|F''|) / k²)
so from some order on none reaches a ten-thousandth of the largest.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Literal

import numpy as np

from heuncli.analyses.balancing.cycle import MassEffects
from heuncli.analyses.balancing.cycle_nodes import CycleNodes, PieceNodes
from heuncli.analyses.balancing.results import OrderRow
from heuncli.analyses.balancing.series import MAX_NODES, compute_rotating_vectors, evaluate_legendre
from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array, Indices, Mask

FIRST_ORDERS = 64
# doublings of the number of orders, after which two in a row without a significant order end the search
MIN_DOUBLINGS = 4
MAX_ORDERS, MAX_WORK = 10_000, 4_000_000  # orders per turn; orders times pieces
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
    jumps, bends = compute_decay(nodes, values)
    first, largest, band = 1, threshold, find_fastest_wave(nodes, values)
    sizes = [np.zeros(0)]
    while first <= last_allowed:
        orders = np.arange(first, min(max(2 * first, FIRST_ORDERS), last_allowed) + 1)
        sizes.append(np.sqrt(np.sum(np.abs(nodes.compute_amplitudes(values, orders)) ** 2, axis=1)))
        largest = max(largest, float(sizes[-1].max()))
        first = int(orders[-1]) + 1
        k, significance = first / nodes.turns, max(tolerances.LISTED_ORDER * largest, threshold)
        is_negligible = [float(size.max(initial=0.0)) <= significance for size in sizes[-2:]]
        if jumps / k + bends / k**2 <= significance or (
            len(sizes) > MIN_DOUBLINGS and all(is_negligible) and first > 2.0 * band
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
    jumps, bends = compute_decay(nodes, values)
    return jumps / order + bends / order**2


def compute_decay(nodes: PieceNodes, values: Array) -> tuple[float, float]:
    """Return the factors of 1/order and 1/order²: 2/L times the sum of jumps, and of slope changes with ∫|F''|."""
    coefficients = nodes.compute_coefficients(values)
    jumps = np.sqrt(np.sum(nodes.compute_jumps(coefficients) ** 2, axis=1)).sum()
    half = 0.5 * (nodes.ends - nodes.begins)
    slopes = np.einsum("mn,pnc->pmc", compute_legendre_slopes(), coefficients) / half[:, None, None]
    inner_bends = np.sqrt(np.sum(np.diff(slopes, axis=1) ** 2, axis=2)).sum()
    break_bends = slopes[:, 0] - np.roll(slopes[:, -1], 1, axis=0)
    bends = inner_bends + np.sqrt(np.sum(break_bends**2, axis=1)).sum()
    return 2.0 / nodes.length * float(jumps), 2.0 / nodes.length * float(bends)


@cache
def compute_legendre_slopes() -> Array:
    """Return the slopes of P_0 ... at equally spaced places of [-1, 1], (SLOPE_PLACES, MAX_NODES)."""
    u = np.linspace(-1.0, 1.0, SLOPE_PLACES)
    P = evaluate_legendre(u)
    slopes = np.zeros_like(P)
    for n in range(1, MAX_NODES):
        slopes[:, n] = n * P[:, n - 1] + u * slopes[:, n - 1]
    return slopes


Verdict = Literal["does not arise", "cancels", "remains"]
MAX_NAMED = 6
SMALLER = "smaller ones"
ENDLESS = ", weaker ones without limit"
LETTERS = ("x", "y", "z")


def classify_order(magnitude: float, body_sum: float, largest: float, threshold: float = 0.0) -> Verdict:
    """Classify an order by its magnitude and the sum of the bodies' amplitudes.

    largest: the largest such sum of any order
    threshold: smaller values are rounding
    """
    if body_sum <= max(tolerances.CANCELS * largest, threshold):
        return "does not arise"
    rounding = max(tolerances.ORDERS_SETTLED * largest, threshold)
    return "cancels" if magnitude <= max(tolerances.CANCELS * body_sum, rounding) else "remains"


def format_remaining_orders(rows: Sequence[OrderRow], *, endless: bool = False) -> str:
    """Describe the orders that remain, the largest of them, and their direction.

    endless: whether the orders have no end
    """
    remaining = [row for row in rows if row.verdict == "remains" and row.order > 0.0]
    if not remaining:
        return "none" if not any(row.verdict == "cancels" for row in rows) else "all orders cancel"
    largest = max(row.size for row in remaining)
    named = sorted(sorted(remaining, key=lambda row: -row.size)[:MAX_NAMED], key=lambda row: row.order)
    named = [row for row in named if row.size > tolerances.NAMED_ORDER * largest]
    directions = {format_direction(row) for row in named}
    common_direction = directions.pop() if len(directions) == 1 else ""
    names = [
        f"{row.order:g}" + (f" ({format_direction(row)})" if directions and format_direction(row) else "")
        for row in named
    ]
    if len(remaining) == 1:
        return f"only order {names[0]} remains{f', {common_direction}' if common_direction else ''}"
    joined_names = f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
    sentence = f"order{'s' if len(names) > 1 else ''} {joined_names} remain{'' if len(names) > 1 else 's'}"
    sentence += f", {common_direction}" if common_direction else ""
    last = max(row.order for row in remaining)
    if len(remaining) == len(named):
        return sentence
    return f"{sentence}; {SMALLER} up to order {last:g}{ENDLESS if endless else ''}"


def format_direction(row: OrderRow) -> str:
    """Return the axis along which an order acts, or the direction in which it turns; empty if it has neither."""
    amplitudes: Array = row.amplitude
    if len(amplitudes) < 3:
        return ""
    along = [letter for letter, value in zip(LETTERS, amplitudes, strict=True) if value > tolerances.NO_PART * row.size]
    if len(along) == 1:
        return f"along {along[0]}"
    if row.with_turn is None or row.against_turn is None:
        return ""
    if row.against_turn <= tolerances.NO_PART * row.with_turn and row.is_across_axis:
        return "rotating with the shaft"
    return (
        "rotating against the shaft"
        if row.with_turn <= tolerances.NO_PART * row.against_turn and row.is_across_axis
        else ""
    )


NO_PARTS: Mapping[str, Array] = MappingProxyType({})
NO_SELECTIONS: Mapping[str, OrderSelection] = MappingProxyType({})


@record
class CycleRotation:
    """How a cycle turns: number of turns, axis (None: not fixed) and rate [rad/s] if known."""

    turns: int
    axis: Array | None
    rate: float | None

    @property
    def scale(self) -> float:
        """Factor from effects at unit rate to effects at the cycle's rate."""
        return (self.rate or 1.0) ** 2


def compute_rounding(effects: MassEffects, scale: float) -> dict[str, float]:
    """Return the rounding level of force, moment and torque at a rate whose square is `scale`."""
    return {name: tolerances.ORDERS_SETTLED * scale * terms for name, terms in effects.terms.items()}


def make_all_rows(
    effects: MassEffects,
    rotation: CycleRotation,
    thresholds: Mapping[str, float],
    selections: Mapping[str, OrderSelection] = NO_SELECTIONS,
) -> dict[str, tuple[OrderRow, ...]]:
    """Return the orders of force and moment ON the foundation, and of torque, at the cycle's rate.

    thresholds: smaller values count as 0
    """
    scale = rotation.scale
    nodes, torque = effects.nodes, scale * effects.half_slope[:, :, None]
    parts = {"orbital": -scale * effects.orbital, "spin": -scale * effects.spin}
    rotation_without_axis = replace(rotation, axis=None)
    return {
        "force": make_order_rows(
            -scale * effects.force, nodes, rotation, thresholds["force"], selection=selections.get("force", ALL_ORDERS)
        ),
        "moment": make_order_rows(
            -scale * effects.moment, nodes, rotation, thresholds["moment"], parts, selections.get("moment", ALL_ORDERS)
        ),
        "torque": make_order_rows(
            torque, nodes, rotation_without_axis, thresholds["torque"], selection=selections.get("torque", ALL_ORDERS)
        ),
    }


def make_order_rows(
    values: Array, nodes: CycleNodes, rotation: CycleRotation, threshold: float, parts: Mapping[str, Array] = NO_PARTS,
    selection: OrderSelection = ALL_ORDERS,
) -> tuple[OrderRow, ...]:  # fmt: skip
    """Return the orders of the sum over the bodies of values (n, bodies, c), up to the last significant one, and those
    requested.

    threshold: level of rounding or error, below which values count as 0
    parts: quantities whose sum the values are, reported with them
    """
    turns, sum_ = rotation.turns, values.sum(axis=1)
    error = float(magnitudes(nodes.estimate_errors(sum_).order)) + selection.noise
    orders = selection.select_orders(nodes, sum_, max(threshold, error))
    amplitudes = nodes.compute_amplitudes(values, orders)
    part_amplitudes = {name: nodes.compute_amplitudes(part, orders) for name, part in parts.items()}
    total, body_sums = amplitudes.sum(axis=1), magnitudes(amplitudes).sum(axis=1)
    largest = float(body_sums.max(initial=0.0))
    rounding = max(tolerances.ORDERS_SETTLED * largest, threshold, error)
    terms = body_sums + sum(
        (magnitudes(part).sum(axis=1) for part in part_amplitudes.values()), np.zeros_like(body_sums)
    )
    significance = (
        rounding
        if nodes.last_order is not None
        else max(tolerances.LISTED_ORDER * float(terms.max(initial=0.0)), rounding)
    )
    last = int(orders[np.flatnonzero(terms > significance).max(initial=turns - 1)])
    selected = np.flatnonzero((orders <= last) | selection.are_requested(orders, turns))
    sizes_of_sums, zero_levels = magnitudes(total), np.maximum(tolerances.CANCELS * body_sums, rounding)
    verdicts = [
        classify_order(float(sizes_of_sums[i]), float(body_sums[i]), largest, max(threshold, error))
        for i in selected.tolist()
    ]
    zero_levels[selected[[verdict != "remains" for verdict in verdicts]]] = math.inf
    cleaned = drop_rounding(total, zero_levels[:, None])
    sizes, angles, reach = np.abs(cleaned), compute_phases(cleaned), magnitudes(cleaned)
    part_levels = np.maximum(tolerances.CANCELS * terms, rounding)[:, None]
    cleaned_parts = {name: drop_rounding(part.sum(axis=1), part_levels) for name, part in part_amplitudes.items()}
    part_rows = {name: (np.abs(part), compute_phases(part)) for name, part in cleaned_parts.items()}
    rows = []
    for i, verdict in zip(selected.tolist(), verdicts, strict=True):
        row = OrderRow(
            float(orders[i] / turns), sizes[i], angles[i], float(reach[i]), float(body_sums[i]), verdict, error,
            parts={name: (size[i], angle[i]) for name, (size, angle) in part_rows.items()} or None,
        )  # fmt: skip
        rows.append(add_rotating_vectors(row, total[i], rotation, float(zero_levels[i])))
    return tuple(rows)


def add_rotating_vectors(row: OrderRow, a: Array, rotation: CycleRotation, zero_level: float) -> OrderRow:
    """Return the row with the vectors that rotate across the cycle's axis; values up to the zero level are rounding."""
    if rotation.axis is None:
        return row
    P, N = (
        abs(vector[0]) if abs(vector[0]) > zero_level else 0.0
        for vector in compute_rotating_vectors(a[None, :], rotation.axis)
    )
    across = bool(abs(a @ rotation.axis) <= zero_level)
    return replace(row, with_turn=float(P), against_turn=float(N), is_across_axis=across)


def drop_rounding(a: Array, zero_level: float) -> Array:
    """Set complex numbers to 0 where they do not exceed rounding."""
    return np.asarray(np.where(np.abs(a) > zero_level, a, 0.0))


def compute_phases(a: Array) -> Array:
    """Return the phases of complex amplitudes of cos(kφ - phase), in (-π, π]; 0 for zero amplitudes."""
    angles = -np.angle(a)
    return np.asarray(np.where(angles <= tolerances.SAME_VALUE - math.pi, angles + 2.0 * math.pi, angles) + 0.0)


def magnitudes(vectors: Array) -> Array:
    """Return the magnitudes of complex vectors (..., c)."""
    return np.asarray(np.sqrt(np.sum(np.abs(vectors) ** 2, axis=-1)))
