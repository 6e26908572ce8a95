"""Closed surfaces of triangles, and their volume and moments by the divergence theorem.

    V = sum a.(b x c)/6     sum m x = V/4 (a + b + c)     sum m x x^T = V/20 (s s^T + sum a a^T),   s = a + b + c
of the tetrahedra between a point and the triangles a, b, c, counter-clockwise from outside; here the point is the
middle of the surface, so that a surface far from the origin loses no digits.

Where the faces of a surface are moved slightly inward, those that touched become separate, those that cross still do. A
corner moves against the mean of the normals around it, weighted by the angles there (Thuermer, Wuethrich, 1998), so
that the mean depends on the surface and not on its triangulation. It moves so far that each face there moves by the
given distance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array, Mask

# Model

IndexArray = NDArray[np.intp]


class SolidMoments(NamedTuple):
    """volume [m^3], center (3,) [m], second: moments about the centre (3, 3) [m^5], of unit density"""

    volume: float
    center: Array
    second: Array


@record
class TriangleMesh:
    """A closed surface, in the units of its file.

    corners: (n, 3)
    triangles: (m, 3) of corner numbers, counter-clockwise from outside
    shells: the number of separate surfaces
    volume: the enclosed volume
    low, high: (3,) its extent
    notes: what was corrected, in sentences
    facts: what the file does not show, in sentences
    moments: of the solid itself, whose surface the triangles approximate; None: they are the solid
    """

    corners: Array
    triangles: IndexArray
    shells: int
    volume: float
    low: Array
    high: Array
    notes: tuple[str, ...] = ()
    facts: tuple[str, ...] = ()
    moments: SolidMoments | None = None


@record
class TriangleSoup:
    """The triangles of a mesh file, as indices (m, 3) into corners (n, 3), which need not be shared."""

    corners: Array
    triangles: IndexArray


def dot_columns(a: Array, b: Array) -> Array:
    """Compute a . b of columns (3, ...)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross_columns(a: Array, b: Array) -> Array:
    """Compute a x b of columns (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def gather_corners(places: Array, triangles: IndexArray) -> Array:
    """Return the places (n, 3) of the corners of triangles, in columns: (3 corners, 3 axes, m)."""
    columns = np.ascontiguousarray(places.T)
    return np.stack([columns.take(numbers, axis=1) for numbers in triangles.T])


def make_tetrahedra(corners: Array, triangles: IndexArray, middle: Array) -> tuple[Array, Array]:
    """Return the corners (3, 3, m) relative to the middle, in columns, and the volumes (m,) of the tetrahedra on
    triangles.
    """
    places = gather_corners(corners - middle, triangles)
    a, b, c = places
    return places, dot_columns(a, cross_columns(b, c)) / 6.0


def middle_of_extent(corners: Array) -> Array:
    """Return the middle of the extent, (3,)."""
    return np.asarray(0.5 * (corners.min(axis=0) + corners.max(axis=0)))


def volume_moments(corners: Array, triangles: IndexArray) -> tuple[float, Array, Array]:
    """Compute the volume, and its first (3,) and second moments (3, 3) about the middle of the corners."""
    (a, b, c), V = make_tetrahedra(corners, triangles, middle_of_extent(corners))
    s = a + b + c
    first = 0.25 * (s @ V)
    second = sum((V * x) @ x.T for x in (s, a, b, c)) / 20.0
    return float(V.sum()), first, np.asarray(second)


def min_of_three(triangles: Array) -> Array:
    """Return the least of three along the second axis, (m, ...); a NumPy reduction along so short an axis takes twice
    as long.
    """
    return np.asarray(np.minimum(np.minimum(triangles[:, 0], triangles[:, 1]), triangles[:, 2]))


def max_of_three(triangles: Array) -> Array:
    """Return the largest of three along the second axis, (m, ...)."""
    return np.asarray(np.maximum(np.maximum(triangles[:, 0], triangles[:, 1]), triangles[:, 2]))


def cross_product_rows(a: Array, b: Array) -> Array:
    """Compute a x b of rows (..., 3)."""
    out = np.empty(np.broadcast(a, b).shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def connected_components(count: int, a: IndexArray, b: IndexArray) -> IndexArray:
    """For each of `count` items, return the least number among those that pairs (a, b) connect to it (Shiloach,
    Vishkin, 1982).
    """
    first = np.arange(count)
    while True:
        one, other = first[a], first[b]
        is_separate = one != other
        if not is_separate.any():
            return first
        a, b = a[is_separate], b[is_separate]
        low, high = np.minimum(one[is_separate], other[is_separate]), np.maximum(one[is_separate], other[is_separate])
        first[high] = low  # if several are joined to one, the last wins; the others are handled in the next round
        while True:
            next_first = first[first]
            if (next_first == first).all():
                break
            first = next_first


def stable_order(keys: IndexArray) -> IndexArray:
    """Return the stable sort order of whole numbers from 0 on. Key and place are packed into 63 bits if they fit, which
    is faster.
    """
    bits = len(keys).bit_length()
    if int(keys.max(initial=0)) >> (63 - bits):
        return np.argsort(keys, kind="stable")
    return np.asarray(np.sort((keys << bits) | np.arange(len(keys))) & ((1 << bits) - 1))


def number_components(first: IndexArray) -> tuple[IndexArray, IndexArray]:
    """For items joined by `connected_components`, return the first of each component (k,), and the component of each
    item.
    """
    is_first = first == np.arange(len(first))
    return np.flatnonzero(is_first), (np.cumsum(is_first) - 1)[first]


# Inward offset

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
