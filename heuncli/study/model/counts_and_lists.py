"""Format counts of things and lists of names for the sentences about the model."""

from __future__ import annotations

from collections.abc import Sequence

MAX_NAMES = 5  # listed in a sentence


def format_count(n: int, one: str, many: str | None = None) -> str:
    """Format a number of things; many: the plural, if it is not the singular with an s."""
    return f"{n:,} {one if n == 1 else many or one + 's'}"


def list_some(names: Sequence[str]) -> str:
    """List the first names, and how many more there are."""
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")
