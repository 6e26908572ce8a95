"""The damage-equivalent range: equal cycles that do as much damage as those counted.

    D ∝ Σ n R^m        Palmgren (1924), Miner (1945): damages add up; a Wöhler line of slope m:  N R^m = constant
    R_eq = (Σ n R^m / N)^(1/m)        N: the cycle number that the range belongs to
Mean stress, endurance limits and the order of the cycles are not considered.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array


class EquivalentRange(NamedTuple):
    """The equivalent range of a cycle number and a slope, with its error."""

    slope: float
    cycles: float
    range: float
    error: float


def equivalent_range(ranges: Array, counts: Array, slope: float, cycles: float) -> float:
    """R_eq of ranges (n,) with their counts; 0 where there are none."""
    largest = float(ranges.max(initial=0.0))
    if largest == 0.0:
        return 0.0
    total = float(np.sum(counts * (ranges / largest) ** slope))
    return float(largest * (total / cycles) ** (1.0 / slope))


def damage_shares(ranges: Array, counts: Array, slope: float) -> Array:
    """The share of each cycle in the total damage, (n,)."""
    largest = float(ranges.max(initial=0.0))
    damages = counts * (ranges / largest) ** slope if largest > 0.0 else np.zeros(len(ranges))
    return np.asarray(damages / (damages.sum() or 1.0))
