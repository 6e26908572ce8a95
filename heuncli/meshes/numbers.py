"""Numbers out of the words of a file, and how a file that cannot be read is refused."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

import numpy as np

from heuncli.errors import Finding
from heuncli.meshes.model import Numbers
from heuncli.results import Array

SAVE_AGAIN = "save it again, as binary STL, OBJ or PLY"


def refused(message: str, hint: str) -> Finding:
    """That a file is no mesh that can be read."""
    return Finding("mesh-file", message, hint)


def floats(words: Sequence[bytes], what: str) -> Array:
    """The numbers that words are, (n,). Raises Finding with the number of the `what` that has none."""
    try:
        return np.frombuffer(array("d", map(float, words)))
    except ValueError:
        raise refused(f"{what} {1 + _first_without(float, words)}: a coordinate is no number", SAVE_AGAIN) from None


def whole_numbers(words: Sequence[bytes], what: str) -> Numbers:
    """The whole numbers that words are, (n,). Raises Finding."""
    try:
        return np.frombuffer(array("q", map(int, words)), np.int64)
    except (ValueError, OverflowError):
        raise refused(f"{what}: the number of a corner is none", SAVE_AGAIN) from None


def _first_without(kind: type[float], words: Sequence[bytes]) -> int:
    for i, word in enumerate(words):
        try:
            kind(word)
        except ValueError:
            return i
    return 0
