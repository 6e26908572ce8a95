"""OBJ: corners `v x y z`, faces `f 1 2 3` of their numbers from 1, or from the last one back, -1; all else is not read.

A face of more corners is taken as the triangles from its first one, as programs do that draw it.
"""

from __future__ import annotations

import re

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.meshes.model import Numbers, Soup
from heuncli.scene.meshes.numbers import SAVE_AGAIN, floats, refused, table, whole_numbers
from heuncli.scene.meshes.polygons import MOST_CORNERS, fans, triangles_of

BESIDE = re.compile(rb"/[^\s]*")  # numbers of texture and normal
GOES_ON = re.compile(rb"\\[ \t]*\r?\n")


def read_obj(content: bytes) -> Soup:
    """The triangles of an OBJ file. Raises Finding."""
    if b"\\" in content:
        content = GOES_ON.sub(b" ", content)
    lines = content.splitlines()
    kinds = [line[:2] for line in lines]
    if any(kind[:1].isspace() for kind in set(kinds)):
        lines = [line.lstrip() for line in lines]
        kinds = [line[:2] for line in lines]
    corner_kinds, face_kinds = ({kind for kind in set(kinds) if kind.rstrip() == name} for name in (b"v", b"f"))
    corners = _corners([line[1:] for line, kind in zip(lines, kinds, strict=True) if kind in corner_kinds])
    faces = [line[1:] for line, kind in zip(lines, kinds, strict=True) if kind in face_kinds]
    if not faces:
        raise refused("there are no faces in it", "a solid's surface, in triangles: f 1 2 3")
    if b"/" in content:
        faces = BESIDE.sub(b"", b"\n".join(faces)).split(b"\n")
    so_far = None
    if b"-" in b"".join(faces):  # counted back from the corners so far
        before = np.cumsum([kind in corner_kinds for kind in kinds])
        so_far = before[[i for i, kind in enumerate(kinds) if kind in face_kinds]]
    triangles = _triangles(faces, so_far)
    if (triangles < 1).any() or (triangles > len(corners)).any():
        raise refused(f"a face has a corner that is none of the {len(corners)}", "corners are counted from 1")
    return Soup(corners, triangles - 1)


def _triangles(faces: list[bytes], so_far: Numbers | None) -> Numbers:
    """Triangles (m, 3) of faces by the numbers of their corners from 1; so_far: how many corners stand before each."""
    rows = table(faces, np.int64)
    if rows is not None and 3 <= rows.shape[1] <= MOST_CORNERS:
        whole = rows.astype(np.intp)
        return triangles_of(whole if so_far is None else np.where(whole < 0, whole + so_far[:, None] + 1, whole))
    words = [face.split() for face in faces]
    if so_far is None:
        return fans(words)
    return fans([[_counted(word, int(n)) for word in row] for row, n in zip(words, so_far, strict=True)])


def _counted(word: bytes, before: int) -> bytes:
    """The number of a corner from 1."""
    (number,) = whole_numbers([word], "face").tolist()
    return b"%d" % (before + 1 + number if number < 0 else number)


def _corners(lines: list[bytes]) -> Array:
    """The coordinates (n, 3); a fourth number, or a colour, stands behind them."""
    together = table(lines, np.float64)
    if together is not None and together.shape[1] >= 3:
        return np.ascontiguousarray(together[:, :3])
    rows = [line.split(None, 3)[:3] for line in lines]
    short = next((i for i, row in enumerate(rows) if len(row) < 3), None)
    if short is not None:
        raise refused(f"corner {short + 1} has not three coordinates", SAVE_AGAIN)
    return np.stack([floats([row[k] for row in rows], "corner") for k in range(3)], axis=-1)
