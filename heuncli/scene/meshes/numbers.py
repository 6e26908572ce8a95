"""Numbers out of the words of a file, and how a file that cannot be read is refused."""

from __future__ import annotations

import warnings
from array import array
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.model import Numbers

N = TypeVar("N", np.float64, np.int64)
SPACE, LINE = 0x20, 0x0A  # what is not more stands between words
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


def at_once(text: bytes, kind: type[N]) -> NDArray[N] | None:
    """The numbers that a text consists of, (n,); None where another word stands in it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, kind, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def begins_of_words(text: NDArray[np.uint8]) -> Mask:
    """At which bytes of a text a word begins."""
    begins = text > SPACE
    begins[1:] &= ~begins[:-1]
    return begins


def table(lines: Sequence[bytes], kind: type[N]) -> NDArray[N] | None:
    """The numbers of lines that have equally many, (n, k); None where they have not, or where a word is no number."""
    joined = b"\n".join(lines)
    if not joined:
        return None
    text = np.frombuffer(joined, np.uint8)
    so_far = np.cumsum(begins_of_words(text), dtype=np.int32)[np.append(np.flatnonzero(text == LINE), -1)]
    found = at_once(joined, kind)
    if found is None or len(so_far) != len(lines) or (np.diff(so_far) != so_far[0]).any():
        return None
    return found.reshape(len(lines), -1) if len(found) == so_far[-1] else None


def _first_without(kind: type[float], words: Sequence[bytes]) -> int:
    for i, word in enumerate(words):
        try:
            kind(word)
        except ValueError:
            return i
    return 0
