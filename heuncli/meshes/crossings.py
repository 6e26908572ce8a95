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

import numpy as np

from heuncli.errors import Finding
from heuncli.meshes.boxes import overlapping
from heuncli.meshes.drawn_in import drawn_in
from heuncli.meshes.model import Numbers, components, crossed, least, most
from heuncli.meshes.numbers import refused
from heuncli.named_tuples import NamedTuple
from heuncli.results import Array, Mask

JOINED = "join its solids to one (a union) in the program that drew it, or give each its own file"
NEXT = ((0, 1), (1, 2), (2, 0))
NARROW = 8.0  # times near: narrower triangles are turned by rounding, 1/16 and more
JOINING = 64.0  # times near: the corners of such are near one line; so an edge that ends there ends at its neighbours
MOST_NARROW = 1e-4  # of the whole area, of triangles whose planes are not asked
HARDLY = 1e-9  # of near: what shared rims may lie apart by the computing


class Faces(NamedTuple):
    """Triangles (m, 3, 3), their unit normals (m, 3) and the heights of their planes over the origin (m,).

    joined (m, 3): of their corners, which are one or are joined by triangles of hardly a width; double (m,): twice their
    areas; narrow (m,): which are so narrow that their planes are not asked.
    """

    places: Array
    normals: Array
    offsets: Array
    joined: Numbers
    double: Array
    narrow: Mask


def require_no_crossing(corners: Array, triangles: Numbers, near: float) -> None:
    """Raise Finding where triangles (m, 3) go deeper into each other than near; each fan with corners of its own."""
    faces = faces_of(corners, triangles, near)
    if faces.double[faces.narrow].sum() > MOST_NARROW * faces.double.sum():
        message = "so many of its triangles are narrower than its digits that whether it crosses itself is not seen"
        raise refused(message, "export it near its origin, and no finer than needed")
    axes = principal_axes(corners)  # boxes along long bodies are narrow
    turned = (corners @ axes)[triangles]
    pairs = [_suspects(faces, a, b, near) for a, b in overlapping(least(turned), most(turned))]
    a, b = (np.concatenate([pair[i] for pair in pairs] or [np.empty(0, np.intp)]) for i in (0, 1))
    if not len(a):
        return
    inner = faces_of(drawn_in(corners, triangles, faces.normals, ~faces.narrow, 0.5 * near), triangles, near)
    met = _on_each_other(faces, a, b, near)
    for one, other in ((a, b), (b, a)):
        met |= _pierced(faces, one, other, near, near) & _pierced(inner, one, other, 0.0, HARDLY * near)
    if met.any():
        at = ", ".join(f"{x:.6g}" for x in faces.places[a[met][0]].mean(axis=0))
        count = int(met.sum())
        many = f"{count} pairs of triangles cross" if count > 1 else "2 triangles cross"
        message = f"the surface crosses itself: {many} each other, about ({at}) in the file's units"
        raise Finding("mesh-crosses-itself", message, JOINED)


def faces_of(corners: Array, triangles: Numbers, near: float) -> Faces:
    """The triangles with their planes."""
    places = corners[triangles]
    edges = [places[:, j] - places[:, i] for i, j in NEXT]
    normals = crossed(edges[0], edges[1])
    double = np.sqrt((normals * normals).sum(axis=1))
    longest = np.sqrt(np.maximum.reduce([(edge * edge).sum(axis=1) for edge in edges]))
    narrow = double <= NARROW * near * longest
    normals /= np.where(double > 0.0, double, 1.0)[:, None]
    a, b, c = triangles[double <= JOINING * near * longest].T
    joined = components(len(corners), np.append(a, b), np.append(b, c))
    return Faces(places, normals, (normals * places[:, 0]).sum(axis=1), joined[triangles], double, narrow)


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
    """The pairs of which the one may go behind the other, or that lie in one plane."""
    kept = np.zeros(len(a), dtype=bool)
    for one, other in ((a, b), (b, a)):
        h = _heights(faces, one, other)
        lowest = least(h)
        behind = (lowest < -near) & (most(h) >= -near)
        kept |= (behind & ~faces.narrow[other]) | ((lowest >= -near) & (most(h) <= near))
    return a[kept], b[kept]


def _heights(faces: Faces, of: Numbers, over: Numbers) -> Array:
    """Of the corners of triangles over the planes of others, (k, 3)."""
    n, offset, places = faces.normals[over], faces.offsets[over], faces.places[of]
    out = np.empty((len(of), 3))
    for i in range(3):
        out[:, i] = (places[:, i] * n).sum(axis=1) - offset
    return out


def _pierced(faces: Faces, a: Numbers, b: Numbers, near: float, beside: float) -> Mask:
    """Whether an edge of a comes out behind b, there or up to `beside` from its rim.

    It may start at b, but not at a corner that is one with a corner of b, or is joined to it; nor may both its ends be.
    """
    h = _heights(faces, a, b)
    met = np.zeros(len(a), dtype=bool)
    for edge in NEXT:
        for behind, before in (edge, edge[::-1]):
            own = np.flatnonzero((h[:, behind] < -near) & (h[:, before] >= -near) & ~faces.narrow[b])
            at_it = [(faces.joined[a[own], i, None] == faces.joined[b[own]]).any(axis=1) for i in (before, behind)]
            own = own[~(at_it[0] & (at_it[1] | (h[own, before] <= near)))]
            p, q = faces.places[a[own], before], faces.places[a[own], behind]
            part = np.maximum(h[own, before], 0.0) / (np.maximum(h[own, before], 0.0) - h[own, behind])
            met[own] |= _is_inside(p + part[:, None] * (q - p), faces.places[b[own]], faces.normals[b[own]], beside)
    return met


def _is_inside(point: Array, triangle: Array, normal: Array, beside: float) -> Mask:
    """Whether points (k, 3) in the planes of triangles (k, 3, 3) lie in them, or not farther than that outside."""
    inside = np.ones(len(point), dtype=bool)
    for i, j in NEXT:
        edge = triangle[:, j] - triangle[:, i]
        inward = crossed(normal, edge)
        length = np.sqrt((edge * edge).sum(axis=1))
        inside &= (inward * (point - triangle[:, i])).sum(axis=1) >= -beside * length
    return inside


def _on_each_other(faces: Faces, a: Numbers, b: Numbers, near: float) -> Mask:
    """Whether two triangles of one plane, turned alike, have an area in common."""
    met = most(np.abs(_heights(faces, a, b))) <= near
    met &= ((faces.normals[a] * faces.normals[b]).sum(axis=1) > 0.0) & ~faces.narrow[a] & ~faces.narrow[b]
    on = np.flatnonzero(met)
    for one, other in ((a, b), (b, a)):  # no edge of either keeps them apart
        for i, j in NEXT:
            triangle, normal = faces.places[one[on]], faces.normals[one[on]]
            edge = triangle[:, j] - triangle[:, i]
            length = np.sqrt((edge * edge).sum(axis=1))
            inward = crossed(normal, edge) / np.where(length > 0.0, length, 1.0)[:, None]
            reach = np.einsum("kij,kj->ki", faces.places[other[on]] - triangle[:, None, i], inward)
            on = on[most(reach) > near]
    met[:] = False
    met[on] = True
    return met
