"""Corners that are one: those of equal coordinates, then those as near as the digits of a float32 tell apart.

STL gives every triangle corners of its own. Where programs round them twice, they differ in the last digit.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.meshes.model import Numbers, Soup, components
from heuncli.scene.meshes.numbers import refused

MOST_PAIRS = 10_000_000  # of corners in neighbouring cells: an honest file has some a corner
MIX = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)  # odd


def welded(soup: Soup) -> Soup:
    """The triangles with one corner for all of equal coordinates; those that have no area for that are left out."""
    first, number = distinct(soup.corners + 0.0)  # no -0.0
    return in_use(without_points(Soup(soup.corners[first] + 0.0, number[soup.triangles])))


def in_use(soup: Soup) -> Soup:
    """The same without corners that no triangle has."""
    used = np.bincount(soup.triangles.ravel(), minlength=len(soup.corners)) > 0
    return soup if used.all() else Soup(soup.corners[used], (np.cumsum(used) - 1)[soup.triangles])


def distinct(rows: Array) -> tuple[Numbers, Numbers]:
    """Of rows (n, 3) the first of each kind, (k,), and of each row its kind, (n,)."""
    bits = np.ascontiguousarray(rows).view(np.uint64)
    mixed = bits ^ (bits >> np.uint64(29))
    key = (mixed * MIX).sum(axis=1, dtype=np.uint64)
    key = key ^ (key >> np.uint64(32))
    order = np.argsort(key)
    ordered = key[order]
    begins = np.append(True, ordered[1:] != ordered[:-1])
    first = np.minimum.reduceat(order, np.flatnonzero(begins))
    number = np.empty(len(rows), dtype=np.intp)
    number[order] = np.cumsum(begins) - 1
    if not (rows[first[number]] == rows).all():  # two kinds with one key: one row is enough to see it
        _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, np.asarray(number, dtype=np.intp).reshape(-1)


def without_points(soup: Soup) -> Soup:
    """Without triangles that have two corners in one: what is beside them closes without them."""
    a, b, c = soup.triangles.T
    thick = (a != b) & (b != c) & (c != a)
    return soup if thick.all() else Soup(soup.corners, soup.triangles[thick])


def resolution(corners: Array) -> float:
    """How far coordinates of one place may lie apart that were rounded to float32."""
    return tolerances.MESH_DIGITS * float(np.abs(corners).max(initial=0.0))


def welded_near(soup: Soup, loose: Numbers) -> Soup:
    """The same with those of the loose corners as one that lie within the resolution of each other."""
    near = resolution(soup.corners)
    a, b = near_pairs(soup.corners[loose], near)
    to = np.arange(len(soup.corners))
    to[loose] = loose[components(len(loose), a, b)]
    return in_use(without_points(Soup(soup.corners, to[soup.triangles])))


def near_pairs(points: Array, near: float) -> tuple[Numbers, Numbers]:
    """Pairs of points, by their numbers, in cells of that size that are neighbours, not farther apart than it."""
    cell = np.floor((points - points.min(axis=0)) / near).astype(np.int64)
    span = cell.max(axis=0) + 3
    key = (cell[:, 0] * span[1] + cell[:, 1]) * span[2] + cell[:, 2]  # may run over: then far ones meet, told below
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    steps = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) >= (0, 0, 0)]
    found: list[tuple[Numbers, Numbers]] = []
    for i, j, k in steps:
        wanted = ordered + (i * span[1] + j) * span[2] + k
        low, high = np.searchsorted(ordered, wanted, "left"), np.searchsorted(ordered, wanted, "right")
        if (i, j, k) == (0, 0, 0):
            low = np.arange(len(ordered)) + 1  # each pair once
        count = np.maximum(high - low, 0)
        if count.sum() > MOST_PAIRS:
            raise refused("its corners lie closer than seven digits of them tell apart", "a coarser mesh will do")
        one = np.repeat(np.arange(len(ordered)), count)
        other = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + np.repeat(low, count)
        a, b = order[one], order[other]
        close = ((points[a] - points[b]) ** 2).sum(axis=1) <= near * near
        found.append((a[close], b[close]))
    return np.concatenate([a for a, _ in found]), np.concatenate([b for _, b in found])
