"""STL: triangles without topology; binary, each corner three float32, or as text.

    80 bytes, count (uint32), count times: normal, three corners (12 float32), 2 bytes         little-endian
    solid NAME  facet normal x y z  outer loop  vertex x y z (three times)  endloop  endfacet ...  endsolid NAME
A text begins with `solid`, but so do some binary files: what has the length of a binary file is one. Normals are not
read: the order of the corners says what is outside.
"""

from __future__ import annotations

import re

import numpy as np

from heuncli.base.errors import Finding
from heuncli.results.results import Array
from heuncli.scene.meshes.model import Soup
from heuncli.scene.meshes.numbers import SAVE_AGAIN, SPACE, at_once, begins_of_words, floats, refused

HEAD, FACET = 84, 50  # bytes
CASE = 0x20  # makes a letter a small one
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
SOLID = re.compile(rb"^[ \t]*(?:end)?solid\b[^\r\n]*", re.MULTILINE | re.IGNORECASE)
# the tokens of a facet; None: a number
FORM = (
    b"facet", b"normal", None, None, None, b"outer", b"loop", *((b"vertex", None, None, None) * 3),
    b"endloop", b"endfacet",
)  # fmt: skip


def read_stl(content: bytes) -> Soup:
    """The triangles of an STL file. Raises Finding."""
    count = int.from_bytes(content[80:HEAD], "little") if len(content) >= HEAD else -1
    if len(content) == HEAD + FACET * count:
        places = np.frombuffer(content, RECORD, count, HEAD)["corners"].astype(np.float64)
        return _soup(places)
    if content.lstrip()[:5].lower() == b"solid":
        return _soup(_as_text(content))
    if count < 0:
        raise refused("an STL file has a head of 84 bytes", SAVE_AGAIN)
    missing = HEAD + FACET * count - len(content)
    what = f"it breaks off: {missing} bytes are missing" if missing > 0 else f"{-missing} bytes more than these"
    raise refused(f"its head announces {count} triangles, but {what}", SAVE_AGAIN)


def _soup(places: Array) -> Soup:
    return Soup(places.reshape(-1, 3), np.arange(3 * len(places)).reshape(-1, 3))


def _as_text(content: bytes) -> Array:
    """The corners (m, 3, 3) of a file that is text; of several solids all."""
    begin, end = content.find(b"\n"), content.rfind(b"endsolid")
    is_last = not content[end:].partition(b"\n")[2].strip()
    body = content[begin:end] if 0 <= begin < end and is_last else b""
    if b"endsolid" in body:
        body = SOLID.sub(b" ", body)
    places = _at_once(body)
    return _of_words(SOLID.sub(b" ", content).split()) if places is None else places


def _at_once(body: bytes) -> Array | None:
    """The corners by all words at their places, and all numbers in one go; None where it is not written as is usual."""
    text = np.frombuffer(body, np.uint8).copy()
    begins = np.flatnonzero(begins_of_words(text))
    if not len(begins) or len(begins) % len(FORM):
        return None
    facets = begins.reshape(-1, len(FORM))
    for k, word in enumerate(FORM):
        if word is None:
            continue
        at = facets[:, k, None] + np.arange(len(word))
        if at[-1, -1] >= len(text) or not ((text[at] | CASE) == np.frombuffer(word, np.uint8)).all():
            return None
        text[at] = SPACE
    numbers = at_once(text.tobytes(), np.float64)
    if numbers is None or len(numbers) != 12 * len(facets):
        return None
    return np.ascontiguousarray(numbers.reshape(-1, 4, 3)[:, 1:])


def _of_words(words: list[bytes]) -> Array:
    """The same word by word, told where one is missing."""
    whole = len(words) // len(FORM)
    for k, word in enumerate(FORM):
        if word is None:
            continue
        found = words[k :: len(FORM)]
        if any(each != word and each.lower() != word for each in set(found)):
            wrong = next(i for i, each in enumerate(found) if each.lower() != word)
            raise _no_facet(wrong + 1, word)
    if len(words) % len(FORM):
        raise refused(f"it breaks off in triangle {whole + 1}", SAVE_AGAIN)
    numbers = [k for k, word in enumerate(FORM) if word is None][3:]
    return np.stack([floats(words[k :: len(FORM)], "triangle") for k in numbers], axis=-1).reshape(-1, 3, 3)


def _no_facet(number: int, word: bytes) -> Finding:
    hint = "facet normal x y z, outer loop, vertex x y z three times, endloop, endfacet; or save it as binary STL"
    return refused(f"triangle {number} is not written as in STL: '{word.decode()}' is missing", hint)
