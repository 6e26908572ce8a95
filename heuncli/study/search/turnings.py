"""Find all turning points of sampled numbers, also those between the samples.

First a grid is made that shows how the numbers run: each interval is sampled, and divided further there unless cubics
through four neighbours predict the sample, twice in a row. For the single largest value of a run an interval that
cannot hold it need not be searched; for all turning points each must be. Then, as extremes are searched
(study/search/intervals.py): an interval may hide a turning point if it promises more than the higher of its ends, or
less than the lower. It is sampled where it promises most and divided there, until none promises more than a part of the
error. Variations below the error are not searched.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.search.extremes import MAX_ROUNDS
from heuncli.study.search.grid import (
    BOTH_SIDES,
    GOOD_ENOUGH,
    ColumnSampler,
    Targets,
    find_intervals_above,
    find_jump_sides,
    sort_distinct,
)

MAX_PROBES = 2_000_000  # instants sampled in one search: turning points of some hundred thousand cycles
OFF_MIDDLE = 0.52  # share of an interval at which it is sampled: off its middle, nothing periodic looks constant
NO_INSTANTS = np.zeros(0)
MIN_PREDICTIONS = 2  # consecutive correct predictions of an interval
# share of the range of four neighbours: the error of cubics through seven instants per period
PREDICTION_TOLERANCE = 0.02

# takes sizes (m, n) over intervals and their widths (m,), returns the negligible part, (m, n)
Slack = Callable[[Array, Array], Array]


class SampledTurns(NamedTuple):
    """Samples of a number: times (n,) ascending, values (n, n_columns).

    complete: whether every interval that may hide a turning point was searched

    The sampling ends where a number is indeterminate (nan).
    """

    times: Array
    values: Array
    complete: bool


def add_turning_points(
    sample: ColumnSampler, times: Array, grid: Array, errors: Array, is_squared: Mask
) -> SampledTurns:
    """Return the samples at the instants of a grid and at all turning points between them.

    times (n_t,): the instants of the grid
    grid (n_t, n_columns): the samples there
    errors (n_columns,): of the numbers
    is_squared: whether columns are squares of these numbers
    """

    def slack(size: Array, _: Array) -> Array:
        """Return the part of numbers of some sizes (m, n_columns) that their errors cover."""
        return np.asarray(np.where(is_squared, errors * errors + 2.0 * errors * np.sqrt(size), errors))

    first_samples = refine_until_predicted(sample, SampledTurns(times, grid, complete=True), slack)
    if len(times) < 2 or not first_samples.complete or not np.isfinite(first_samples.values).all():
        return first_samples
    columns = np.arange(grid.shape[1], dtype=np.intp)
    targets = Targets(len(columns), columns, columns, errors, is_squared)
    required_height = make_required_height(errors, is_squared)
    pool = find_intervals_above(first_samples.times, first_samples.values, targets, required_height, BOTH_SIDES)
    span, probes = float(np.ptp(times)), 0
    parts = [first_samples]
    for _ in range(MAX_ROUNDS):
        shape = pool.compute_bends()
        required = required_height(pool.f[:, 1], pool.f[:, 2], pool.target)
        wide = pool.t[:, 2] - pool.t[:, 1] > tolerances.SIDE_BY_SIDE * span
        worth = wide & (targets.limit_promise(pool.bound_heights(shape), pool.target) > required)
        pool, shape = pool.select(worth), shape.select(worth)
        if not len(pool.target) or probes > MAX_PROBES:
            break
        probe_times = pool.choose_probes(shape)
        instants = sort_distinct(probe_times)
        values = sample(instants)
        parts.append(SampledTurns(instants, values, complete=True))
        probes += len(instants)
        if np.isnan(values).any():
            return merge_samples(parts, complete=True)
        side = np.where(pool.target < targets.n, -1.0, 1.0)
        pool = pool.divide(shape, probe_times, side * values[np.searchsorted(instants, probe_times), pool.column])
    return merge_samples(parts, complete=not len(pool.target))


def refine_until_predicted(
    sample: ColumnSampler,
    samples: SampledTurns,
    slack: Slack,
    *,
    max_instants: int = MAX_PROBES,
    probes: Array | None = None,
    is_doubtful: Mask | None = None,
) -> SampledTurns:
    """Add instants to the grid where a number does not run as its neighbours predict.

    An interval is done when both it and the half of it that it came from were predicted: a single instant may be so by
    chance, as a wave is in the middle between its summits. The intervals adjacent to one that was not predicted are
    sampled again, because their prediction did not show it.

    slack: the negligible part of the numbers
    max_instants: limit of the number of samples
    probes (m,): instants between those of the grid that are sampled, too; then predicted samples are dropped, and one
    per interval is enough
    is_doubtful (n - 1,): the intervals of the grid to be sampled; all, by default
    """
    span, sampled_count = float(np.ptp(samples.times)), 0
    min_predictions = MIN_PREDICTIONS if probes is None else 1
    # consecutive correct predictions of each interval
    predictions = np.zeros(max(len(samples.times) - 1, 0), dtype=np.intp)
    if is_doubtful is not None:
        predictions[~is_doubtful] = min_predictions
    extra_instants = NO_INSTANTS if probes is None else probes
    for _ in range(MAX_ROUNDS):
        times, values, complete = samples
        wide = np.diff(times) > tolerances.SIDE_BY_SIDE * span
        k = np.flatnonzero((predictions < min_predictions) & wide & ~find_jump_sides(times))
        if not len(k) + len(extra_instants) or not np.isfinite(values).all():
            return samples
        if sampled_count > max_instants:
            return samples._replace(complete=False)
        times_sampled = times[k] + OFF_MIDDLE * (times[k + 1] - times[k])
        times_sampled, extra_instants = sort_distinct(np.concatenate([times_sampled, extra_instants])), NO_INSTANTS
        k = np.searchsorted(times, times_sampled) - 1
        new_values = sample(times_sampled)
        sampled_count += len(times_sampled)
        is_missed = ~is_predicted(samples, k, times_sampled, new_values, slack)
        is_kept = is_missed | (probes is None)
        predictions[k] += 1
        predictions[k[is_missed]] = 0
        adjacent = np.clip(np.concatenate([k[is_missed] - 1, k[is_missed] + 1]), 0, len(predictions) - 1)
        predictions[adjacent] = np.minimum(predictions[adjacent], min_predictions - 1)
        samples = merge_samples(
            [samples, SampledTurns(times_sampled[is_kept], new_values[is_kept], complete)], complete=complete
        )
        predictions = predictions[np.searchsorted(times, samples.times[:-1], side="right") - 1]
    return samples._replace(complete=samples.complete and bool((predictions >= min_predictions).all()))


def find_doubtful(samples: SampledTurns, slack: Slack) -> Mask:
    """Mark the intervals of a grid next to an instant that its neighbours do not predict, (n - 1,).

    The others are half as wide as the prediction's, and need not be sampled.
    """
    times, values, _ = samples
    is_doubtful = np.ones(max(len(times) - 1, 0), dtype=bool)
    if len(times) < 5:
        return is_doubtful
    jumps = np.append(np.append(True, find_jump_sides(times)), True)
    inner = np.arange(2, len(times) - 2)
    inner = inner[~(jumps[inner - 1] | jumps[inner] | jumps[inner + 1] | jumps[inner + 2])]
    neighbour_indices = inner[:, None] + np.array([-2, -1, 1, 2])
    has_prediction = np.zeros(len(times), dtype=bool)
    has_prediction[inner] = matches_cubic(samples, neighbour_indices, inner - 1, times[inner], values[inner], slack)
    is_doubtful &= ~(has_prediction[1:] & has_prediction[:-1])
    return is_doubtful


def is_predicted(samples: SampledTurns, k: Indices, new_times: Array, new_values: Array, slack: Slack) -> Mask:
    """Mark the new samples within intervals that the cubics through their neighbours predict, (m,)."""
    return matches_cubic(samples, find_neighbours(samples.times, k), k, new_times, new_values, slack)


def matches_cubic(
    samples: SampledTurns, neighbour_indices: Indices, k: Indices, new_times: Array, new_values: Array, slack: Slack
) -> Mask:
    """Mark the new samples in the intervals k that the cubics through four instants each, (m, 4), predict, (m,)."""
    times, values, _ = samples
    expected = evaluate_cubic(times[neighbour_indices], values[neighbour_indices], new_times)
    swing = np.ptp(np.concatenate([values[neighbour_indices], new_values[:, None]], axis=1), axis=1)
    size = np.maximum(np.abs(values[k]), np.abs(values[k + 1]))
    allowed = slack(size, times[k + 1] - times[k])
    return np.asarray((np.abs(new_values - expected) <= np.maximum(PREDICTION_TOLERANCE * swing, allowed)).all(axis=1))


def find_neighbours(times: Array, k: Indices) -> Indices:
    """Return four neighbouring instants about each interval, (m, 4), on the same side of a jump if that has four."""
    jumps = np.flatnonzero(find_jump_sides(times))
    first = np.concatenate([[0], jumps + 1])
    last = np.concatenate([jumps, [len(times) - 1]])
    own = np.searchsorted(first, k, side="right") - 1
    begin = np.clip(k - 1, first[own], np.maximum(last[own] - 3, first[own]))
    return np.asarray(np.minimum(begin[:, None] + np.arange(4), len(times) - 1))


def evaluate_cubic(t: Array, f: Array, new_times: Array) -> Array:
    """Evaluate the cubics through four points each, t (m, 4), f (m, 4, n), at one instant each, (m, n).

    nan where two of the points coincide, or are two sides of a jump.
    """
    value = np.zeros((len(new_times), f.shape[2]))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i in range(4):
            others = [j for j in range(4) if j != i]
            weight = np.prod([(new_times - t[:, j]) / (t[:, i] - t[:, j]) for j in others], axis=0)
            value += weight[:, None] * f[:, i]
    return value


def merge_samples(parts: Sequence[SampledTurns], *, complete: bool) -> SampledTurns:
    """Merge samples, ascending in time, each instant once."""
    times, values = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    order = np.argsort(times, kind="stable")
    first = np.append(True, np.diff(times[order]) > 0.0)
    return SampledTurns(times[order][first], values[order][first], complete)


def make_required_height(errors: Array, is_squared: Mask) -> Callable[[Array, Array, Indices], Array]:
    """Return the function for how high an interval must promise to go before it may hide a relevant turning point.

    The function takes the heights at both ends of intervals, and their targets.
    """
    n = len(errors)

    def require_height(b: Array, c: Array, target: Indices) -> Array:
        """Return the height that a promise must exceed to be worth a sample."""
        higher, group = np.maximum(b, c), target % n
        error, size = GOOD_ENOUGH * errors[group], np.abs(higher)
        squared = error * error + 2.0 * error * np.sqrt(size)
        return np.asarray(higher + np.where(is_squared[group], squared, error) + tolerances.SUM_ROUNDING * size)

    return require_height
