"""Bound what an interval between two neighbouring instants may hide, by the parabolas through it.

Between two neighbours b < c of a grid a < b < c < d a smooth quantity runs between the two parabolas through a, b, c
and b, c, d: their errors have opposite signs where its third derivative has one. With the bend κ = −f[.,.,.](c−b)² of a
parabola and the rise Δ = f_c − f_b it is

    f_b + Δ s + κ s (1 − s),  s = (t − b)/(c − b);   highest where s = (1 + Δ/κ)/2: max(f_b, f_c) + (κ − |Δ|)²/4κ

if κ > |Δ|. An interval promises the highest point of the parabola that bends most, plus a part of the difference
between the two: where a grid is too coarse for a quantity, they differ by as much as it does. At a kink the slopes on
either side meet, at a jump a quantity continues as before it: there these promise more.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask

# share of the difference of the two bends that is added to the larger one, for third derivatives that change sign
THIRD_DERIVATIVE_SHARE = 0.5
# share of the bend that the fourth derivative may add where four instants span a summit
FOURTH_DERIVATIVE_SHARE = 0.5
# share of an interval that a division leaves at its ends at least, so that a summit's neighbourhood shrinks fast
MIN_END_DISTANCE = 0.02
MAX_RISE_PER_BEND = 0.26  # rise of a parabola above its higher end, per bend: a quarter, and more than rounding adds
MIN_KINK_MISFIT = 0.2  # share of the bend: a parabola that misses a value by more shows a kink, or too coarse a grid


class Bends(NamedTuple):
    """The bends of the two parabolas of intervals (m,), and the continuation from either side.

    kappa_before, kappa_after: κ of the parabola with the neighbour before, and after; where one is nan, the other's
    rise_before: rise from b to c if the slope from a to b continues
    rise_after: rise from c back to b if the slope from d to c continues
    """

    kappa_before: Array
    kappa_after: Array
    rise_before: Array
    rise_after: Array

    def select(self, mask: Mask | Indices) -> Bends:
        """Return the bends of the marked intervals."""
        return Bends(*(x[mask] for x in self))


class Intervals(NamedTuple):
    """Intervals that may hold a target's best value.

    t, f (m, 4): instants and heights of a, b, c, d; the interval is from b to c
    doubt (m,): by how much the parabola missed the last sample, as a bend
    is_rough (m,): whether it missed by so much that a kink, or too coarse a grid, is likely
    target, column: what the interval is searched for
    """

    t: Array
    f: Array
    doubt: Array
    is_rough: Mask
    target: Indices
    column: Indices

    def select(self, mask: Mask | Indices) -> Intervals:
        """Return the marked intervals."""
        t, f, misfit, is_rough, target, column = self
        return Intervals(t[mask], f[mask], misfit[mask], is_rough[mask], target[mask], column[mask])

    def compute_bends(self) -> Bends:
        """Compute the bends and rises of each interval."""
        t, f = self.t.T, self.f.T
        w, rise = t[1:] - t[:-1], f[1:] - f[:-1]
        square = w[1] * w[1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            slope = rise / w
            kappa_before = -square * (slope[1] - slope[0]) / (t[2] - t[0])
            kappa_after = -square * (slope[2] - slope[1]) / (t[3] - t[1])
            rise_before, rise_after = rise[0] * (w[1] / w[0]), -rise[2] * (w[1] / w[2])
        return Bends(*fill_missing(kappa_before, kappa_after), rise_before, rise_after)

    def bound_heights(self, bends: Bends) -> Array:
        """Return the highest values that may lie between b and c."""
        b, c = self.f[:, 1], self.f[:, 2]
        smooth = bound_heights(
            b, c, bends.kappa_before, bends.kappa_after, self.doubt, bends.rise_before, bends.rise_after
        )
        if not self.is_rough.any():
            return smooth
        kink = b + bends.rise_before * find_kink(c - b, bends.rise_before, bends.rise_after)
        return np.asarray(np.where(self.is_rough, np.fmax(smooth, kink), smooth))

    def choose_probes(self, bends: Bends) -> Array:
        """Choose where to sample: at the summit of the mean parabola.

        Where the two parabolas differ much: where the slopes on either side meet, as at a kink, otherwise in the
        middle.
        """
        kappa_before, kappa_after, rise_before, rise_after = bends
        rise, mean_kappa, difference = (
            self.f[:, 2] - self.f[:, 1],
            0.5 * (kappa_before + kappa_after),
            np.abs(kappa_before - kappa_after),
        )
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            summit = 0.5 + 0.5 * rise / np.where(
                mean_kappa > np.abs(rise), mean_kappa, np.maximum(kappa_before, kappa_after)
            )
        smooth = (difference < np.abs(mean_kappa)) & np.isfinite(summit) & ~self.is_rough
        share = summit
        if not smooth.all():
            kink = find_kink(rise, rise_before, rise_after)
            kink = np.where((kink > 0.0) & (kink < 1.0), kink, 0.5)
            share = np.where(smooth, summit, kink)
        share = np.minimum(np.maximum(share, MIN_END_DISTANCE), 1.0 - MIN_END_DISTANCE)
        return np.asarray(self.t[:, 1] + share * (self.t[:, 2] - self.t[:, 1]))

    def divide(self, bends: Bends, times: Array, height: Array) -> Intervals:
        """Divide each interval at an instant with a sampled height into two; one with a height of nan is dropped."""
        (ta, tb, tc, td), (a, b, c, d) = self.t.T, self.f.T
        share = (times - tb) / (tc - tb)
        expected = b + (c - b) * share + 0.5 * (bends.kappa_before + bends.kappa_after) * share * (1.0 - share)
        misfit = np.abs(height - expected) / (share * (1.0 - share))  # divided by s (1 - s), as a bend is
        is_rough = misfit > MIN_KINK_MISFIT * np.maximum(np.abs(bends.kappa_before), np.abs(bends.kappa_after))
        parts = [
            Intervals(np.array(t).T, np.array(f).T, misfit * part, is_rough, self.target, self.column)
            for t, f, part in (
                ((ta, tb, times, tc), (a, b, height, c), share), ((tb, times, tc, td), (b, height, c, d), 1.0 - share),
            )
        ]  # fmt: skip
        known = np.isfinite(height)
        return concatenate_intervals(parts if known.all() else [part.select(known) for part in parts])


def concatenate_intervals(parts: Sequence[Intervals]) -> Intervals:
    """Concatenate several lists of intervals."""
    return Intervals(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def fill_missing(kappa_before: Array, kappa_after: Array) -> tuple[Array, Array]:
    """Replace an undefined bend (nan, at an end of the grid) by that of the other side; 0 where both are."""
    known = np.isfinite(kappa_before), np.isfinite(kappa_after)
    if known[0].all() and known[1].all():
        return kappa_before, kappa_after
    filled = (
        np.where(known[0], kappa_before, np.where(known[1], kappa_after, 0.0)),
        np.where(known[1], kappa_after, 0.0),
    )
    return filled[0], np.where(known[1], filled[1], filled[0])


def find_kink(rise: Array, rise_before: Array, rise_after: Array) -> Array:
    """Return where the slopes before and after an interval meet in it, as at a kink, from 0 to 1; 0 where they do
    not.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        share = (rise + rise_after) / (rise_before + rise_after)
        return np.asarray(np.where((rise_before + rise_after > 0.0) & (share > 0.0) & (share < 1.0), share, 0.0))


