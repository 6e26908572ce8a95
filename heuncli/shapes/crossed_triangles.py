"""Which triangles of a closed surface parallel planes cross, and where.

    X (n, 3)   corners, the third coordinate along the planes' normal        D (k,)   heights of the planes, ascending
A corner is above a plane or not, one exactly in it is not: as if the plane lay a hair higher. So it is for all
triangles that share the corner, and what the plane meets is closed lines, wherever corners, edges and faces lie.
"""

from __future__ import annotations

import numpy as np

from heuncli.meshes.model import components, least, most
from heuncli.records import record
from heuncli.results import Array, Indices, Mask

FIRST, NEXT, LAST = np.array([0, 1, 2]), np.array([1, 2, 0]), np.array([2, 0, 1])
AT_ONCE = 1 << 20  # crossings of triangles and planes that are looked at together


@record
class CrossedTriangles:
    """Crossings of triangles and planes, q of them: numbers of the triangle and the plane.

    lone (q, 3): the corners of the triangle in their order, first the one that has a side of the plane to itself;
    up: whether that is the upper side. h (q, 3): their heights over the plane. part (q, 2): where on the way from the
    first corner to the second and to the third the plane meets it, 0 to 1.
    """

    triangle: Indices
    plane: Indices
    lone: Indices
    up: Mask
    h: Array
    part: Array


def levels(heights: Array, triangles: Indices, D: Array) -> tuple[Indices, Indices]:
    """Of each triangle how many planes lie below all of it, and how many below its highest corner, (m,)."""
    own = heights[triangles]
    return np.searchsorted(D, least(own), "left"), np.searchsorted(D, most(own), "left")


def crossings(heights: Array, triangles: Indices, D: Array, low: Indices, high: Indices) -> CrossedTriangles:
    """All crossings, those of a triangle one after the other."""
    count = high - low
    crossed = np.flatnonzero(count)
    count = count[crossed]
    triangle = np.repeat(crossed, count)
    plane = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count - low[crossed], count)
    h = heights[triangles[triangle]] - D[plane, None]
    above = h > 0.0
    up = (above[:, 0] ^ above[:, 1]) ^ above[:, 2]  # one or two of three are
    alone = above == up[:, None]
    lone = np.where(alone[:, 0], 0, np.where(alone[:, 1], 1, 2))
    turned = np.stack([FIRST[lone], NEXT[lone], LAST[lone]], axis=1)
    h = np.take_along_axis(h, turned, axis=1)
    own = np.take_along_axis(triangles[triangle], turned, axis=1)
    part = h[:, :1] / (h[:, :1] - h[:, 1:])
    return CrossedTriangles(triangle, plane, own, up, h, part)


def met_at(X: Array, c: CrossedTriangles) -> tuple[Array, Array]:
    """The ends (q, 2) of the lines in which planes meet triangles, with the inside to the left."""
    a, b, d = (X[c.lone[:, i], :2] for i in range(3))
    p = a + c.part[:, :1] * (b - a)
    q = a + c.part[:, 1:] * (d - a)
    swapped = ~c.up[:, None]
    return np.where(swapped, q, p), np.where(swapped, p, q)


def loops(c: CrossedTriangles, corners: int, planes: int) -> Indices:
    """Of each crossing the number of the closed line that it is part of, from 0."""

    def key(i: int) -> Array:
        one, other = c.lone[:, 0], c.lone[:, i]
        edge = np.minimum(one, other) * corners + np.maximum(one, other)
        return np.asarray(edge * planes + c.plane)

    to_second, to_third = key(1), key(2)
    begins, ends = np.where(c.up, to_second, to_third), np.where(c.up, to_third, to_second)
    order = np.argsort(begins, kind="stable")
    following = order[np.searchsorted(begins[order], ends)]
    first = components(len(begins), np.arange(len(begins)), following)
    return np.asarray(np.unique(first, return_inverse=True)[1]).reshape(-1)
