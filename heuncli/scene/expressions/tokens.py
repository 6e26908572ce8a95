"""Split an expression into tokens: numbers, names and marks."""

from __future__ import annotations

import re
from functools import lru_cache

TOKEN = re.compile(
    r"\s*+(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<mark>\*\*|[<>=!]=|//|&&|\|\||\S))"
)
MAX_CACHED_TEXTS = 1024  # size of the cache: variants of a spec parse the same texts again
END_PADDING = ("",) * 4  # the parser looks ahead this far


@lru_cache(maxsize=MAX_CACHED_TEXTS)
def tokenize(text: str) -> tuple[tuple[tuple[str, str, int], ...], tuple[str, ...], tuple[str, ...]]:
    """Split a text into tokens: kind, word and end of each; then kinds and words alone, padded after the last."""
    found = tuple((one.lastgroup or "", one[one.lastgroup or 0], one.end()) for one in TOKEN.finditer(text))
    return found, tuple(kind for kind, _, _ in found) + END_PADDING, tuple(word for _, word, _ in found) + END_PADDING
