"""What tells of the whole course of a quantity: its means, its mean square, how well instants of extremes are known.

Two kinds of sums. Those over fixed instants need no integration: they err by no more than the numbers themselves, so a
change as small as the stated error is found, but a pulse between two of the instants is not. Those over the instants at
which extremes are searched are integrals: they see whatever the search sees, and err by their quadrature, too, which is
estimated by a second rule.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.kept import BEYOND, UNKNOWN, Value
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.search.extremes import sides_of_jumps

INSTANTS = 16  # of each tenth of a run
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  # uneven to whatever repeats itself
SHARES = np.sort(np.mod((np.arange(INSTANTS) + 0.5) * GOLDEN, 1.0))  # of a tenth, (INSTANTS,)
PIECE = 4  # intervals of the search that one rule of quadrature takes: a step of the integrator has as many
INNER, OUTER = (np.sqrt(3.0 / 7.0 + sign * 2.0 / 7.0 * np.sqrt(1.2)) for sign in (-1.0, 1.0))
GAUSS = np.array([-OUTER, -INNER, INNER, OUTER])
WEIGHTS = (18.0 + np.sqrt(30.0) * np.array([-1.0, 1.0, 1.0, -1.0])) / 36.0
LARGEST_WEIGHTS = 2.0  # the sum of the magnitudes of weights, of 1: above, instants lie too unevenly for one polynomial
SAME_NODE = 1e-12  # of a piece: nodes nearer than that are one


class CourseSums(NamedTuple):
    """Of one quantity: the means of each tenth, the mean square; the integral mean, first moment and their error."""

    tenths: list[Value]
    mean_square: float | None = None
    mean: float | None = None
    moment: float | None = None
    mean_error: float | None = None

    def ended(self, beyond: Mask) -> CourseSums:
        """The same of a run with a horizon; beyond (10,): the tenths that reach it."""
        tenths = [BEYOND if far else mean for mean, far in zip(self.tenths, beyond, strict=True)]
        return self._replace(tenths=tenths)

    @property
    def told(self) -> CourseSums:
        """The same without means that are all words."""
        return self if any(isinstance(mean, float) for mean in self.tenths) else self._replace(tenths=[])


class SampledColumns:
    """The columns that a search for extremes saw, in the order in which it asked for them."""

    def __init__(self) -> None:
        self.times: list[Array] = []
        self.values: list[Array] = []

    def add(self, times: Array, values: Array) -> None:
        """Keep the columns (n_t, n_columns) at some instants (n_t,)."""
        self.times.append(times)
        self.values.append(values)

    def at(self, times: Array) -> Array:
        """The columns at some of the instants that were asked for, (n_t, n_columns)."""
        known, values = self.together
        return np.asarray(values[np.searchsorted(known, times)])

    @cached_property
    def together(self) -> tuple[Array, Array]:
        """All instants, ascending, each once, and the columns there."""
        times, values = np.concatenate(self.times), np.concatenate(self.values)
        order = np.argsort(times, kind="stable")
        fresh = np.append(True, np.diff(times[order]) > 0.0)
        return times[order][fresh], values[order][fresh]


def instants_of_tenths(even: Array) -> Array:
    """Uneven instants of each tenth of a run, (10, INSTANTS); even (11,): the ends of the tenths."""
    return np.asarray(even[:-1, None] + np.diff(even)[:, None] * SHARES)


def sum_tenths(values: Array, near_jump: Mask) -> CourseSums:
    """The means and the mean square of a quantity (10, INSTANTS); near_jump: instants so near to a jump that its side
    is not certain."""
    known: Mask = np.asarray(np.isfinite(values).all(axis=1) & ~near_jump.any(axis=1))
    means = values.mean(axis=1)
    tenths: list[Value] = [float(mean) if sure else UNKNOWN for mean, sure in zip(means, known, strict=True)]
    return CourseSums(tenths, float(np.mean(values**2)) if known.all() else None)


class Pieces(NamedTuple):
    """Pieces of a run over each of which a quantity runs smoothly: first and last instant, (m,), and their indices."""

    times: Array
    first: Indices
    last: Indices

    @property
    def nodes(self) -> Array:
        """The instants of Gauss's rule, (m, 4)."""
        begin, end = self.times[self.first], self.times[self.last]
        return np.asarray(0.5 * (begin + end)[:, None] + 0.5 * (end - begin)[:, None] * GAUSS)


NO_PIECES = Pieces(np.zeros(1), np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))


def pieces_of(times: Array) -> Pieces:
    """Divide a run at its jumps into pieces of a few intervals; times (n,): of the search, ascending."""
    begins = np.flatnonzero(np.append(True, sides_of_jumps(times)))
    ends = np.append(begins[1:] - 1, len(times) - 1)
    first = np.concatenate([np.arange(b, e, PIECE) for b, e in zip(begins, ends, strict=True)] or [np.zeros(0)])
    first = first.astype(np.intp)
    last = np.minimum(first + PIECE, ends[np.searchsorted(begins, first, side="right") - 1])
    return Pieces(times, first, last)


