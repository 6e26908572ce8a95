"""The orders of a cycle's force, moment and torque as rows with their verdicts; what is rounding reads 0."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from heuncli.analyses.balancing.effects import MassEffects
from heuncli.analyses.balancing.harmonics import turning_vectors
from heuncli.analyses.balancing.nodes import CycleNodes
from heuncli.analyses.balancing.results import OrderRow
from heuncli.analyses.balancing.verdicts import verdict_of
from heuncli.analyses.balancing.wanted import ANY, IN_TABLE, WantedOrders
from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array

NO_PARTS: Mapping[str, Array] = MappingProxyType({})
NO_WISHES: Mapping[str, WantedOrders] = MappingProxyType({})


@record
class CycleTurning:
    """How a cycle turns: over so many turns, about which axis (None: no fixed one), at which rate [rad/s] if known."""

    turns: int
    axis: Array | None
    rate: float | None

    @property
    def scale(self) -> float:
        """What effects at unit rate are multiplied by."""
        return (self.rate or 1.0) ** 2


def rounding_of(effects: MassEffects, scale: float) -> dict[str, float]:
    """What is rounding of force, moment and torque at a rate of which `scale` is the square."""
    return {name: tolerances.ORDERS_SETTLED * scale * terms for name, terms in effects.terms.items()}


def all_rows(
    effects: MassEffects,
    turning: CycleTurning,
    least: Mapping[str, float],
    wanted: Mapping[str, WantedOrders] = NO_WISHES,
) -> dict[str, tuple[OrderRow, ...]]:
    """The orders of force and moment ON the foundation, and of torque, at the rate; below `least` is none."""
    scale = turning.scale
    nodes, torque = effects.nodes, scale * effects.half_slope[:, :, None]
    parts = {"orbital": -scale * effects.orbital, "spin": -scale * effects.spin}
    flat = replace(turning, axis=None)
    return {
        "force": order_rows(-scale * effects.force, nodes, turning, least["force"], wanted=wanted.get("force", ANY)),
        "moment": order_rows(
            -scale * effects.moment, nodes, turning, least["moment"], parts, wanted.get("moment", ANY)
        ),
        "torque": order_rows(torque, nodes, flat, least["torque"], wanted=wanted.get("torque", ANY)),
    }


def order_rows(
    values: Array, nodes: CycleNodes, turning: CycleTurning, least: float, parts: Mapping[str, Array] = NO_PARTS,
    wanted: WantedOrders = ANY,
) -> tuple[OrderRow, ...]:  # fmt: skip
    """The orders of the sum over the bodies of values (n, bodies, c), up to the last that counts, and those asked for.

    least: what is below is rounding of what moves, or an error; parts: of which the values are sums, told beside them.
    """
    turns, sum_ = turning.turns, values.sum(axis=1)
    error = float(lengths(nodes.errors(sum_).order)) + wanted.noise
    orders = wanted.of(nodes, sum_, max(least, error))
    amplitudes = nodes.amplitudes(values, orders)
    apart = {name: nodes.amplitudes(part, orders) for name, part in parts.items()}
    whole, own = amplitudes.sum(axis=1), lengths(amplitudes).sum(axis=1)
    largest = float(own.max(initial=0.0))
    rounding = max(tolerances.ORDERS_SETTLED * largest, least, error)
    terms = own + sum((lengths(part).sum(axis=1) for part in apart.values()), np.zeros_like(own))
    counts = rounding if nodes.last_order is not None else max(IN_TABLE * float(terms.max(initial=0.0)), rounding)
    last = int(orders[np.flatnonzero(terms > counts).max(initial=turns - 1)])
    told = np.flatnonzero((orders <= last) | wanted.are_asked(orders, turns))
    left, none = lengths(whole), np.maximum(tolerances.CANCELS * own, rounding)
    verdicts = [verdict_of(float(left[i]), float(own[i]), largest, max(least, error)) for i in told.tolist()]
    none[told[[verdict != "remains" for verdict in verdicts]]] = math.inf
    a = above(whole, none[:, None])
    sizes, angles, reach = np.abs(a), phases(a), lengths(a)
    split_none = np.maximum(tolerances.CANCELS * terms, rounding)[:, None]
    split = {name: above(part.sum(axis=1), split_none) for name, part in apart.items()}
    split_told = {name: (np.abs(part), phases(part)) for name, part in split.items()}
    rows = []
    for i, verdict in zip(told.tolist(), verdicts, strict=True):
        row = OrderRow(
            float(orders[i] / turns), sizes[i], angles[i], float(reach[i]), float(own[i]), verdict, error,
            parts={name: (size[i], angle[i]) for name, (size, angle) in split_told.items()} or None,
        )  # fmt: skip
        rows.append(in_the_plane(row, whole[i], turning, float(none[i])))
    return tuple(rows)


def in_the_plane(row: OrderRow, a: Array, turning: CycleTurning, none: float) -> OrderRow:
    """The row with the vectors that turn across the cycle's axis; none: what is no more is rounding."""
    if turning.axis is None:
        return row
    P, N = (abs(one[0]) if abs(one[0]) > none else 0.0 for one in turning_vectors(a[None, :], turning.axis))
    across = bool(abs(a @ turning.axis) <= none)
    return replace(row, with_turn=float(P), against=float(N), across=across)


def above(a: Array, none: float) -> Array:
    """Complex numbers, 0 where they are no larger than rounding."""
    return np.asarray(np.where(np.abs(a) > none, a, 0.0))


def phases(a: Array) -> Array:
    """The phases of complex amplitudes of cos(kφ - phase), in (-π, π]; 0 of what is none."""
    found = -np.angle(a)
    return np.asarray(np.where(found <= tolerances.SAME_VALUE - math.pi, found + 2.0 * math.pi, found) + 0.0)


def lengths(vectors: Array) -> Array:
    """The magnitudes of complex vectors (..., c)."""
    return np.asarray(np.sqrt(np.sum(np.abs(vectors) ** 2, axis=-1)))
