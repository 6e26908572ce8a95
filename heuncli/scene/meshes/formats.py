"""Read the formats STL and OBJ; the numbers, faces and errors that all formats share.

OBJ has corners `v x y z` and faces `f 1 2 3` with corner numbers from 1, or -1 for the last one; the rest is ignored. A
face with more corners is divided into triangles from its first corner, as drawing programs do.

STL has triangles without topology; binary, each corner three float32, or as text:

    80 bytes, count (uint32), count times: normal, three corners (12 float32), 2 bytes         little-endian
    solid NAME  facet normal x y z  outer loop  vertex x y z (three times)  endloop  endfacet ...  endsolid NAME
A text begins with `solid`, but so do some binary files, so a file with the length of a binary file is read as one.
Normals are not read: the order of the corners determines the outside.
"""

from __future__ import annotations

import re
import warnings
from array import array
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.model import IndexArray, TriangleSoup

# Numbers

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


# Polygons

MAX_CORNERS = 10_000  # largest number of corners of a face


def triangulate_words(rows: Sequence[Sequence[bytes]]) -> IndexArray:
    """Divide faces given by the words of their corners into triangles (m, 3). Raises Finding."""
    counts = np.fromiter(map(len, rows), np.intp, len(rows))
    require_faces(counts)
    triangles = []
    for count in np.unique(counts).tolist():
        same_count = rows if (counts == count).all() else [rows[i] for i in np.flatnonzero(counts == count).tolist()]
        flat = parse_integers([word for row in same_count for word in row], "face")
        triangles.append(triangulate(flat.reshape(-1, count)))
    return np.concatenate(triangles)


def require_faces(counts: IndexArray) -> None:
    """Raise Finding for a face with fewer than three corners, or with more than are read."""
    is_wrong = (counts < 3) | (counts > MAX_CORNERS)
    if is_wrong.any():
        k = int(is_wrong.argmax())
        raise mesh_file_finding(
            f"face {k + 1} has {int(counts[k])} vertices", f"a face must have 3 to {MAX_CORNERS} vertices"
        )


def triangulate(faces: IndexArray) -> IndexArray:
    """Divide m faces of c corners, (m, c), into triangles (m (c - 2), 3)."""
    m, c = faces.shape
    fan = np.stack([np.broadcast_to(faces[:, :1], (m, c - 2)), faces[:, 1:-1], faces[:, 2:]], axis=-1)
    return np.asarray(fan.reshape(-1, 3))


# Obj

TEXTURE_AND_NORMAL = re.compile(rb"/[^\s]*")  # numbers of texture and normal
LINE_CONTINUATION = re.compile(rb"\\[ \t]*\r?\n")


def read_obj(content: bytes) -> TriangleSoup:
    """Read the triangles of an OBJ file. Raises Finding."""
    if b"\\" in content:
        content = LINE_CONTINUATION.sub(b" ", content)
    lines = content.splitlines()
    kinds = [line[:2] for line in lines]
    if any(kind[:1].isspace() for kind in set(kinds)):
        lines = [line.lstrip() for line in lines]
        kinds = [line[:2] for line in lines]
    corner_kinds, face_kinds = ({kind for kind in set(kinds) if kind.rstrip() == name} for name in (b"v", b"f"))
    corners = _parse_corners([line[1:] for line, kind in zip(lines, kinds, strict=True) if kind in corner_kinds])
    faces = [line[1:] for line, kind in zip(lines, kinds, strict=True) if kind in face_kinds]
    if not faces:
        raise mesh_file_finding("the file has no faces", "give the surface of a solid as triangles: f 1 2 3")
    if b"/" in content:
        faces = TEXTURE_AND_NORMAL.sub(b"", b"\n".join(faces)).split(b"\n")
    corners_so_far = None
    if b"-" in b"".join(faces):  # negative numbers count back from the corners so far
        corner_counts = np.cumsum([kind in corner_kinds for kind in kinds])
        corners_so_far = corner_counts[[i for i, kind in enumerate(kinds) if kind in face_kinds]]
    triangles = _parse_triangles(faces, corners_so_far)
    if (triangles < 1).any() or (triangles > len(corners)).any():
        raise mesh_file_finding(f"a face uses a vertex outside 1 to {len(corners)}", "vertices are numbered from 1")
    return TriangleSoup(corners, triangles - 1)


def _parse_triangles(faces: list[bytes], corners_so_far: IndexArray | None) -> IndexArray:
    """Parse faces into triangles (m, 3) of corner numbers from 1; corners_so_far: the number of corners before each
    face.
    """
    rows = parse_rows(faces, np.int64)
    if rows is not None and 3 <= rows.shape[1] <= MAX_CORNERS:
        numbers = rows.astype(np.intp)
        return triangulate(
            numbers if corners_so_far is None else np.where(numbers < 0, numbers + corners_so_far[:, None] + 1, numbers)
        )
    words = [face.split() for face in faces]
    if corners_so_far is None:
        return triangulate_words(words)
    return triangulate_words(
        [[_resolve_corner_number(word, int(n)) for word in row] for row, n in zip(words, corners_so_far, strict=True)]
    )


def _resolve_corner_number(word: bytes, corners_before: int) -> bytes:
    """Convert a corner number that may count back from the last corner to one that counts from 1."""
    (number,) = parse_integers([word], "face").tolist()
    return b"%d" % (corners_before + 1 + number if number < 0 else number)


def _parse_corners(lines: list[bytes]) -> Array:
    """Parse the coordinates (n, 3); a fourth number, or a colour, may follow them."""
    rows_at_once = parse_rows(lines, np.float64)
    if rows_at_once is not None and rows_at_once.shape[1] >= 3:
        return np.ascontiguousarray(rows_at_once[:, :3])
    rows = [line.split(None, 3)[:3] for line in lines]
    short = next((i for i, row in enumerate(rows) if len(row) < 3), None)
    if short is not None:
        raise mesh_file_finding(f"vertex {short + 1} does not have three coordinates", SAVE_AGAIN_HINT)
    return np.stack([parse_floats([row[k] for row in rows], "vertex") for k in range(3)], axis=-1)


# Stl

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
