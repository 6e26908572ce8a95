"""Meshes as they are drawn: of fine ones so many triangles as a picture shows, and the edges by which they are known.

Thinned, the corners in each cell of a grid are one, in their middle. It is nothing that is computed with.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.closure import edges_of
from heuncli.scene.meshes.model import Numbers, crossed

MOST = 6000  # triangles of a mesh that are drawn
CELLS = 64  # along each of its extents, to begin with
# Cosine of the angle between two faces below which their common side is an edge; so in output/web_page/surfaces.js.
EDGE = 0.8


class ThinnedMesh(NamedTuple):
    """Corners and triangles that are drawn; of each corner of the mesh which of them it is; the cells' size, 0: all."""

    corners: Array
    triangles: Numbers
    number: Numbers
    cell: float


def thinned(corners: Array, triangles: Numbers, most: int = MOST) -> ThinnedMesh:
    """A mesh of at most so many triangles that looks like it."""
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    drawn = ThinnedMesh(corners, triangles, np.arange(len(corners)), 0.0)
    cells = CELLS
    while len(drawn.triangles) > most and cells > 1:
        cell = np.minimum((corners - low) / np.where(size > 0.0, size, 1.0) * cells, cells - 1).astype(np.int64)
        key = (cell[:, 0] * cells + cell[:, 1]) * cells + cell[:, 2]
        number = np.unique(key, return_inverse=True)[1].reshape(-1)
        middles = np.stack([np.bincount(number, x) for x in corners.T], axis=1) / np.bincount(number)[:, None]
        a, b, c = number[triangles].T
        faces = number[triangles][(a != b) & (b != c) & (c != a)]
        drawn = ThinnedMesh(middles, faces, number, float(np.sqrt((size * size).sum())) / cells)
        cells = cells * 3 // 4
    return drawn


def sharp_edges(corners: Array, triangles: Numbers) -> Numbers:
    """The edges (k, 2), by their corners, between triangles of a closed mesh that do not look nearly the same way."""
    p, q, r = corners[triangles.T]
    normals = crossed(q - p, r - p)
    normals = normals / np.maximum(np.sqrt((normals * normals).sum(axis=1)), np.finfo(float).tiny)[:, None]
    edges = edges_of(triangles)
    one, other = edges.order[edges.starts], edges.order[edges.starts + 1]
    along = (normals[one // 3] * normals[other // 3]).sum(axis=1)
    return np.asarray(edges.ends[one[along < EDGE]])
