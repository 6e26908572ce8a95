"""Count the cycles of a load history by rainflow, and sort them into classes and level crossings (ASTM E1049-85).

Of four consecutive turning points a b c d the range b c is a cycle if it is no larger than the ranges on either side; b
and c are removed, and a d replaces the three ranges. When no more can be removed, the remaining points (the residue)
grow up to the largest range and fall after it; each of its ranges is half a cycle.

The rule of 5.4.4, of three points, counts a range that contains the first point as half a cycle at once, and drops that
point. Both count the same: a range that it drops is smaller than the next one, and so is left to the residue. Where the
two are equal, to the bit, four points count one cycle where three count two halves of the same range and mean. Numbers
only: knows nothing of joints, units or text.

Classes are equally wide. A limit belongs to the class below it, and so does a value above it by no more than its own
error: rounding decides nothing.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask

WHOLE, HALF = 1.0, 0.5


class Cycles(NamedTuple):
    """Cycles (n,): the two turning points of each, in order, so that halves rise or fall; counts: how often each
    occurs.
    """

    begin: Array
    end: Array
    counts: Array

    @property
    def ranges(self) -> Array:
        """The difference between highest and lowest value of each cycle, (n,)."""
        return np.abs(self.end - self.begin)

    @property
    def means(self) -> Array:
        """The mean of highest and lowest value of each cycle, (n,)."""
        return 0.5 * (self.begin + self.end)

    def select(self, mask: Mask) -> Cycles:
        """Return the cycles that the mask marks."""
        return Cycles(*(x[mask] for x in self))


def find_turning_points(values: Array) -> Array:
    """Return the first of some values (n,), each at which they turn, and the last; equal neighbours count as one
    point.
    """
    change = np.diff(values)
    changing = np.flatnonzero(change)
    if not len(changing):
        return values[:1]
    rises = change[changing] > 0.0
    turns = changing[1:][rises[1:] != rises[:-1]]
    return np.concatenate([values[:1], values[turns], values[-1:]])


def count_once(values: Array) -> Cycles:
    """Count the cycles of a history (n,) that is run through once: whole cycles, then the halves of the residue."""
    closed, residue = pair_points(find_turning_points(values).tolist())
    return concatenate_cycles([make_whole_cycles(closed), make_half_cycles(residue)])


def count_repeated(values: Array, times: int) -> Cycles:
    """Count the cycles of a history (n,), closed to its beginning, that is run through `times` times.

    The residue is the same from the second pass on, so each further pass closes the same cycles.
    """
    period = find_turning_points(np.append(values[:-1], values[:1]))
    closed, residue = pair_points(period.tolist())
    parts, passes = [make_whole_cycles(closed, float(times))], 1
    while passes < times:
        before = residue
        points = find_turning_points(np.array(before + pair_points(period.tolist()).residue))
        closed, residue = pair_points(points.tolist())
        again = 1 if residue != before else times - passes
        parts.append(make_whole_cycles(closed, float(again)))
        passes += again
    return concatenate_cycles([*parts, make_half_cycles(residue)])


def count_endless(values: Array) -> Cycles:
    """Count the cycles that each pass adds if a history (n,), closed to its beginning, is repeated for ever: no halves.

    It starts at its highest point (5.4.5); then the residue is the largest range, up and down.
    """
    period = values[:-1] if len(values) > 1 else values
    top = int(np.argmax(period))
    points = find_turning_points(np.concatenate([period[top:], period[: top + 1]]))
    closed, residue = pair_points(points.tolist())
    return make_whole_cycles([*closed, *zip(residue[:-1:2], residue[1::2], strict=True)])


class PairedPoints(NamedTuple):
    """The cycles that close among turning points, by both ends, and the turning points that remain."""

    closed: list[tuple[float, float]]
    residue: list[float]


def pair_points(points: list[float]) -> PairedPoints:
    """Pair the turning points whose cycles close; plain floats, 0.2 µs a point."""
    closed: list[tuple[float, float]] = []
    residue: list[float] = []
    for d in points:
        while len(residue) > 2:
            b, c = residue[-2], residue[-1]
            inner = abs(c - b)
            if inner > abs(d - c) or inner > abs(b - residue[-3]):
                break
            closed.append((b, c))
            del residue[-2:]
        residue.append(d)
    return PairedPoints(closed, residue)


def make_whole_cycles(pairs: list[tuple[float, float]], times: float = 1.0) -> Cycles:
    """Make closed cycles, each counted `times` times."""
    ends = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return Cycles(ends[:, 0], ends[:, 1], np.full(len(ends), times * WHOLE))


def make_half_cycles(residue: list[float]) -> Cycles:
    """Make the half cycles between the points of a residue."""
    points = np.array(residue)
    return Cycles(points[:-1], points[1:], np.full(max(len(points) - 1, 0), HALF))


def concatenate_cycles(parts: list[Cycles]) -> Cycles:
    """Concatenate several lists of cycles."""
    return Cycles(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


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
