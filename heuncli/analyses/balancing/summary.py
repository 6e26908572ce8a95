"""Summarise the mass effects of a cycle: orders with verdicts, means, and residuals over the cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.analyses.balancing.cycle_magnitudes import compute_residuals
from heuncli.analyses.balancing.effects import MassEffects
from heuncli.analyses.balancing.options import BalanceOptions
from heuncli.analyses.balancing.order_rows import CycleRotation, compute_rounding, magnitudes, make_all_rows
from heuncli.analyses.balancing.order_selection import OrderSelection
from heuncli.analyses.balancing.results import BalanceResults, OrderRow
from heuncli.analyses.balancing.verdicts import format_remaining_orders
from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec

NO_NOISE: Mapping[str, float] = MappingProxyType({})
MOST_ROWS = 12


def to_results(
    spec: Spec,
    coordinate: str,
    rotation: CycleRotation,
    effects: MassEffects,
    reference_point: Array,
    options: BalanceOptions,
    noise: Mapping[str, float] = NO_NOISE,
) -> BalanceResults:
    """Return the results by orders of a coordinate at the cycle's rate.

    noise: errors of the quantities in addition to those at the nodes
    """
    scale, nodes = rotation.scale, effects.nodes
    thresholds = {name: max(x, noise.get(name, 0.0)) for name, x in compute_rounding(effects, scale).items()}
    selections = {name: OrderSelection(options.orders, noise.get(name, 0.0)) for name in thresholds}
    orders = make_all_rows(effects, rotation, thresholds, selections)
    summaries = {name: format_remaining_orders(rows, endless=nodes.last_order is None) for name, rows in orders.items()}
    if options.orders is not None:
        orders = {
            name: tuple(row for row in rows if is_requested(row.order, options.orders)) for name, rows in orders.items()
        }
    values = {
        "force": -scale * effects.force, "moment": -scale * effects.moment,
        "moment_orbital": -scale * effects.orbital, "moment_spin": -scale * effects.spin,
        "torque": scale * effects.half_slope[:, :, None],
    }  # fmt: skip
    sums = {name: total.sum(axis=1) for name, total in values.items()}
    kinds = {name: name.partition("_")[0] for name in values}
    errors = {name: nodes.estimate_errors(total) for name, total in sums.items()}
    extra_errors = {name: noise.get(kind, 0.0) for name, kind in kinds.items()}
    return BalanceResults(
        title=spec.title,
        spec={"path": spec.path, "sha256": spec.sha256},
        coordinate=coordinate,
        turns=rotation.turns,
        rate=rotation.rate,
        samples=len(effects.angles),
        is_resolved=True,
        reference_point=reference_point,
        place=options.place,
        axis=rotation.axis,
        effects=effects,
        orders=orders,
        summaries=summaries,
        mean={name: np.einsum("n,nc->c", nodes.weights, total) for name, total in sums.items()},
        mean_error={name: float(magnitudes(total.order)) + extra_errors[name] for name, total in errors.items()},
        residual=compute_residuals(
            values, nodes, {name: thresholds[kind] for name, kind in kinds.items()}, extra_errors
        ),
        shown_orders=select_shown_orders(orders) if options.orders is None else options.orders,
        are_orders_requested=options.orders is not None,
    )


def is_requested(order: float, orders: Sequence[float]) -> bool:
    """Return whether an order is among the requested ones."""
    return any(abs(order - one) < tolerances.SAME_VALUE for one in orders)


def select_shown_orders(orders: dict[str, tuple[OrderRow, ...]]) -> tuple[float, ...]:
    """Return the orders that a table shows: up to the last that is not small relative to the largest of its
    quantity.
    """
    last, shares = 0.0, dict[float, float]()
    for rows in orders.values():
        largest = max((row.size for row in rows), default=0.0)
        last = max([last, *(row.order for row in rows if row.size > tolerances.LISTED_ORDER * largest)])
        for row in rows:
            shares[row.order] = max(shares.get(row.order, 0.0), row.size / largest if largest > 0.0 else 0.0)
    nonzero = {row.order for rows in orders.values() for row in rows if row.size > 0.0}
    candidates = [order for order in sorted(shares) if order <= last and (order == round(order) or order in nonzero)]
    return select_largest([(order, shares[order]) for order in candidates], MOST_ROWS)


def select_largest(sizes: Sequence[tuple[float, float]], count: int) -> tuple[float, ...]:
    """Return the `count` largest orders, ascending; of equal ones the first."""
    chosen = sorted(sizes, key=lambda own: (-own[1], own[0]))[:count] if len(sizes) > count else sizes
    return tuple(sorted(order for order, _ in chosen))
