"""OBJ: corners `v x y z`, faces `f 1 2 3` of their numbers from 1, or from the last one back, -1; all else is not read.

A face of more corners is taken as the triangles from its first one, as programs do that draw it.
"""

from __future__ import annotations

import re

import numpy as np

from heuncli.meshes.model import Soup
from heuncli.meshes.numbers import SAVE_AGAIN, floats, refused, whole_numbers
from heuncli.meshes.polygons import fans
from heuncli.results import Array

BESIDE = re.compile(rb"/[^\s]*")  # numbers of texture and normal
GOES_ON = re.compile(rb"\\[ \t]*\r?\n")


def read_obj(content: bytes) -> Soup:
    """The triangles of an OBJ file. Raises Finding."""
    if b"\\" in content:
        content = GOES_ON.sub(b" ", content)
    lines = content.splitlines()
    kinds = [line.lstrip()[:2].rstrip() for line in lines]
    corners = _corners([line for line, kind in zip(lines, kinds, strict=True) if kind == b"v"])
    faces = [line for line, kind in zip(lines, kinds, strict=True) if kind == b"f"]
    rows = [row.split()[1:] for row in BESIDE.sub(b"", b"\n".join(faces)).split(b"\n")] if faces else []
    if not rows:
        raise refused("there are no faces in it", "a solid's surface, in triangles: f 1 2 3")
    triangles = fans(rows)
    if (triangles < 0).any():  # counted back from the corners so far
        before = np.cumsum([kind == b"v" for kind in kinds])
        so_far = before[[i for i, kind in enumerate(kinds) if kind == b"f"]]
        triangles = fans([[_counted(word, int(n)) for word in row] for row, n in zip(rows, so_far, strict=True)])
    if (triangles < 1).any() or (triangles > len(corners)).any():
        raise refused(f"a face has a corner that is none of the {len(corners)}", "corners are counted from 1")
    return Soup(corners, triangles - 1)


def _counted(word: bytes, before: int) -> bytes:
    """The number of a corner from 1."""
    (number,) = whole_numbers([word], "face").tolist()
    return b"%d" % (before + 1 + number if number < 0 else number)


def _corners(lines: list[bytes]) -> Array:
    """The coordinates (n, 3); a fourth number, or a colour, stands behind them."""
    rows = [line.split(None, 4)[1:4] for line in lines]
    short = next((i for i, row in enumerate(rows) if len(row) < 3), None)
    if short is not None:
        raise refused(f"corner {short + 1} has not three coordinates", SAVE_AGAIN)
    return np.stack([floats([row[k] for row in rows], "corner") for k in range(3)], axis=-1)
