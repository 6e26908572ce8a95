"""All turning points of sampled numbers, also those between the samples, searched as extremes are.

An interval between two neighbours hides a turn if it promises more than the higher of the two, or less than the lower
(study/search/intervals.py). It is asked where it promises most and divided there, until no interval promises more than
a part of the error. What the run does below its own error is not looked for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli import tolerances
from heuncli.results import Array, Indices, Mask
from heuncli.study.search.extremes import (
    BOTH,
    GOOD_ENOUGH,
    MOST_ROUNDS,
    ColumnsAt,
    Targets,
    distinct,
    intervals_above,
)

MOST_PROBES = 2_000_000  # instants asked for in one search: turning points of some hundred thousand cycles


def with_turnings(sample: ColumnsAt, times: Array, grid: Array, errors: Array, even: Mask) -> tuple[Array, Array, bool]:
    """Instants (n,) ascending, with what is sampled there (n, n_columns); whether all turns are among them.

    times (n_t,), grid (n_t, n_columns): what is begun with; errors (n_columns,): of the numbers; even: whether columns
    are their squares. Ends where a number is open (nan).
    """
    asked_times, values = [times], [grid]
    if len(times) < 2 or not np.isfinite(grid).all():
        return times, grid, True
    columns = np.arange(grid.shape[1], dtype=np.intp)
    asked = Targets(len(columns), columns, columns, errors, even)
    enough = margin(errors, even)
    pool = intervals_above(times, grid, asked, enough, BOTH)
    span, probes = float(np.ptp(times)), 0
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
        found = sample(instants)
        asked_times.append(instants)
        values.append(found)
        probes += len(instants)
        if np.isnan(found).any():
            pool = pool.some(np.zeros(len(pool.target), dtype=bool))
            break
        side = np.where(pool.target < asked.n, -1.0, 1.0)
        pool = pool.divided(shape, at, side * found[np.searchsorted(instants, at), pool.column])
    all_times, rows = np.concatenate(asked_times), np.concatenate(values)
    order = np.argsort(all_times, kind="stable")
    new = np.append(True, np.diff(all_times[order]) > 0.0)
    return all_times[order][new], rows[order][new], not len(pool.target)


def margin(errors: Array, even: Mask) -> Callable[[Array, Array, Indices], Array]:
    """What an interval between two heights has to promise to hide a turn of a target that counts."""
    n = len(errors)

    def beat(b: Array, c: Array, target: Indices) -> Array:
        higher, of = np.maximum(b, c), target % n
        error, size = GOOD_ENOUGH * errors[of], np.maximum(np.abs(b), np.abs(c))
        squared = error * error + 2.0 * error * np.sqrt(size)
        return np.asarray(higher + np.where(even[of], squared, error) + tolerances.SUM_ROUNDING * size)

    return beat
