"""Sample curves over the instants of a run: choose the instants, and find the lowest and highest values from samples.

The instants bracket every summit. About a sample that is higher than its neighbours, the curve is approximated by the
parabola through the three samples. For a sine of amplitude 1 it adds up to c = step² / 8 to the sample, with an error
of 3/2 c². If it adds too much, more instants are needed.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.study.queries.study import Study
from heuncli.study.search.extremes import find_jump_sides, sort_distinct

MIN_CURVE_INSTANTS = 400  # instants of a curve: nearly two a pixel
MAX_SEARCH_INSTANTS = 4000  # largest number of the search's instants that a curve uses
MAX_ADDED = 0.03  # of the largest value, added by a parabola: the error is then 1.4e-3, a fifth of a pixel


def choose_curve_instants(study: Study, max_search_instants: int = MAX_SEARCH_INSTANTS) -> Array:
    """Choose the instants of curves, (n,) ascending, up to the horizon.

    max_search_instants: how many instants of the search for extremes are used at most
    """
    results = study.results
    times = results.time
    if study.has_one_instant:
        return times
    search_times = study.search_times
    if len(search_times) > max_search_instants:
        jumps = np.flatnonzero(find_jump_sides(search_times))
        selected = np.linspace(0, len(search_times) - 1, max_search_instants).round().astype(np.intp)
        search_times = search_times[sort_distinct(np.concatenate([selected, jumps, jumps + 1]))]
    even = np.linspace(times[0], times[-1], MIN_CURVE_INSTANTS)
    curve_times = sort_distinct(np.concatenate([times, search_times, even]))
    horizon = results.horizon
    return np.asarray(curve_times if horizon is None else curve_times[curve_times < horizon])


class CurveBounds(NamedTuple):
    """The lowest and highest value of curves, (k,) each.

    is_fine: whether the instants were close enough
    """

    low: Array
    high: Array
    is_fine: bool


def find_bounds(times: Array, values: Array, smooth: Mask, error: float) -> CurveBounds:
    """Return the bounds of curves (n_t, k) with a stated error; nan is unknown.

    smooth (n_t - 1, k): where neighbours are not the two sides of a jump
    """
    low, high = (side * _find_highest(times, side * values, smooth) for side in (-1.0, 1.0))
    all_unknown = np.isnan(values).all(axis=0)
    sampled = [np.where(all_unknown, np.nan, f(np.where(np.isnan(values), -side * np.inf, values), axis=0))
               for side, f in ((-1.0, np.min), (1.0, np.max))]  # fmt: skip
    added = np.fmax(sampled[0] - low, high - sampled[1])
    size = np.abs(np.where(np.isnan(values), 0.0, values)).max(initial=0.0)
    return CurveBounds(low, high, not bool((added > max(MAX_ADDED * size, error)).any()))


def _find_highest(times: Array, heights: Array, smooth: Mask) -> Array:
    """Return the highest value of each curve, including the summits of parabolas, (k,)."""
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


def halve_steps(times: Array, jumps: Mask) -> Array:
    """Add the instants in the middle between neighbours, except between the two sides of a jump (n_t - 1,)."""
    return np.sort(np.concatenate([times, (0.5 * (times[1:] + times[:-1]))[~jumps]]))
