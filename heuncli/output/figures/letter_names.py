"""Short names where there is no room for long ones: A to Z, then AA, AB and so on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, product


def iter_letters(first: str) -> Iterator[str]:
    """Yield names without end from the first letter of the alphabet on, capital or small."""
    alphabet = [chr(ord(first) + k) for k in range(26)]
    for length in count(1):
        yield from ("".join(word) for word in product(alphabet, repeat=length))
