"""Report the orders of a cycle's force, moment and torque: amplitudes, phases, rotating vectors and a verdict on each.

An order "does not arise" where no body contributes to it, "cancels" where the contributions of the bodies add up to
rounding, and otherwise "remains".
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal

import numpy as np

from heuncli.analyses.balancing.cycle import MassEffects
from heuncli.analyses.balancing.cycle_nodes import CycleNodes
from heuncli.analyses.balancing.order_selection import ALL_ORDERS, OrderSelection
from heuncli.analyses.balancing.results import OrderRow
from heuncli.analyses.balancing.series import compute_rotating_vectors
from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array, Indices

Verdict = Literal["does not arise", "cancels", "remains"]
NO_PARTS: Mapping[str, Array] = MappingProxyType({})
NO_SELECTIONS: Mapping[str, OrderSelection] = MappingProxyType({})
MAX_NAMED = 6  # orders that a sentence names
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
    ending = f", {common_direction}" if common_direction else ""
    names = [
        f"{row.order:g}" + (f" ({format_direction(row)})" if directions and format_direction(row) else "")
        for row in named
    ]
    if len(remaining) == 1:
        return f"only order {names[0]} remains{ending}"
    if len(names) > 1:
        sentence = f"orders {', '.join(names[:-1])} and {names[-1]} remain{ending}"
    else:
        sentence = f"order {names[0]} remains{ending}"
    if len(remaining) == len(named):
        return sentence
    last = max(row.order for row in remaining)
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
    if row.with_turn <= tolerances.NO_PART * row.against_turn and row.is_across_axis:
        return "rotating against the shaft"
    return ""


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


def compute_rounding(effects: MassEffects, squared_rate: float) -> dict[str, float]:
    """Return the rounding level of force, moment and torque at a rate with this square."""
    return {name: tolerances.ORDERS_SETTLED * squared_rate * terms for name, terms in effects.terms.items()}


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
    spectrum = compute_spectrum(values, nodes, parts, threshold, selection)
    listed = find_listed_orders(spectrum, nodes, selection)
    verdicts = spectrum.classify(listed)
    zero_levels = np.maximum(tolerances.CANCELS * spectrum.body_sums, spectrum.rounding)
    # All of an order that does not remain is dropped:
    zero_levels[listed[[verdict != "remains" for verdict in verdicts]]] = math.inf
    cleaned = drop_rounding(spectrum.total, zero_levels[:, None])
    sizes, phases, norms = np.abs(cleaned), compute_phases(cleaned), magnitudes(cleaned)
    part_levels = np.maximum(tolerances.CANCELS * spectrum.terms, spectrum.rounding)[:, None]
    cleaned_parts = {name: drop_rounding(part, part_levels) for name, part in spectrum.parts.items()}
    part_rows = {name: (np.abs(part), compute_phases(part)) for name, part in cleaned_parts.items()}
    rows = []
    for i, verdict in zip(listed.tolist(), verdicts, strict=True):
        row = OrderRow(
            float(spectrum.orders[i] / rotation.turns), sizes[i], phases[i], float(norms[i]),
            float(spectrum.body_sums[i]), verdict, spectrum.error,
            parts={name: (size[i], phase[i]) for name, (size, phase) in part_rows.items()} or None,
        )  # fmt: skip
        rows.append(add_rotating_vectors(row, spectrum.total[i], rotation, float(zero_levels[i])))
    return tuple(rows)


@record
class OrderSpectrum:
    """Complex amplitudes of m orders of a quantity with c components, and the size of the terms that they add up.

    orders (m,): whole numbers per cycle
    total (m, c): amplitudes of the sum over the bodies
    parts: amplitudes of each part of the quantity, summed over the bodies, (m, c)
    body_sums (m,): sum of the magnitudes of the bodies
    terms (m,): sum of the magnitudes of the bodies, and of those of their parts
    error: error of any amplitude
    floor: the larger of the threshold and the error, below which values count as 0
    """

    orders: Indices
    total: Array
    parts: Mapping[str, Array]
    body_sums: Array
    terms: Array
    error: float
    floor: float

    @property
    def largest(self) -> float:
        """The largest sum of the bodies' magnitudes of any order."""
        return float(self.body_sums.max(initial=0.0))

    @property
    def rounding(self) -> float:
        """The floor, or a share of the largest body sum if that is larger."""
        return max(tolerances.ORDERS_SETTLED * self.largest, self.floor)

    def classify(self, listed: Indices) -> list[Verdict]:
        """Return the verdict on each of the listed orders."""
        sizes, largest = magnitudes(self.total), self.largest
        return [classify_order(float(sizes[i]), float(self.body_sums[i]), largest, self.floor) for i in listed.tolist()]


