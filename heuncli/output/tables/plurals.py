"""Words around numbers. Imports nothing, so that `heun validate` does without NumPy."""

from __future__ import annotations


def count(number: int, what: str) -> str:
    """A number of things: `1 body`, `2 bodies`, `no loops`."""
    plural = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
    return f"{number or 'no'} {what if number == 1 else plural}"
