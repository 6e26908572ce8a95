"""The surfaces of shapes as polygons, in body axes: round ones in so many flat faces."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Vec

ROUND = 24  # faces about an axis
OVERTURNED = 8.0  # cells: as long may lines be about triangles that are turned over where a mesh is thinned
THIN = 0.015  # radius of a rod that has none, of its length


class Surface(NamedTuple):
    """Faces over corners (n, 3), each a tuple of their numbers, counter-clockwise from outside; and edges to be drawn.

    edges: polylines (k, 3): the rims and ridges by which the shape is known. convex: whether it is seen as the hull of
    its corners; a ring is as its outer rim. blur [m]: lines of its silhouette that are shorter are none. ball: centre
    and radius of a sphere.
    """

    corners: Array
    faces: tuple[tuple[int, ...], ...]
    edges: tuple[Array, ...]
    convex: bool = True
    blur: float = 0.0
    ball: tuple[Vec, float] | None = None


def surfaces_of(shape: Shape, faces: int = ROUND) -> tuple[Surface, ...]:
    """The surfaces of a shape, a round one with so many faces about its axis; a point mass has none."""
    if shape.type == "point":
        return ()
    if shape.type == "box":
        return (_box(shape),)
    if shape.type == "mesh":
        return (_mesh(shape),)
    if shape.type == "sphere":
        radius = shape.radius or 0.0
        return (_sphere(_vector(shape.center), radius, faces)._replace(ball=(shape.center or (0.0, 0.0, 0.0), radius)),)
    start, end = _vector(shape.from_), _vector(shape.to)
    if shape.type == "rod":
        radius = THIN * float(np.linalg.norm(end - start))
        return (_revolved(start, end, radius, radius, 0.0, faces),)
    first = shape.radius or 0.0
    last = first if shape.to_radius is None else shape.to_radius
    return (_revolved(start, end, first, last, shape.inner_radius or 0.0, faces),)


def reached(shape: Shape, point: Array) -> tuple[Array, float]:
    """The place of a shape that leads to a point, and how far outside the shape the point lies; 0: it does not.

    That is on its axis, of a box on its surface, of a sphere and a point mass its centre, of a mesh a corner. Outside a
    mesh is what is outside its extent: a bore's axis is in it.
    """
    if shape.type == "point":
        place = _vector(shape.at)
        return place, float(np.linalg.norm(point - place))
    if shape.type == "box":
        axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
        half = 0.5 * _vector(shape.size)
        place = _vector(shape.center) + axes @ np.clip(axes.T @ (point - _vector(shape.center)), -half, half)
        return place, float(np.linalg.norm(point - place))
    if shape.type == "mesh":
        corners = corners_of(shape)
        place = corners[int(((corners - point) ** 2).sum(axis=1).argmin())]
        off = np.maximum(np.maximum(corners.min(axis=0) - point, point - corners.max(axis=0)), 0.0)
        return place, float(np.linalg.norm(off))
    if shape.type == "sphere":
        place = _vector(shape.center)
        return place, max(0.0, float(np.linalg.norm(point - place)) - (shape.radius or 0.0))
    start, end = _vector(shape.from_), _vector(shape.to)
    way = end - start
    share = float((point - start) @ way / (way @ way))
    place = start + min(max(share, 0.0), 1.0) * way
    beside = float(np.linalg.norm(point - start - share * way))
    beyond = max(share - 1.0, -share, 0.0) * float(np.linalg.norm(way))
    first = shape.radius or 0.0
    last = first if shape.to_radius is None else shape.to_radius
    return place, max(beyond, beside - max(first, last))


def ellipsoid(mass: float, center: Array, inertia: Array, faces: int = ROUND) -> Surface:
    """The even ellipsoid of a mass with that inertia (3, 3) about its centre; flat where there is no such.

    a1^2 = 5/(2 m) (A2 + A3 - A1)    of the principal moments A
    """
    moments, axes = np.linalg.eigh(inertia)
    squares = np.maximum(2.5 / mass * (moments.sum() - 2.0 * moments), 0.0)
    if np.linalg.det(axes) < 0.0:
        axes = axes * np.array([1.0, 1.0, -1.0])
    whole = np.sqrt(squares) * axes  # columns are the half axes
    unit = _sphere(np.zeros(3), 1.0, faces)
    edges = tuple(center + edge @ whole.T for edge in unit.edges)
    return Surface(center + unit.corners @ whole.T, unit.faces, edges)


def _vector(vector: Vec | None) -> Array:
    return np.array(vector, dtype=np.float64)


def corners_of(mesh: Shape) -> Array:
    """The corners of a mesh, (n, 3), in body axes."""
    assert mesh.mesh is not None and mesh.scale is not None
    return np.asarray(_vector(mesh.at) + (mesh.scale * mesh.mesh.corners) @ np.array(mesh.rotation).T)


def _mesh(shape: Shape) -> Surface:
    """Its triangles, of many some, and the edges between those that do not look the same way."""
    from heuncli.output.machine_geometry.thinned import sharp_edges, thinned  # few scenes have them

    assert shape.mesh is not None
    corners, triangles = corners_of(shape), shape.mesh.triangles
    drawn = thinned(corners, triangles)
    ends = np.unique(np.sort(drawn.number[sharp_edges(corners, triangles)], axis=1), axis=0)
    edges = drawn.corners[ends[ends[:, 0] < ends[:, 1]]]
    faces = tuple(map(tuple, drawn.triangles.tolist()))
    return Surface(drawn.corners, faces, tuple(edges), convex=False, blur=OVERTURNED * drawn.cell)


def _box(shape: Shape) -> Surface:
    """Six faces and twelve edges."""
    axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
    signs = np.array([[(k & 1) * 2 - 1, (k & 2) - 1, ((k & 4) >> 1) - 1] for k in range(8)], dtype=np.float64)
    corners = _vector(shape.center) + (signs * 0.5 * _vector(shape.size)) @ axes.T
    faces = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    edges = tuple(corners[[a, b]] for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4))
    return Surface(corners, faces, edges)


def across(direction: Array) -> tuple[Array, Array]:
    """Two directions of unit length across a unit direction, right-handed with it."""
    least = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, least)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)


def circle(centre: Array, direction: Array, radius: float, count: int) -> Array:
    """Points (count, 3) of a circle, counter-clockwise about the direction."""
    u, v = across(direction)
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.asarray(centre + radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v))


def _revolved(start: Array, end: Array, first: float, last: float, inner: float, n: int) -> Surface:
    """A cylinder, cone or tube: its wall in flat faces, its ends, its rims and two lines along it."""
    axis = (end - start) / np.linalg.norm(end - start)
    low, high = circle(start, axis, first, n), circle(end, axis, last, n)
    corners = [low, high]
    faces: list[tuple[int, ...]] = []
    for k in range(n):
        j = (k + 1) % n
        faces.append((k, j, n + j, n + k))
    edges = [_closed(low), _closed(high), np.array([low[0], high[0]]), np.array([low[n // 2], high[n // 2]])]
    if inner > 0.0:
        inner_low, inner_high = circle(start, axis, inner, n), circle(end, axis, inner, n)
        corners += [inner_low, inner_high]
        for k in range(n):
            j = (k + 1) % n
            faces.append((2 * n + j, 2 * n + k, 3 * n + k, 3 * n + j))
            faces += [(j, k, 2 * n + k, 2 * n + j), (n + k, n + j, 3 * n + j, 3 * n + k)]
        edges += [_closed(inner_low), _closed(inner_high)]
    else:
        faces += [tuple(reversed(range(n))), tuple(range(n, 2 * n))]
    return Surface(np.concatenate(corners), tuple(faces), tuple(edges))


def _sphere(centre: Array, radius: float, n: int) -> Surface:
    """Rings from pole to pole; three great circles as its edges."""
    axis = np.array([0.0, 0.0, 1.0])
    levels = np.pi * np.arange(1, n // 2) / (n // 2)
    rings = [circle(centre - radius * np.cos(a) * axis, axis, radius * np.sin(a), n) for a in levels]
    corners = np.concatenate([*rings, [centre - radius * axis, centre + radius * axis]])
    m = len(rings)
    faces: list[tuple[int, ...]] = []
    for i in range(m - 1):
        for k in range(n):
            j = (k + 1) % n
            faces.append((i * n + k, i * n + j, (i + 1) * n + j, (i + 1) * n + k))
    for k in range(n):
        j = (k + 1) % n
        faces += [(m * n, j, k), (m * n + 1, (m - 1) * n + k, (m - 1) * n + j)]
    edges = tuple(_closed(circle(centre, direction, radius, n)) for direction in np.eye(3))
    return Surface(corners, tuple(faces), edges)


def _closed(ring: Array) -> Array:
    return np.concatenate([ring, ring[:1]])
