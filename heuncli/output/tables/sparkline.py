"""Draw numbers as a row of characters from low to high: ▁▂▃▄▅▆▇█, or plain ASCII where these cannot be shown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.results.results import Array

BLOCK_CHARACTERS = "▁▂▃▄▅▆▇█"
ASCII_CHARACTERS = "_.-:=+*#"
UNKNOWN_CHARACTERS = {BLOCK_CHARACTERS: "·", ASCII_CHARACTERS: " "}  # for unknown numbers


def choose_characters(encoding: str | None) -> str:
    """Return the characters that a terminal of this encoding shows; None stands for UTF-8."""
    try:
        BLOCK_CHARACTERS.encode(encoding or "utf-8")
    except (UnicodeError, LookupError):
        return ASCII_CHARACTERS
    return BLOCK_CHARACTERS


def draw_sparkline(
    values: Sequence[float] | Array, width: int, limits: tuple[float, float], characters: str = BLOCK_CHARACTERS
) -> str:
    """Draw a character for each number between the limits; of more than `width` numbers, neighbours are joined to their
    maximum.

    An unknown number (nan) becomes a dot. If both limits are equal, all characters are low.
    """
    shown_values = reduce_to_width(np.asarray(values, dtype=np.float64), width)
    low, high = limits
    heights = (shown_values - low) / (high - low) if high > low else np.where(np.isnan(shown_values), np.nan, 0.0)
    return "".join(
        UNKNOWN_CHARACTERS[characters] if np.isnan(height) else _choose_character(height, characters)
        for height in heights.tolist()
    )


def _choose_character(height: float, characters: str) -> str:
    """Return the character of a height from 0 to 1."""
    return characters[min(max(int(height * len(characters)), 0), len(characters) - 1)]


def reduce_to_width(values: Array, width: int) -> Array:
    """Reduce the numbers to at most `width`: the maximum of neighbours, nan if none of them is known."""
    if len(values) <= width:
        return values
    starts = np.arange(width) * len(values) // width
    lowest = np.where(np.isnan(values), -np.inf, values)
    greatest: Array = np.maximum.reduceat(lowest, starts)
    return np.where(np.isneginf(greatest), np.nan, greatest)


def draw_histogram(values: Array, limits: tuple[float, float], bins: int, characters: str = BLOCK_CHARACTERS) -> str:
    """Draw how many of the numbers lie in each of the bins between the limits."""
    known = values[np.isfinite(values)]
    low, high = limits
    if not known.size or not high > low:
        return characters[-1] * min(known.size, 1)
    counts, _ = np.histogram(known, bins, (low, high))
    return "".join(
        " " if count == 0 else _choose_character(count / counts.max(), characters) for count in counts.tolist()
    )
