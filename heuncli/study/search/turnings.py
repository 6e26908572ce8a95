"""All turning points of sampled numbers, also those between the samples.

First a grid is made that shows how the numbers run: each interval is asked, and divided further there unless cubics
through four neighbours foretold what is found, twice in a row. For the one largest value of a run an interval that
cannot hold it need not be looked into; for all turns each must be. Then, as extremes are searched
(study/search/intervals.py): an interval hides a turn if it promises more than the higher of its ends, or less than the
lower. It is asked where it promises most and divided there, until none promises more than a part of the error. What a
run does below its own error is not looked for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.search.extremes import (
    BOTH,
    GOOD_ENOUGH,
    MOST_ROUNDS,
    ColumnsAt,
    Targets,
    distinct,
    intervals_above,
    sides_of_jumps,
)

MOST_PROBES = 2_000_000  # instants asked for in one search: turning points of some hundred thousand cycles
OFF_MIDDLE = 0.52  # of an interval: where it is asked, so that nothing that repeats itself looks at rest
NO_INSTANTS = np.zeros(0)
OFTEN_ENOUGH = 2  # times in a row that an interval is foretold
FORETOLD = 0.02  # of the swing of four neighbours: cubics through seven instants a period do as well

Slack = Callable[[Array, Array], Array]  # of sizes (m, n) over intervals of widths (m,) what does not count, (m, n)


class SampledTurns(NamedTuple):
    """What was sampled: times (n,) ascending, values (n, n_columns); complete: whether all was looked at that may turn.

    Ends where a number is open (nan).
    """

    times: Array
    values: Array
    complete: bool


def with_turnings(sample: ColumnsAt, times: Array, grid: Array, errors: Array, even: Mask) -> SampledTurns:
    """What is sampled at the instants of a grid and at all turns between them.

    times (n_t,), grid (n_t, n_columns): what is begun with; errors (n_columns,): of the numbers; even: whether columns
    are their squares.
    """

    def slack(size: Array, _: Array) -> Array:
        """What of numbers of some sizes (m, n_columns) their errors leave open."""
        return np.asarray(np.where(even, errors * errors + 2.0 * errors * np.sqrt(size), errors))

    found = resolved(sample, SampledTurns(times, grid, complete=True), slack)
    if len(times) < 2 or not found.complete or not np.isfinite(found.values).all():
        return found
    columns = np.arange(grid.shape[1], dtype=np.intp)
    asked = Targets(len(columns), columns, columns, errors, even)
    enough = margin(errors, even)
    pool = intervals_above(found.times, found.values, asked, enough, BOTH)
    span, probes = float(np.ptp(times)), 0
    parts = [found]
    for _ in range(MOST_ROUNDS):
        shape = pool.shape()
        beat = enough(pool.f[:, 1], pool.f[:, 2], pool.target)
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * span
        worth = wide & (asked.possible(pool.promise(shape), pool.target) > beat)
        pool, shape = pool.some(worth), shape.some(worth)
        if not len(pool.target) or probes > MOST_PROBES:
            break
        at = pool.probe(shape)
        instants = distinct(at)
        values = sample(instants)
        parts.append(SampledTurns(instants, values, complete=True))
        probes += len(instants)
        if np.isnan(values).any():
            return together(parts, complete=True)
        side = np.where(pool.target < asked.n, -1.0, 1.0)
        pool = pool.divided(shape, at, side * values[np.searchsorted(instants, at), pool.column])
    return together(parts, complete=not len(pool.target))


def resolved(
    sample: ColumnsAt,
    found: SampledTurns,
    slack: Slack,
    *,
    most: int = MOST_PROBES,
    probes: Array | None = None,
    doubted: Mask | None = None,
) -> SampledTurns:
    """The grid with more instants where a number does not run as its neighbours foretell.

    An interval is done when both it and the half of it that it lies in were foretold: one instant may be so by chance,
    as a wave is in the middle between its summits. Those beside one that was not are asked again, for they were
    foretold by what did not show it.
    slack: what of the numbers does not count. probes (m,): instants between those of the grid that are asked, too; with
    these what was foretold is left out, and one instant of an interval is enough. most: so many instants are asked for.
    doubted (n - 1,): the intervals of the grid that need be asked; all, by default.
    """
    span, asked = float(np.ptp(found.times)), 0
    enough = OFTEN_ENOUGH if probes is None else 1
    often = np.zeros(max(len(found.times) - 1, 0), dtype=np.intp)  # in a row that each interval was foretold
    if doubted is not None:
        often[~doubted] = enough
    also = NO_INSTANTS if probes is None else probes
    for _ in range(MOST_ROUNDS):
        times, values, complete = found
        wide = np.diff(times) > tolerances.SIDE_BY_SIDE * span
        k = np.flatnonzero((often < enough) & wide & ~sides_of_jumps(times))
        if not len(k) + len(also) or not np.isfinite(values).all():
            return found
        if asked > most:
            return found._replace(complete=False)
        at = times[k] + OFF_MIDDLE * (times[k + 1] - times[k])
        at, also = distinct(np.concatenate([at, also])), NO_INSTANTS
        k = np.searchsorted(times, at) - 1
        there = sample(at)
        asked += len(at)
        off = ~foretold(found, k, at, there, slack)
        kept = off | (probes is None)
        often[k] += 1
        often[k[off]] = 0
        beside = np.clip(np.concatenate([k[off] - 1, k[off] + 1]), 0, len(often) - 1)
        often[beside] = np.minimum(often[beside], enough - 1)
        found = together([found, SampledTurns(at[kept], there[kept], complete)], complete=complete)
        often = often[np.searchsorted(times, found.times[:-1], side="right") - 1]
    return found._replace(complete=found.complete and bool((often >= enough).all()))


def doubtful(found: SampledTurns, slack: Slack) -> Mask:
    """The intervals of a grid beside an instant that its neighbours do not foretell, (n - 1,): the others, half as
    wide as what foretells, need not be asked."""
    times, values, _ = found
    doubted = np.ones(max(len(times) - 1, 0), dtype=bool)
    if len(times) < 5:
        return doubted
    jumps = np.append(np.append(True, sides_of_jumps(times)), True)
    inner = np.arange(2, len(times) - 2)
    inner = inner[~(jumps[inner - 1] | jumps[inner] | jumps[inner + 1] | jumps[inner + 2])]
    four = inner[:, None] + np.array([-2, -1, 1, 2])
    known = np.zeros(len(times), dtype=bool)
    known[inner] = as_expected(found, four, inner - 1, times[inner], values[inner], slack)
    doubted &= ~(known[1:] & known[:-1])
    return doubted


def foretold(found: SampledTurns, k: Indices, at: Array, there: Array, slack: Slack) -> Mask:
    """Whether what is there at instants within intervals is what the cubics through their neighbours have, (m,)."""
    return as_expected(found, neighbours(found.times, k), k, at, there, slack)


def as_expected(found: SampledTurns, four: Indices, k: Indices, at: Array, there: Array, slack: Slack) -> Mask:
    """Whether the cubics through four instants each, (m, 4), have what is there at others in the intervals k, (m,)."""
    times, values, _ = found
    expected = cubic(times[four], values[four], at)
    swing = np.ptp(np.concatenate([values[four], there[:, None]], axis=1), axis=1)
    size = np.maximum(np.abs(values[k]), np.abs(values[k + 1]))
    beside = slack(size, times[k + 1] - times[k])
    return np.asarray((np.abs(there - expected) <= np.maximum(FORETOLD * swing, beside)).all(axis=1))


def neighbours(times: Array, k: Indices) -> Indices:
    """Four neighbouring instants about each interval, (m, 4), on no other side of a jump where that has four."""
    jumps = np.flatnonzero(sides_of_jumps(times))
    first = np.concatenate([[0], jumps + 1])
    last = np.concatenate([jumps, [len(times) - 1]])
    own = np.searchsorted(first, k, side="right") - 1
    begin = np.clip(k - 1, first[own], np.maximum(last[own] - 3, first[own]))
    return np.asarray(np.minimum(begin[:, None] + np.arange(4), len(times) - 1))


def cubic(t: Array, f: Array, at: Array) -> Array:
    """What the cubics through four points each, t (m, 4), f (m, 4, n), have at one instant each, (m, n).

    Where two of the points are one, or two sides of a jump, it is no number.
    """
    value = np.zeros((len(at), f.shape[2]))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i in range(4):
            others = [j for j in range(4) if j != i]
            weight = np.prod([(at - t[:, j]) / (t[:, i] - t[:, j]) for j in others], axis=0)
            value += weight[:, None] * f[:, i]
    return value


def together(parts: Sequence[SampledTurns], *, complete: bool) -> SampledTurns:
    """All instants that were asked, ascending, each once."""
    times, values = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    order = np.argsort(times, kind="stable")
    first = np.append(True, np.diff(times[order]) > 0.0)
    return SampledTurns(times[order][first], values[order][first], complete)


def margin(errors: Array, even: Mask) -> Callable[[Array, Array, Indices], Array]:
    """What an interval between two heights has to promise to hide a turn of a target that counts."""
    n = len(errors)

    def beat(b: Array, c: Array, target: Indices) -> Array:
        higher, of = np.maximum(b, c), target % n
        error, size = GOOD_ENOUGH * errors[of], np.abs(higher)
        squared = error * error + 2.0 * error * np.sqrt(size)
        return np.asarray(higher + np.where(even[of], squared, error) + tolerances.SUM_ROUNDING * size)

    return beat
