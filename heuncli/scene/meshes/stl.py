"""Read STL: triangles without topology; binary, each corner three float32, or as text.

    80 bytes, count (uint32), count times: normal, three corners (12 float32), 2 bytes         little-endian
    solid NAME  facet normal x y z  outer loop  vertex x y z (three times)  endloop  endfacet ...  endsolid NAME
A text begins with `solid`, but so do some binary files, so a file with the length of a binary file is read as one.
Normals are not read: the order of the corners determines the outside.
"""

from __future__ import annotations

import re

import numpy as np

from heuncli.base.errors import Finding
from heuncli.results.results import Array
from heuncli.scene.meshes.model import TriangleSoup
from heuncli.scene.meshes.numbers import (
    SAVE_AGAIN_HINT,
    SPACE_BYTE,
    find_word_starts,
    mesh_file_finding,
    parse_all,
    parse_floats,
)

HEADER_SIZE, FACET_SIZE = 84, 50  # bytes
LOWER_CASE_BIT = 0x20  # this bit makes an ASCII letter lower case
FACET_TYPE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
SOLID_LINE = re.compile(rb"^[ \t]*(?:end)?solid\b[^\r\n]*", re.MULTILINE | re.IGNORECASE)
# the tokens of a facet; None: a number
FACET_TOKENS = (
    b"facet", b"normal", None, None, None, b"outer", b"loop", *((b"vertex", None, None, None) * 3),
    b"endloop", b"endfacet",
)  # fmt: skip


def read_stl(content: bytes) -> TriangleSoup:
    """Read the triangles of an STL file. Raises Finding."""
    count = int.from_bytes(content[80:HEADER_SIZE], "little") if len(content) >= HEADER_SIZE else -1
    if len(content) == HEADER_SIZE + FACET_SIZE * count:
        places = np.frombuffer(content, FACET_TYPE, count, HEADER_SIZE)["corners"].astype(np.float64)
        return _make_soup(places)
    if content.lstrip()[:5].lower() == b"solid":
        return _make_soup(_read_text(content))
    if count < 0:
        raise mesh_file_finding("an STL file needs a header of 84 bytes", SAVE_AGAIN_HINT)
    missing = HEADER_SIZE + FACET_SIZE * count - len(content)
    what = f"{missing} bytes are missing" if missing > 0 else f"the file has {-missing} bytes more"
    raise mesh_file_finding(f"its header declares {count} triangles, but {what}", SAVE_AGAIN_HINT)


def _make_soup(places: Array) -> TriangleSoup:
    return TriangleSoup(places.reshape(-1, 3), np.arange(3 * len(places)).reshape(-1, 3))


def _read_text(content: bytes) -> Array:
    """Read the corners (m, 3, 3) of a text file; of several solids all."""
    begin, end = content.find(b"\n"), content.rfind(b"endsolid")
    is_last = not content[end:].partition(b"\n")[2].strip()
    body = content[begin:end] if 0 <= begin < end and is_last else b""
    if b"endsolid" in body:
        body = SOLID_LINE.sub(b" ", body)
    places = _parse_regular_text(body)
    return _parse_words(SOLID_LINE.sub(b" ", content).split()) if places is None else places


def _parse_regular_text(body: bytes) -> Array | None:
    """Parse a regular text by the places of its words, with all numbers in one call; None if it is not written as
    usual.
    """
    text = np.frombuffer(body, np.uint8).copy()
    word_starts = np.flatnonzero(find_word_starts(text))
    if not len(word_starts) or len(word_starts) % len(FACET_TOKENS):
        return None
    facets = word_starts.reshape(-1, len(FACET_TOKENS))
    for k, word in enumerate(FACET_TOKENS):
        if word is None:
            continue
        byte_numbers = facets[:, k, None] + np.arange(len(word))
        if (
            byte_numbers[-1, -1] >= len(text)
            or not ((text[byte_numbers] | LOWER_CASE_BIT) == np.frombuffer(word, np.uint8)).all()
        ):
            return None
        text[byte_numbers] = SPACE_BYTE
    numbers = parse_all(text.tobytes(), np.float64)
    if numbers is None or len(numbers) != 12 * len(facets):
        return None
    return np.ascontiguousarray(numbers.reshape(-1, 4, 3)[:, 1:])


def _parse_words(words: list[bytes]) -> Array:
    """Parse the corners word by word. Raises Finding where a word is missing."""
    facet_count = len(words) // len(FACET_TOKENS)
    for k, word in enumerate(FACET_TOKENS):
        if word is None:
            continue
        found = words[k :: len(FACET_TOKENS)]
        if any(each != word and each.lower() != word for each in set(found)):
            wrong_facet = next(i for i, each in enumerate(found) if each.lower() != word)
            raise _facet_finding(wrong_facet + 1, word)
    if len(words) % len(FACET_TOKENS):
        raise mesh_file_finding(f"the file is truncated in triangle {facet_count + 1}", SAVE_AGAIN_HINT)
    numbers = [k for k, word in enumerate(FACET_TOKENS) if word is None][3:]
    return np.stack([parse_floats(words[k :: len(FACET_TOKENS)], "triangle") for k in numbers], axis=-1).reshape(
        -1, 3, 3
    )


def _facet_finding(number: int, word: bytes) -> Finding:
    hint = "write facet normal x y z, outer loop, vertex x y z three times, endloop, endfacet; or save it as binary STL"
    return mesh_file_finding(f"triangle {number} is not valid STL: '{word.decode()}' is missing", hint)
