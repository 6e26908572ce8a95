"""Numbers of things and lists of names, as the sentences on the model have them."""

from __future__ import annotations

from collections.abc import Sequence

MOST_NAMES = 5  # that a sentence lists


def count(n: int, one: str, many: str | None = None) -> str:
    """A number of things; many: of more than one, where that is not one with an s."""
    return f"{n:,} {one if n == 1 else many or one + 's'}"


def some(names: Sequence[str]) -> str:
    """The first names, and how many more there are."""
    more = len(names) - MOST_NAMES
    return ", ".join(names[:MOST_NAMES]) + (f" and {more} more" if more > 0 else "")
