"""Estimate statistics from a random sample, and Sobol indices, each with the error that few draws leave.

    mean        x̄ ± t s/√n                                  t: of n - 1 degrees of freedom, 97.5 %
    deviation   s √c e^(± c z √((γ - (n - 3)/n)/(n - 1))/2) c = n/(n - z), γ: the sample's own kurtosis (Bonett 2006)
    percentile  between two values of the sample            by how many of n lie below it, which is binomial in any law

An interval contains the true value in 95 of 100 such samples, if the draws are independent of each other. Those of a
mean and of a deviation do so somewhat less often where few are drawn from a skew law (91 of 100 samples of 100
exponential numbers have their deviation within). A Latin hypercube or a Sobol sequence is more even than independent
draws: its mean is more accurate than its interval says.

    f_A, f_B   the measure at two independent samples; f_i: at A with its i-th parameter from B
    V          the variance, of f_A and f_B together
    S_i        Σ f_B (f_i - f_A) / (n V)        first order: of the parameter alone (Saltelli 2010)
    T_i        Σ (f_A - f_i)² / (2 n V)         total: with all its interactions with others (Jansen 1999)

Each is a ratio of two means, R = ⟨m⟩/⟨v⟩, with the standard error s: that of the mean of (m - R v)/⟨v⟩. Products of
measures have long tails, so that s of few samples is usually too small: 1.96 s contains the true value in 75 of 100
samples. The distribution of the error of R in units of its own s is found by resampling units of the sample (the
symmetric bootstrap-t of Hall 1988); R* and s* are the ratio and the standard error of a resample:

    |R* - R| / s*  ≤ q   in a share p of resamples     interval: R ± q s, q not below that of Student's t

with p somewhat above 95 % where n is small. Units are samples (of many of them batches) where these are drawn
independently; for a space-filling plan they are the repetitions of the plan, which alone are independent of each other.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

CONFIDENCE = 0.95  # probability that an interval contains the true value
TAIL = 0.5 * (1.0 - CONFIDENCE)  # probability that it lies below the interval; and above
NORMAL = 1.959963984540054  # z: deviations of a normal law within which 95 % of it lie
PERCENTS = (1.0, 5.0, 50.0, 95.0, 99.0)
MIN_COUNT = 2  # fewest numbers that have a deviation
MIN_BOUNDED = 5  # fewest numbers whose deviation has an interval


class BoundedEstimate(NamedTuple):
    """A number estimated from a sample, and the ends of its interval; None: the sample is too small to bound it."""

    value: float
    low: float | None
    high: float | None


class SampleStatistics(NamedTuple):
    """The statistics of a measure.

    draws: number of values
    percentiles: per cent of the values that lie below each, and its estimate
    """

    draws: int
    mean: BoundedEstimate
    deviation: BoundedEstimate
    percentiles: tuple[tuple[float, BoundedEstimate], ...]


def compute_statistics(values: Array) -> SampleStatistics | None:
    """Compute the statistics of independent draws, (n,); None for fewer than two."""
    from scipy.special import stdtrit  # a fifth of a second, where there are random sweeps

    n = len(values)
    if n < MIN_COUNT:
        return None
    sorted_values = np.sort(values)
    mean, s = float(values.mean()), float(values.std(ddof=1))
    mean_error = float(stdtrit(n - 1, 1.0 - TAIL)) * s / math.sqrt(n)
    return SampleStatistics(
        n,
        BoundedEstimate(mean, mean - mean_error, mean + mean_error),
        estimate_deviation(sorted_values, s),
        tuple((percent, estimate_percentile(sorted_values, percent)) for percent in PERCENTS),
    )


def estimate_deviation(sorted_values: Array, s: float) -> BoundedEstimate:
    """Estimate the standard deviation from a sorted sample, with Bonett's interval (2006, equations 3 to 5)."""
    n = len(sorted_values)
    if s == 0.0:
        return BoundedEstimate(0.0, 0.0, 0.0)
    if n < MIN_BOUNDED:
        return BoundedEstimate(s, None, None)
    # the mean without the tails, which draw it to one side where the law is skew
    cut = int(n / (2.0 * math.sqrt(n - 4)))
    trimmed_mean = float(sorted_values[cut : n - cut].mean())
    kurtosis = n * float(np.sum(((sorted_values - trimmed_mean) / s) ** 4)) / (n - 1) ** 2
    c = n / (n - NORMAL)
    log_error = 0.5 * c * NORMAL * math.sqrt(max(kurtosis - (n - 3) / n, 0.0) / (n - 1))
    return BoundedEstimate(s, min(s, s * math.sqrt(c) * math.exp(-log_error)), s * math.sqrt(c) * math.exp(log_error))


def estimate_percentile(sorted_values: Array, percent: float) -> BoundedEstimate:
    """Estimate the value below which `percent` per cent lie, from a sorted sample, by interpolation."""
    n, share = len(sorted_values), 0.01 * percent
    low_index, high_index = _find_least_count(TAIL, n, share) - 1, _find_least_count(1.0 - TAIL, n, share)
    low = float(sorted_values[low_index]) if low_index >= 0 else None
    high = float(sorted_values[high_index]) if high_index < n else None
    return BoundedEstimate(float(np.quantile(sorted_values, share)), low, high)


