"""Cycles sorted into classes: by range, by range and mean; and how often levels are crossed (ASTM E1049-85, 5.1).

Classes are equally wide. A limit belongs to the class below it, and what is above a limit by no more than its own error
does, too: rounding decides nothing.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices
from heuncli.study.load_cycles.rainflow import HALF, Cycles


class Matrix(NamedTuple):
    """Cycles by range and mean: limits of the classes of both (n + 1,), counts (n ranges, n means)."""

    ranges: Array
    means: Array
    counts: Array


class LevelCrossings(NamedTuple):
    """How often levels (n,) are passed upwards, and downwards."""

    levels: Array
    up: Array
    down: Array

    def counted(self, reference: float) -> Array:
        """As 5.1 counts: upwards at the reference and above it, downwards below it, (n,)."""
        return np.where(self.levels >= reference, self.up, self.down)


def limits(lowest: float, highest: float, n: int) -> Array:
    """Of n classes between two numbers, (n + 1,)."""
    return np.asarray(lowest + (highest - lowest) * (np.arange(n + 1) / n))


def classes_of(values: Array, limits: Array, slack: float) -> Indices:
    """The class of each value (n,) between limits; slack: by how much it may be above the limit of its class."""
    return np.asarray(np.clip(np.searchsorted(limits[1:-1] + slack, values, side="left"), 0, len(limits) - 2))


def by_range(cycles: Cycles, limits: Array, slack: float, weights: Array | None = None) -> Array:
    """How many cycles are in each class of ranges, (n,); weights: what is added up in place of their counts."""
    own = classes_of(cycles.ranges, limits, slack)
    return np.asarray(
        np.bincount(own, cycles.counts if weights is None else weights, len(limits) - 1), dtype=np.float64
    )


def matrix(cycles: Cycles, ranges: Array, slack: float) -> Matrix:
    """The cycles by range and by mean, the means in as many classes; slack: of ranges, twice that of means."""
    n = len(ranges) - 1
    own = cycles.means
    means = limits(float(own.min(initial=np.inf)), float(own.max(initial=-np.inf)), n) if len(own) else np.zeros(n + 1)
    cell = classes_of(cycles.ranges, ranges, slack) * n + classes_of(own, means, 0.5 * slack)
    counts = np.asarray(np.bincount(cell, cycles.counts, n * n), dtype=np.float64)
    return Matrix(ranges, means, counts.reshape(n, n))


def crossings(cycles: Cycles, levels: Array) -> LevelCrossings:
    """How often the history passes levels (n,) that has these cycles.

    Each whole cycle passes those between its ends once upwards and once downwards, each half in its own direction: what
    is taken out of a history and what is left pass as often as it did. A history that only touches a level from below
    does not pass it.
    """
    low, high = np.minimum(cycles.begin, cycles.end), np.maximum(cycles.begin, cycles.end)
    half = cycles.counts == HALF
    rises = cycles.end > cycles.begin
    up = np.where(half, np.where(rises, 1.0, 0.0), cycles.counts)
    down = np.where(half, np.where(rises, 0.0, 1.0), cycles.counts)
    return LevelCrossings(
        levels,
        _above(low, up, levels, "right") - _above(high, up, levels, "right"),
        _above(low, down, levels, "left") - _above(high, down, levels, "left"),
    )


def _above(ends: Array, weights: Array, levels: Array, side: str) -> Array:
    """The weights of the ends that levels are above, (n,): at the level itself, too (right), or not (left)."""
    order = np.argsort(ends, kind="stable")
    total = np.concatenate([[0.0], np.cumsum(weights[order])])
    return np.asarray(total[np.searchsorted(ends[order], levels, side="right" if side == "right" else "left")])
