"""Read OBJ: corners `v x y z`, faces `f 1 2 3` with corner numbers from 1, or -1 for the last one; the rest is ignored.

A face with more corners is divided into triangles from its first corner, as drawing programs do.
"""

from __future__ import annotations

import re

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.meshes.model import IndexArray, TriangleSoup
from heuncli.scene.meshes.numbers import SAVE_AGAIN_HINT, mesh_file_finding, parse_floats, parse_integers, parse_rows
from heuncli.scene.meshes.polygons import MAX_CORNERS, triangulate, triangulate_words

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