def _find_least_count(probability: float, n: int, share: float) -> int:
    """Find the least k such that at most k of n draws lie below the share's quantile with at least this probability."""
    from scipy.special import bdtr

    low, high = -1, n
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if bdtr(middle, n, share) >= probability else (middle, high)
    return high


UnitIndices = npt.NDArray[np.signedinteger[Any]]  # the unit, or repetition, that each sample belongs to
MIN_INDEX_COUNT = 8  # fewest samples that give indices
MIN_INDEX_BOUNDED = 64  # fewest samples whose indices have intervals
EXTRA_CONFIDENCE = 0.03  # added to the share p at that many samples; it falls with the root of their number
MAX_UNITS = 512  # units that are resampled; more samples are put together in batches
RESAMPLE_COUNT = 999  # resamples of the units
ROUNDING = 1e-12  # standard error of an index below which it is rounding


class SobolIndices(NamedTuple):
    """The Sobol indices of a parameter: of first order, and total."""

    first: BoundedEstimate
    total: BoundedEstimate


def compute_sobol_indices(rows: Array, repetitions: UnitIndices | None = None) -> tuple[SobolIndices, ...] | None:
    """Compute the indices of each parameter.

    rows (n, d + 2): f_A, f_B and the d exchanged ones of each sample
    repetitions (n,): which repetition of its plan a sample belongs to, None where samples are independent

    Returns None where there are few samples, or the measure does not vary.
    """
    n = len(rows)
    if n < MIN_INDEX_COUNT:
        return None
    centred = rows - rows[:, :2].mean()
    A, B, exchanged = centred[:, 0], centred[:, 1], centred[:, 2:].T
    v = 0.5 * (A**2 + B**2)
    if not float(v.mean()) > 0.0:
        return None
    if repetitions is None:
        units = np.arange(n) * min(n, MAX_UNITS) // n
    else:
        units = np.unique(repetitions, return_inverse=True)[1]
    weights = _draw_weights(int(units.max()) + 1) if n >= MIN_INDEX_BOUNDED else None
    return tuple(
        SobolIndices(
            _estimate_ratio(B * (f - A), v, units, weights), _estimate_ratio(0.5 * (A - f) ** 2, v, units, weights)
        )
        for f in exchanged
    )


def _draw_weights(count: int) -> Array:
    """Draw how often each of `count` units is drawn, (RESAMPLE_COUNT, count): the same numbers for the same count."""
    generator = np.random.Generator(np.random.PCG64(count))
    weights: Array = generator.multinomial(count, np.full(count, 1.0 / count), size=RESAMPLE_COUNT).astype(np.float64)
    return weights


def _estimate_ratio(m: Array, v: Array, units: UnitIndices, weights: Array | None) -> BoundedEstimate:
    """Estimate the ratio of the means of m and v (n,), with its interval.

    units (n,): the unit of each sample
    weights (RESAMPLE_COUNT, units): how often each unit is drawn; None: without an interval
    """
    R = float(m.mean()) / float(v.mean())
    if weights is None:
        return BoundedEstimate(R, None, None)
    unit_m, unit_v = (np.bincount(units, x).astype(np.float64) for x in (m, v))
    unit_count = len(unit_m)
    residuals = unit_m - R * unit_v
    s = float(np.sqrt((residuals @ residuals) / (unit_count * (unit_count - 1)))) / float(unit_v.mean())
    if not s > ROUNDING:
        return BoundedEstimate(R, R, R)
    deviations = _resample_deviations(unit_m, unit_v, weights, R)
    q = max(_find_quantile(deviations, len(m)), _find_student_quantile(unit_count, len(m)))
    return BoundedEstimate(R, R - q * s, R + q * s)


def _resample_deviations(unit_m: Array, unit_v: Array, weights: Array, R: float) -> Array:
    """Return |R* - R| / s* of each resample, without those that are not determined.

    unit_m, unit_v (units,): sums of m and v over each unit
    """
    count = len(unit_m)
    products = np.stack([unit_m, unit_v, unit_m * unit_m, unit_m * unit_v, unit_v * unit_v], axis=1)
    mean_m, mean_v, mean_mm, mean_mv, mean_vv = (weights @ products / count).T
    ratio = mean_m / mean_v
    squares = np.maximum(mean_mm - 2.0 * ratio * mean_mv + ratio * ratio * mean_vv, 0.0) / (count - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviations = np.abs(ratio - R) / (np.sqrt(squares) / mean_v)
    return np.asarray(deviations[~np.isnan(deviations)])


def _compute_share(n: int) -> float:
    """Return the share p of resamples that lie within an interval, for n samples."""
    return CONFIDENCE + EXTRA_CONFIDENCE * math.sqrt(MIN_INDEX_BOUNDED / n)


def _find_quantile(deviations: Array, n: int) -> float:
    """Return q, below which the share p of the deviations lies, for n samples; 0 if there are none."""
    return float(np.quantile(deviations, _compute_share(n), method="inverted_cdf")) if len(deviations) else 0.0


def _find_student_quantile(unit_count: int, n: int) -> float:
    """Return the quantile of Student's t for the share p, for n samples in units."""
    from scipy.special import stdtrit  # where there are random sweeps

    return float(stdtrit(unit_count - 1, 0.5 + 0.5 * _compute_share(n)))
