"""Make rows with verdicts from the orders of a cycle's force, moment and torque; values below rounding become 0."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import CycleNodes
from heuncli.analyses.balancing.effects import MassEffects
from heuncli.analyses.balancing.harmonics import compute_rotating_vectors
from heuncli.analyses.balancing.order_selection import ALL_ORDERS, OrderSelection
from heuncli.analyses.balancing.results import OrderRow
from heuncli.analyses.balancing.verdicts import classify_order
from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array

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
