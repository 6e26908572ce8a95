"""Search the extremes of sampled quantities between the samples, until no interval promises more than the best found.

A quantity is known on a grid and can be sampled at any other instant. Intervals that promise more than the best value
so far (grid.py, intervals.py), by more than a share of the quantity's own error, are sampled where they promise
most, for all quantities in one batch, and divided there, until none is left. So values and parabolas agree in the end;
at a kink or a jump the intervals shrink to nothing. Of peaks that are equal within the quantity's error, as those of a
periodic motion are, the first is named. Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Extremes, Indices, Mask
from heuncli.study.search.grid import (
    BOTH_SIDES,
    Best,
    ColumnSampler,
    Targets,
    find_best,
    find_intervals,
    find_varying,
    replace_non_finite,
    sort_distinct,
)
from heuncli.study.search.intervals import Intervals, concatenate_intervals

FIRST_INTERVALS = 4  # intervals of a quantity that are sampled in the first round, twice as many in each following one
MAX_ROUNDS = 60  # enough halvings to reach rounding at an unannounced jump
MAX_PROBES = 100_000  # instants sampled in one search
MAX_COLUMNS = 400  # varying quantities that a table searches; if there are more, it shows the values at the instants
SAME_PROBE = 1e-4  # share of an interval: closer instants are sampled as one; the summit's error is its square
ROUNDS_FOR_FIRST = 5  # three show a smooth peak to rounding, the others lower peaks before it


class GridSize(NamedTuple):
    """The number of instants that a search begins with, and the time from the first to the last [s]."""

    instants: int
    span: float


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
        search_between = search_between and len(sort_distinct(owner[find_varying(values[:, column])])) <= max_groups
    complete = True
    if search_between and len(times) > 1:
        grid_size = GridSize(len(times), float(np.ptp(times)))
        intervals = find_intervals(times, values, targets, best, sides)
        complete = refine_best(sample, intervals, targets, best, grid_size)
        name_first_peaks(sample, intervals, times, values, targets, best)
    value = np.repeat([-1.0, 1.0], n) * best.height
    time, column = best.time, best.column
    return Extremes(value[:n], time[:n], column[:n], value[n:], time[n:], column[n:], search_between, complete)


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
