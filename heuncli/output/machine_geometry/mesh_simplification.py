"""Simplify meshes for drawing: reduce the number of triangles, and find the sharp edges that show the shape.

All corners in one cell of a grid are merged in their centre. Nothing is computed with the simplified mesh.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.closure import find_edges
from heuncli.scene.meshes.model import IndexArray, cross_product_rows

MAX_TRIANGLES = 6000  # drawn triangles of a mesh
INITIAL_CELLS = 64  # grid cells along each axis in the first attempt
# An edge is sharp if the cosine of the angle between its faces is smaller; same in output/web_page/solids.js.
EDGE_COSINE = 0.8


class SimplifiedMesh(NamedTuple):
    """The corners and triangles that are drawn.

    corner_numbers: for each corner of the original mesh, the number of its drawn corner
    cell_size: diagonal of a grid cell [m]; 0 if the mesh is not simplified
    """

    corners: Array
    triangles: IndexArray
    corner_numbers: IndexArray
    cell_size: float


def simplify_mesh(corners: Array, triangles: IndexArray, max_triangles: int = MAX_TRIANGLES) -> SimplifiedMesh:
    """Simplify a mesh to at most `max_triangles` triangles, so that it looks alike."""
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    simple_mesh = SimplifiedMesh(corners, triangles, np.arange(len(corners)), 0.0)
    cells = INITIAL_CELLS
    while len(simple_mesh.triangles) > max_triangles and cells > 1:
        cell = np.minimum((corners - low) / np.where(size > 0.0, size, 1.0) * cells, cells - 1).astype(np.int64)
        key = (cell[:, 0] * cells + cell[:, 1]) * cells + cell[:, 2]
        number = np.unique(key, return_inverse=True)[1].reshape(-1)
        centres = np.stack([np.bincount(number, x) for x in corners.T], axis=1) / np.bincount(number)[:, None]
        a, b, c = number[triangles].T
        faces = number[triangles][(a != b) & (b != c) & (c != a)]
        simple_mesh = SimplifiedMesh(centres, faces, number, float(np.sqrt((size * size).sum())) / cells)
        cells = cells * 3 // 4
    return simple_mesh


def find_sharp_edges(corners: Array, triangles: IndexArray) -> IndexArray:
    """Find the edges (k, 2) of a closed mesh, as corner numbers, whose triangles face clearly different directions."""
    p, q, r = corners[triangles.T]
    normals = cross_product_rows(q - p, r - p)
    normals = normals / np.maximum(np.sqrt((normals * normals).sum(axis=1)), np.finfo(float).tiny)[:, None]
    edges = find_edges(triangles)
    first, second = edges.order[edges.starts], edges.order[edges.starts + 1]
    cosines = (normals[first // 3] * normals[second // 3]).sum(axis=1)
    return np.asarray(edges.ends[first[cosines < EDGE_COSINE]])
