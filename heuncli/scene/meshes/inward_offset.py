"""Move the faces of a surface slightly inward: faces that touched become separate, those that cross still do.

A corner moves against the mean of the normals around it, weighted by the angles there (Thuermer, Wuethrich, 1998), so
that the mean depends on the surface and not on its triangulation. It moves so far that each face there moves by the
given distance.
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.model import IndexArray, connected_components, number_components

MIN_COSINE = 0.25  # least cosine between a corner's direction and the normals there; a sharper corner moves less
NEXT, LAST = (1, 2, 0), (2, 0, 1)


def move_faces_inward(
    corners: Array, triangles: IndexArray, normals: Array, has_normal: Mask, distance: float
) -> Array:
    """Return the corners (n, 3) of the inner surface; normals (m, 3) count only where `has_normal` (m,)."""
    places = corners[triangles]
    weighted = np.zeros_like(corners)
    for i in range(3):
        one, other = places[:, NEXT[i]] - places[:, i], places[:, LAST[i]] - places[:, i]
        sine = np.sqrt((np.cross(one, other) ** 2).sum(axis=1))
        angle = np.where(has_normal, np.arctan2(sine, (one * other).sum(axis=1)), 0.0)
        for axis in range(3):
            weighted[:, axis] += np.bincount(triangles[:, i], angle * normals[:, axis], len(corners))
    length = np.sqrt((weighted * weighted).sum(axis=1))
    weighted /= np.where(length > 0.0, length, 1.0)[:, None]
    cosine = np.ones(len(corners))
    for i in range(3):
        corner_numbers = triangles[has_normal, i]
        np.minimum.at(cosine, corner_numbers, (weighted[corner_numbers] * normals[has_normal]).sum(axis=1))
    step = np.where(cosine > 0.0, distance / np.maximum(cosine, MIN_COSINE), 0.0)
    return np.asarray(corners - step[:, None] * weighted)


def separate_fans(
    corners: Array, triangles: IndexArray, edge_neighbours: tuple[IndexArray, IndexArray]
) -> tuple[Array, IndexArray]:
    """Return the same surface, where each of several fans of triangles around one place has a corner of its own.

    edge_neighbours: the two triangles of each edge, from `find_edge_neighbours`
    """
    m = len(triangles)
    places = np.arange(3 * m).reshape(m, 3)
    a, b = (np.asarray(each) for each in edge_neighbours)
    links: list[tuple[IndexArray, IndexArray]] = []
    for i in range(3):
        for j in range(3):
            same = triangles[a, i] == triangles[b, j]
            links.append((places[a[same], i], places[b[same], j]))
    one, other = (np.concatenate([link[k] for link in links]) for k in (0, 1))
    fans, number = number_components(connected_components(3 * m, one, other))
    if len(fans) == len(corners):
        return corners, triangles
    return corners[triangles.ravel()[fans]], number.reshape(m, 3)
