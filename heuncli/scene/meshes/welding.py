"""Merge corners that are the same: first those of equal coordinates, then those closer than the digits of a float32.

STL gives every triangle corners of its own. If programs round them twice, they differ in the last digit.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.meshes.model import IndexArray, TriangleSoup, connected_components
from heuncli.scene.meshes.numbers import mesh_file_finding

MAX_PAIRS = 10_000_000  # pairs of corners in neighbouring cells: a valid file has only a few for each corner
HASH_FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)  # odd factors


def weld_equal_corners(soup: TriangleSoup) -> TriangleSoup:
    """Merge corners of equal coordinates; triangles that lose their area by this are dropped."""
    first, number = find_distinct_rows(soup.corners + 0.0)  # no -0.0
    return drop_unused_corners(
        drop_collapsed_triangles(TriangleSoup(soup.corners[first] + 0.0, number[soup.triangles]))
    )


def drop_unused_corners(soup: TriangleSoup) -> TriangleSoup:
    """Drop corners that no triangle has."""
    is_used = np.bincount(soup.triangles.ravel(), minlength=len(soup.corners)) > 0
    return soup if is_used.all() else TriangleSoup(soup.corners[is_used], (np.cumsum(is_used) - 1)[soup.triangles])


def find_distinct_rows(rows: Array) -> tuple[IndexArray, IndexArray]:
    """Return for rows (n, 3) the first row of each kind, (k,), and the kind of each row, (n,)."""
    bits = np.ascontiguousarray(rows).view(np.uint64)
    mixed = bits ^ (bits >> np.uint64(29))
    key = (mixed * HASH_FACTORS).sum(axis=1, dtype=np.uint64)
    key = key ^ (key >> np.uint64(32))
    order = np.argsort(key)
    ordered = key[order]
    begins = np.append(True, ordered[1:] != ordered[:-1])
    first_rows = np.minimum.reduceat(order, np.flatnonzero(begins))
    kind_numbers = np.empty(len(rows), dtype=np.intp)
    kind_numbers[order] = np.cumsum(begins) - 1
    if not (rows[first_rows[kind_numbers]] == rows).all():  # hash collision of two kinds
        _, first_rows, kind_numbers = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first_rows, np.asarray(kind_numbers, dtype=np.intp).reshape(-1)


def drop_collapsed_triangles(soup: TriangleSoup) -> TriangleSoup:
    """Drop triangles with two equal corners; their neighbours still close without them."""
    a, b, c = soup.triangles.T
    has_area = (a != b) & (b != c) & (c != a)
    return soup if has_area.all() else TriangleSoup(soup.corners, soup.triangles[has_area])


def coordinate_resolution(corners: Array) -> float:
    """Return by how much coordinates of one place may differ after rounding to float32."""
    return tolerances.MESH_DIGITS * float(np.abs(corners).max(initial=0.0))


def weld_near_corners(soup: TriangleSoup, open_corners: IndexArray) -> TriangleSoup:
    """Merge those of the open corners that lie within the resolution of each other."""
    tolerance = coordinate_resolution(soup.corners)
    a, b = find_near_pairs(soup.corners[open_corners], tolerance)
    merged = np.arange(len(soup.corners))
    merged[open_corners] = open_corners[connected_components(len(open_corners), a, b)]
    return drop_unused_corners(drop_collapsed_triangles(TriangleSoup(soup.corners, merged[soup.triangles])))


def find_near_pairs(points: Array, distance: float) -> tuple[IndexArray, IndexArray]:
    """Find pairs of points that are not farther apart than a distance, by their numbers, with a grid of cells of that
    size.
    """
    cell = np.floor((points - points.min(axis=0)) / distance).astype(np.int64)
    span = cell.max(axis=0) + 3
    # may overflow; equal keys of distant corners are separated below
    key = (cell[:, 0] * span[1] + cell[:, 1]) * span[2] + cell[:, 2]
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    steps = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) >= (0, 0, 0)]
    found: list[tuple[IndexArray, IndexArray]] = []
    for i, j, k in steps:
        neighbour_keys = ordered + (i * span[1] + j) * span[2] + k
        low, high = np.searchsorted(ordered, neighbour_keys, "left"), np.searchsorted(ordered, neighbour_keys, "right")
        if (i, j, k) == (0, 0, 0):
            low = np.arange(len(ordered)) + 1  # each pair once
        count = np.maximum(high - low, 0)
        if count.sum() > MAX_PAIRS:
            raise mesh_file_finding(
                "its vertices are closer together than seven digits can resolve", "use a coarser mesh"
            )
        one = np.repeat(np.arange(len(ordered)), count)
        other = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
        a, b = order[one], order[other]
        is_close = ((points[a] - points[b]) ** 2).sum(axis=1) <= distance * distance
        found.append((a[is_close], b[is_close]))
    return np.concatenate([a for a, _ in found]), np.concatenate([b for _, b in found])
