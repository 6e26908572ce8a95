"""Search the extremes of sampled quantities between the samples, until no interval promises more than the best found.

A quantity is known on a grid and can be sampled at any other instant. Intervals that promise more than the best value
so far (study/search/intervals.py), by more than a share of the quantity's own error, are sampled where they promise
most, for all quantities in one batch, and divided there, until none is left. So values and parabolas agree in the end;
at a kink or a jump the intervals shrink to nothing. Neighbouring instants no farther apart than rounding are the two
sides of a jump: nothing is searched between them. Of peaks that are equal within the quantity's error, as those of a
periodic motion are, the first is named. Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Extremes, Indices, Mask
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

FIRST_INTERVALS = 4  # intervals of a quantity that are sampled in the first round, twice as many in each following one
MIN_STRETCH = 5  # fewest instants of a smooth stretch that show its second derivative and how that changes
MAX_ROUNDS = 60  # enough halvings to reach rounding at an unannounced jump
MAX_PROBES = 100_000  # instants sampled in one search
MAX_COLUMNS = 400  # varying quantities that a table searches; if there are more, it shows the values at the instants
SAME_PROBE = 1e-4  # share of an interval: closer instants are sampled as one; the summit's error is its square
ROUNDS_FOR_FIRST = 5  # three show a smooth peak to rounding, the others lower peaks before it
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


class GridSize(NamedTuple):
    """The number of instants that a search begins with, and the time from the first to the last [s]."""

    instants: int
    span: float


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


def search_extremes(
    sample: ColumnSampler,
    times: Array,
    groups: Sequence[Sequence[int]] | None = None,
    *,
    errors: Array | None = None,
    is_squared: Mask | None = None,
    search_between: bool = True,
    max_groups: int | None = None,
    sides: tuple[float, ...] = BOTH_SIDES,
) -> Extremes:
    """Search the extremes over the span of `times`, (n_t,) ascending, of the columns that `sample` gives.

    groups: the columns that are compared with each other; by default each column is on its own
    errors (n,): of each group's numbers
    is_squared (n,): whether its columns are squares of these numbers
    search_between: whether to search between the instants, too, if no more than `max_groups` groups vary; otherwise the
    values at `times` are the result
    sides: the extremes searched between the instants
    """
    values = sample(times)
    column_groups = [[column] for column in range(values.shape[1])] if groups is None else groups
    n = len(column_groups)
    if n == 0:
        none, nowhere = np.zeros(0), np.zeros(0, dtype=np.intp)
        return Extremes(none, none, nowhere, none, none, nowhere, is_searched=True)
    column = np.concatenate([np.asarray(group, dtype=np.intp) for group in column_groups])
    owner = np.repeat(np.arange(n), [len(group) for group in column_groups])
    is_squared = np.zeros(n, dtype=bool) if is_squared is None else np.asarray(is_squared, dtype=bool)
    largest = np.zeros(n)
    np.maximum.at(largest, owner, replace_non_finite(np.abs(values[:, column]), 0.0).max(axis=0))
    least = tolerances.CONSTANT * np.where(is_squared, np.sqrt(largest), largest)
    targets = Targets(n, column, owner, least if errors is None else np.fmax(errors, least), is_squared)
    best = find_best(times, values, targets)
    if max_groups is not None:
        search_between = search_between and len(sort_distinct(owner[_find_varying(values[:, column])])) <= max_groups
    complete = True
    if search_between and len(times) > 1:
        grid_size = GridSize(len(times), float(np.ptp(times)))
        intervals = find_intervals(times, values, targets, best, sides)
        complete = refine_best(sample, intervals, targets, best, grid_size)
        name_first_peaks(sample, intervals, times, values, targets, best)
    value = np.repeat([-1.0, 1.0], n) * best.height
    time, column = best.time, best.column
    return Extremes(value[:n], time[:n], column[:n], value[n:], time[n:], column[n:], search_between, complete)


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
    varies = _find_varying(heights)
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


def refine_best(sample: ColumnSampler, pool: Intervals, targets: Targets, best: Best, grid_size: GridSize) -> bool:
    """Divide the intervals until none promises more than the best, which is updated in place; return whether that
    succeeded.

    Where a round would sample more instants than the grid has, neighbouring ones are sampled as one.
    """
    probes = 0
    for turn in range(MAX_ROUNDS):
        shape = pool.compute_bends()
        promise = targets.limit_promise(pool.bound_heights(shape), pool.target)
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * grid_size.span
        worth = wide & (promise > (best.height + targets.find_min_gain(best.height))[pool.target])
        if not worth.all():
            pool, shape, promise = pool.select(worth), shape.select(worth), promise[worth]
        if not len(promise):
            return True
        if probes > MAX_PROBES:
            return False
        is_chosen = _select_most_promising(
            promise - best.height[pool.target], pool.target, FIRST_INTERVALS << min(turn, 12)
        )
        chosen, shape, rest = (
            (pool, shape, None)
            if is_chosen.all()
            else (pool.select(is_chosen), shape.select(is_chosen), pool.select(~is_chosen))
        )
        probe_times = chosen.choose_probes(shape)
        instants = sort_distinct(probe_times)
        if len(instants) > grid_size.instants:
            probe_times = merge_neighbours(probe_times, chosen.t[:, 2] - chosen.t[:, 1])
            instants = sort_distinct(probe_times)
        side = np.where(chosen.target < targets.n, -1.0, 1.0)
        height = side * sample(instants)[np.searchsorted(instants, probe_times), chosen.column]
        probes += len(instants)
        best.update(height, probe_times, chosen.column, chosen.target)
        parts = chosen.divide(shape, probe_times, height)
        pool = parts if rest is None else concatenate_intervals([rest, parts])
    return False


def name_first_peaks(
    sample: ColumnSampler, intervals: Intervals, times: Array, values: Array, targets: Targets, best: Best
) -> None:
    """Replace the time and column of each best, in place, by those of the first peak that equals it; its height stays.

    intervals: of the grid, those that may hold a value as high

    The earliest are sampled first. No more instants are sampled than the grid has: what is found until then is a peak
    of that height, too.
    """
    equal = targets.find_equal_height(best.height)
    for side, offset in ((-1.0, 0), (1.0, targets.n)):
        target = targets.owner + offset
        is_equal = side * values[:, targets.column] >= equal[target]
        first = np.argmax(is_equal, axis=0)
        found = np.flatnonzero(is_equal[first, np.arange(len(first))])
        _move_earlier(best, times[first[found]], targets.column[found], target[found])
    pool = _select_before_dips(intervals, times, values, targets, best)
    probes = 0
    for _ in range(ROUNDS_FOR_FIRST):
        shape = pool.compute_bends()
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * np.ptp(times)
        worth = wide & (targets.limit_promise(pool.bound_heights(shape), pool.target) > equal[pool.target])
        worth &= pool.t[:, 2] < best.time[pool.target]
        pool, shape = pool.select(worth), shape.select(worth)
        if not worth.any() or probes > len(times):
            return
        is_chosen = _select_most_promising(-pool.t[:, 1], pool.target, FIRST_INTERVALS)
        chosen, shape = pool.select(is_chosen), shape.select(is_chosen)
        probe_times = merge_neighbours(chosen.choose_probes(shape), chosen.t[:, 2] - chosen.t[:, 1])
        instants = sort_distinct(probe_times)
        signs = np.where(chosen.target < targets.n, -1.0, 1.0)
        height = signs * sample(instants)[np.searchsorted(instants, probe_times), chosen.column]
        probes += len(instants)
        is_equal = height >= equal[chosen.target]
        _move_earlier(best, probe_times[is_equal], chosen.column[is_equal], chosen.target[is_equal])
        pool = concatenate_intervals([pool.select(~is_chosen), chosen.divide(shape, probe_times, height)])


def _select_before_dips(pool: Intervals, times: Array, values: Array, targets: Targets, best: Best) -> Intervals:
    """Select the intervals of a grid after which the column falls and rises again up to the best of its target: those
    of other peaks.
    """
    is_high = pool.target >= targets.n
    key = pool.column + values.shape[1] * is_high
    keys = sort_distinct(key)
    place = np.searchsorted(keys, key)
    end = np.zeros(len(keys), dtype=np.intp)
    end[place] = np.searchsorted(times, best.time[pool.target])
    is_low_key = keys < values.shape[1]
    heights = np.where(is_low_key, -1.0, 1.0) * values[:, keys % values.shape[1]]
    heights[np.arange(len(times))[:, None] >= end] = np.inf
    lowest_after = np.minimum.accumulate(heights[::-1], axis=0)[::-1]
    following = np.searchsorted(times, pool.t[:, 2])
    return pool.select(lowest_after[following, place] < np.maximum(pool.f[:, 1], pool.f[:, 2]))


def _move_earlier(best: Best, times: Array, column: Indices, target: Indices) -> None:
    """Move the best of targets to earlier instants, in place."""
    order = np.argsort(-times, kind="stable")  # the earliest is written last
    order = order[times[order] < best.time[target[order]]]
    best.time[target[order]], best.column[target[order]] = times[order], column[order]


def merge_neighbours(times: Array, width: Array) -> Array:
    """Replace instants next to each other in intervals of some width (n,) by one.

    The several equal parts of a machine, as cylinders and wheels, have their extremes at the same time but for
    rounding.
    """
    order = np.argsort(times, kind="stable")
    ascending = times[order]
    is_separate = np.append(True, np.diff(ascending) > SAME_PROBE * np.minimum(width[order][1:], width[order][:-1]))
    merged = np.empty_like(times)
    merged[order] = ascending[np.maximum.accumulate(np.where(is_separate, np.arange(len(times)), 0))]
    return merged


def _select_most_promising(gains: Array, target: Indices, max_count: int) -> Mask:
    """Mark for each target the `max_count` intervals that promise the largest gains."""
    if len(target) <= max_count:
        return np.ones(len(target), dtype=bool)
    order = np.lexsort((-gains, target))
    starts = np.append(True, target[order[1:]] > target[order[:-1]])
    rank = np.arange(len(order)) - np.maximum.accumulate(np.where(starts, np.arange(len(order)), 0))
    is_chosen = np.empty(len(order), dtype=bool)
    is_chosen[order] = rank < max_count
    return is_chosen


def replace_non_finite(values: Array, infinite: float | None = None) -> Array:
    """Replace nan by 0, and infinities by `infinite`, by default the largest double."""
    if np.isfinite(values).all():
        return values
    return np.nan_to_num(values, posinf=infinite)


def _find_varying(values: Array) -> Mask:
    """Mark the columns that vary by more than rounding."""
    known = replace_non_finite(values)
    varies: Mask = np.ptp(known, axis=0) > tolerances.CONSTANT * np.abs(known).max(axis=0)
    return varies


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
