"""What an interval between two neighbouring instants may hide, by the parabolas through it.

Between two neighbours b < c of a grid a < b < c < d a smooth quantity runs between the two parabolas through a, b, c
and b, c, d: their errors have opposite signs where its third derivative has one. With the bend κ = −f[.,.,.](c−b)² of
a parabola and the rise Δ = f_c − f_b it is

    f_b + Δ s + κ s (1 − s),  s = (t − b)/(c − b);   highest where s = (1 + Δ/κ)/2: max(f_b, f_c) + (κ − |Δ|)²/4κ

if κ > |Δ|. What an interval promises is the highest of the parabola that bends most, and more of what the two differ
by: where a grid is too coarse for a quantity, they differ by as much as it does. At a kink the slopes on either side
meet, at a jump a quantity goes on as before it: there these promise more.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask

DIFFERENCE = 0.5  # of what the two bends differ by, on top of the larger: for third derivatives that change sign
FOURTH = 0.5  # of the bend: what the fourth derivative may add to it where four instants span a summit
NEAREST = 0.02  # of an interval: how near to its ends it is divided: a summit's neighbourhood shrinks so fast
ROUNDED_UP = 0.26  # of a bend: a quarter, and more than rounding adds to it
ROUGH = 0.2  # of the bend: a parabola that misses a value by more has met a kink, or a grid too coarse for it


class Bends(NamedTuple):
    """Of intervals (m,): the bends of the two parabolas, and how each would go on from either side.

    left, right: κ of those with the neighbour before and behind; where one has no number, the other's. up, down: by how
    much each rises from b on as from a to b, and from c back as from d to c.
    """

    left: Array
    right: Array
    up: Array
    down: Array

    def some(self, which: Mask | Indices) -> Bends:
        """Of the intervals that are marked."""
        return Bends(*(x[which] for x in self))


class Intervals(NamedTuple):
    """Intervals that may hold a target's best value.

    t, f (m, 4): instants and heights of a, b, c, d, the interval is from b to c; doubt (m,): by how much the parabola
    missed the last value asked for; rough (m,): whether that was most of what it bends, as at a kink; target, column.
    """

    t: Array
    f: Array
    doubt: Array
    rough: Mask
    target: Indices
    column: Indices

    def some(self, which: Mask | Indices) -> Intervals:
        """The intervals that are marked."""
        t, f, doubt, rough, target, column = self
        return Intervals(t[which], f[which], doubt[which], rough[which], target[which], column[which])

    def shape(self) -> Bends:
        """How each bends and rises."""
        t, f = self.t.T, self.f.T
        w, rise = t[1:] - t[:-1], f[1:] - f[:-1]
        square = w[1] * w[1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            slope = rise / w
            left = -square * (slope[1] - slope[0]) / (t[2] - t[0])
            right = -square * (slope[2] - slope[1]) / (t[3] - t[1])
            up, down = rise[0] * (w[1] / w[0]), -rise[2] * (w[1] / w[2])
        return Bends(*completed(left, right), up, down)

    def promise(self, shape: Bends) -> Array:
        """The highest that may lie between b and c."""
        b, c = self.f[:, 1], self.f[:, 2]
        smooth = promised(b, c, shape.left, shape.right, self.doubt, shape.up, shape.down)
        if not self.rough.any():
            return smooth
        kink = b + shape.up * meeting(c - b, shape.up, shape.down)
        return np.asarray(np.where(self.rough, np.fmax(smooth, kink), smooth))

    def probe(self, shape: Bends) -> Array:
        """Where to ask: at the summit of the mean parabola.

        Where the two have little in common: where the slopes on either side meet, as at a kink, else in the middle.
        """
        left, right, up, down = shape
        rise, mean, apart = self.f[:, 2] - self.f[:, 1], 0.5 * (left + right), np.abs(left - right)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            summit = 0.5 + 0.5 * rise / np.where(mean > np.abs(rise), mean, np.maximum(left, right))
        smooth = (apart < np.abs(mean)) & np.isfinite(summit) & ~self.rough
        share = summit
        if not smooth.all():
            kink = meeting(rise, up, down)
            kink = np.where((kink > 0.0) & (kink < 1.0), kink, 0.5)
            share = np.where(smooth, summit, kink)
        share = np.minimum(np.maximum(share, NEAREST), 1.0 - NEAREST)
        return np.asarray(self.t[:, 1] + share * (self.t[:, 2] - self.t[:, 1]))

    def divided(self, shape: Bends, at: Array, height: Array) -> Intervals:
        """The two parts of each, divided at an instant whose height was asked; what is no number has none."""
        (ta, tb, tc, td), (a, b, c, d) = self.t.T, self.f.T
        share = (at - tb) / (tc - tb)
        expected = b + (c - b) * share + 0.5 * (shape.left + shape.right) * share * (1.0 - share)
        doubt = np.abs(height - expected) / (share * (1.0 - share))  # as a bend
        rough = doubt > ROUGH * np.maximum(np.abs(shape.left), np.abs(shape.right))
        parts = [
            Intervals(np.array(t).T, np.array(f).T, doubt * part, rough, self.target, self.column)
            for t, f, part in (
                ((ta, tb, at, tc), (a, b, height, c), share), ((tb, at, tc, td), (b, height, c, d), 1.0 - share),
            )
        ]  # fmt: skip
        known = np.isfinite(height)
        return joined(parts if known.all() else [part.some(known) for part in parts])


def joined(parts: Sequence[Intervals]) -> Intervals:
    """The intervals of several lists in one."""
    return Intervals(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def completed(left: Array, right: Array) -> tuple[Array, Array]:
    """Two bends of which one may have no number, for want of a neighbour: then it is the other; 0 where neither has."""
    known = np.isfinite(left), np.isfinite(right)
    if known[0].all() and known[1].all():
        return left, right
    both = np.where(known[0], left, np.where(known[1], right, 0.0)), np.where(known[1], right, 0.0)
    return both[0], np.where(known[1], both[1], both[0])


def meeting(rise: Array, up: Array, down: Array) -> Array:
    """Where the slopes before and behind an interval meet in it, as at a kink, from 0 to 1; 0 where they do not."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        share = (rise + down) / (up + down)
        return np.asarray(np.where((up + down > 0.0) & (share > 0.0) & (share < 1.0), share, 0.0))


