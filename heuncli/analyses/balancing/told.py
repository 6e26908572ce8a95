"""What was found of a cycle, as orders with their verdicts, means and what acts over the cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.analyses.balancing.asked import BalanceOptions
from heuncli.analyses.balancing.effects import MassEffects
from heuncli.analyses.balancing.over_cycle import residuals
from heuncli.analyses.balancing.results import BalanceResults, OrderRow
from heuncli.analyses.balancing.rows import CycleTurning, all_rows, lengths, rounding_of
from heuncli.analyses.balancing.verdicts import in_words
from heuncli.analyses.balancing.wanted import IN_TABLE, WantedOrders
from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec

NOTHING: Mapping[str, float] = MappingProxyType({})
MOST_ROWS = 12


def told(
    spec: Spec, coordinate: str, turning: CycleTurning, effects: MassEffects, about: Array, asked: BalanceOptions,
    noise: Mapping[str, float] = NOTHING,
) -> BalanceResults:  # fmt: skip
    """What was found, by orders of a coordinate at the cycle's rate; noise: what these are off by besides."""
    scale, nodes = turning.scale, effects.nodes
    least = {name: max(x, noise.get(name, 0.0)) for name, x in rounding_of(effects, scale).items()}
    wanted = {name: WantedOrders(asked.orders, noise.get(name, 0.0)) for name in least}
    found = all_rows(effects, turning, least, wanted)
    words = {name: in_words(rows, endless=nodes.last_order is None) for name, rows in found.items()}
    if asked.orders is not None:
        found = {name: tuple(row for row in rows if is_asked(row.order, asked.orders)) for name, rows in found.items()}
    values = {
        "force": -scale * effects.force, "moment": -scale * effects.moment,
        "moment_orbital": -scale * effects.orbital, "moment_spin": -scale * effects.spin,
        "torque": scale * effects.half_slope[:, :, None],
    }  # fmt: skip
    sums = {name: own.sum(axis=1) for name, own in values.items()}
    kinds = {name: name.partition("_")[0] for name in values}
    off = {name: nodes.errors(own) for name, own in sums.items()}
    more = {name: noise.get(kind, 0.0) for name, kind in kinds.items()}
    return BalanceResults(
        title=spec.title, spec={"path": spec.path, "sha256": spec.sha256},
        coordinate=coordinate, turns=turning.turns, rate=turning.rate, samples=len(effects.angles), settled=True,
        about=about, place=asked.place, axis=turning.axis, effects=effects, orders=found,
        words=words,
        mean={name: np.einsum("n,nc->c", nodes.weights, own) for name, own in sums.items()},
        mean_error={name: float(lengths(own.order)) + more[name] for name, own in off.items()},
        residual=residuals(values, nodes, {name: least[kind] for name, kind in kinds.items()}, more),
        shown=shown(found) if asked.orders is None else asked.orders, asked=asked.orders is not None,
    )  # fmt: skip


def is_asked(order: float, orders: Sequence[float]) -> bool:
    """Whether an order is among those."""
    return any(abs(order - one) < tolerances.SAME_VALUE for one in orders)


def shown(found: dict[str, tuple[OrderRow, ...]]) -> tuple[float, ...]:
    """The orders that a table shows: up to the last that is no small part of the largest of its quantity."""
    last, parts = 0.0, dict[float, float]()
    for rows in found.values():
        largest = max((row.size for row in rows), default=0.0)
        last = max([last, *(row.order for row in rows if row.size > IN_TABLE * largest)])
        for row in rows:
            parts[row.order] = max(parts.get(row.order, 0.0), row.size / largest if largest > 0.0 else 0.0)
    some = {row.order for rows in found.values() for row in rows if row.size > 0.0}
    every = [order for order in sorted(parts) if order <= last and (order == round(order) or order in some)]
    return largest_of([(order, parts[order]) for order in every], MOST_ROWS)


def largest_of(sizes: Sequence[tuple[float, float]], most: int) -> tuple[float, ...]:
    """Of orders with their sizes so many of the largest, ascending; of equal ones the first."""
    chosen = sorted(sizes, key=lambda own: (-own[1], own[0]))[:most] if len(sizes) > most else sizes
    return tuple(sorted(order for order, _ in chosen))
