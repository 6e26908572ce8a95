"""The figures in which planes meet a body: convex outlines, and the number of separate regions they form.

Only for a warning: two figures nearer to each other than 1e-3 of their size count as one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import perpendicular

Flags = NDArray[np.bool_]
Planes = NDArray[np.intp]
Corners = Callable[[Planes], Array]

SIDES = 96  # of the polygons for curved outlines: 5e-4 of a radius off


@record
class Outline:
    """Convex figures, one a plane: whether the plane meets the shape (k,), and its corners (c, m, 3) [m] at c planes.

    A ring has a hole where `hollow` (k,). Corners are asked for only where a plane meets several shapes, or only rods.
    part: of what the figures are regions, each apart from the others of it; None: of nothing else.
    """

    met: Flags
    corners: Corners
    hole: Corners | None = None
    hollow: Flags | None = None
    part: int | None = None


def circle(n: Array, centers: Array, radii: Array) -> Array:
    """Corners (k, SIDES, 3) on circles about n."""
    e, f = perpendicular(n)
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    directions = np.cos(angle)[:, None] * e + np.sin(angle)[:, None] * f
    return centers[:, None, :] + radii[:, None, None] * directions


def polygon(n: Array, points: Array, present: Flags) -> Array:
    """Points (k, m, 3) of convex figures put in order about n; those not present (k, m) repeat one that is."""
    first = np.take_along_axis(points, np.argmax(present, axis=1)[:, None, None], axis=1)
    points = np.where(present[..., None], points, first)
    count = np.maximum(present.sum(axis=1), 1)[:, None, None]
    arm = points - np.where(present[..., None], points, 0.0).sum(axis=1, keepdims=True) / count
    e, f = perpendicular(n)
    order = np.argsort(np.arctan2(arm @ f, arm @ e), axis=1)
    return np.take_along_axis(points, order[..., None], axis=1)


@record
class Shadow:
    """Polygons in the plane's own coordinates (k, m, 2), with centre and the circles inside and outside about it."""

    corners: Array
    center: Array
    inner: Array
    outer: Array


def shadow(points: Array, e: Array, f: Array) -> Shadow:
    corners = np.stack([points @ e, points @ f], axis=-1)
    center = corners.mean(axis=1)
    arms = corners - center[:, None, :]
    normals = edge_normals(corners)
    reach = np.where(normals.any(axis=-1), np.abs((normals * arms).sum(axis=-1)), np.inf).min(axis=1)
    return Shadow(corners, center, np.where(np.isinf(reach), 0.0, reach), np.sqrt((arms**2).sum(axis=-1)).max(axis=1))


def edge_normals(corners: Array) -> Array:
    """Unit normals (..., m, 2) of the edges that start at the corners; zero for an edge without length."""
    edge = np.roll(corners, -1, axis=-2) - corners
    length = np.sqrt((edge**2).sum(axis=-1, keepdims=True))
    return np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / np.where(length > 0.0, length, 1.0)


def apart(A: Array, B: Array, gap: Array) -> NDArray[np.bool_]:
    """Whether a line along an edge of one of two convex polygons (k, m, 2) keeps them more than the gap (k,) apart."""
    found = np.zeros(len(gap), dtype=bool)
    for corners in (A, B):
        normals = np.swapaxes(edge_normals(corners), -1, -2)
        a, b = A @ normals, B @ normals
        beyond = (a.min(axis=1) > b.max(axis=1) + gap[:, None]) | (b.min(axis=1) > a.max(axis=1) + gap[:, None])
        found |= beyond.any(axis=1)
    return found


def lies_in_hole(A: Array, hole: Array, gap: float) -> bool:
    """Whether the polygon A lies in the hole, nowhere nearer than the gap to its edge."""
    normals = edge_normals(hole)
    outward = np.sign(((hole - hole.mean(axis=0)) * normals).sum(axis=-1))[:, None] * normals
    return bool(np.all((A @ outward.T).max(axis=0) <= (hole * outward).sum(axis=-1) - gap))


def count_regions(outlines: Sequence[Outline], n: Array, near: float) -> NDArray[np.intp]:
    """Number of separate regions in which each plane meets the body, (k,); two that touch or are `near` [m] are one."""
    count = np.sum([outline.met for outline in outlines], axis=0)
    several = np.flatnonzero(count > 1)
    if len(several):
        count[several] = count_joined(outlines, several, n, near)
    return np.asarray(count)


def count_joined(outlines: Sequence[Outline], planes: Planes, n: Array, near: float) -> NDArray[np.intp]:
    """`count_regions` at some planes: outlines that touch are joined, each set of joined ones labelled by its first."""
    e, f = perpendicular(n)
    shadows = [shadow(outline.corners(planes), e, f) for outline in outlines]
    holes = [None if outline.hole is None else shadow(outline.hole(planes), e, f) for outline in outlines]
    hollow = [None if outline.hollow is None else outline.hollow[planes] for outline in outlines]
    met = np.stack([outline.met[planes] for outline in outlines], axis=1)
    label = np.broadcast_to(np.arange(len(outlines)), met.shape).copy()

    def in_hole(i: int, j: int, cut: int, gap: float) -> bool:
        hole, there = holes[j], hollow[j]
        if hole is None or there is None or not there[cut]:
            return False
        return lies_in_hole(shadows[i].corners[cut], hole.corners[cut], gap)

    for i, A in enumerate(shadows):
        for j, B in enumerate(shadows[:i]):
            if outlines[i].part is not None and outlines[i].part == outlines[j].part:
                continue
            one = met[:, i] & met[:, j] & (label[:, i] != label[:, j])  # what is joined by others needs no look
            if not one.any():
                continue
            distance = np.sqrt(((A.center - B.center) ** 2).sum(axis=1))
            gap = tolerances.OUTLINES_APART * (A.outer + B.outer) + near
            one &= distance <= A.outer + B.outer + gap
            full = holes[i] is None and holes[j] is None
            unsure = np.flatnonzero(one & (distance > A.inner + B.inner) if full else one)
            if len(unsure):
                one[unsure] = ~apart(A.corners[unsure], B.corners[unsure], gap[unsure])
            for cut in [] if full else unsure[one[unsure]].tolist():
                one[cut] = not (in_hole(i, j, cut, gap[cut]) or in_hole(j, i, cut, gap[cut]))
            joined = label[one]
            low, high = np.sort(joined[:, [i, j]], axis=1).T[:, :, None]
            label[one] = np.where(joined == high, low, joined)
    return np.asarray((met & (label == np.arange(len(outlines)))).sum(axis=1))
