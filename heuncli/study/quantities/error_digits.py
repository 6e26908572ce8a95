"""Format a single number with all digits that its own error leaves: more than the six of a table."""

from __future__ import annotations

import math

MAX_DIGITS = 10  # digits
LARGE, SMALL = 1e10, 1e-4  # beyond these with an exponent


def format_with_error(value: float, error: float) -> str:
    """Format a number so that its last digit is that of the error's first; without an error with up to MAX_DIGITS
    digits.
    """
    if not math.isfinite(value):
        return "unbounded"
    if value == 0.0:
        return "0"
    if error <= 0.0:
        return f"{value:.{MAX_DIGITS}g}"
    lead = math.floor(math.log10(abs(value)))
    last = min(max(math.floor(math.log10(error)), lead - MAX_DIGITS + 1), lead)
    if not SMALL <= abs(value) < LARGE or last > 0:
        return f"{value:.{lead - last}e}"
    return f"{value:.{-last}f}"
