"""Parse numbers from the words of a mesh file, and make the error for a file that cannot be read."""

from __future__ import annotations

import warnings
from array import array
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.model import IndexArray

N = TypeVar("N", np.float64, np.int64)
SPACE_BYTE, NEWLINE_BYTE = 0x20, 0x0A  # bytes up to this one separate words
SAVE_AGAIN_HINT = "save it again, as binary STL, OBJ or PLY"


def mesh_file_finding(message: str, hint: str) -> Finding:
    """Make the Finding [mesh-file] for a file that is no readable mesh."""
    return Finding("mesh-file", message, hint)


def parse_floats(words: Sequence[bytes], what: str) -> Array:
    """Parse words as numbers, (n,). Raises Finding with the number of the first `what` that is none."""
    try:
        return np.frombuffer(array("d", map(float, words)))
    except ValueError:
        raise mesh_file_finding(
            f"{what} {1 + _find_first_invalid(float, words)}: a coordinate is not a number", SAVE_AGAIN_HINT
        ) from None


def parse_integers(words: Sequence[bytes], what: str) -> IndexArray:
    """Parse words as whole numbers, (n,). Raises Finding."""
    try:
        return np.frombuffer(array("q", map(int, words)), np.int64)
    except (ValueError, OverflowError):
        raise mesh_file_finding(f"{what}: a vertex index is not a whole number", SAVE_AGAIN_HINT) from None


def parse_all(text: bytes, kind: type[N]) -> NDArray[N] | None:
    """Parse a text of numbers, (n,), in one call; None if it contains any other word."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, kind, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def find_word_starts(text: NDArray[np.uint8]) -> Mask:
    """Return at which bytes of a text a word begins."""
    is_start = text > SPACE_BYTE
    is_start[1:] &= ~is_start[:-1]
    return is_start


def parse_rows(lines: Sequence[bytes], kind: type[N]) -> NDArray[N] | None:
    """Parse lines with equally many numbers, (n, k); None if they differ, or if a word is no number."""
    joined = b"\n".join(lines)
    if not joined:
        return None
    text = np.frombuffer(joined, np.uint8)
    words_so_far = np.cumsum(find_word_starts(text), dtype=np.int32)[
        np.append(np.flatnonzero(text == NEWLINE_BYTE), -1)
    ]
    found = parse_all(joined, kind)
    if found is None or len(words_so_far) != len(lines) or (np.diff(words_so_far) != words_so_far[0]).any():
        return None
    return found.reshape(len(lines), -1) if len(found) == words_so_far[-1] else None


def _find_first_invalid(kind: type[float], words: Sequence[bytes]) -> int:
    for i, word in enumerate(words):
        try:
            kind(word)
        except ValueError:
            return i
    return 0
