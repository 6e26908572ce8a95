"""Which variants have the least and the greatest value of a measure, and which cannot be told from these."""

from __future__ import annotations

import numpy as np

from heuncli.named_tuples import NamedTuple
from heuncli.results import Array


class BestAndWorst(NamedTuple):
    """The places of the least and the greatest value, and of those that may be it as well, by their errors."""

    least: int
    greatest: int
    least_too: frozenset[int]
    greatest_too: frozenset[int]

    @property
    def flat(self) -> bool:
        """Whether any could be either: the measure does not vary, as far as is known."""
        return self.greatest in self.least_too


def extremes(values: Array, errors: Array) -> BestAndWorst | None:
    """Of a measure, (n,) each, nan where it is not known; None where it is known of less than two variants."""
    if np.count_nonzero(np.isfinite(values)) < 2:
        return None
    least, greatest = int(np.nanargmin(values)), int(np.nanargmax(values))
    with np.errstate(invalid="ignore"):
        low = np.flatnonzero(values - errors <= values[least] + errors[least])
        high = np.flatnonzero(values + errors >= values[greatest] - errors[greatest])
    return BestAndWorst(least, greatest, frozenset(low.tolist()), frozenset(high.tolist()))
