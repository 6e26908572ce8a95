"""Sobol indices: which share of a measure's variance is due to which parameter.

    f_A, f_B   the measure at two independent samples; f_i: at A with its i-th parameter from B
    V          the variance, of f_A and f_B together
    S_i        Σ f_B (f_i - f_A) / (n V)        first order: of the parameter alone (Saltelli 2010)
    T_i        Σ (f_A - f_i)² / (2 n V)         total: of it and of all that it does together with others (Jansen 1999)

Each is a ratio of two means, R = ⟨m⟩/⟨v⟩, whose error is that of the mean of (m - R v)/⟨v⟩; the interval is 1.96 of
them to both sides and holds the truth in 95 of 100 samples of many independent draws.
"""

from __future__ import annotations

import math

from heuncli.named_tuples import NamedTuple
from heuncli.results import Array
from heuncli.variants.sampling import NORMAL, Estimated

LEAST_COUNT = 8  # of samples by which an error is estimated


class SobolIndices(NamedTuple):
    """The indices of a parameter: of first order, and in total."""

    first: Estimated
    total: Estimated


def sobol_indices(rows: Array) -> tuple[SobolIndices, ...] | None:
    """The indices of each parameter; rows (n, d + 2): f_A, f_B and the d exchanged ones of each sample.

    None where there are few samples, or the measure does not vary.
    """
    n = len(rows)
    if n < LEAST_COUNT:
        return None
    centred = rows - rows[:, :2].mean()
    A, B, exchanged = centred[:, 0], centred[:, 1], centred[:, 2:].T
    v = 0.5 * (A**2 + B**2)
    if not float(v.mean()) > 0.0:
        return None
    return tuple(SobolIndices(ratio(B * (f - A), v), ratio(0.5 * (A - f) ** 2, v)) for f in exchanged)


def ratio(m: Array, v: Array) -> Estimated:
    """The ratio of two means, with its interval."""
    mean = float(v.mean())
    R = float(m.mean()) / mean
    off = NORMAL * float((m - R * v).std(ddof=1)) / mean / math.sqrt(len(m))
    return Estimated(R, R - off, R + off)
