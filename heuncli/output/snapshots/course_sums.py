"""Numbers of the whole course of a quantity: its means and mean square, and the error of the instants of extremes.

There are two kinds of sums. Those over fixed instants need no integration: their error is no larger than that of the
numbers themselves, so that a change as small as the stated error is found, but a pulse between two of the instants is
not. Those over the instants at which extremes are searched are integrals: they include whatever the search sees, and
their quadrature error is estimated by a second rule.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.golden_file import BEYOND, UNKNOWN, Value
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.search.grid import find_jump_sides

INSTANTS = 16  # in each tenth of a run
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  # golden ratio: instants that avoid resonance with periodic motions
PLACES_IN_TENTH = np.sort(np.mod((np.arange(INSTANTS) + 0.5) * GOLDEN, 1.0))  # places within a tenth, (INSTANTS,)
PIECE_INTERVALS = 4  # intervals of one quadrature rule: as many as the search makes in a step
INNER, OUTER = (np.sqrt(3.0 / 7.0 + sign * 2.0 / 7.0 * np.sqrt(1.2)) for sign in (-1.0, 1.0))
GAUSS = np.array([-OUTER, -INNER, INNER, OUTER])
WEIGHTS = (18.0 + np.sqrt(30.0) * np.array([-1.0, 1.0, 1.0, -1.0])) / 36.0
MAX_WEIGHTS = 2.0  # sum of absolute weights (their sum is 1); above, the instants are too uneven
SAME_NODE = 1e-12  # share of a piece: closer nodes coincide


class CourseSums(NamedTuple):
    """Sums of one quantity.

    tenths (10,): its means over the uneven instants of each tenth of the run, or words
    mean_square: over all these instants
    mean, moment: integrals over the run, of the quantity and of it times the place in the run, -1 to 1
    mean_error: of both
    """

    tenths: list[Value]
    mean_square: float | None = None
    mean: float | None = None
    moment: float | None = None
    mean_error: float | None = None

    def cut_at_horizon(self, beyond_horizon: Mask) -> CourseSums:
        """Replace the means beyond the horizon by a word.

        beyond_horizon (10,): the tenths that reach it
        """
        tenths = [BEYOND if is_beyond else mean for mean, is_beyond in zip(self.tenths, beyond_horizon, strict=True)]
        return self._replace(tenths=tenths)

    @property
    def without_words(self) -> CourseSums:
        """The sums; without the means if none of these is a number."""
        return self if any(isinstance(mean, float) for mean in self.tenths) else self._replace(tenths=[])


class SampledColumns:
    """The columns that a search for extremes evaluated, in the order of its queries."""

    def __init__(self) -> None:
        self.times: list[Array] = []
        self.values: list[Array] = []

    def add(self, times: Array, values: Array) -> None:
        """Add the columns (n_t, n_columns) at some instants (n_t,)."""
        self.times.append(times)
        self.values.append(values)

    def find_values(self, times: Array) -> Array:
        """Return the columns at some of the evaluated instants, (n_t, n_columns)."""
        known_times, values = self.sorted_samples
        return np.asarray(values[np.searchsorted(known_times, times)])

    @cached_property
    def sorted_samples(self) -> tuple[Array, Array]:
        """All instants in ascending order, each once, and the columns there."""
        times, values = np.concatenate(self.times), np.concatenate(self.values)
        order = np.argsort(times, kind="stable")
        is_new = np.append(True, np.diff(times[order]) > 0.0)
        return times[order][is_new], values[order][is_new]


def make_tenth_instants(tenth_ends: Array) -> Array:
    """Return uneven instants in each tenth of a run, (10, INSTANTS).

    tenth_ends (11,): the ends of the tenths
    """
    return np.asarray(tenth_ends[:-1, None] + np.diff(tenth_ends)[:, None] * PLACES_IN_TENTH)


def sum_tenths(values: Array, near_jump: Mask) -> CourseSums:
    """Return the means and the mean square of a quantity with values (10, INSTANTS).

    near_jump (10, INSTANTS): instants so near to a jump that its side is not certain
    """
    known: Mask = np.asarray(np.isfinite(values).all(axis=1) & ~near_jump.any(axis=1))
    means = values.mean(axis=1)
    tenths: list[Value] = [float(mean) if is_known else UNKNOWN for mean, is_known in zip(means, known, strict=True)]
    return CourseSums(tenths, float(np.mean(values**2)) if known.all() else None)


class Pieces(NamedTuple):
    """The intervals of a run between the jumps of a quantity.

    first, last: indices of the first and last instant of each piece, (m,)
    """

    times: Array
    first: Indices
    last: Indices

    @property
    def nodes(self) -> Array:
        """The Gauss nodes of each piece, (m, 4)."""
        begin, end = self.times[self.first], self.times[self.last]
        return np.asarray(0.5 * (begin + end)[:, None] + 0.5 * (end - begin)[:, None] * GAUSS)


NO_PIECES = Pieces(np.zeros(1), np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))


def split_into_pieces(times: Array) -> Pieces:
    """Split a run at its jumps into pieces of a few intervals.

    times (n,): of the search, ascending
    """
    begins = np.flatnonzero(np.append(True, find_jump_sides(times)))
    ends = np.append(begins[1:] - 1, len(times) - 1)
    first = np.concatenate(
        [np.arange(b, e, PIECE_INTERVALS) for b, e in zip(begins, ends, strict=True)] or [np.zeros(0)]
    )
    first = first.astype(np.intp)
    last = np.minimum(first + PIECE_INTERVALS, ends[np.searchsorted(begins, first, side="right") - 1])
    return Pieces(times, first, last)


def integrate_columns(
    pieces: Pieces, grid: Array, node_values: Array, jump_time_errors: Array
) -> tuple[Array, Array, Array]:
    """Return mean, first moment and error of the integrals of columns over a run, (n_columns,) each.

    grid (n_t, n_columns): values at the instants of the pieces
    node_values (m, 4, n_columns): values at the Gauss nodes of the pieces
    jump_time_errors: the error of each jump's instant [s]

    The moment is the mean of the quantity times the place in the run, -1 to 1. The error contains that of the
    quadrature, estimated by the polynomials through the instants of the search, and that of the instants of jumps.
    """
    times = pieces.times
    begin, end = times[pieces.first], times[pieces.last]
    span = float(times[-1] - times[0])
    share = (end - begin) / span
    place = (pieces.nodes - 0.5 * (times[0] + times[-1])) / (0.5 * span)
    means = 0.5 * np.einsum("k,mkc->mc", WEIGHTS, node_values)
    moments = 0.5 * np.einsum("k,mk,mkc->mc", WEIGHTS, place, node_values)
    check_means = _integrate_polynomials(pieces, grid)
    steps = np.abs(np.diff(grid, axis=0))[find_jump_sides(times)]
    error = share @ np.abs(means - check_means) + jump_time_errors @ steps / span
    rounding = tolerances.SUM_ROUNDING * np.abs(grid).max(axis=0)
    return share @ means, share @ moments, error + rounding


def _integrate_polynomials(pieces: Pieces, grid: Array) -> Array:
    """Return the means over each piece (m, n_columns) of the polynomials through the instants of the search in it.

    If these instants are so uneven that a polynomial would oscillate between them, straight lines are used.
    """
    means = np.empty((len(pieces.first), grid.shape[1]))
    count = pieces.last - pieces.first
    for n in range(1, PIECE_INTERVALS + 1):
        selected = np.flatnonzero(count == n)
        if not len(selected):
            continue
        nodes = pieces.first[selected, None] + np.arange(n + 1)
        t = pieces.times[nodes]
        width = t[:, -1:] - t[:, :1]
        x = 2.0 * (t - t[:, :1]) / width - 1.0
        weights = _make_weights(x)
        lines = 0.25 * np.diff(x, axis=1)
        straight = np.pad(lines, ((0, 0), (1, 0))) + np.pad(lines, ((0, 0), (0, 1)))
        uneven = ~(np.abs(weights).sum(axis=1) <= MAX_WEIGHTS)
        weights[uneven] = straight[uneven]
        means[selected] = np.einsum("mk,mkc->mc", weights, grid[nodes])
    return means


def _make_weights(x: Array) -> Array:
    """Return the weights of the mean over -1 to 1 of polynomials through nodes x (m, n); nan if two nodes coincide."""
    n = x.shape[1]
    are_separate = np.diff(x, axis=1).min(axis=1) > SAME_NODE
    powers = np.arange(n)
    means = np.where(powers % 2 == 0, 1.0 / (powers + 1.0), 0.0)
    weights = np.full(x.shape, np.nan)
    matrix = np.transpose(x[are_separate, :, None] ** powers, (0, 2, 1))
    if len(matrix):
        weights[are_separate] = np.linalg.solve(matrix, np.broadcast_to(means[:, None], (len(matrix), n, 1)))[..., 0]
    return weights


def find_instant_spread(times: Array, heights: Array, highest: float, time: float, margin: float) -> float:
    """Return how far the instant of a highest value may lie elsewhere [s].

    Any value within `margin` of it may be the highest, and between two of the evaluated points a course may rise by as
    much as its second difference.

    times, heights (n,): the evaluated points
    """
    curvatures = np.zeros(len(heights))
    curvatures[1:-1] = np.abs(heights[2:] - 2.0 * heights[1:-1] + heights[:-2])
    curvatures[1:-1] = np.maximum(curvatures[1:-1], np.maximum(curvatures[:-2], curvatures[2:]))
    candidates = np.flatnonzero(heights + np.nan_to_num(curvatures, nan=0.0) >= highest - margin)
    if not len(candidates):
        return float(times[-1] - times[0])
    first, last = times[max(candidates[0] - 1, 0)], times[min(candidates[-1] + 1, len(times) - 1)]
    return float(max(time - first, last - time))


def find_near_jumps(instants: Array, jumps: Array, jump_time_errors: Array) -> Mask:
    """Mark the instants that are closer to a jump than its error: their side of it is not certain.

    jump_time_errors: the error of each jump's instant [s]
    """
    near = np.zeros(instants.shape, dtype=bool)
    if not len(jumps):
        return near
    order = np.argsort(jumps)
    jump_times, jump_errors = jumps[order], jump_time_errors[order]
    after = np.searchsorted(jump_times, instants)
    for k in (np.clip(after - 1, 0, len(jump_times) - 1), np.clip(after, 0, len(jump_times) - 1)):
        near |= np.abs(instants - jump_times[k]) <= jump_errors[k]
    return near
