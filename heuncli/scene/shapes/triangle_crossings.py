"""Find which triangles of a closed surface parallel planes cross, and where.

    X (3, n)   corners, the third coordinate along the planes' normal        D (k,)   heights of the planes, ascending
A corner is above a plane or not; one exactly in the plane is not, as if the plane lay slightly higher. All triangles
that share the corner agree on this, so the plane meets the surface in closed lines, wherever corners, edges and faces
lie.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.meshes.model import connected_components, max_of_three, min_of_three, number_components, stable_order

FIRST, NEXT, AFTER_NEXT = np.array([0, 1, 2]), np.array([1, 2, 0]), np.array([2, 0, 1])
MAX_CROSSINGS_AT_ONCE = 1 << 17  # crossings of triangles and planes handled together


@record
class TriangleCrossings:
    """Crossings of triangles and planes, q of them.

    triangle, plane: their indices
    lone: (3, q) the corners of the triangle in order, starting with the one that is alone on its side of the plane
    lone_is_above: whether that corner is on the upper side
    h: (3, q) heights of these corners over the plane
    part: (2, q) where the plane meets the edges from the first corner to the second and to the third, 0 to 1
    """

    triangle: Indices
    plane: Indices
    lone: Indices
    lone_is_above: Mask
    h: Array
    part: Array


def count_planes_below(heights: Array, triangles: Indices, D: Array) -> tuple[Indices, Indices]:
    """For each triangle, count the planes below all of it, and those below its highest corner, (m,)."""
    corner_heights = heights[triangles]
    return np.searchsorted(D, min_of_three(corner_heights), "left"), np.searchsorted(
        D, max_of_three(corner_heights), "left"
    )


def find_crossings(heights: Array, triangles: Indices, D: Array, low: Indices, high: Indices) -> TriangleCrossings:
    """Find all crossings; those of a triangle follow each other."""
    count = high - low
    crossed = np.flatnonzero(count)
    count = count[crossed]
    triangle = np.repeat(crossed, count)
    plane = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count - low[crossed], count)
    corners = np.stack([corner_numbers.take(triangle) for corner_numbers in triangles.T])
    above = heights.take(corners) > D.take(plane)
    lone_is_above = (above[0] ^ above[1]) ^ above[2]  # one or two of three corners are above
    first = np.where(above[0] == lone_is_above, 0, np.where(above[1] == lone_is_above, 1, 2))
    q = np.arange(len(plane))
    lone = np.stack([corners.ravel().take(turned[first] * len(plane) + q) for turned in (FIRST, NEXT, AFTER_NEXT)])
    h = heights.take(lone) - D.take(plane)
    return TriangleCrossings(triangle, plane, lone, lone_is_above, h, h[0] / (h[0] - h[1:]))


def intersection_lines(X: Array, c: TriangleCrossings) -> tuple[Array, Array]:
    """Compute the ends (2, q) of the lines in which planes meet triangles, with the inside to the left."""
    a, b, d = (X[:2].take(corner_numbers, axis=1) for corner_numbers in c.lone)
    p = a + c.part[0] * (b - a)
    q = a + c.part[1] * (d - a)
    return np.where(c.lone_is_above, p, q), np.where(c.lone_is_above, q, p)


def number_loops(c: TriangleCrossings, corners: int, planes: int) -> Indices:
    """Number the closed lines from 0, and return for each crossing the line to which it belongs."""

    def edge_key(i: int) -> Array:
        one, other = c.lone[0], c.lone[i]
        edge = np.minimum(one, other) * corners + np.maximum(one, other)
        return np.asarray(edge * planes + c.plane)

    to_second, to_third = edge_key(1), edge_key(2)
    begins, ends = np.where(c.lone_is_above, to_second, to_third), np.where(c.lone_is_above, to_third, to_second)
    following = np.empty_like(begins)
    following[stable_order(ends)] = stable_order(begins)  # a crossed edge ends one line and begins the next
    return number_components(connected_components(len(begins), np.arange(len(begins)), following))[1]
