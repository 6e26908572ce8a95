"""Extremes of sampled quantities, searched between the samples until nothing promises more than what was found.

A quantity is known on a grid and can be asked for at any other instant. Intervals that promise more than the best value
found so far (study/search/intervals.py), by more than a share of the quantity's own error, are asked where they promise
most, for all quantities in one batch, and divided there, until none is left. So values and parabolas agree in the end;
at a kink or a jump the intervals shrink to nothing. Neighbouring instants no farther apart than rounding are the two
sides of a jump: nothing is searched between them. Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Extremes, Indices, Mask, Results
from heuncli.scene.expressions.discontinuities import MOST_EQUAL
from heuncli.study.search.intervals import FOURTH, Intervals, ceiling, completed, joined, promised

ColumnsAt = Callable[[Array], Array]  # of sorted instants (n,) the quantities there, (n, n_columns)
HeightToBeat = Callable[[Array, Array, Indices], Array]  # by the heights at both ends of intervals, and their targets

FIRST = 4  # intervals of a quantity that are asked in the first round, twice as many in each that follows
FEW = 5  # instants of a smooth stretch, the least that show how it bends, and how that changes
MOST_ROUNDS = 60  # at a jump that nobody told of: halvings down to rounding
MOST_PROBES = 100_000  # instants asked for in one search
MOST_COLUMNS = 400  # of quantities that vary, in tables; beyond, the grid's own values stand
SAME = 1e-4  # of an interval: how near two instants in it are asked as one; a summit is missed by the square of it
GOOD_ENOUGH = 0.1  # of a quantity's own error: what a higher summit is not looked for beyond


BOTH = (-1.0, 1.0)


class ColumnSearch(NamedTuple):
    """What a search is made of: columns of results, (n_t, n_columns), and groups of those that are compared.

    along: quantities of runs of cuts, each with the name of its run, (n_t, n_cuts); each is a group more. errors: of
    the groups' numbers, how well they are known; even: whether they are squares. bent: whether the quantities along
    runs are no polynomials of the loads, as stresses. sides: of which extremes there is use, -1 the lowest, 1 the
    highest: between the samples no other is looked for.
    """

    columns: Callable[[Results], Array]
    groups: Sequence[Sequence[int]]
    errors: Array
    even: Mask
    along: Callable[[Results], Sequence[tuple[str, Array]]] | None = None
    bent: bool = False
    sides: tuple[float, ...] = BOTH


def no_columns(results: Results) -> Array:
    """No columns beside what is searched along runs, (n_t, 0)."""
    return np.zeros((len(results.time), 0))


class Targets(NamedTuple):
    """What is searched for, 2n targets: the lowest values of n groups of columns, then the highest, as heights.

    column, owner (m,): the columns of all groups, and to which group each belongs; error (n,): absolute, of what is
    asked for; even (n,): whether the columns are squares of it.
    """

    n: int
    column: Indices
    owner: Indices
    error: Array
    even: Mask

    def enough(self, height: Array) -> Array:
        """By how much more an interval has to promise than what was found (2n,) to be worth a look, (2n,)."""
        error, even = GOOD_ENOUGH * self.error, self.even
        size = np.where(np.isfinite(height), np.abs(height), 0.0).reshape(2, self.n)
        squared = error * error + 2.0 * error * np.sqrt(size)
        return np.asarray(np.where(even, squared, error) + tolerances.SUM_ROUNDING * size).reshape(-1)

    def possible(self, promise: Array, target: Indices) -> Array:
        """Promises of targets, where they are possible: no square is below 0."""
        bounded = self.even[target % self.n] & (target < self.n)
        return np.asarray(np.where(bounded, np.minimum(promise, 0.0), promise))


class AtFirst(NamedTuple):
    """How many instants a search begins with, and the time from the first to the last [s]."""

    instants: int
    span: float


class Best(NamedTuple):
    """The best of each target so far, (2n,): its height, instant and column."""

    height: Array
    at: Array
    column: Indices

    def take(self, height: Array, at: Array, column: Indices, target: Indices) -> None:
        """Better ones among more heights, in place."""
        known = np.where(np.isnan(height), -np.inf, height)
        order = np.lexsort((known, target))
        ascending = target[order]
        last = order[np.append(ascending[1:] != ascending[:-1], np.ones(min(len(order), 1), dtype=bool))]
        better = last[known[last] > np.where(np.isnan(self.height), -np.inf, self.height)[target[last]]]
        own = target[better]
        self.height[own], self.at[own], self.column[own] = height[better], at[better], column[better]


def search(
    sample: ColumnsAt,
    times: Array,
    groups: Sequence[Sequence[int]] | None = None,
    *,
    errors: Array | None = None,
    even: Mask | None = None,
    between: bool = True,
    most: int | None = None,
    sides: tuple[float, ...] = BOTH,
) -> Extremes:
    """Extremes over the span of `times`, (n_t,) ascending, of what `sample` gives.

    groups: the columns that are compared with each other; by default each column is on its own. errors (n,): of each
    group's numbers, how well they are known; even (n,): whether its columns are their squares. between: whether the
    instants between are looked at, too, for no more groups that vary than `most`, and for which sides; else the values
    at `times` stand.
    """
    values = sample(times)
    members = [[column] for column in range(values.shape[1])] if groups is None else groups
    n = len(members)
    if n == 0:
        none, nowhere = np.zeros(0), np.zeros(0, dtype=np.intp)
        return Extremes(none, none, nowhere, none, none, nowhere, searched=True)
    column = np.concatenate([np.asarray(group, dtype=np.intp) for group in members])
    owner = np.repeat(np.arange(n), [len(group) for group in members])
    even = np.zeros(n, dtype=bool) if even is None else np.asarray(even, dtype=bool)
    largest = np.zeros(n)
    np.maximum.at(largest, owner, finite(np.abs(values[:, column]), 0.0).max(axis=0))
    least = tolerances.CONSTANT * np.where(even, np.sqrt(largest), largest)
    asked = Targets(n, column, owner, least if errors is None else np.fmax(errors, least), even)
    found = highest(times, values, asked)
    if most is not None:
        between = between and len(distinct(owner[_varies(values[:, column])])) <= most
    complete = True
    if between and len(times) > 1:
        first = AtFirst(len(times), float(np.ptp(times)))
        complete = refined(sample, intervals_of(times, values, asked, found, sides), asked, found, first)
    value = np.repeat([-1.0, 1.0], n) * found.height
    at, column = found.at, found.column
    return Extremes(value[:n], at[:n], column[:n], value[n:], at[n:], column[n:], between, complete)


def highest(times: Array, values: Array, asked: Targets) -> Best:
    """The best of each target on the grid; nan is passed over, and told where there is nothing else."""
    parts = []
    for side in (-1.0, 1.0):
        heights = side * values[:, asked.column]
        known = np.where(np.isnan(heights), -np.inf, heights)
        instant = np.argmax(known, axis=0)
        order = np.lexsort((-known[instant, np.arange(len(asked.column))], asked.owner))
        place = np.empty(asked.n, dtype=np.intp)
        place[asked.owner[order[::-1]]] = order[::-1]
        instant = instant[place]
        parts.append((heights[instant, place], times[instant], asked.column[place]))
    return Best(*(np.concatenate(both) for both in zip(*parts, strict=True)))


def intervals_of(
    times: Array, values: Array, asked: Targets, found: Best, sides: tuple[float, ...] = BOTH
) -> Intervals:
    """The intervals of the grid that promise more than the best on it, on these sides."""
    best = found.height + asked.enough(found.height)
    return intervals_above(times, values, asked, lambda b, c, target: best[target], sides)


def intervals_above(
    times: Array, values: Array, asked: Targets, to_beat: HeightToBeat, sides: tuple[float, ...] = BOTH
) -> Intervals:
    """The intervals of the grid that promise more than what they have to beat, on these sides."""
    step = times[1:] - times[:-1]
    smooth = ~sides_of_jumps(times)
    heights = values[:, asked.column]
    varies = _varies(heights)
    heights, owner, column = heights[:, varies], asked.owner[varies], asked.column[varies]
    slope = (heights[1:] - heights[:-1]) / step[:, None]
    slope[~smooth] = np.nan
    left, right = completed(*_bends(times, slope, step, smooth))
    up, down = _rises(slope, step)
    most = np.maximum(np.abs(left), np.abs(right))
    doubt = FOURTH * most
    inner = np.concatenate([[False], smooth, [False]])
    parts = []
    for side in sides:
        target = owner if side < 0.0 else owner + asked.n
        b, c, before, after, rising, falling = (side * x for x in (heights[:-1], heights[1:], left, right, up, down))
        with np.errstate(invalid="ignore"):
            k, j = np.nonzero((ceiling(b, c, most, rising, falling) > to_beat(b, c, target)) & smooth[:, None])
        some = (x[k, j] for x in (b, c, before, after, doubt, rising, falling))
        more = asked.possible(promised(*some), target[j]) > to_beat(b[k, j], c[k, j], target[j])
        k, j = k[more], j[more]
        # neighbours beyond a jump or the end are none: such are made up from the bends
        w, f, g = step[k], heights[k, j], heights[k + 1, j]
        p, q = np.maximum(k - 1, 0), np.minimum(k + 2, len(times) - 1)
        known = inner[k] & np.isfinite(heights[p, j]), inner[k + 2] & np.isfinite(heights[q, j])
        t = [np.where(known[0], times[p], times[k] - w), np.where(known[1], times[q], times[k + 1] + w)]
        a = np.where(known[0], heights[p, j], 2.0 * f - g - 2.0 * left[k, j])
        d = np.where(known[1], heights[q, j], 2.0 * g - f - 2.0 * right[k, j])
        parts.append(Intervals(
            np.stack([t[0], times[k], times[k + 1], t[1]], 1), side * np.stack([a, f, g, d], 1), doubt[k, j],
            np.zeros(len(k), dtype=bool), target[j], column[j],
        ))  # fmt: skip
    return joined(parts)


def _bends(times: Array, slope: Array, step: Array, smooth: Mask) -> tuple[Array, Array]:
    """κ of the parabolas with the neighbour before and with that after each interval, (n_t - 1, m); slope: so, too.

    At the end of a smooth stretch the second differences are continued as they run.
    """
    second = np.full((len(times) + 2, slope.shape[1]), np.nan)  # [k + 1]: about the instant k
    if len(times) > 2:
        second[2:-2] = (slope[1:] - slope[:-1]) / (times[2:] - times[:-2])[:, None]
    begins = np.append(True, ~smooth)  # whether a stretch begins at an instant, or ends
    ends = np.append(~smooth, True)
    for edge, inward in ((begins, 1), (ends, -1)):
        k = np.flatnonzero(edge) + 1
        near, far = second[np.clip(k + inward, 0, len(second) - 1)], second[np.clip(k + 2 * inward, 0, len(second) - 1)]
        second[k] = np.where(np.isfinite(far), 2.0 * near - far, near)
    square = -(step * step)[:, None]
    return square * second[1:-2], square * second[2:-1]


def _rises(slope: Array, step: Array) -> tuple[Array, Array]:
    """How much a quantity goes on changing into each interval as it did before it, and backwards as after it."""
    up, down = np.full(slope.shape, np.nan), np.full(slope.shape, np.nan)
    up[1:], down[:-1] = slope[:-1] * step[1:, None], -slope[1:] * step[:-1, None]
    return up, down


def refined(sample: ColumnsAt, pool: Intervals, asked: Targets, found: Best, first: AtFirst) -> bool:
    """Divide the intervals until none promises more than what was found, which is kept up in place; whether so.

    Where more instants would be asked at once than at first, those next to each other are asked as one.
    """
    probes = 0
    for turn in range(MOST_ROUNDS):
        shape = pool.shape()
        promise = asked.possible(pool.promise(shape), pool.target)
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * first.span
        worth = wide & (promise > (found.height + asked.enough(found.height))[pool.target])
        if not worth.all():
            pool, shape, promise = pool.some(worth), shape.some(worth), promise[worth]
        if not len(promise):
            return True
        if probes > MOST_PROBES:
            return False
        now = _first(promise - found.height[pool.target], pool.target, FIRST << min(turn, 12))
        some, shape, rest = (pool, shape, None) if now.all() else (pool.some(now), shape.some(now), pool.some(~now))
        at = some.probe(shape)
        instants = distinct(at)
        if len(instants) > first.instants:
            at = together(at, some.t[:, 2] - some.t[:, 1])
            instants = distinct(at)
        side = np.where(some.target < asked.n, -1.0, 1.0)
        height = side * sample(instants)[np.searchsorted(instants, at), some.column]
        probes += len(instants)
        found.take(height, at, some.column, some.target)
        parts = some.divided(shape, at, height)
        pool = parts if rest is None else joined([rest, parts])
    return False


def together(at: Array, width: Array) -> Array:
    """Instants in intervals of some width (n,), those next to each other as one.

    What a machine has several of, as cylinders and wheels, has its extremes together but for rounding.
    """
    order = np.argsort(at, kind="stable")
    ascending = at[order]
    apart = np.append(True, np.diff(ascending) > SAME * np.minimum(width[order][1:], width[order][:-1]))
    found = np.empty_like(at)
    found[order] = ascending[np.maximum.accumulate(np.where(apart, np.arange(len(at)), 0))]
    return found


def _first(worth: Array, target: Indices, most: int) -> Mask:
    """Which are among the so many worthiest of their target."""
    if len(target) <= most:
        return np.ones(len(target), dtype=bool)
    order = np.lexsort((-worth, target))
    starts = np.append(True, target[order[1:]] > target[order[:-1]])
    rank = np.arange(len(order)) - np.maximum.accumulate(np.where(starts, np.arange(len(order)), 0))
    chosen = np.empty(len(order), dtype=bool)
    chosen[order] = rank < most
    return chosen


def finite(values: Array, infinite: float | None = None) -> Array:
    """The values, with 0 for those that are none; infinite: what stands for what has no bound, by default the most."""
    if np.isfinite(values).all():
        return values
    return np.nan_to_num(values, posinf=infinite)


def _varies(values: Array) -> Mask:
    """Which columns have a peak worth a search."""
    known = finite(values)
    varies: Mask = np.ptp(known, axis=0) > tolerances.CONSTANT * np.abs(known).max(axis=0)
    return varies


def sides_of_jumps(times: Array) -> Mask:
    """Which neighbouring instants are the two sides of a jump: no farther apart than rounding, (n_t - 1,)."""
    return np.asarray(times[1:] - times[:-1] <= 2.0 * MOST_EQUAL * tolerances.EPS * np.abs(times[1:]))


def filled(times: Array) -> Array:
    """The instants, and more of them in stretches between two jumps that have too few to show how they bend."""
    jumps = sides_of_jumps(times)
    if not jumps.any() and len(times) > FEW:
        return times
    stretch = np.append(0, np.cumsum(jumps))
    few = (np.diff(stretch) == 0) & (np.bincount(stretch)[stretch[1:]] < FEW)
    more = times[:-1][few, None] + np.diff(times)[few, None] * (np.arange(1, FEW) / FEW)
    return np.asarray(distinct(np.concatenate([times, more.ravel()])))


def distinct(values: np.ndarray[Any, Any]) -> Any:
    """The different numbers among these, ascending; np.unique would import numpy.ma for it, 10 ms."""
    ascending = values.flatten()
    ascending.sort()
    first = np.ones(len(ascending), dtype=bool)
    np.not_equal(ascending[1:], ascending[:-1], out=first[1:])
    return ascending[first]
