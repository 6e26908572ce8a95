"""Sobol indices: the share of a measure's variance that is due to each parameter.

    f_A, f_B   the measure at two independent samples; f_i: at A with its i-th parameter from B
    V          the variance, of f_A and f_B together
    S_i        Σ f_B (f_i - f_A) / (n V)        first order: of the parameter alone (Saltelli 2010)
    T_i        Σ (f_A - f_i)² / (2 n V)         total: with all its interactions with others (Jansen 1999)

Each is a ratio of two means, R = ⟨m⟩/⟨v⟩, with the error s of the mean of (m - R v)/⟨v⟩. Products of measures have long
tails, so that s of few samples is usually too small: 1.96 s contains the true value in 75 of 100 samples. The
distribution of the error of R in units of its own s is found by resampling units of the sample (the symmetric
bootstrap-t of Hall 1988):

    |R* - R| / s*  ≤ q   in a share p of drawings     interval: R ± q s, q not below that of Student's t

with p somewhat above 95 % where n is small. Units are samples (of many of them batches) where these are drawn
independently; for a space-filling plan they are the repetitions of the plan, which alone are independent of each other.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from heuncli.analyses.variants.sampling import CONFIDENCE, BoundedEstimate
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

Places = npt.NDArray[np.signedinteger[Any]]
MIN_COUNT = 8  # of samples for indices
MIN_BOUNDED = 64  # of samples whose indices have intervals
EXTRA_CONFIDENCE = 0.03  # added to the share p at that many samples; it falls with the root of their number
MAX_UNITS = 512
RESAMPLES = 999
ROUNDING = 1e-12  # of the variance: deviations below are rounding


class SobolIndices(NamedTuple):
    """The Sobol indices of a parameter: of first order, and total."""

    first: BoundedEstimate
    total: BoundedEstimate


def compute_sobol_indices(rows: Array, repetitions: Places | None = None) -> tuple[SobolIndices, ...] | None:
    """Compute the indices of each parameter.

    rows (n, d + 2): f_A, f_B and the d exchanged ones of each sample
    repetitions (n,): which repetition of its plan a sample belongs to, None where samples are independent

    Returns None where there are few samples, or the measure does not vary.
    """
    n = len(rows)
    if n < MIN_COUNT:
        return None
    centred = rows - rows[:, :2].mean()
    A, B, exchanged = centred[:, 0], centred[:, 1], centred[:, 2:].T
    v = 0.5 * (A**2 + B**2)
    if not float(v.mean()) > 0.0:
        return None
    units = (
        np.arange(n) * min(n, MAX_UNITS) // n if repetitions is None else np.unique(repetitions, return_inverse=True)[1]
    )
    weights = _draw_weights(int(units.max()) + 1) if n >= MIN_BOUNDED else None
    return tuple(
        SobolIndices(
            _estimate_ratio(B * (f - A), v, units, weights), _estimate_ratio(0.5 * (A - f) ** 2, v, units, weights)
        )
        for f in exchanged
    )


def _draw_weights(count: int) -> Array:
    """Draw how often each of `count` units is drawn, (DRAWINGS, count): the same numbers for the same count."""
    generator = np.random.Generator(np.random.PCG64(count))
    found: Array = generator.multinomial(count, np.full(count, 1.0 / count), size=RESAMPLES).astype(np.float64)
    return found


def _estimate_ratio(m: Array, v: Array, units: Places, weights: Array | None) -> BoundedEstimate:
    """Estimate the ratio of two means, with its interval; weights: of resampled units, None: without an interval."""
    R = float(m.mean()) / float(v.mean())
    if weights is None:
        return BoundedEstimate(R, None, None)
    M, W = np.bincount(units, m), np.bincount(units, v)
    count = len(M)
    residuals = M - R * W
    s = float(np.sqrt((residuals @ residuals) / (count * (count - 1)))) / float(W.mean())
    if not s > ROUNDING:
        return BoundedEstimate(R, R, R)
    sums = weights @ np.stack([M, W, M * M, M * W, W * W], axis=1) / count
    mean, size, MM, MW, WW = sums.T
    resampled_ratio = mean / size
    squares = np.maximum(MM - 2.0 * resampled_ratio * MW + resampled_ratio * resampled_ratio * WW, 0.0) / (count - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        deviations = np.abs(resampled_ratio - R) / (np.sqrt(squares) / size)
    q = max(_quantile(deviations[~np.isnan(deviations)], len(m)), _student_quantile(count, len(m)))
    return BoundedEstimate(R, R - q * s, R + q * s)


def _confidence(n: int) -> float:
    """The share of drawings that lie within an interval, for n samples."""
    return CONFIDENCE + EXTRA_CONFIDENCE * math.sqrt(MIN_BOUNDED / n)


def _quantile(deviations: Array, n: int) -> float:
    return float(np.quantile(deviations, _confidence(n), method="inverted_cdf")) if len(deviations) else 0.0


def _student_quantile(count: int, n: int) -> float:
    from scipy.special import stdtrit  # where there are random sweeps

    return float(stdtrit(count - 1, 0.5 + 0.5 * _confidence(n)))
