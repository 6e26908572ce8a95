"""Find the instants at which a sampled number passes through zero, searched between the samples as extremes are.

A number h(t) is known on a grid and can be sampled at any other instant; it counts as positive where it exceeds its own
error. Where two neighbours of the grid differ in that there is a crossing between them, found as a root. Where they do
not, the number may still pass zero and return: intervals that may hide this (study/search/intervals.py) are sampled
where they promise most and divided there, until none is left. Neighbours that are the two sides of a jump are reported
as such. Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.study.search.extremes import MAX_PROBES, MAX_ROUNDS
from heuncli.study.search.grid import Best, Targets, find_intervals, find_jump_sides, sort_distinct
from heuncli.study.search.intervals import Intervals

# takes sorted instants (n,), returns the number there, (n,); nan where there is none
NumberSampler = Callable[[Array], Array]
MAX_STEPS = 120  # steps to a root: bisection takes 53, and twice that if every interpolation between fails


class Crossings(NamedTuple):
    """The crossings of zero of a number.

    begins: whether the number is positive at the first instant
    times (n,): ascending
    is_rise (n,): whether it is positive after the crossing
    error (n,): of the times
    jumps (n,): whether it jumps there
    gaps: whether it was nan somewhere
    complete: whether every interval that may hide a crossing was searched
    """

    begins: bool
    times: Array
    is_rise: Mask
    error: Array
    jumps: Mask
    gaps: bool
    complete: bool


class Bracket(NamedTuple):
    """Instants a before b (n,) on two sides of a root; f, g: h there."""

    a: Array
    b: Array
    f: Array
    g: Array


def find_crossings(sample: NumberSampler, times: Array, h: Array, error: float) -> Crossings:
    """Find where the sampled number passes zero within the span of `times`, (n,) ascending.

    h (n,): its values there
    error: of the number
    """
    times, h, complete = refine_grid(sample, times, h, error)
    known = np.isfinite(h)
    gaps = not bool(known.all())
    above = h > error
    is_crossing = known[1:] & known[:-1] & (above[1:] != above[:-1])
    jumps = find_jump_sides(times)
    k = np.flatnonzero(is_crossing)
    crossing_times, smooth = times[k + 1].copy(), ~jumps[k]
    if smooth.any():
        i = k[smooth]
        bracket = Bracket(times[i], times[i + 1], h[i], h[i + 1])
        crossing_times[smooth] = find_roots(
            sample, bracket, np.where((bracket.f > 0.0) == (bracket.g > 0.0), error, 0.0)
        )  # else its own error
    time_errors = np.full(len(k), tolerances.EPS) * np.abs(crossing_times)
    time_errors[smooth] = estimate_time_errors(
        sample, crossing_times[smooth], error, (float(times[0]), float(times[-1]))
    )
    begins = bool(above[known][0]) if known.any() else False
    return Crossings(begins, crossing_times, above[k + 1], time_errors, jumps[k], gaps, complete)


class SampledNumber(NamedTuple):
    """The instants at which a number was sampled, (n,) ascending, its values, and whether all was searched."""

    times: Array
    values: Array
    is_complete: bool


def refine_grid(sample: NumberSampler, times: Array, h: Array, error: float) -> SampledNumber:
    """Add instants where h passes zero and returns between two of the grid."""
    if len(times) < 3:
        return SampledNumber(times, h, is_complete=True)
    targets = Targets(
        1, np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp), np.array([error]), np.zeros(1, dtype=bool)
    )
    zero_level = Best(np.zeros(2), np.zeros(2), np.zeros(2, dtype=np.intp))  # zero has to be exceeded, on either side
    pool, probes = select_hidden(find_intervals(times, (h - error)[:, None], targets, zero_level)), 0
    more_t, more_h = [times], [h]
    span = float(np.ptp(times))
    for _ in range(MAX_ROUNDS):
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * span
        shape = pool.compute_bends()
        least = tolerances.EPS * np.abs(pool.f[:, 1:3]).max(axis=1, initial=0.0)
        worth = wide & (pool.bound_heights(shape) > least)
        pool, shape = pool.select(worth), shape.select(worth)
        if not len(pool.target):
            return merge_samples(more_t, more_h, is_complete=True)
        if probes > MAX_PROBES:
            break
        probe_times = pool.choose_probes(shape)
        instants = sort_distinct(probe_times)
        values = sample(instants)
        side = np.where(pool.target < 1, -1.0, 1.0)
        more_t.append(instants)
        more_h.append(values)
        probes += len(instants)
        pool = select_hidden(
            pool.divide(shape, probe_times, side * (values[np.searchsorted(instants, probe_times)] - error))
        )
    return merge_samples(more_t, more_h, is_complete=False)


def select_hidden(pool: Intervals) -> Intervals:
    """Select the intervals at whose ends zero is not passed: a pair of roots may be hidden in them."""
    return pool.select((pool.f[:, 1] <= 0.0) & (pool.f[:, 2] <= 0.0))


def merge_samples(times: list[Array], h: list[Array], *, is_complete: bool) -> SampledNumber:
    """Put all sampled instants in order; each stands once."""
    t, values = np.concatenate(times), np.concatenate(h)
    order = np.argsort(t, kind="stable")
    new = np.append(True, np.diff(t[order]) > 0.0)
    return SampledNumber(t[order][new], values[order][new], is_complete)


def find_roots(sample: NumberSampler, bracket: Bracket, level: Array) -> Array:
    """Find the instant in each bracket at which h passes its level (n,).

    By inverse quadratic interpolation where that is safe, else by bisection: T. R. Chandrupatla, Adv. Eng. Softw. 28
    (1997).
    """
    a, b, f, g = (
        bracket.b.copy(),
        bracket.a.copy(),
        bracket.g - level,
        bracket.f - level,
    )  # a: the newest, b: on its other side
    c, e = b.copy(), g.copy()
    share = np.full(len(a), 0.5)
    width = 2.0 * tolerances.EPS * np.maximum(np.abs(bracket.b), 0.01 * np.abs(bracket.b).max(initial=0.0))
    going = np.abs(a - b) > width
    for _ in range(MAX_STEPS):
        if not going.any():
            break
        x = a + share * (b - a)
        instants = sort_distinct(x[going])
        y = np.where(going, 0.0, f)
        y[going] = sample(instants)[np.searchsorted(instants, x[going])] - level[going]
        same = (y > 0.0) == (f > 0.0)
        c, e = np.where(going, np.where(same, a, b), c), np.where(going, np.where(same, f, g), e)
        b, g = np.where(going & ~same, a, b), np.where(going & ~same, f, g)
        a, f = np.where(going, x, a), np.where(going, y, f)
        going &= np.abs(a - b) > width
        share = choose_next_share(Bracket(a, b, f, g), c, e, width)
    return np.maximum(a, b)


def choose_next_share(bracket: Bracket, c: Array, e: Array, width: Array) -> Array:
    """Choose the next place between a and b, as a share of the bracket, from the last three points."""
    a, b, f, g = bracket
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        xi, phi = (a - b) / (c - b), (f - g) / (e - g)
        safe = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        inverse = f / (g - f) * e / (g - e) + (c - a) / (b - a) * f / (e - f) * g / (e - g)
        share = np.where(safe & np.isfinite(inverse), inverse, 0.5)
        least = np.minimum(0.5 * width / np.abs(b - a), 0.5)
    return np.clip(share, least, 1.0 - least)


def estimate_time_errors(sample: NumberSampler, root_times: Array, error: float, span: tuple[float, float]) -> Array:
    """Estimate the errors of roots, (n,): the time within which h exceeds its error on both sides.

    nan where it does not do so within a part of the span
    """
    time_errors, open_ = np.full(len(root_times), np.nan), np.ones(len(root_times), dtype=bool)
    d = tolerances.KERNEL["one_instant"] * max(abs(span[1]), 1e-300)
    while open_.any() and d <= tolerances.CLAIMED * (span[1] - span[0]):
        t = root_times[open_]
        instants = sort_distinct(np.clip(np.concatenate([t - d, t + d]), *span))
        h = sample(instants)
        before, after = (h[np.searchsorted(instants, np.clip(t + s * d, *span))] for s in (-1.0, 1.0))
        decided = ((before > error) & (after < -error)) | ((before < -error) & (after > error))
        which = np.flatnonzero(open_)[decided]
        time_errors[which], open_[which] = d, False
        d *= 4.0
    return time_errors
