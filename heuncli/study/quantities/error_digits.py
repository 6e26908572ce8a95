"""A number at the digits that its own error leaves, for what is looked for and not listed: more than a table's six."""

from __future__ import annotations

import math

MOST = 10  # digits
LARGE, SMALL = 1e10, 1e-4  # beyond these with an exponent


def with_digits(value: float, error: float) -> str:
    """The number, its last digit that of the error's first; without an error as many of MOST digits as it has."""
    if not math.isfinite(value):
        return "unbounded"
    if value == 0.0:
        return "0"
    if error <= 0.0:
        return f"{value:.{MOST}g}"
    lead = math.floor(math.log10(abs(value)))
    last = min(max(math.floor(math.log10(error)), lead - MOST + 1), lead)
    if not SMALL <= abs(value) < LARGE or last > 0:
        return f"{value:.{lead - last}e}"
    return f"{value:.{-last}f}"
