"""The grid of instants that a search starts from: what is searched, the best on the grid, and where more may hide.

The targets of a search are the lowest and the highest values of groups of columns, as heights: the lowest with their
sign changed. Of the intervals between neighbouring instants those are found that promise more than a target's best, by
the bends of parabolas through their neighbours (intervals.py). Neighbouring instants no farther apart than rounding are
the two sides of a jump: nothing is searched between them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.expressions.discontinuities import MAX_TIED_DOUBLES
from heuncli.study.search.intervals import (
    FOURTH_DERIVATIVE_SHARE,
    Intervals,
    bound_heights,
    bound_heights_cheaply,
    concatenate_intervals,
    fill_missing,
)

# takes sorted instants (n,), returns the quantities there, (n, n_columns)
ColumnSampler = Callable[[Array], Array]
# takes the heights at both ends of intervals and the targets these belong to, returns the height to be exceeded
HeightToBeat = Callable[[Array, Array, Indices], Array]
MIN_STRETCH = 5  # fewest instants of a smooth stretch that show its second derivative and how that changes
KNOWN_WELL = 1e-6  # relative error: peaks are compared where tables show all their six digits
GOOD_ENOUGH = 0.1  # share of a quantity's own error: a smaller gain is not searched for
BOTH_SIDES = (-1.0, 1.0)  # the lowest and the highest: signs that make each a maximum


class Targets(NamedTuple):
    """The 2n targets of a search, as heights: the lowest values of n groups of columns, then the highest.

    column (m,): the columns of all groups
    owner (m,): the group of each of these columns
    error (n,): absolute, of the searched number
    is_squared (n,): whether the columns are squares of that number
    """

    n: int
    column: Indices
    owner: Indices
    error: Array
    is_squared: Mask

    def find_min_gain(self, height: Array) -> Array:
        """Return how much more than the best so far (2n,) an interval must promise to be worth a sample, (2n,)."""
        return self._convert_error(GOOD_ENOUGH * self.error, height)

    def find_equal_height(self, height: Array) -> Array:
        """Return the heights from which peaks equal the best (2n,) within the error; infinite where that is large."""
        margin = self._convert_error(self.error, height)
        return np.where(margin <= KNOWN_WELL * np.abs(height), height - margin, np.inf)

    def _convert_error(self, error: Array, height: Array) -> Array:
        """Return the error (2n,) of heights from that (n,) of the numbers, at least their rounding."""
        size = np.where(np.isfinite(height), np.abs(height), 0.0).reshape(2, self.n)
        # of squares: (|x| + e)^2 - x^2 = e^2 + 2 e |x|
        squared = error * error + 2.0 * error * np.sqrt(size)
        return np.asarray(np.where(self.is_squared, squared, error) + tolerances.SUM_ROUNDING * size).reshape(-1)

    def limit_promise(self, promise: Array, target: Indices) -> Array:
        """Limit promises of targets to possible values: no square is below 0."""
        bounded = self.is_squared[target % self.n] & (target < self.n)
        return np.asarray(np.where(bounded, np.minimum(promise, 0.0), promise))


class Best(NamedTuple):
    """The best of each target so far, (2n,): its height, time and column."""

    height: Array
    time: Array
    column: Indices

    def update(self, height: Array, times: Array, column: Indices, target: Indices) -> None:
        """Replace the best of each target by better ones among more heights, in place."""
        known = np.where(np.isnan(height), -np.inf, height)
        order = np.lexsort((known, target))
        ascending = target[order]
        last = order[np.append(ascending[1:] != ascending[:-1], np.ones(min(len(order), 1), dtype=bool))]
        better = last[known[last] > np.where(np.isnan(self.height), -np.inf, self.height)[target[last]]]
        own = target[better]
        self.height[own], self.time[own], self.column[own] = height[better], times[better], column[better]


def find_best(times: Array, values: Array, targets: Targets) -> Best:
    """Return the best of each target on the grid; nan only where a target has no other values."""
    parts = []
    for side in (-1.0, 1.0):
        heights = side * values[:, targets.column]
        known_heights = np.where(np.isnan(heights), -np.inf, heights)
        instant = np.argmax(known_heights, axis=0)
        order = np.lexsort((-known_heights[instant, np.arange(len(targets.column))], targets.owner))
        place = np.empty(targets.n, dtype=np.intp)
        place[targets.owner[order[::-1]]] = order[::-1]
        instant = instant[place]
        parts.append((heights[instant, place], times[instant], targets.column[place]))
    return Best(*(np.concatenate(both) for both in zip(*parts, strict=True)))


def find_intervals(
    times: Array, values: Array, targets: Targets, best: Best, sides: tuple[float, ...] = BOTH_SIDES
) -> Intervals:
    """Return the grid intervals that may hold a value as high as the best sample, for each side."""
    heights = np.fmin(targets.find_equal_height(best.height), best.height + targets.find_min_gain(best.height))
    return find_intervals_above(times, values, targets, lambda b, c, target: heights[target], sides)


def find_intervals_above(
    times: Array, values: Array, targets: Targets, to_beat: HeightToBeat, sides: tuple[float, ...] = BOTH_SIDES
) -> Intervals:
    """Return the intervals of the grid that promise more than the height that `to_beat` requires, on these sides."""
    step = times[1:] - times[:-1]
    smooth = ~find_jump_sides(times)
    heights = values[:, targets.column]
    varies = find_varying(heights)
    heights, owner, column = heights[:, varies], targets.owner[varies], targets.column[varies]
    slope = (heights[1:] - heights[:-1]) / step[:, None]
    slope[~smooth] = np.nan
    kappa_before, kappa_after = fill_missing(*_compute_bends(times, slope, step, smooth))
    rise_before, rise_after = _compute_rises(slope, step)
    most = np.maximum(np.abs(kappa_before), np.abs(kappa_after))
    doubt = FOURTH_DERIVATIVE_SHARE * most
    inner = np.concatenate([[False], smooth, [False]])
    parts = []
    for side in sides:
        target = owner if side < 0.0 else owner + targets.n
        b, c, before, after, rising, falling = (
            side * x for x in (heights[:-1], heights[1:], kappa_before, kappa_after, rise_before, rise_after)
        )
        with np.errstate(invalid="ignore"):
            k, j = np.nonzero(
                (bound_heights_cheaply(b, c, most, rising, falling) > to_beat(b, c, target)) & smooth[:, None]
            )
        promise_inputs = (x[k, j] for x in (b, c, before, after, doubt, rising, falling))
        is_promising = targets.limit_promise(bound_heights(*promise_inputs), target[j]) > to_beat(
            b[k, j], c[k, j], target[j]
        )
        k, j = k[is_promising], j[is_promising]
        # the interval b..c with its neighbours a and d (intervals.py); for one after a jump or the
        # end, one on the parabola stands in
        w, b_height, c_height = step[k], heights[k, j], heights[k + 1, j]
        k_before, k_after = np.maximum(k - 1, 0), np.minimum(k + 2, len(times) - 1)
        known = inner[k] & np.isfinite(heights[k_before, j]), inner[k + 2] & np.isfinite(heights[k_after, j])
        t = [np.where(known[0], times[k_before], times[k] - w), np.where(known[1], times[k_after], times[k + 1] + w)]
        a = np.where(known[0], heights[k_before, j], 2.0 * b_height - c_height - 2.0 * kappa_before[k, j])
        d = np.where(known[1], heights[k_after, j], 2.0 * c_height - b_height - 2.0 * kappa_after[k, j])
        parts.append(Intervals(
            np.stack([t[0], times[k], times[k + 1], t[1]], 1), side * np.stack([a, b_height, c_height, d], 1),
            doubt[k, j], np.zeros(len(k), dtype=bool), target[j], column[j],
        ))  # fmt: skip
    return concatenate_intervals(parts)


def _compute_bends(times: Array, slope: Array, step: Array, smooth: Mask) -> tuple[Array, Array]:
    """Return κ of the parabolas with the neighbour before and with that after each interval, (n_t - 1, m).

    At the end of a smooth stretch the second differences are extrapolated.
    """
    second = np.full((len(times) + 2, slope.shape[1]), np.nan)  # [k + 1]: about the instant k
    if len(times) > 2:
        second[2:-2] = (slope[1:] - slope[:-1]) / (times[2:] - times[:-2])[:, None]
    begins = np.append(True, ~smooth)  # whether a stretch begins at an instant, or ends
    ends = np.append(~smooth, True)
    for edge, inward in ((begins, 1), (ends, -1)):
        k = np.flatnonzero(edge) + 1
        near, far = (second.take(k + n * inward, 0, mode="clip") for n in (1, 2))
        second[k] = np.where(np.isfinite(far), 2.0 * near - far, near)
    square = -(step * step)[:, None]
    return square * second[1:-2], square * second[2:-1]


def _compute_rises(slope: Array, step: Array) -> tuple[Array, Array]:
    """Return how far a quantity would rise from b to c at its slope before b, and from c back to b at its slope after
    c, (n_t - 1, m).
    """
    up, down = np.full(slope.shape, np.nan), np.full(slope.shape, np.nan)
    up[1:], down[:-1] = slope[:-1] * step[1:, None], -slope[1:] * step[:-1, None]
    return up, down


def find_varying(values: Array) -> Mask:
    """Mark the columns that vary by more than rounding."""
    known = replace_non_finite(values)
    varies: Mask = np.ptp(known, axis=0) > tolerances.CONSTANT * np.abs(known).max(axis=0)
    return varies


def replace_non_finite(values: Array, infinite: float | None = None) -> Array:
    """Replace nan by 0, and infinities by `infinite`, by default the largest double."""
    if np.isfinite(values).all():
        return values
    return np.nan_to_num(values, posinf=infinite)


def find_jump_sides(times: Array) -> Mask:
    """Mark the neighbouring instants that are the two sides of a jump: no farther apart than rounding, (n_t - 1,)."""
    return np.asarray(times[1:] - times[:-1] <= 2.0 * MAX_TIED_DOUBLES * tolerances.EPS * np.abs(times[1:]))


def fill_short_stretches(times: Array) -> Array:
    """Add instants in stretches between two jumps that have too few to show how quantities bend."""
    jumps = find_jump_sides(times)
    if not jumps.any() and len(times) > MIN_STRETCH:
        return times
    stretch = np.append(0, np.cumsum(jumps))
    is_short = (np.diff(stretch) == 0) & (np.bincount(stretch)[stretch[1:]] < MIN_STRETCH)
    more = times[:-1][is_short, None] + np.diff(times)[is_short, None] * (np.arange(1, MIN_STRETCH) / MIN_STRETCH)
    return np.asarray(sort_distinct(np.concatenate([times, more.ravel()])))


def sort_distinct(values: np.ndarray[Any, Any]) -> Any:
    """Return the distinct numbers, ascending; np.unique would import numpy.ma for it, 10 ms."""
    ascending = values.flatten()
    ascending.sort()
    first = np.ones(len(ascending), dtype=bool)
    np.not_equal(ascending[1:], ascending[:-1], out=first[1:])
    return ascending[first]
