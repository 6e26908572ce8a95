"""The orders of a cycle's force, moment and torque as rows with their verdicts; what is rounding reads 0."""

from __future__ import annotations

import math

import numpy as np

from heuncli import tolerances
from heuncli.commands.balance.effects import MassEffects
from heuncli.commands.balance.harmonics import orders_of, turning_vectors
from heuncli.commands.balance.results import OrderRow, Residual
from heuncli.commands.balance.verdicts import verdict_of
from heuncli.records import record, replace
from heuncli.results import Array


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


def all_rows(effects: MassEffects, turning: CycleTurning) -> dict[str, tuple[OrderRow, ...]]:
    """The orders of force, moment and torque at the rate, ON the foundation, and of the drive."""
    scale = turning.scale
    return {
        "force": order_rows(-scale * effects.force, effects.angles, turning),
        "moment": moment_rows(-scale * effects.orbital, -scale * effects.spin, effects.angles, turning),
        "torque": order_rows(scale * effects.half_slope[:, :, None], effects.angles, replace(turning, axis=None)),
    }


def order_rows(values: Array, angles: Array, turning: CycleTurning) -> tuple[OrderRow, ...]:
    """The orders of the sum over the bodies of values (n, bodies, c), up to the last that is no rounding."""
    turns, axis = turning.turns, turning.axis
    amplitudes = orders_of(values, angles, turns).values
    whole = amplitudes.sum(axis=1)
    sizes = lengths(whole)
    own = lengths(amplitudes).sum(axis=1)
    largest = float(own[1:].max(initial=0.0))
    told = np.flatnonzero(own > tolerances.ORDERS_SETTLED * largest)
    last = int(told.max(initial=0)) if largest > 0.0 else 0
    P, N = turning_vectors(whole, axis) if axis is not None else (None, None)
    if turning.backwards:
        P, N = N, P
    rows = []
    for k in range(1, max(last, turns) + 1):
        verdict = verdict_of(float(sizes[k]), float(own[k]), largest)
        least = tolerances.CANCELS * own[k] if verdict == "remains" else math.inf  # below it stands rounding
        a = np.where(np.abs(whole[k]) > least, whole[k], 0.0)
        rows.append(OrderRow(
            order=k / turns, amplitude=np.abs(a), phase=phases(a), size=float(lengths(a)), own=float(own[k]),
            verdict=verdict,
            with_turn=None if P is None else clean(P[k], least), against=None if N is None else clean(N[k], least),
            across=axis is not None and bool(abs(a @ axis) <= least),
        ))  # fmt: skip
    return tuple(rows)


def moment_rows(orbital: Array, spin: Array, angles: Array, turning: CycleTurning) -> tuple[OrderRow, ...]:
    """The orders of the moment, with those of its two parts beside them."""
    rows = order_rows(orbital + spin, angles, turning)
    both = {"orbital": orbital, "spin": spin}
    parts = {name: orders_of(own, angles, turning.turns).values for name, own in both.items()}
    found = []
    for row in rows:
        k = round(row.order * turning.turns)
        own = float(sum(lengths(part[k]).sum() for part in parts.values()))
        least = tolerances.CANCELS * own if row.verdict != "does not arise" else math.inf
        split = {}
        for name, part in parts.items():
            a = part[k].sum(axis=0)
            a = np.where(np.abs(a) > least, a, 0.0)
            split[name] = (np.abs(a), phases(a))
        found.append(replace(row, parts=split))
    return tuple(found)


def phases(a: Array) -> Array:
    """The phases of complex amplitudes of cos(kφ - phase), in (-π, π]; 0 of what is none."""
    found = -np.angle(a)
    return np.asarray(np.where(found <= -math.pi, math.pi, found) + 0.0)


def clean(value: complex, least: float) -> float:
    """A magnitude, 0 where it is no larger than rounding."""
    return float(abs(value)) if abs(value) > least else 0.0


def lengths(vectors: Array) -> Array:
    """The magnitudes of complex vectors (..., c)."""
    return np.asarray(np.sqrt(np.sum(np.abs(vectors) ** 2, axis=-1)))


def residual(values: Array, angles: Array) -> Residual:
    """Root of the mean square of the sum over the bodies of values (n, bodies, c), the largest and where."""
    sizes = lengths(values.sum(axis=1))
    k = int(np.argmax(sizes))
    if sizes[k] <= tolerances.CANCELS * float(lengths(values).sum(axis=1).max()):
        return Residual(0.0, 0.0, float(angles[0]))
    return Residual(float(np.sqrt(np.mean(sizes**2))), float(sizes[k]), float(angles[k]))
