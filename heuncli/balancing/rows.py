"""The orders of a cycle's force, moment and torque as rows with their verdicts; what is rounding reads 0."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from heuncli import tolerances
from heuncli.balancing.effects import MassEffects
from heuncli.balancing.harmonics import orders_of, turning_vectors
from heuncli.balancing.results import OrderRow, Residual
from heuncli.balancing.verdicts import verdict_of
from heuncli.records import record, replace
from heuncli.results import Array

NO_PARTS: Mapping[str, Array] = MappingProxyType({})


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

    @property
    def backwards(self) -> bool:
        """Whether the angle falls."""
        return self.rate is not None and self.rate < 0.0


def rounding_of(effects: MassEffects, scale: float) -> dict[str, float]:
    """What is rounding of force, moment and torque at a rate of which `scale` is the square."""
    return {name: tolerances.ORDERS_SETTLED * scale * terms for name, terms in effects.terms.items()}


def all_rows(
    effects: MassEffects, turning: CycleTurning, least: Mapping[str, float]
) -> dict[str, tuple[OrderRow, ...]]:
    """The orders of force and moment ON the foundation, and of torque, at the rate; below `least` is none."""
    scale = turning.scale
    angles, torque = effects.angles, scale * effects.half_slope[:, :, None]
    parts = {"orbital": -scale * effects.orbital, "spin": -scale * effects.spin}
    return {
        "force": order_rows(-scale * effects.force, angles, turning, least["force"]),
        "moment": order_rows(-scale * effects.moment, angles, turning, least["moment"], parts),
        "torque": order_rows(torque, angles, replace(turning, axis=None), least["torque"]),
    }


def order_rows(
    values: Array, angles: Array, turning: CycleTurning, least: float, parts: Mapping[str, Array] = NO_PARTS
) -> tuple[OrderRow, ...]:
    """The orders of the sum over the bodies of values (n, bodies, c), up to the last that is no rounding.

    least: what is below is rounding of what moves; parts: of which the values are sums, told beside them.
    """
    turns = turning.turns
    amplitudes = orders_of(values, angles, turns).values
    apart = {name: orders_of(part, angles, turns).values for name, part in parts.items()}
    whole, own = amplitudes.sum(axis=1), lengths(amplitudes).sum(axis=1)
    largest = float(own[1:].max(initial=0.0))
    rounding = max(tolerances.ORDERS_SETTLED * largest, least)
    terms = own + sum((lengths(part).sum(axis=1) for part in apart.values()), np.zeros_like(own))
    last = int(np.flatnonzero(terms > rounding).max(initial=turns))
    rows = []
    for k in range(1, last + 1):
        verdict = verdict_of(float(lengths(whole[k])), float(own[k]), largest, least)
        none = max(tolerances.CANCELS * float(own[k]), rounding) if verdict == "remains" else math.inf
        a = above(whole[k], none)
        row = OrderRow(k / turns, np.abs(a), phases(a), float(lengths(a)), float(own[k]), verdict)
        row = in_the_plane(row, whole[k], turning, none)
        none = max(tolerances.CANCELS * float(terms[k]), rounding)
        split = {name: above(part[k].sum(axis=0), none) for name, part in apart.items()}
        told = {name: (np.abs(part), phases(part)) for name, part in split.items()}
        rows.append(replace(row, parts=told) if told else row)
    return tuple(rows)


def in_the_plane(row: OrderRow, a: Array, turning: CycleTurning, none: float) -> OrderRow:
    """The row with the vectors that turn across the cycle's axis; none: what is no more is rounding."""
    if turning.axis is None:
        return row
    P, N = (abs(one[0]) if abs(one[0]) > none else 0.0 for one in turning_vectors(a[None, :], turning.axis))
    with_turn, against = (N, P) if turning.backwards else (P, N)
    across = bool(abs(a @ turning.axis) <= none)
    return replace(row, with_turn=float(with_turn), against=float(against), across=across)


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


def residual(values: Array, angles: Array, least: float) -> Residual:
    """Root of the mean square of the sum over the bodies of values (n, bodies, c), the largest and where."""
    sizes = lengths(values.sum(axis=1))
    k = int(np.argmax(sizes))
    if sizes[k] <= max(tolerances.CANCELS * float(lengths(values).sum(axis=1).max()), least):
        return Residual(0.0, 0.0, float(angles[0]))
    return Residual(float(np.sqrt(np.mean(sizes**2))), float(sizes[k]), float(angles[k]))