def compute_spectrum(
    values: Array, nodes: CycleNodes, parts: Mapping[str, Array], threshold: float, selection: OrderSelection
) -> OrderSpectrum:
    """Compute the selected orders of the sum over the bodies of values (n, bodies, c), and of their parts.

    threshold: level of rounding or error, below which values count as 0
    """
    sum_ = values.sum(axis=1)
    error = float(magnitudes(nodes.estimate_errors(sum_).order)) + selection.noise
    floor = max(threshold, error)
    orders = selection.select_orders(nodes, sum_, floor)
    amplitudes = nodes.compute_amplitudes(values, orders)
    part_amplitudes = {name: nodes.compute_amplitudes(part, orders) for name, part in parts.items()}
    body_sums = magnitudes(amplitudes).sum(axis=1)
    part_sums = (magnitudes(part).sum(axis=1) for part in part_amplitudes.values())
    return OrderSpectrum(
        orders=orders,
        total=amplitudes.sum(axis=1),
        parts={name: part.sum(axis=1) for name, part in part_amplitudes.items()},
        body_sums=body_sums,
        terms=body_sums + sum(part_sums, np.zeros_like(body_sums)),
        error=error,
        floor=floor,
    )


def find_listed_orders(spectrum: OrderSpectrum, nodes: CycleNodes, selection: OrderSelection) -> Indices:
    """Return the indices of the orders up to the last significant one, at least of one turn, and of those requested."""
    significance = spectrum.rounding
    if nodes.last_order is None:
        significance = max(tolerances.LISTED_ORDER * float(spectrum.terms.max(initial=0.0)), significance)
    last = int(spectrum.orders[np.flatnonzero(spectrum.terms > significance).max(initial=nodes.turns - 1)])
    return np.flatnonzero((spectrum.orders <= last) | selection.are_requested(spectrum.orders, nodes.turns))


def add_rotating_vectors(row: OrderRow, a: Array, rotation: CycleRotation, zero_level: float) -> OrderRow:
    """Return the row with the rotating vectors of its amplitude a (c,) across the cycle's axis; values up to the zero
    level are rounding.
    """
    if rotation.axis is None:
        return row
    with_turn, against_turn = (
        float(abs(vector[0])) if abs(vector[0]) > zero_level else 0.0
        for vector in compute_rotating_vectors(a[None, :], rotation.axis)
    )
    is_across = bool(abs(a @ rotation.axis) <= zero_level)
    return replace(row, with_turn=with_turn, against_turn=against_turn, is_across_axis=is_across)


def drop_rounding(a: Array, zero_levels: Array) -> Array:
    """Set complex numbers (m, c) to 0 where they do not exceed rounding, (m, 1)."""
    return np.asarray(np.where(np.abs(a) > zero_levels, a, 0.0))


def compute_phases(a: Array) -> Array:
    """Return the phases of complex amplitudes of cos(kφ - phase), in (-π, π]; 0 for zero amplitudes."""
    angles = -np.angle(a)
    return np.asarray(np.where(angles <= tolerances.SAME_VALUE - math.pi, angles + 2.0 * math.pi, angles) + 0.0)


def magnitudes(vectors: Array) -> Array:
    """Return the magnitudes of complex vectors (..., c)."""
    return np.asarray(np.sqrt(np.sum(np.abs(vectors) ** 2, axis=-1)))