def bound_heights(
    b: Array, c: Array, kappa_before: Array, kappa_after: Array, misfit: Array, rise_before: Array, rise_after: Array
) -> Array:
    """Bound the highest value between two heights, by the bends of the two parabolas through them.

    misfit: by how much a parabola missed the last sample
    rise_before, rise_after: continuation into the interval from its left and its right

    Up to a jump within the interval a quantity follows these continuations; the parabolas then differ by as much as it
    falls.
    """
    rise, difference, larger_kappa = (
        np.abs(c - b),
        np.abs(kappa_before - kappa_after),
        np.maximum(kappa_before, kappa_after),
    )
    bend = larger_kappa + THIRD_DERIVATIVE_SHARE * difference + misfit
    spare = bend - rise
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        bound = np.maximum(b, c) + np.where(spare > 0.0, 0.25 * spare * spare / bend, 0.0)
        is_wild = difference > 0.5 * np.maximum(rise, np.abs(kappa_before + kappa_after))
        return np.asarray(np.where(is_wild, np.fmax(bound, np.fmax(b + rise_before, c + rise_after)), bound))


def bound_heights_cheaply(b: Array, c: Array, largest_kappa: Array, rise_before: Array, rise_after: Array) -> Array:
    """Bound `bound_heights` from above at less cost; largest_kappa: the larger of the two bends' magnitudes.

    The bend that it uses is at most 1 + 2 THIRD_DERIVATIVE_SHARE + FOURTH_DERIVATIVE_SHARE of that, and a parabola
    rises by a quarter of its bend.
    """
    bend = (1.0 + 2.0 * THIRD_DERIVATIVE_SHARE + FOURTH_DERIVATIVE_SHARE) * largest_kappa
    return np.asarray(np.fmax(np.maximum(b, c) + MAX_RISE_PER_BEND * bend, np.fmax(b + rise_before, c + rise_after)))
