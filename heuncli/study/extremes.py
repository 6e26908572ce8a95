"""Extremes of sampled quantities, searched between the samples.

A quantity is known on a grid fine enough to bracket its extremes, and can be asked for at any other instant. Every
round asks at three instants about the vertex of a parabola through the bracket, and at one in its wider half, for all
quantities in one batch:

    v = b − ½ ((b−a)²(f_b−f_c) − (b−c)²(f_b−f_a)) / ((b−a)(f_b−f_c) − (b−c)(f_b−f_a))

and keeps the neighbours of the highest. A smooth peak is met to rounding in three rounds; at a kink or a jump only the
bracket shrinks, so a grid should hold the instants of jumps, from both sides. Numbers only: knows nothing of joints,
units or text.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heuncli import tolerances
from heuncli.results import Array, Extremes, Indices

Sample = Callable[[Array], Array]

ROUNDS = 3  # after two a smooth peak is right to seven digits, after three to rounding
SPREAD = 0.05  # distance of the outer probes from the vertex, as part of the bracket; a tenth of it a round later
GOLDEN = 0.381966011250105  # (3 - √5) / 2: where to look when no parabola tells
MOST_COLUMNS = 400  # of quantities that vary; beyond, the grid's own values stand: a batch is 8 instants a quantity


def search(
    sample: Sample, times: Array, groups: Sequence[Sequence[int]] | None = None, rounds: int = ROUNDS
) -> Extremes:
    """Extremes over the span of `times`, (n_t,) ascending, of what `sample` gives at sorted instants as (n, n_columns).

    `groups` names the columns that are compared with each other; by default each column is on its own. Without any
    rounds the values at `times` stand.
    """
    values = sample(times)
    members = [[column] for column in range(values.shape[1])] if groups is None else groups
    n = len(members)
    if n == 0:
        none, nowhere = np.zeros(0), np.zeros(0, dtype=np.intp)
        return Extremes(none, none, nowhere, none, none, nowhere, searched=True)
    columns = np.concatenate([np.asarray(group, dtype=np.intp) for group in members])
    owner = np.repeat(np.arange(n), [len(group) for group in members])
    varies = _varies(values)
    varying = sum(bool(varies[list(group)].any()) for group in members)
    searched = rounds > 0 and len(times) > 2 and varying <= MOST_COLUMNS
    starts = [
        _highest(heights, owner, n)
        for side in (-1.0, 1.0)
        for heights in (side * values[:, columns], _promise(times, side * values[:, columns]))
    ]
    sign = np.repeat([-1.0, 1.0], 2 * n)
    instant = np.concatenate([start[0] for start in starts])
    column = columns[np.concatenate([start[1] for start in starts])]
    at, height = times[instant], sign * values[instant, column]
    if searched:
        worth = varies[column] & np.isfinite(height)
        at, height = _refine(sample, times, values, instant, column, sign, at, height, worth, rounds)
    # Of the two starts of each search, the highest sample and the most promising one, the better stays.
    best = np.arange(2 * n) + n * np.repeat([0, 1], n)
    best += n * (height[best + n] > height[best])
    value, at, column = (sign * height)[best], at[best], column[best]
    return Extremes(value[:n], at[:n], column[:n], value[n:], at[n:], column[n:], searched)


def _highest(heights: Array, owner: Indices, n_groups: int) -> tuple[Indices, Indices]:
    """Instant and place in `owner` of the highest of each group; nan counts as lowest."""
    known = np.where(np.isnan(heights), -np.inf, heights)
    instant = np.argmax(known, axis=0)
    order = np.lexsort((-known[instant, np.arange(len(owner))], owner))
    place = np.empty(n_groups, dtype=np.intp)
    place[owner[order[::-1]]] = order[::-1]
    return instant[place], place


def _promise(times: Array, heights: Array) -> Array:
    """The heights, at summits with what they may gain between samples: twice what a parabola says."""
    promise = heights.copy()
    if len(times) > 2:
        x, y, z = times[:-2, None], times[1:-1, None], times[2:, None]
        a, b, c = heights[:-2], heights[1:-1], heights[2:]
        bend = ((b - a) / (y - x) - (c - b) / (z - y)) / (z - x)
        with np.errstate(invalid="ignore", over="ignore"):
            rise = np.minimum(2.0 * bend * (_vertex(x, y, z, a, b, c) - y) ** 2, b - np.minimum(a, c))
        promise[1:-1] += np.where((b >= a) & (b >= c) & np.isfinite(rise), rise, 0.0)
    return promise


def _vertex(a: Array, b: Array, c: Array, fa: Array, fb: Array, fc: Array) -> Array:
    """Abscissa of the vertex of the parabola through three points; nan or far away where there is none."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        p, q = (b - a) * (fb - fc), (b - c) * (fb - fa)
        return b - 0.5 * ((b - a) * p - (b - c) * q) / (p - q)


def _varies(values: Array) -> NDArray[np.bool_]:
    """Which columns have a peak worth a search."""
    known = np.nan_to_num(values)
    varies: NDArray[np.bool_] = np.ptp(known, axis=0) > tolerances.CONSTANT * np.abs(known).max(axis=0)
    return varies


def distinct(values: Array) -> Array:
    """The different numbers among these, ascending; np.unique would import numpy.ma for it, 10 ms."""
    ascending: Array = np.sort(values, axis=None)
    kept: Array = ascending[np.concatenate([[True], ascending[1:] != ascending[:-1]])]
    return kept


def _refine(
    sample: Sample,
    times: Array,
    values: Array,
    instant: Indices,
    column: Indices,
    sign: Array,
    at: Array,
    height: Array,
    worth: NDArray[np.bool_],
    rounds: int,
) -> tuple[Array, Array]:
    """Instants and heights after some batches of probes between each start's neighbours on the grid."""
    live = np.flatnonzero(worth)
    if not live.size:
        return at, height
    index, which, side = instant[live], column[live], sign[live]
    near = np.clip(index[:, None] + np.array([-1, 0, 1]), 0, len(times) - 1)
    T, F = times[near], side[:, None] * values[near, which[:, None]]
    for turn in range(rounds):
        a, b, c = T.T
        v = _vertex(a, b, c, *F.T)
        wide = np.where(c - b >= b - a, c - b, a - b)
        v = np.where(np.isfinite(v) & (v > a) & (v < c), v, b + GOLDEN * wide)
        step = SPREAD * 0.1**turn * (c - a)
        about = [np.clip(v + side_step, a, c) for side_step in (-step, 0.0 * step, step)]
        probes = np.stack([*about, b + GOLDEN * wide], axis=1)
        asked = distinct(probes)
        values = side[:, None] * sample(asked)[np.searchsorted(asked, probes), which[:, None]]
        T, F = np.hstack([T, probes]), np.hstack([F, values])
        order = np.argsort(T, axis=1, kind="stable")
        T, F = np.take_along_axis(T, order, 1), np.take_along_axis(F, order, 1)
        top = np.argmax(np.where(np.isfinite(F), F, -np.inf), axis=1)
        near = np.clip(top[:, None] + np.array([-1, 0, 1]), 0, T.shape[1] - 1)
        T, F = np.take_along_axis(T, near, 1), np.take_along_axis(F, near, 1)
    at, height = at.copy(), height.copy()
    better = F[:, 1] > height[live]
    at[live[better]], height[live[better]] = T[better, 1], F[better, 1]
    return at, height
