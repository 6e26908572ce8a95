"""Find the convex outlines in which planes meet a body, and the number of separate regions that they form.

Only for a warning: two figures closer to each other than 1e-3 of their size count as one.

Parallel planes cross some of the triangles of a closed surface:

    X (3, n)   corners, the third coordinate along the planes' normal        D (k,)   heights of the planes, ascending
A corner is above a plane or not; one exactly in the plane is not, as if the plane lay slightly higher. All triangles
that share the corner agree on this, so the plane meets the surface in closed lines, wherever corners, edges and faces
lie.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.meshes.model import connected_components, max_of_three, min_of_three, number_components, stable_order
from heuncli.scene.shapes.rotations import perpendicular_pair

# Outlines

Flags = NDArray[np.bool_]
Planes = NDArray[np.intp]
Corners = Callable[[Planes], Array]

SIDES = 96  # corners of the polygons for curved outlines: error 5e-4 of a radius


@record
class Outline:
    """Convex figures, one a plane.

    is_met: (k,) whether the plane meets the shape
    corners: returns the corners (c, m, 3) [m] at c planes; called only where a plane meets several shapes, or only rods
    hole: returns the corners of a ring's hole
    hollow: (k,) where there is a hole
    part: identifies the shape of which the figures are separate regions; None: they belong to no other figure
    """

    is_met: Flags
    corners: Corners
    hole: Corners | None = None
    hollow: Flags | None = None
    part: int | None = None


def circle_corners(n: Array, centers: Array, radii: Array) -> Array:
    """Return corners (k, SIDES, 3) on circles about n."""
    e, f = perpendicular_pair(n)
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    directions = np.cos(angle)[:, None] * e + np.sin(angle)[:, None] * f
    return centers[:, None, :] + radii[:, None, None] * directions


def sort_polygon_corners(n: Array, points: Array, present: Flags) -> Array:
    """Sort the corners (k, m, 3) of convex figures about n; absent ones (k, m) repeat one that is present."""
    first = np.take_along_axis(points, np.argmax(present, axis=1)[:, None, None], axis=1)
    points = np.where(present[..., None], points, first)
    count = np.maximum(present.sum(axis=1), 1)[:, None, None]
    from_center = points - np.where(present[..., None], points, 0.0).sum(axis=1, keepdims=True) / count
    e, f = perpendicular_pair(n)
    order = np.argsort(np.arctan2(from_center @ f, from_center @ e), axis=1)
    return np.take_along_axis(points, order[..., None], axis=1)


@record
class PlanarPolygons:
    """Polygons in the plane's own coordinates (k, m, 2), with centre and the inscribed and circumscribed circles about
    it.
    """

    corners: Array
    center: Array
    inner: Array
    outer: Array


def project_polygons(points: Array, e: Array, f: Array) -> PlanarPolygons:
    corners = np.stack([points @ e, points @ f], axis=-1)
    center = corners.mean(axis=1)
    arms = corners - center[:, None, :]
    normals = edge_normals(corners)
    edge_distance = np.where(normals.any(axis=-1), np.abs((normals * arms).sum(axis=-1)), np.inf).min(axis=1)
    return PlanarPolygons(
        corners,
        center,
        np.where(np.isinf(edge_distance), 0.0, edge_distance),
        np.sqrt((arms**2).sum(axis=-1)).max(axis=1),
    )


def edge_normals(corners: Array) -> Array:
    """Compute the unit normals (..., m, 2) of the edges that start at the corners; zero for an edge without length."""
    edge = np.roll(corners, -1, axis=-2) - corners
    length = np.sqrt((edge**2).sum(axis=-1, keepdims=True))
    return np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / np.where(length > 0.0, length, 1.0)


def are_separate(A: Array, B: Array, gap: Array) -> NDArray[np.bool_]:
    """Return whether a line along an edge of one of two convex polygons (k, m, 2) separates them by more than the gap
    (k,).
    """
    separated = np.zeros(len(gap), dtype=bool)
    for corners in (A, B):
        normals = np.swapaxes(edge_normals(corners), -1, -2)
        a, b = A @ normals, B @ normals
        is_gap = (a.min(axis=1) > b.max(axis=1) + gap[:, None]) | (b.min(axis=1) > a.max(axis=1) + gap[:, None])
        separated |= is_gap.any(axis=1)
    return separated


def lies_in_hole(A: Array, hole: Array, gap: float) -> bool:
    """Return whether polygon A lies in the hole, with at least the gap to its edge everywhere."""
    normals = edge_normals(hole)
    outward = np.sign(((hole - hole.mean(axis=0)) * normals).sum(axis=-1))[:, None] * normals
    return bool(np.all((A @ outward.T).max(axis=0) <= (hole * outward).sum(axis=-1) - gap))


def count_regions(outlines: Sequence[Outline], n: Array, tolerance: float) -> NDArray[np.intp]:
    """Count the separate regions in which each plane meets the body, (k,); those within the tolerance [m] are one."""
    count = np.sum([outline.is_met for outline in outlines], axis=0)
    multiple = np.flatnonzero(count > 1)
    if len(multiple):
        count[multiple] = count_joined_regions(outlines, multiple, n, tolerance)
    return np.asarray(count)


def count_joined_regions(outlines: Sequence[Outline], planes: Planes, n: Array, tolerance: float) -> NDArray[np.intp]:
    """Count regions at some planes: outlines that touch are joined, and each joined set is labelled by its first."""
    e, f = perpendicular_pair(n)
    shadows = [project_polygons(outline.corners(planes), e, f) for outline in outlines]
    holes = [None if outline.hole is None else project_polygons(outline.hole(planes), e, f) for outline in outlines]
    hollow = [None if outline.hollow is None else outline.hollow[planes] for outline in outlines]
    is_met = np.stack([outline.is_met[planes] for outline in outlines], axis=1)
    labels = np.broadcast_to(np.arange(len(outlines)), is_met.shape).copy()

    def in_hole(i: int, j: int, cut: int, gap: float) -> bool:
        hole, there = holes[j], hollow[j]
        if hole is None or there is None or not there[cut]:
            return False
        return lies_in_hole(shadows[i].corners[cut], hole.corners[cut], gap)

    for i, A in enumerate(shadows):
        for j, B in enumerate(shadows[:i]):
            if outlines[i].part is not None and outlines[i].part == outlines[j].part:
                continue
            # figures that are joined already need no test
            is_joined = is_met[:, i] & is_met[:, j] & (labels[:, i] != labels[:, j])
            if not is_joined.any():
                continue
            distance = np.sqrt(((A.center - B.center) ** 2).sum(axis=1))
            gap = tolerances.OUTLINES_APART * (A.outer + B.outer) + tolerance
            is_joined &= distance <= A.outer + B.outer + gap
            without_holes = holes[i] is None and holes[j] is None
            undecided = np.flatnonzero(is_joined & (distance > A.inner + B.inner) if without_holes else is_joined)
            if len(undecided):
                is_joined[undecided] = ~are_separate(A.corners[undecided], B.corners[undecided], gap[undecided])
            for cut in [] if without_holes else undecided[is_joined[undecided]].tolist():
                is_joined[cut] = not (in_hole(i, j, cut, gap[cut]) or in_hole(j, i, cut, gap[cut]))
            joined_labels = labels[is_joined]
            low, high = np.sort(joined_labels[:, [i, j]], axis=1).T[:, :, None]
            labels[is_joined] = np.where(joined_labels == high, low, joined_labels)
    return np.asarray((is_met & (labels == np.arange(len(outlines)))).sum(axis=1))


# Triangle crossings

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
