"""Which variants have the least and the greatest value of a measure, and which cannot be told from these."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array


class BestAndWorst(NamedTuple):
    """The places of the least and the greatest value, and which may be it as well by their errors, (n,) of bool."""

    least: int
    greatest: int
    least_too: Array
    greatest_too: Array

    @property
    def flat(self) -> bool:
        """Whether any could be either: the measure does not vary, as far as is known."""
        return bool(self.least_too[self.greatest])


def extremes(values: Array, errors: Array) -> BestAndWorst | None:
    """Of a measure, (n,) each, nan where it is not known; None where it is known of less than two variants."""
    if np.count_nonzero(np.isfinite(values)) < 2:
        return None
    least, greatest = int(np.nanargmin(values)), int(np.nanargmax(values))
    with np.errstate(invalid="ignore"):
        low = values - errors <= values[least] + errors[least]
        high = values + errors >= values[greatest] - errors[greatest]
    return BestAndWorst(least, greatest, low, high)
