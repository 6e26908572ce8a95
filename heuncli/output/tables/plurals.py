"""Format counts with their nouns. Imports nothing, so that `heun validate` does not need NumPy."""

from __future__ import annotations


def format_count(number: int, noun: str) -> str:
    """Format a number of things: `1 body`, `2 bodies`, `no loops`, `0 degrees of freedom`."""
    if noun == "degree of freedom":
        return f"{number} {noun if number == 1 else 'degrees of freedom'}"
    plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
    return f"{number or 'no'} {noun if number == 1 else plural}"
