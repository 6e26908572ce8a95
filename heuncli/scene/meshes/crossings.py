"""Whether triangles of a closed surface cross each other, deeper than the digits of its file.

Two surfaces cross where an edge of the one comes out behind a triangle of the other, or they run into each other along
faces of one plane, which then lie on one another turned alike (turned apart they touch, as two bodies do that stand on
each other). A corner in the plane counts as before it: so one that stands on a face touches, and an edge that goes on
behind the face from there crosses.

    u = 2^-24 max |x|    what rounding to float32 moves a coordinate by, so a corner by sqrt(3) u
    near = 8 u           more than two surfaces come to lie in each other whose corners were rounded twice, 4 sqrt(3) u
What goes no deeper than near is rounding, and touches. What lies at the rim of a triangle within near may have come
there by rounding, or touch it, as edges that lie on each other crosswise: whether it crosses is seen where every face
is moved inward by near/2 (`drawn_in`). Then what touched is apart, and what is deeper by 3 near, a needle by 6, crosses
still. Planes of triangles that are narrow against near are turned by rounding: they are not asked, their edges are.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.boxes import along_curve, overlapping
from heuncli.scene.meshes.drawn_in import drawn_in
from heuncli.scene.meshes.model import Numbers, across, along, at_corners, components
from heuncli.scene.meshes.numbers import refused

JOINED = "join its solids to one (a union) in the program that drew it, or give each its own file"
NEXT = ((0, 1), (1, 2), (2, 0))
BEGINS, ENDS = np.array([0, 1, 2, 1, 2, 0]), np.array([1, 2, 0, 0, 1, 2])  # of edges, run through both ways
NARROW = 8.0  # times near: narrower triangles are turned by rounding, 1/16 and more
JOINING = 64.0  # times near: the corners of such are near one line; so an edge that ends there ends at its neighbours
MOST_NARROW = 1e-4  # of the whole area, of triangles whose planes are not asked
HARDLY = 1e-9  # of near: what shared rims may lie apart by the computing


class Faces(NamedTuple):
    """Triangles, all in columns: places (3, 3, m) of their corners, unit normals (3, m), heights (m,) over the origin.

    corners (3, m): their numbers; joined (3, m): which of them are one or joined by triangles of hardly a width;
    double (m,): twice their areas; narrow (m,): which are so narrow that their planes are not asked;
    joins: whether any corners are joined.
    """

    places: Array
    normals: Array
    offsets: Array
    corners: Numbers
    joined: Numbers
    double: Array
    narrow: Mask
    joins: bool


def require_no_crossing(corners: Array, triangles: Numbers, near: float) -> None:
    """Raise Finding where triangles (m, 3) go deeper into each other than near; each fan with corners of its own."""
    turned = at_corners(corners @ principal_axes(corners), triangles)  # boxes along long bodies are narrow
    order = along_curve(turned.sum(axis=0))  # what meets stands together, also in memory
    triangles, turned = triangles[order], turned[..., order]
    faces = faces_of(corners, triangles, near)
    if faces.double[faces.narrow].sum() > MOST_NARROW * faces.double.sum():
        message = "so many of its triangles are narrower than its digits that whether it crosses itself is not seen"
        raise refused(message, "export it near its origin, and no finer than needed")
    pairs = [_suspects(faces, a, b, near) for a, b in overlapping(turned.min(axis=0), turned.max(axis=0))]
    a, b = (np.concatenate([pair[i] for pair in pairs] or [np.empty(0, np.intp)]) for i in (0, 1))
    if not len(a):
        return
    inner = faces_of(drawn_in(corners, triangles, faces.normals.T, ~faces.narrow, 0.5 * near), triangles, near)
    met = _on_each_other(faces, a, b, near)
    for one, other in ((a, b), (b, a)):
        met |= _pierced(faces, one, other, near, near) & _pierced(inner, one, other, 0.0, HARDLY * near)
    if met.any():
        at = ", ".join(f"{x:.6g}" for x in faces.places[:, :, a[met][0]].mean(axis=0))
        count = int(met.sum())
        many = f"{count} pairs of triangles cross" if count > 1 else "2 triangles cross"
        message = f"the surface crosses itself: {many} each other, about ({at}) in the file's units"
        raise Finding("mesh-crosses-itself", message, JOINED)


def faces_of(corners: Array, triangles: Numbers, near: float) -> Faces:
    """The triangles with their planes."""
    places, numbers = at_corners(corners, triangles), np.ascontiguousarray(triangles.T)
    edges = [places[j] - places[i] for i, j in NEXT]
    normals = across(edges[0], edges[1])
    double = np.sqrt(along(normals, normals))
    longest = np.sqrt(np.maximum.reduce([along(edge, edge) for edge in edges]))
    narrow = double <= NARROW * near * longest
    normals /= np.where(double > 0.0, double, 1.0)
    a, b, c = numbers[:, double <= JOINING * near * longest]
    joined = components(len(corners), np.append(a, b), np.append(b, c))
    joins = bool((joined != np.arange(len(corners))).any())
    return Faces(places, normals, along(normals, places[0]), numbers, joined[numbers], double, narrow, joins)


def principal_axes(corners: Array) -> Array:
    """Columns along which the corners are spread most and least, (3, 3)."""
    off = corners - corners.mean(axis=0)
    return np.asarray(np.linalg.eigh(off.T @ off)[1])


def _suspects(faces: Faces, a: Numbers, b: Numbers, near: float) -> tuple[Numbers, Numbers]:
    """The pairs that cross, or seem to at a rim."""
    a, b = _not_aside(faces, a, b, near)
    met = _pierced(faces, a, b, near, near) | _pierced(faces, b, a, near, near) | _on_each_other(faces, a, b, near)
    return a[met], b[met]


def _not_aside(faces: Faces, a: Numbers, b: Numbers, near: float) -> tuple[Numbers, Numbers]:
    """The pairs of which the one may go behind the other, or that lie in one plane; none that share an edge."""
    of_a, of_b = faces.corners.take(a, axis=1), faces.corners.take(b, axis=1)
    others = 3 - _count(of_a[i] == of_b[j] for i in range(3) for j in range(3))
    own = np.flatnonzero(others > 1)
    a, b, others, behind = a[own], b[own], others[own], np.zeros(len(own), dtype=bool)
    for _ in range(2):
        h = _heights(faces, a, b)  # a corner that they share is neither above nor below
        above, below = (_count(sides) for sides in (h > near, h < -near))
        known = ~faces.narrow[b]
        behind |= ((below > 0) & (below < others) & known) | ((above == 0) & (below == 0))
        own = np.flatnonzero(((above < others) & (below < others)) | ~known)
        a, b, others, behind = b[own], a[own], others[own], behind[own]
    return a[behind], b[behind]


def _count(masks: Iterable[Mask]) -> NDArray[np.int8]:
    """How many of some masks are true, everywhere."""
    return np.asarray(sum(mask.view(np.int8) for mask in masks))


def _heights(faces: Faces, of: Numbers, over: Numbers) -> Array:
    """Of the corners of triangles over the planes of others, (3, k)."""
    normals, offsets = faces.normals.take(over, axis=1), faces.offsets.take(over)
    return np.stack([along(corner.take(of, axis=1), normals) - offsets for corner in faces.places])


def _pierced(faces: Faces, a: Numbers, b: Numbers, near: float, beside: float) -> Mask:
    """Whether an edge of a comes out behind b, there or up to `beside` from its rim.

    It may start at b, but not at a corner that is one with a corner of b, or is joined to it; nor may both its ends be.
    """
    own_corners = (faces.corners.take(a, axis=1)[:, None] == faces.corners.take(b, axis=1)).any(axis=1)
    h = np.where(own_corners, 0.0, _heights(faces, a, b))
    behind, before = h < -near, (h >= -near) & ~faces.narrow[b]
    edge, own = np.nonzero(before[BEGINS] & behind[ENDS])
    i, j = BEGINS[edge], ENDS[edge]
    held = np.flatnonzero((h[i, own] <= near) | faces.joins)
    at_it = [_is_joined(faces, a[own[held]], k[held], b[own[held]]) for k in (i, j)]
    free = np.ones(len(own), dtype=bool)
    free[held] = ~(at_it[0] & (at_it[1] | (h[i[held], own[held]] <= near)))
    own, i, j = own[free], i[free], j[free]
    p, q, above = faces.places[i, :, a[own]].T, faces.places[j, :, a[own]].T, np.maximum(h[i, own], 0.0)
    point = p + above / (above - h[j, own]) * (q - p)
    met = np.zeros(len(a), dtype=bool)
    met[own[_inside(faces, point, b[own], beside)]] = True
    return met


def _is_joined(faces: Faces, a: Numbers, corner: Numbers, b: Numbers) -> Mask:
    """Whether a corner of a is one with any of b, or joined to it."""
    return np.asarray((faces.joined[corner, a] == faces.joined.take(b, axis=1)).any(axis=0))


def _inside(faces: Faces, points: Array, b: Numbers, beside: float) -> Numbers:
    """Which of points (3, k) in the planes of triangles lie in them, or not farther than `beside` outside."""
    found = np.arange(len(b))
    for i, j in NEXT:
        first, normals = faces.places[i].take(b, axis=1), faces.normals.take(b, axis=1)
        edge = faces.places[j].take(b, axis=1) - first
        inward = along(across(normals, edge), points - first)
        on = np.flatnonzero(inward >= -beside * np.sqrt(along(edge, edge)))
        found, points, b = found[on], points.take(on, axis=1), b[on]
    return found


def _on_each_other(faces: Faces, a: Numbers, b: Numbers, near: float) -> Mask:
    """Whether two triangles of one plane, turned alike, have an area in common."""
    on = np.flatnonzero(along(faces.normals.take(a, axis=1), faces.normals.take(b, axis=1)) > 0.0)
    on = on[np.abs(_heights(faces, a[on], b[on])).max(axis=0) <= near]
    on = on[~(faces.narrow[a[on]] | faces.narrow[b[on]])]
    for one, other in ((a, b), (b, a)):  # no edge of either keeps them apart
        for i, j in NEXT:
            first, normals = faces.places[i].take(one[on], axis=1), faces.normals.take(one[on], axis=1)
            edge = faces.places[j].take(one[on], axis=1) - first
            length = np.sqrt(along(edge, edge))
            inward = across(normals, edge) / np.where(length > 0.0, length, 1.0)
            reach = [along(corner.take(other[on], axis=1) - first, inward) for corner in faces.places]
            on = on[np.maximum.reduce(reach) > near]
    met = np.zeros(len(a), dtype=bool)
    met[on] = True
    return met
