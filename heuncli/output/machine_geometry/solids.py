"""Make surfaces of flat faces, in body axes: of shapes, with round ones approximated, of hulls of points, of meshes.

A fine mesh is simplified for drawing: all corners in one cell of a grid are merged in their centre, and the sharp edges
show the shape. Nothing is computed with the simplified mesh.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.meshes.closure import find_edges
from heuncli.scene.meshes.model import IndexArray, cross_product_rows

ROUND_FACES = 24  # faces about an axis
ROD_RADIUS_RATIO = 0.015  # drawn radius of a rod, of its length
FLAT = 1e-6  # share of the points' extent: less in a direction is none
MAX_HULL_POINTS = 24  # each three of them are tried as a face
MAX_FLIPPED_CELLS = 8.0  # grid cells: maximum length of lines around triangles that simplification turned over
MAX_TRIANGLES = 6000  # drawn triangles of a mesh
INITIAL_CELLS = 64  # grid cells along each axis in the first attempt
# An edge is sharp if the cosine of the angle between its faces is smaller; same in output/web_page/solids.js.
EDGE_COSINE = 0.8


class Surface(NamedTuple):
    """Corners (n, 3), faces as tuples of corner numbers, counter-clockwise from outside, and the edges to be drawn.

    edges: polylines (k, 3), the rims and ridges that show the shape
    convex: whether it is drawn as the hull of its corners; a ring is drawn by its outer rim
    blur [m]: silhouette lines that are shorter are not drawn
    ball: centre and radius of a sphere
    """

    corners: Array
    faces: tuple[tuple[int, ...], ...]
    edges: tuple[Array, ...]
    convex: bool = True
    blur: float = 0.0
    ball: tuple[Vec, float] | None = None


def make_surfaces(shape: Shape, faces: int = ROUND_FACES) -> tuple[Surface, ...]:
    """Make the surfaces of a shape, a round one with so many faces about its axis; a point mass has none."""
    if shape.type == "point":
        return ()
    if shape.type == "box":
        return (_make_box(shape),)
    if shape.type == "mesh":
        return (_make_mesh_surface(shape),)
    if shape.type == "member":
        return (_make_member_surface(shape),)
    if shape.type == "sphere":
        radius = shape.radius or 0.0
        return (
            _make_sphere(_to_array(shape.center), radius, faces)._replace(
                ball=(shape.center or (0.0, 0.0, 0.0), radius)
            ),
        )
    start, end = _to_array(shape.from_), _to_array(shape.to)
    if shape.type == "rod":
        radius = ROD_RADIUS_RATIO * float(np.linalg.norm(end - start))
        return (_make_revolved(start, end, radius, radius, 0.0, faces),)
    first = shape.radius or 0.0
    last = first if shape.to_radius is None else shape.to_radius
    return (_make_revolved(start, end, first, last, shape.inner_radius or 0.0, faces),)


def find_nearest_place(shape: Shape, point: Array) -> tuple[Array, float]:
    """Find the place of a shape nearest to a point, and the distance of the point from the shape; 0: it lies inside.

    The place is on the shape's axis, for a box on its surface, for a sphere or point mass its centre, for a mesh a
    corner. For a mesh the distance is that from its bounding box, so a point on a bore's axis counts as inside.
    """
    if shape.type == "point":
        place = _to_array(shape.at)
        return place, float(np.linalg.norm(point - place))
    if shape.type == "box":
        axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
        half = 0.5 * _to_array(shape.size)
        place = _to_array(shape.center) + axes @ np.clip(axes.T @ (point - _to_array(shape.center)), -half, half)
        return place, float(np.linalg.norm(point - place))
    if shape.type == "mesh":
        corners = compute_mesh_corners(shape)
        place = corners[int(((corners - point) ** 2).sum(axis=1).argmin())]
        outside = np.maximum(np.maximum(corners.min(axis=0) - point, point - corners.max(axis=0)), 0.0)
        return place, float(np.linalg.norm(outside))
    if shape.type == "sphere":
        place = _to_array(shape.center)
        return place, max(0.0, float(np.linalg.norm(point - place)) - (shape.radius or 0.0))
    start, end = _to_array(shape.from_), _to_array(shape.to)
    axis = end - start
    fraction = float((point - start) @ axis / (axis @ axis))
    place = start + min(max(fraction, 0.0), 1.0) * axis
    radial = float(np.linalg.norm(point - start - fraction * axis))
    axial = max(fraction - 1.0, -fraction, 0.0) * float(np.linalg.norm(axis))
    first = shape.radius or 0.0
    if shape.member is not None:
        first = 0.5 * max(max(m.width, m.height) for m in (shape.member.start, shape.member.end))
    last = first if shape.to_radius is None else shape.to_radius
    return place, max(axial, radial - max(first, last))


def _to_array(vector: Vec | None) -> Array:
    return np.array(vector, dtype=np.float64)


def compute_mesh_corners(mesh: Shape) -> Array:
    """Compute the corners of a mesh, (n, 3), in body axes."""
    assert mesh.mesh is not None and mesh.scale is not None
    return np.asarray(_to_array(mesh.at) + (mesh.scale * mesh.mesh.corners) @ np.array(mesh.rotation).T)


def _make_member_surface(shape: Shape) -> Surface:
    """Make a member: its faces, its outlines at both ends, and the edges along it that are not of a fillet."""
    from heuncli.scene.shapes.member_solid import make_member_solid, make_unrounded  # few scenes have them

    assert shape.member is not None
    solid = make_member_solid(make_unrounded(shape.member), _to_array(shape.from_), _to_array(shape.to), 1.0)
    half = len(solid.vertices) // 2
    low, high = solid.vertices[:half], solid.vertices[half:]
    parts = [slice(0, half)] if shape.member.family != "box" else [slice(0, half // 2), slice(half // 2, half)]
    rims = [_close_ring(ring[part]) for ring in (low, high) for part in parts]
    edges = (*rims, *np.stack([low, high], axis=1))
    return Surface(solid.vertices, tuple(map(tuple, solid.triangles.tolist())), edges, convex=False)


def _make_box(shape: Shape) -> Surface:
    """Make a box: six faces and twelve edges."""
    axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
    signs = np.array([[(k & 1) * 2 - 1, (k & 2) - 1, ((k & 4) >> 1) - 1] for k in range(8)], dtype=np.float64)
    corners = _to_array(shape.center) + (signs * 0.5 * _to_array(shape.size)) @ axes.T
    faces = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    edges = tuple(corners[[a, b]] for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4))
    return Surface(corners, faces, edges)


def find_perpendiculars(direction: Array) -> tuple[Array, Array]:
    """Find two unit vectors perpendicular to a unit direction, right-handed with it."""
    axis = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, axis)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)


def make_circle(centre: Array, direction: Array, radius: float, count: int) -> Array:
    """Make points (count, 3) of a circle, counter-clockwise about the direction."""
    u, v = find_perpendiculars(direction)
    angle = 2.0 * np.pi * np.arange(count) / count
    return np.asarray(centre + radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v))


def _make_revolved(start: Array, end: Array, first: float, last: float, inner: float, n: int) -> Surface:
    """Make a cylinder, cone or tube: its wall in flat faces, its ends, its rims and two lines along it."""
    axis = (end - start) / np.linalg.norm(end - start)
    low, high = make_circle(start, axis, first, n), make_circle(end, axis, last, n)
    corners = [low, high]
    faces: list[tuple[int, ...]] = []
    for k in range(n):
        j = (k + 1) % n
        faces.append((k, j, n + j, n + k))
    edges = [_close_ring(low), _close_ring(high), np.array([low[0], high[0]]), np.array([low[n // 2], high[n // 2]])]
    if inner > 0.0:
        inner_low, inner_high = make_circle(start, axis, inner, n), make_circle(end, axis, inner, n)
        corners += [inner_low, inner_high]
        for k in range(n):
            j = (k + 1) % n
            faces.append((2 * n + j, 2 * n + k, 3 * n + k, 3 * n + j))
            faces += [(j, k, 2 * n + k, 2 * n + j), (n + k, n + j, 3 * n + j, 3 * n + k)]
        edges += [_close_ring(inner_low), _close_ring(inner_high)]
    else:
        faces += [tuple(reversed(range(n))), tuple(range(n, 2 * n))]
    return Surface(np.concatenate(corners), tuple(faces), tuple(edges))


def _make_sphere(centre: Array, radius: float, n: int) -> Surface:
    """Make a sphere: rings from pole to pole, and three great circles as edges."""
    axis = np.array([0.0, 0.0, 1.0])
    levels = np.pi * np.arange(1, n // 2) / (n // 2)
    rings = [make_circle(centre - radius * np.cos(a) * axis, axis, radius * np.sin(a), n) for a in levels]
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
    edges = tuple(_close_ring(make_circle(centre, direction, radius, n)) for direction in np.eye(3))
    return Surface(corners, tuple(faces), edges)


def _close_ring(ring: Array) -> Array:
    return np.concatenate([ring, ring[:1]])


def compute_convex_hull(points: Array) -> Array:
    """Compute the corners of the convex hull of points (n, 2), counter-clockwise (Andrew, 1979)."""
    sorted_points = sorted(set(map(tuple, points.tolist())))
    if len(sorted_points) < 3:
        return np.array(sorted_points).reshape(-1, 2)
    halves: list[tuple[float, float]] = []
    for sequence in (sorted_points, sorted_points[::-1]):
        half: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(half) > 1:
                (ax, ay), (bx, by) = half[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                half.pop()
            half.append((x, y))
        halves += half[:-1]
    return np.array(halves)


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


def _make_mesh_surface(shape: Shape) -> Surface:
    """Make the surface of a mesh, simplified if it is fine, with its sharp edges."""

    assert shape.mesh is not None
    corners, triangles = compute_mesh_corners(shape), shape.mesh.triangles
    simple_mesh = simplify_mesh(corners, triangles)
    ends = np.unique(np.sort(simple_mesh.corner_numbers[find_sharp_edges(corners, triangles)], axis=1), axis=0)
    edges = simple_mesh.corners[ends[ends[:, 0] < ends[:, 1]]]
    faces = tuple(map(tuple, simple_mesh.triangles.tolist()))
    return Surface(
        simple_mesh.corners, faces, tuple(edges), convex=False, blur=MAX_FLIPPED_CELLS * simple_mesh.cell_size
    )


class SimplifiedMesh(NamedTuple):
    """The corners and triangles that are drawn.

    corner_numbers: for each corner of the original mesh, the number of its drawn corner
    cell_size: diagonal of a grid cell [m]; 0 if the mesh is not simplified
    """

    corners: Array
    triangles: IndexArray
    corner_numbers: IndexArray
    cell_size: float


def simplify_mesh(corners: Array, triangles: IndexArray, max_triangles: int = MAX_TRIANGLES) -> SimplifiedMesh:
    """Simplify a mesh to at most `max_triangles` triangles, so that it looks alike."""
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    simple_mesh = SimplifiedMesh(corners, triangles, np.arange(len(corners)), 0.0)
    cells = INITIAL_CELLS
    while len(simple_mesh.triangles) > max_triangles and cells > 1:
        cell = np.minimum((corners - low) / np.where(size > 0.0, size, 1.0) * cells, cells - 1).astype(np.int64)
        key = (cell[:, 0] * cells + cell[:, 1]) * cells + cell[:, 2]
        number = np.unique(key, return_inverse=True)[1].reshape(-1)
        centres = np.stack([np.bincount(number, x) for x in corners.T], axis=1) / np.bincount(number)[:, None]
        a, b, c = number[triangles].T
        faces = number[triangles][(a != b) & (b != c) & (c != a)]
        simple_mesh = SimplifiedMesh(centres, faces, number, float(np.sqrt((size * size).sum())) / cells)
        cells = cells * 3 // 4
    return simple_mesh


def find_sharp_edges(corners: Array, triangles: IndexArray) -> IndexArray:
    """Find the edges (k, 2) of a closed mesh, as corner numbers, whose triangles face clearly different directions."""
    p, q, r = corners[triangles.T]
    normals = cross_product_rows(q - p, r - p)
    normals = normals / np.maximum(np.sqrt((normals * normals).sum(axis=1)), np.finfo(float).tiny)[:, None]
    edges = find_edges(triangles)
    first, second = edges.order[edges.starts], edges.order[edges.starts + 1]
    cosines = (normals[first // 3] * normals[second // 3]).sum(axis=1)
    return np.asarray(edges.ends[first[cosines < EDGE_COSINE]])
