"""Numbers as a row of letters, from low to high: ▁▂▃▄▅▆▇█, and what stands for them where those cannot be shown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.results.results import Array

BLOCKS = "▁▂▃▄▅▆▇█"
PLAIN = "_.-:=+*#"
NONE = {BLOCKS: "·", PLAIN: " "}  # of what is not known


def letters(encoding: str | None) -> str:
    """The letters that a terminal of an encoding shows; None: what is read as UTF-8."""
    try:
        BLOCKS.encode(encoding or "utf-8")
    except (UnicodeError, LookupError):
        return PLAIN
    return BLOCKS


def sparkline(values: Sequence[float] | Array, width: int, limits: tuple[float, float], by: str = BLOCKS) -> str:
    """A letter a number, from the lower limit to the upper one; of more than `width` the greatest of neighbours.

    Not known (nan): a point. Where both limits are the same all are low.
    """
    known = squeezed(np.asarray(values, dtype=np.float64), width)
    low, high = limits
    heights = (known - low) / (high - low) if high > low else np.where(np.isnan(known), np.nan, 0.0)
    return "".join(NONE[by] if np.isnan(height) else _letter(height, by) for height in heights.tolist())


def _letter(height: float, by: str) -> str:
    """The letter of a height from 0 to 1."""
    return by[min(max(int(height * len(by)), 0), len(by) - 1)]


def squeezed(values: Array, width: int) -> Array:
    """At most so many numbers: of neighbours the greatest, nan where none of them is known."""
    if len(values) <= width:
        return values
    starts = np.arange(width) * len(values) // width
    lowest = np.where(np.isnan(values), -np.inf, values)
    greatest: Array = np.maximum.reduceat(lowest, starts)
    return np.where(np.isneginf(greatest), np.nan, greatest)


def histogram(values: Array, limits: tuple[float, float], bins: int, by: str = BLOCKS) -> str:
    """How many of the numbers lie in each part between the limits."""
    known = values[np.isfinite(values)]
    low, high = limits
    if not known.size or not high > low:
        return by[-1] * min(known.size, 1)
    counts, _ = np.histogram(known, bins, (low, high))
    return "".join(" " if count == 0 else _letter(count / counts.max(), by) for count in counts.tolist())
