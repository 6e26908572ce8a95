"""Find the variants with the least and the greatest value of a measure, and those that their errors do not separate
from these.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array


class MeasureExtremes(NamedTuple):
    """The extremes of a measure.

    least, greatest: indices of the variants
    may_be_least, may_be_greatest: (n,) bool, which variants may be it as well by their errors
    """

    least: int
    greatest: int
    may_be_least: Array
    may_be_greatest: Array

    @property
    def is_constant(self) -> bool:
        """Whether any variant could be either: the measure does not vary, as far as is known."""
        return bool(self.may_be_least[self.greatest])


def find_extremes(values: Array, errors: Array) -> MeasureExtremes | None:
    """Find the extremes of a measure, (n,) values and errors, nan if unknown; None if fewer than two values are
    known.
    """
    if np.count_nonzero(np.isfinite(values)) < 2:
        return None
    least, greatest = int(np.nanargmin(values)), int(np.nanargmax(values))
    with np.errstate(invalid="ignore"):
        low = values - errors <= values[least] + errors[least]
        high = values + errors >= values[greatest] - errors[greatest]
    return MeasureExtremes(least, greatest, low, high)