def integrate_columns(pieces: Pieces, grid: Array, inner: Array, uncertain: Array) -> tuple[Array, Array, Array]:
    """Mean, first moment and error of the integrals of columns over a run, (n_columns,) each.

    grid (n_t, n_columns): at the instants of the pieces; inner (m, 4, n_columns): at their Gauss nodes; uncertain: how
    far each jump may lie elsewhere [s]. The moment is the mean of the quantity times the place in the run, -1 to 1.
    The error is that of the quadrature, estimated by the polynomials through the instants of the search, and that of
    the instants of jumps.
    """
    times = pieces.times
    begin, end = times[pieces.first], times[pieces.last]
    span = float(times[-1] - times[0])
    share = (end - begin) / span
    place = (pieces.nodes - 0.5 * (times[0] + times[-1])) / (0.5 * span)
    means = 0.5 * np.einsum("k,mkc->mc", WEIGHTS, inner)
    moments = 0.5 * np.einsum("k,mk,mkc->mc", WEIGHTS, place, inner)
    others = _closed_means(pieces, grid)
    steps = np.abs(np.diff(grid, axis=0))[sides_of_jumps(times)]
    error = share @ np.abs(means - others) + uncertain @ steps / span
    rounding = tolerances.SUM_ROUNDING * np.abs(grid).max(axis=0)
    return share @ means, share @ moments, error + rounding


def _closed_means(pieces: Pieces, grid: Array) -> Array:
    """The means over each piece (m, n_columns) of the polynomials through the instants of the search in it.

    Where these lie so unevenly that a polynomial would swing between them, of straight lines.
    """
    found = np.empty((len(pieces.first), grid.shape[1]))
    count = pieces.last - pieces.first
    for n in range(1, PIECE + 1):
        some = np.flatnonzero(count == n)
        if not len(some):
            continue
        nodes = pieces.first[some, None] + np.arange(n + 1)
        t = pieces.times[nodes]
        width = t[:, -1:] - t[:, :1]
        x = 2.0 * (t - t[:, :1]) / width - 1.0
        weights = _weights(x)
        lines = 0.25 * np.diff(x, axis=1)
        straight = np.pad(lines, ((0, 0), (1, 0))) + np.pad(lines, ((0, 0), (0, 1)))
        uneven = ~(np.abs(weights).sum(axis=1) <= LARGEST_WEIGHTS)
        weights[uneven] = straight[uneven]
        found[some] = np.einsum("mk,mkc->mc", weights, grid[nodes])
    return found


def _weights(x: Array) -> Array:
    """The weights of the mean over -1 to 1 of polynomials through nodes x (m, n); nan where two nodes are one."""
    n = x.shape[1]
    apart = np.diff(x, axis=1).min(axis=1) > SAME_NODE
    powers = np.arange(n)
    means = np.where(powers % 2 == 0, 1.0 / (powers + 1.0), 0.0)
    weights = np.full(x.shape, np.nan)
    matrix = np.transpose(x[apart, :, None] ** powers, (0, 2, 1))
    if len(matrix):
        weights[apart] = np.linalg.solve(matrix, np.broadcast_to(means[:, None], (len(matrix), n, 1)))[..., 0]
    return weights


def spread_of_instant(times: Array, heights: Array, best: float, at: float, margin: float) -> float:
    """How far the instant of a highest value may lie elsewhere [s]: whatever comes within `margin` of it is as high.

    times, heights (n,): what was seen; between two instants a course may rise by as much as it bends there.
    """
    bends = np.zeros(len(heights))
    bends[1:-1] = np.abs(heights[2:] - 2.0 * heights[1:-1] + heights[:-2])
    bends[1:-1] = np.maximum(bends[1:-1], np.maximum(bends[:-2], bends[2:]))
    near = np.flatnonzero(heights + np.nan_to_num(bends, nan=0.0) >= best - margin)
    if not len(near):
        return float(times[-1] - times[0])
    first, last = times[max(near[0] - 1, 0)], times[min(near[-1] + 1, len(times) - 1)]
    return float(max(at - first, last - at))


def near_jumps(instants: Array, jumps: Array, uncertain: Array) -> Mask:
    """Whether instants lie so near to a jump that its side is not certain; uncertain [s]: of each jump."""
    near = np.zeros(instants.shape, dtype=bool)
    if not len(jumps):
        return near
    order = np.argsort(jumps)
    at, off = jumps[order], uncertain[order]
    after = np.searchsorted(at, instants)
    for k in (np.clip(after - 1, 0, len(at) - 1), np.clip(after, 0, len(at) - 1)):
        near |= np.abs(instants - at[k]) <= off[k]
    return near
