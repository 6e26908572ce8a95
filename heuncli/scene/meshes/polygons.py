"""Faces of three and more corners as triangles from the first corner."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.scene.meshes.model import Numbers
from heuncli.scene.meshes.numbers import refused, whole_numbers

MOST_CORNERS = 10_000  # of one face


def fans(rows: Sequence[Sequence[bytes]]) -> Numbers:
    """Triangles (m, 3) of faces given by the words of their corners. Raises Finding."""
    counts = np.fromiter(map(len, rows), np.intp, len(rows))
    require_faces(counts)
    found = []
    for count in np.unique(counts).tolist():
        own = rows if (counts == count).all() else [rows[i] for i in np.flatnonzero(counts == count).tolist()]
        flat = whole_numbers([word for row in own for word in row], "face")
        found.append(triangles_of(flat.reshape(-1, count)))
    return np.concatenate(found)


def require_faces(counts: Numbers) -> None:
    """Raise Finding where a face has fewer corners than three, or more than are read."""
    few = (counts < 3) | (counts > MOST_CORNERS)
    if few.any():
        k = int(few.argmax())
        raise refused(f"face {k + 1} has {int(counts[k])} corners", "a face has three corners, or some more")


def triangles_of(faces: Numbers) -> Numbers:
    """Triangles (m (c - 2), 3) of m faces of c corners, (m, c)."""
    m, c = faces.shape
    fan = np.stack([np.broadcast_to(faces[:, :1], (m, c - 2)), faces[:, 1:-1], faces[:, 2:]], axis=-1)
    return np.asarray(fan.reshape(-1, 3))
