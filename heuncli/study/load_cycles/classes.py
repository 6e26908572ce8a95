"""Sort cycles into classes by range, and by range and mean, and count how often levels are crossed (ASTM E1049-85,
5.1).

Classes are equally wide. A limit belongs to the class below it, and so does a value above it by no more than its own
error: rounding decides nothing.
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
    """How often levels (n,) are crossed upwards, and downwards."""

    levels: Array
    upward: Array
    downward: Array

    def count_by_reference(self, reference: float) -> Array:
        """Count by 5.1: upwards at the reference and above it, downwards below it, (n,)."""
        return np.where(self.levels >= reference, self.upward, self.downward)


def make_class_limits(lowest: float, highest: float, n: int) -> Array:
    """Return the limits of n equal classes between two numbers, (n + 1,)."""
    return np.asarray(lowest + (highest - lowest) * (np.arange(n + 1) / n))


def find_classes(values: Array, limits: Array, slack: float) -> Indices:
    """Find the class of each value (n,) between limits; slack: by how much it may exceed the limit of its class."""
    return np.asarray(np.clip(np.searchsorted(limits[1:-1] + slack, values, side="left"), 0, len(limits) - 2))


def count_by_range(cycles: Cycles, limits: Array, slack: float, weights: Array | None = None) -> Array:
    """Count the cycles in each class of ranges, (n,); weights: summed in place of their counts."""
    class_indices = find_classes(cycles.ranges, limits, slack)
    return np.asarray(
        np.bincount(class_indices, cycles.counts if weights is None else weights, len(limits) - 1), dtype=np.float64
    )


def count_matrix(cycles: Cycles, ranges: Array, slack: float) -> Matrix:
    """Count the cycles by range and by mean, with as many classes of means; slack: of ranges, twice that of means."""
    n = len(ranges) - 1
    cycle_means = cycles.means
    means = (
        make_class_limits(float(cycle_means.min(initial=np.inf)), float(cycle_means.max(initial=-np.inf)), n)
        if len(cycle_means)
        else np.zeros(n + 1)
    )
    cell = find_classes(cycles.ranges, ranges, slack) * n + find_classes(cycle_means, means, 0.5 * slack)
    counts = np.asarray(np.bincount(cell, cycles.counts, n * n), dtype=np.float64)
    return Matrix(ranges, means, counts.reshape(n, n))


def count_crossings(cycles: Cycles, levels: Array) -> LevelCrossings:
    """Count how often a history with these cycles crosses levels (n,).

    Each whole cycle crosses the levels between its ends once upwards and once downwards, each half cycle in its own
    direction: the counted cycles and the residue cross as often as the history did. A history that only touches a level
    from below does not cross it.
    """
    low, high = np.minimum(cycles.begin, cycles.end), np.maximum(cycles.begin, cycles.end)
    is_half = cycles.counts == HALF
    rises = cycles.end > cycles.begin
    up = np.where(is_half, np.where(rises, 1.0, 0.0), cycles.counts)
    down = np.where(is_half, np.where(rises, 0.0, 1.0), cycles.counts)
    return LevelCrossings(
        levels,
        _sum_weights_below(low, up, levels, "right") - _sum_weights_below(high, up, levels, "right"),
        _sum_weights_below(low, down, levels, "left") - _sum_weights_below(high, down, levels, "left"),
    )


def _sum_weights_below(end_points: Array, weights: Array, levels: Array, side: str) -> Array:
    """Sum the weights of the ends below each level, (n,); with those at the level itself (right), or without (left)."""
    order = np.argsort(end_points, kind="stable")
    total = np.concatenate([[0.0], np.cumsum(weights[order])])
    return np.asarray(total[np.searchsorted(end_points[order], levels, side="right" if side == "right" else "left")])
