"""Instants at which a sampled number passes through zero, searched between the samples as extremes are.

A number h(t) is known on a grid and can be asked for at any other instant; it counts as above zero where it is above
its own error. Where two neighbours of the grid differ in that there is a crossing between them, found as a root; where
they do not the number may still pass zero and come back: parts that promise so (study/search/intervals.py) are asked
where they promise most and divided there, until none is left. Neighbours that are the two sides of a jump are told as
such.
Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.study.search.extremes import (
    MOST_PROBES,
    MOST_ROUNDS,
    Best,
    Targets,
    distinct,
    intervals_of,
    sides_of_jumps,
)
from heuncli.study.search.intervals import Intervals

NumberAt = Callable[[Array], Array]  # of sorted instants (n,) the number there, (n,); nan where there is none
MOST_STEPS = 120  # towards a root: halving alone takes 53, an interpolation that fails each time twice that


class Crossings(NamedTuple):
    """Where a number passes zero: times (n,) ascending, up (n,): whether it is above behind; error (n,) of the times.

    begins: whether it is above at first; jumps (n,): whether it jumps there; gaps: whether it was no number somewhere;
    complete: whether all was looked at that may pass.
    """

    begins: bool
    times: Array
    up: Mask
    error: Array
    jumps: Mask
    gaps: bool
    complete: bool


class Bracket(NamedTuple):
    """Instants a before b (n,), on two sides of what is searched; f, g: h there."""

    a: Array
    b: Array
    f: Array
    g: Array


def crossings(sample: NumberAt, times: Array, h: Array, error: float) -> Crossings:
    """Where what is sampled passes zero within the span of `times`, (n,) ascending; h: it there, error: of h."""
    times, h, complete = refined(sample, times, h, error)
    known = np.isfinite(h)
    gaps = not bool(known.all())
    above = h > error
    both = known[1:] & known[:-1] & (above[1:] != above[:-1])
    jumps = sides_of_jumps(times)
    k = np.flatnonzero(both)
    at, smooth = times[k + 1].copy(), ~jumps[k]
    if smooth.any():
        i = k[smooth]
        of = Bracket(times[i], times[i + 1], h[i], h[i + 1])
        at[smooth] = roots(sample, of, np.where((of.f > 0.0) == (of.g > 0.0), error, 0.0))  # else its own error
    off = np.full(len(k), tolerances.EPS) * np.abs(at)
    off[smooth] = errors(sample, at[smooth], error, (float(times[0]), float(times[-1])))
    begins = bool(above[known][0]) if known.any() else False
    return Crossings(begins, at, above[k + 1], off, jumps[k], gaps, complete)


def refined(sample: NumberAt, times: Array, h: Array, error: float) -> tuple[Array, Array, bool]:
    """More instants where h passes zero and comes back between two of the grid; whether all was looked at."""
    if len(times) < 3:
        return times, h, True
    asked = Targets(
        1, np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp), np.array([error]), np.zeros(1, dtype=bool)
    )
    none = Best(np.zeros(2), np.zeros(2), np.zeros(2, dtype=np.intp))  # zero is the height to be passed, on either side
    pool, probes = hidden(intervals_of(times, (h - error)[:, None], asked, none)), 0
    more_t, more_h = [times], [h]
    span = float(np.ptp(times))
    for _ in range(MOST_ROUNDS):
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * span
        shape = pool.shape()
        least = tolerances.EPS * np.abs(pool.f[:, 1:3]).max(axis=1, initial=0.0)
        worth = wide & (pool.promise(shape) > least)
        pool, shape = pool.some(worth), shape.some(worth)
        if not len(pool.target):
            return joined(more_t, more_h, complete=True)
        if probes > MOST_PROBES:
            break
        at = pool.probe(shape)
        instants = distinct(at)
        found = sample(instants)
        side = np.where(pool.target < 1, -1.0, 1.0)
        more_t.append(instants)
        more_h.append(found)
        probes += len(instants)
        pool = hidden(pool.divided(shape, at, side * (found[np.searchsorted(instants, at)] - error)))
    return joined(more_t, more_h, complete=False)


def hidden(pool: Intervals) -> Intervals:
    """Intervals at both ends of which zero is not passed, on the side that they are looked at from."""
    return pool.some((pool.f[:, 1] <= 0.0) & (pool.f[:, 2] <= 0.0))


def joined(times: list[Array], h: list[Array], *, complete: bool) -> tuple[Array, Array, bool]:
    """All instants that were asked, ascending."""
    t, values = np.concatenate(times), np.concatenate(h)
    order = np.argsort(t, kind="stable")
    new = np.append(True, np.diff(t[order]) > 0.0)
    return t[order][new], values[order][new], complete


def roots(sample: NumberAt, of: Bracket, level: Array) -> Array:
    """The instant in each bracket at which h passes its level (n,).

    By inverse quadratic interpolation where that is safe, else by halves: T. R. Chandrupatla, Adv. Eng. Softw. 28
    (1997).
    """
    a, b, f, g = of.b.copy(), of.a.copy(), of.g - level, of.f - level  # a: the newest, b: on its other side
    c, e = b.copy(), g.copy()
    share = np.full(len(a), 0.5)
    width = 2.0 * tolerances.EPS * np.maximum(np.abs(of.b), 0.01 * np.abs(of.b).max(initial=0.0))
    going = np.abs(a - b) > width
    for _ in range(MOST_STEPS):
        if not going.any():
            break
        x = a + share * (b - a)
        instants = distinct(x[going])
        y = np.where(going, 0.0, f)
        y[going] = sample(instants)[np.searchsorted(instants, x[going])] - level[going]
        same = (y > 0.0) == (f > 0.0)
        c, e = np.where(going, np.where(same, a, b), c), np.where(going, np.where(same, f, g), e)
        b, g = np.where(going & ~same, a, b), np.where(going & ~same, f, g)
        a, f = np.where(going, x, a), np.where(going, y, f)
        going &= np.abs(a - b) > width
        share = next_share(Bracket(a, b, f, g), c, e, width)
    return np.maximum(a, b)


def next_share(of: Bracket, c: Array, e: Array, width: Array) -> Array:
    """Where between a and b to ask next, from the three last points."""
    a, b, f, g = of
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        xi, phi = (a - b) / (c - b), (f - g) / (e - g)
        safe = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        inverse = f / (g - f) * e / (g - e) + (c - a) / (b - a) * f / (e - f) * g / (e - g)
        share = np.where(safe & np.isfinite(inverse), inverse, 0.5)
        least = np.minimum(0.5 * width / np.abs(b - a), 0.5)
    return np.clip(share, least, 1.0 - least)


def errors(sample: NumberAt, at: Array, error: float, span: tuple[float, float]) -> Array:
    """Within which time of each root h is beyond its error on either side, (n,); nan if not within a part of all."""
    found, open_ = np.full(len(at), np.nan), np.ones(len(at), dtype=bool)
    d = tolerances.KERNEL["one_instant"] * max(abs(span[1]), 1e-300)
    while open_.any() and d <= tolerances.CLAIMED * (span[1] - span[0]):
        t = at[open_]
        instants = distinct(np.clip(np.concatenate([t - d, t + d]), *span))
        h = sample(instants)
        before, after = (h[np.searchsorted(instants, np.clip(t + s * d, *span))] for s in (-1.0, 1.0))
        decided = ((before > error) & (after < -error)) | ((before < -error) & (after > error))
        which = np.flatnonzero(open_)[decided]
        found[which], open_[which] = d, False
        d *= 4.0
    return found