def promised(b: Array, c: Array, left: Array, right: Array, doubt: Array, up: Array, down: Array) -> Array:
    """The highest that may lie between two heights, by the bends of the two parabolas through them.

    up, down: by how much the quantity rises into the interval from its left and its right, as it did outside. It goes
    on so where it jumps within, and the parabolas then differ by as much as it falls.
    """
    rise, apart, most = np.abs(c - b), np.abs(left - right), np.maximum(left, right)
    bend = most + DIFFERENCE * apart + doubt
    spare = bend - rise
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        more = np.maximum(b, c) + np.where(spare > 0.0, 0.25 * spare * spare / bend, 0.0)
        wild = apart > 0.5 * np.maximum(rise, np.abs(left + right))
        return np.asarray(np.where(wild, np.fmax(more, np.fmax(b + up, c + down)), more))


def ceiling(b: Array, c: Array, most: Array, up: Array, down: Array) -> Array:
    """What `promised` does not exceed, found at less cost; most: the larger of the two bends' magnitudes.

    The bend it goes by is at most 1 + 2 DIFFERENCE + FOURTH of that, and a parabola rises by a quarter of its bend.
    """
    bend = (1.0 + 2.0 * DIFFERENCE + FOURTH) * most
    return np.asarray(np.fmax(np.maximum(b, c) + ROUNDED_UP * bend, np.fmax(b + up, c + down)))
