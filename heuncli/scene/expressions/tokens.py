"""The words of an expression: numbers, names and marks."""

from __future__ import annotations

import re
from functools import lru_cache

TOKEN = re.compile(
    r"\s*+(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<mark>\*\*|[<>=!]=|//|&&|\|\||\S))"
)
MOST_TEXTS = 1024  # whose tokens are kept: variants of a spec read the same ones again
BEHIND = ("",) * 4  # as far as it is looked ahead


@lru_cache(maxsize=MOST_TEXTS)
def tokens_of(text: str) -> tuple[tuple[tuple[str, str, int], ...], tuple[str, ...], tuple[str, ...]]:
    """The tokens of a text: kind, word and end of each; then kinds and words alone, empty ones after the last."""
    found = tuple((one.lastgroup or "", one[one.lastgroup or 0], one.end()) for one in TOKEN.finditer(text))
    return found, tuple(kind for kind, _, _ in found) + BEHIND, tuple(word for _, word, _ in found) + BEHIND
