"""What a random sample tells of all that could be drawn: each statistic with the error of having drawn so few.

    mean        x̄ ± t s/√n                                  t: of n - 1 degrees of freedom, 97.5 %
    deviation   s √c e^(± c z √((γ - (n - 3)/n)/(n - 1))/2) c = n/(n - z), γ: the sample's own kurtosis (Bonett 2006)
    percentile  between two values of the sample            by how many of n lie below it, which is binomial in any law

An interval holds the truth in 95 of 100 such samples, if the draws are independent of each other. Those of a mean and
of a deviation do so in somewhat less where few are drawn from a skew law (91 of 100 samples of 100 exponential numbers
have their deviation within). What a Latin hypercube or a Sobol sequence draws is more even than independent draws: its
mean is nearer than its interval says.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

SURE = 0.95  # of intervals
TAIL = 0.5 * (1.0 - SURE)
NORMAL = 1.959963984540054  # z: deviations of a normal law within which 95 % of it lie
PERCENTS = (1.0, 5.0, 50.0, 95.0, 99.0)
LEAST_COUNT = 2  # of numbers that have a deviation
LEAST_BOUNDED = 5  # of numbers whose deviation has an interval


class Estimated(NamedTuple):
    """A number that is known from a sample, and the ends of its interval; None: the sample is too small to bound it."""

    value: float
    low: float | None
    high: float | None


class Sampled(NamedTuple):
    """The statistics of a measure; percentiles: by their per cent."""

    draws: int
    mean: Estimated
    deviation: Estimated
    percentiles: tuple[tuple[float, Estimated], ...]


def sampled(values: Array) -> Sampled | None:
    """The statistics of independent draws, (n,); None of fewer than two."""
    from scipy.special import stdtrit  # a fifth of a second, where there are random sweeps

    n = len(values)
    if n < LEAST_COUNT:
        return None
    ordered = np.sort(values)
    mean, s = float(values.mean()), float(values.std(ddof=1))
    off = float(stdtrit(n - 1, 1.0 - TAIL)) * s / math.sqrt(n)
    return Sampled(
        n,
        Estimated(mean, mean - off, mean + off),
        deviation(ordered, s),
        tuple((percent, percentile(ordered, percent)) for percent in PERCENTS),
    )


def deviation(ordered: Array, s: float) -> Estimated:
    """The standard deviation of an ordered sample, with Bonett's interval (2006, equations 3 to 5)."""
    n = len(ordered)
    if s == 0.0:
        return Estimated(0.0, 0.0, 0.0)
    if n < LEAST_BOUNDED:
        return Estimated(s, None, None)
    cut = int(n / (2.0 * math.sqrt(n - 4)))
    middle = float(ordered[cut : n - cut].mean())  # the mean without its tails, which draw it to the side of a skew law
    kurtosis = n * float(np.sum(((ordered - middle) / s) ** 4)) / (n - 1) ** 2
    c = n / (n - NORMAL)
    off = 0.5 * c * NORMAL * math.sqrt(max(kurtosis - (n - 3) / n, 0.0) / (n - 1))
    return Estimated(s, min(s, s * math.sqrt(c) * math.exp(-off)), s * math.sqrt(c) * math.exp(off))


def percentile(ordered: Array, percent: float) -> Estimated:
    """The value below which so many per cent lie, between two values of the ordered sample where it falls so."""
    n, share = len(ordered), 0.01 * percent
    below, above = _least_count(TAIL, n, share) - 1, _least_count(1.0 - TAIL, n, share)
    low = float(ordered[below]) if below >= 0 else None
    high = float(ordered[above]) if above < n else None
    return Estimated(float(np.quantile(ordered, share)), low, high)


def _least_count(sure: float, n: int, share: float) -> int:
    """The least k such that no more than k of n draws lie below the share's quantile, with this probability or more."""
    from scipy.special import bdtr

    low, high = -1, n
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if bdtr(middle, n, share) >= sure else (middle, high)
    return high
