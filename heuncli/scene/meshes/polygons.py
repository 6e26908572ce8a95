"""Divide faces of three and more corners into triangles from the first corner."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.scene.meshes.model import IndexArray
from heuncli.scene.meshes.numbers import mesh_file_finding, parse_integers

MAX_CORNERS = 10_000  # of one face


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
