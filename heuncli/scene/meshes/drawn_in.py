"""A surface whose faces are moved inward by a hair: what touched stands apart, what crosses crosses still.

A corner moves against the mean of the normals around it, weighted by the angles there (Thuermer, Wuethrich, 1998): so
the mean is of the surface, not of how it is divided. It moves so far that each face there moves by the hair.
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.model import Numbers, components, numbered

BLUNT = 0.25  # the least cosine between a corner's direction and the normals there: a sharper one moves less
NEXT, LAST = (1, 2, 0), (2, 0, 1)


def drawn_in(corners: Array, triangles: Numbers, normals: Array, known: Mask, hair: float) -> Array:
    """The corners (n, 3) of the surface within; normals (m, 3) count where they are known (m,)."""
    places = corners[triangles]
    weighted = np.zeros_like(corners)
    for i in range(3):
        one, other = places[:, NEXT[i]] - places[:, i], places[:, LAST[i]] - places[:, i]
        sine = np.sqrt((np.cross(one, other) ** 2).sum(axis=1))
        angle = np.where(known, np.arctan2(sine, (one * other).sum(axis=1)), 0.0)
        for axis in range(3):
            weighted[:, axis] += np.bincount(triangles[:, i], angle * normals[:, axis], len(corners))
    length = np.sqrt((weighted * weighted).sum(axis=1))
    weighted /= np.where(length > 0.0, length, 1.0)[:, None]
    cosine = np.ones(len(corners))
    for i in range(3):
        own = triangles[known, i]
        np.minimum.at(cosine, own, (weighted[own] * normals[known]).sum(axis=1))
    step = np.where(cosine > 0.0, hair / np.maximum(cosine, BLUNT), 0.0)
    return np.asarray(corners - step[:, None] * weighted)


def parted(corners: Array, triangles: Numbers, beside: tuple[Numbers, Numbers]) -> tuple[Array, Numbers]:
    """The same surface, where triangles around one place form several fans each of them with a corner of its own.

    beside: the two triangles of each edge, as `neighbours` has them.
    """
    m = len(triangles)
    places = np.arange(3 * m).reshape(m, 3)
    a, b = (np.asarray(each) for each in beside)
    links: list[tuple[Numbers, Numbers]] = []
    for i in range(3):
        for j in range(3):
            same = triangles[a, i] == triangles[b, j]
            links.append((places[a[same], i], places[b[same], j]))
    one, other = (np.concatenate([link[k] for link in links]) for k in (0, 1))
    fans, number = numbered(components(3 * m, one, other))
    if len(fans) == len(corners):
        return corners, triangles
    return corners[triangles.ravel()[fans]], number.reshape(m, 3)
