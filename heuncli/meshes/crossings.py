"""Whether triangles of a closed surface cross each other.

Two surfaces cross where an edge of the one comes out behind a triangle of the other, be it at its rim; or they run into
each other along faces of one plane, which then lie on one another turned alike (turned apart they touch, as two bodies
do that stand on each other). What goes no deeper than the digits of the corners is rounding, and touches. Edges that
touch crosswise are taken for a crossing: that they are none is seen in no pair of triangles.
"""

from __future__ import annotations

import numpy as np

from heuncli.errors import Finding
from heuncli.meshes.boxes import overlapping
from heuncli.meshes.model import Numbers, crossed, least, most
from heuncli.results import Array, Mask

JOINED = "join its solids to one (a union) in the program that drew it, or give each its own file"
NEXT = ((0, 1), (1, 2), (2, 0))


def require_no_crossing(corners: Array, triangles: Numbers, near: float) -> None:
    """Raise Finding where triangles (m, 3) go deeper into each other than near."""
    axes = principal_axes(corners)  # boxes along long bodies are narrow
    turned = (corners @ axes)[triangles]
    low, high = least(turned), most(turned)
    places = corners[triangles]
    normals = crossed(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    double = np.sqrt((normals * normals).sum(axis=1))
    flat = double <= near * np.sqrt(((places[:, 1] - places[:, 0]) ** 2).sum(axis=1))
    normals = normals / np.where(double > 0.0, double, 1.0)[:, None]
    offsets = (normals * places[:, 0]).sum(axis=1)
    thick = np.flatnonzero(~flat)  # what has no area crosses nothing
    count, where = 0, np.zeros(3)
    for one, other in overlapping(low[thick], high[thick]):
        a, b = _not_aside(places, normals, offsets, thick[one], thick[other], near)
        met = _pierced(places, normals, offsets, a, b, near) | _pierced(places, normals, offsets, b, a, near)
        met |= _on_each_other(places, normals, offsets, a, b, near)
        if met.any():
            count += int(met.sum())
            where = places[a[met][0]].mean(axis=0)
    if count:
        at = ", ".join(f"{x:.6g}" for x in where)
        pairs = f"{count} pairs of triangles cross" if count > 1 else "2 triangles cross"
        message = f"the surface crosses itself: {pairs} each other, about ({at}) in the file's units"
        raise Finding("mesh-crosses-itself", message, JOINED)


def principal_axes(corners: Array) -> Array:
    """Columns along which the corners are spread most and least, (3, 3)."""
    off = corners - corners.mean(axis=0)
    return np.asarray(np.linalg.eigh(off.T @ off)[1])


def _heights(places: Array, normals: Array, offsets: Array, of: Numbers, over: Numbers) -> Array:
    """Of the corners of triangles over the planes of others, (k, 3)."""
    return np.asarray(np.einsum("kij,kj->ki", places[of], normals[over]) - offsets[over, None])


def _not_aside(
    places: Array, normals: Array, offsets: Array, a: Numbers, b: Numbers, near: float
) -> tuple[Numbers, Numbers]:
    """The pairs of which neither lies on one side of the other."""
    for one, other in ((0, 1), (1, 0)):
        pair = (a, b)
        h = _heights(places, normals, offsets, pair[one], pair[other])
        highest, lowest = most(h), least(h)
        both = ((highest > near) & (lowest < -near)) | ((highest <= near) & (lowest >= -near))
        a, b = a[both], b[both]
    return a, b


def _pierced(places: Array, normals: Array, offsets: Array, a: Numbers, b: Numbers, near: float) -> Mask:
    """Whether an edge of a goes through b."""
    h = _heights(places, normals, offsets, a, b)
    met = np.zeros(len(a), dtype=bool)
    for i, j in NEXT:
        through = np.flatnonzero((np.minimum(h[:, i], h[:, j]) < -near) & (np.maximum(h[:, i], h[:, j]) > near))
        if not len(through):
            continue
        p, q = places[a[through], i], places[a[through], j]
        part = h[through, i] / (h[through, i] - h[through, j])
        point = p + part[:, None] * (q - p)
        met[through] |= _is_inside(point, places[b[through]], normals[b[through]], near)
    return met


def _is_inside(point: Array, triangle: Array, normal: Array, near: float) -> Mask:
    """Whether points (k, 3) in the planes of triangles (k, 3, 3) lie in them, or not farther than near outside."""
    inside = np.ones(len(point), dtype=bool)
    for i, j in NEXT:
        edge = triangle[:, j] - triangle[:, i]
        inward = crossed(normal, edge)
        length = np.sqrt((edge * edge).sum(axis=1))
        inside &= (inward * (point - triangle[:, i])).sum(axis=1) >= -near * length
    return inside


def _on_each_other(places: Array, normals: Array, offsets: Array, a: Numbers, b: Numbers, near: float) -> Mask:
    """Whether two triangles of one plane, turned alike, have an area in common."""
    met = most(np.abs(_heights(places, normals, offsets, a, b))) <= near
    met &= (normals[a] * normals[b]).sum(axis=1) > 0.0
    on = np.flatnonzero(met)
    for one, other in ((a, b), (b, a)):  # no edge of either keeps them apart
        for i, j in NEXT:
            triangle, normal = places[one[on]], normals[one[on]]
            edge = triangle[:, j] - triangle[:, i]
            length = np.sqrt((edge * edge).sum(axis=1))
            inward = crossed(normal, edge) / np.where(length > 0.0, length, 1.0)[:, None]
            reach = np.einsum("kij,kj->ki", places[other[on]] - triangle[:, None, i], inward)
            on = on[most(reach) > near]
    met[:] = False
    met[on] = True
    return met
