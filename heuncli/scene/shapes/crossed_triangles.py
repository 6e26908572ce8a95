"""Which triangles of a closed surface parallel planes cross, and where.

    X (3, n)   corners, the third coordinate along the planes' normal        D (k,)   heights of the planes, ascending
A corner is above a plane or not, one exactly in it is not: as if the plane lay a hair higher. So it is for all
triangles that share the corner, and what the plane meets is closed lines, wherever corners, edges and faces lie.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.meshes.model import components, in_order, least, most, numbered

FIRST, NEXT, LAST = np.array([0, 1, 2]), np.array([1, 2, 0]), np.array([2, 0, 1])
AT_ONCE = 1 << 17  # crossings of triangles and planes that are looked at together


@record
class CrossedTriangles:
    """Crossings of triangles and planes, q of them: numbers of the triangle and the plane.

    lone (3, q): the corners of the triangle in their order, first the one that has a side of the plane to itself;
    up: whether that is the upper side. h (3, q): their heights over the plane. part (2, q): where on the way from the
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
    corners = np.stack([own.take(triangle) for own in triangles.T])
    above = heights.take(corners) > D.take(plane)
    up = (above[0] ^ above[1]) ^ above[2]  # one or two of three are
    first = np.where(above[0] == up, 0, np.where(above[1] == up, 1, 2))
    q = np.arange(len(plane))
    lone = np.stack([corners.ravel().take(turned[first] * len(plane) + q) for turned in (FIRST, NEXT, LAST)])
    h = heights.take(lone) - D.take(plane)
    return CrossedTriangles(triangle, plane, lone, up, h, h[0] / (h[0] - h[1:]))


def met_at(X: Array, c: CrossedTriangles) -> tuple[Array, Array]:
    """The ends (2, q) of the lines in which planes meet triangles, with the inside to the left."""
    a, b, d = (X[:2].take(own, axis=1) for own in c.lone)
    p = a + c.part[0] * (b - a)
    q = a + c.part[1] * (d - a)
    return np.where(c.up, p, q), np.where(c.up, q, p)


def loops(c: CrossedTriangles, corners: int, planes: int) -> Indices:
    """Of each crossing the number of the closed line that it is part of, from 0."""

    def key(i: int) -> Array:
        one, other = c.lone[0], c.lone[i]
        edge = np.minimum(one, other) * corners + np.maximum(one, other)
        return np.asarray(edge * planes + c.plane)

    to_second, to_third = key(1), key(2)
    begins, ends = np.where(c.up, to_second, to_third), np.where(c.up, to_third, to_second)
    following = np.empty_like(begins)
    following[in_order(ends)] = in_order(begins)  # on a closed surface each edge ends a line there and begins one
    return numbered(components(len(begins), np.arange(len(begins)), following))[1]
