"""The lowest and the highest of many curves over the instants of a run, from their values at some of these.

The instants bracket every summit. About a sample that is higher than its neighbours a curve is taken for the parabola
through the three of them. Of a sine of size 1 it adds up to c = step² / 8 to the sample, and errs by 3/2 c²: where it
adds much, more instants are wanted.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask

ADDED = 0.03  # of the largest value: what a parabola may add: 1.4 thousandths are then left, a fifth of a pixel


class CurveBounds(NamedTuple):
    """Of curves, (k,) each: the lowest and the highest; fine: whether the instants were close enough to tell."""

    low: Array
    high: Array
    fine: bool


def bounds_of(times: Array, values: Array, smooth: Mask, error: float) -> CurveBounds:
    """The bounds of curves (n_t, k), known to an error; smooth (n_t - 1, k): where neighbours are no sides of a jump.

    nan is not known.
    """
    low, high = (side * _highest(times, side * values, smooth) for side in (-1.0, 1.0))
    none = np.isnan(values).all(axis=0)
    sampled = [np.where(none, np.nan, f(np.where(np.isnan(values), -side * np.inf, values), axis=0))
               for side, f in ((-1.0, np.min), (1.0, np.max))]  # fmt: skip
    added = np.fmax(sampled[0] - low, high - sampled[1])
    size = np.abs(np.where(np.isnan(values), 0.0, values)).max(initial=0.0)
    return CurveBounds(low, high, not bool((added > max(ADDED * size, error)).any()))


def _highest(times: Array, heights: Array, smooth: Mask) -> Array:
    """The highest of each curve, at the summits of parabolas, too, (k,)."""
    known = np.where(np.isnan(heights), -np.inf, heights)
    top = known.max(axis=0)
    if len(times) > 2:
        left, right = (np.diff(times)[:-1, None], np.diff(times)[1:, None])
        with np.errstate(invalid="ignore", divide="ignore"):
            rises = np.diff(heights, axis=0) / np.diff(times)[:, None]
            up, down = rises[:-1], rises[1:]
            slope, bend = (up * right + down * left) / (left + right), (down - up) / (left + right)
            tops = heights[1:-1] - slope * slope / (4.0 * bend)
        summit = (up >= 0.0) & (down <= 0.0) & (bend < 0.0) & smooth[:-1] & smooth[1:]
        top = np.maximum(top, np.where(summit, tops, -np.inf).max(axis=0))
    return np.where(np.isneginf(top), np.nan, top)


def halved(times: Array, jumps: Mask) -> Array:
    """The instants and those in the middle between neighbours, but for the two sides of a jump (n_t - 1,)."""
    return np.sort(np.concatenate([times, (0.5 * (times[1:] + times[:-1]))[~jumps]]))
