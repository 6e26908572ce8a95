"""Estimate statistics from a random sample: each with the error that follows from the small number of draws.

    mean        x̄ ± t s/√n                                  t: of n - 1 degrees of freedom, 97.5 %
    deviation   s √c e^(± c z √((γ - (n - 3)/n)/(n - 1))/2) c = n/(n - z), γ: the sample's own kurtosis (Bonett 2006)
    percentile  between two values of the sample            by how many of n lie below it, which is binomial in any law

An interval contains the true value in 95 of 100 such samples, if the draws are independent of each other. Those of a
mean and of a deviation do so somewhat less often where few are drawn from a skew law (91 of 100 samples of 100
exponential numbers have their deviation within). A Latin hypercube or a Sobol sequence is more even than independent
draws: its mean is more accurate than its interval says.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

CONFIDENCE = 0.95  # of intervals
TAIL = 0.5 * (1.0 - CONFIDENCE)
NORMAL = 1.959963984540054  # z: deviations of a normal law within which 95 % of it lie
PERCENTS = (1.0, 5.0, 50.0, 95.0, 99.0)
MIN_COUNT = 2  # of numbers that have a deviation
MIN_BOUNDED = 5  # of numbers whose deviation has an interval


class BoundedEstimate(NamedTuple):
    """A number estimated from a sample, and the ends of its interval; None: the sample is too small to bound it."""

    value: float
    low: float | None
    high: float | None


class SampleStatistics(NamedTuple):
    """The statistics of a measure; percentiles: by their per cent."""

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
    cut = int(n / (2.0 * math.sqrt(n - 4)))
    # the mean without its tails, which draw it to the side of a skew law
    middle = float(sorted_values[cut : n - cut].mean())
    kurtosis = n * float(np.sum(((sorted_values - middle) / s) ** 4)) / (n - 1) ** 2
    c = n / (n - NORMAL)
    log_error = 0.5 * c * NORMAL * math.sqrt(max(kurtosis - (n - 3) / n, 0.0) / (n - 1))
    return BoundedEstimate(s, min(s, s * math.sqrt(c) * math.exp(-log_error)), s * math.sqrt(c) * math.exp(log_error))


def estimate_percentile(sorted_values: Array, percent: float) -> BoundedEstimate:
    """Estimate the value below which `percent` per cent lie, from a sorted sample; interpolated between two values
    where it falls so.
    """
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
