"""Make the convex hull of a body's points: what a body without shapes is drawn as, a plate or a solid."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from heuncli.output.machine_geometry.silhouettes import compute_convex_hull
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array

FLAT = 1e-6  # share of the points' extent: less in a direction is none
MAX_HULL_POINTS = 24  # each three of them are tried as a face


def make_hull(points: Array) -> Surface | None:
    """Make the convex hull of distinct points (n, 3); a plate has two faces.

    Returns None for points on a line, which span no plate, and for more than MAX_HULL_POINTS.
    """
    if not 3 <= len(points) <= MAX_HULL_POINTS:
        return None
    offsets = points - points.mean(axis=0)
    sizes, directions = np.linalg.svd(offsets, full_matrices=False)[1:]
    if sizes[1] <= FLAT * sizes[0]:
        return None
    size = float(np.abs(offsets).max())
    if sizes[2] <= FLAT * sizes[0]:
        ring = _order_ring(offsets, np.arange(len(points)), directions[2])
        rings = [ring, ring[::-1]]
    else:
        rings = _find_faces(offsets, FLAT * size)
    corners = sorted({k for ring in rings for k in ring})
    faces = tuple(tuple(corners.index(k) for k in ring) for ring in rings)
    edges = {(min(a, b), max(a, b)) for ring in rings for a, b in zip(ring, (*ring[1:], ring[0]), strict=True)}
    return Surface(points[corners], faces, tuple(points[list(edge)] for edge in sorted(edges)))


def _find_faces(offsets: Array, tolerance: float) -> list[list[int]]:
    """Find the faces of a solid hull, each with its corners counter-clockwise as seen from outside."""
    faces: dict[frozenset[int], list[int]] = {}
    for a, b, c in combinations(range(len(offsets)), 3):
        normal = np.cross(offsets[b] - offsets[a], offsets[c] - offsets[a])
        length = float(np.linalg.norm(normal))
        if length <= tolerance * tolerance:
            continue
        heights = (offsets - offsets[a]) @ (normal / length)
        if heights.min() < -tolerance and heights.max() > tolerance:
            continue
        outward = normal if heights.max() <= tolerance else -normal
        ring = _order_ring(offsets, np.flatnonzero(np.abs(heights) <= tolerance), outward / length)
        faces.setdefault(frozenset(ring), ring)
    return list(faces.values())


def _order_ring(offsets: Array, numbers: np.ndarray[tuple[int], np.dtype[np.intp]], normal: Array) -> list[int]:
    """Return the corners of the hull of points in a plane, counter-clockwise about its normal."""
    axis = np.eye(3)[int(np.argmin(np.abs(normal)))]
    right = np.cross(axis, normal)
    right /= np.linalg.norm(right)
    flat = np.column_stack([offsets[numbers] @ right, offsets[numbers] @ np.cross(normal, right)])
    places = {tuple(place): int(k) for place, k in zip(flat.tolist(), numbers, strict=True)}
    return [places[tuple(place)] for place in compute_convex_hull(flat).tolist()]
