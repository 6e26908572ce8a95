"""Check that triangles of a closed surface do not cross each other by more than the digits of its file.

Two surfaces cross where an edge of one emerges behind a triangle of the other, or where they overlap along faces of one
plane that have the same orientation (with opposite orientations they touch, as two bodies that stand on each other). A
corner in the plane counts as before it: a corner that stands on a face touches, and an edge that continues from there
behind the face crosses.

    u = 2^-24 max |x|    what rounding to float32 moves a coordinate by, so a corner by sqrt(3) u
    near = 8 u           more than the overlap of two surfaces whose corners were rounded twice, 4 sqrt(3) u
An overlap no deeper than near (`tolerance` below) is rounding, and counts as touching. A crossing at the rim of a
triangle within near may be due to rounding, or only touch, as edges that lie across each other. Whether it is real is
decided where every face is moved inward by near/2 (`move_faces_inward`): then faces that touched are separate, and
anything deeper by 3 near, a needle by 6, still crosses. The planes of triangles that are narrow against near are
rotated by rounding: they are not used, but their edges are.

Pairs that may cross are those of overlapping boxes, found down a tree of boxes, all pairs of a level at once. Boxes are
sorted along a space-filling curve (Morton, 1966), and groups of them are put into larger ones. A pair of nodes whose
boxes overlap is followed to the pairs of their members. The members of nodes are stored in columns (the first of each
node, the second of each and so on), so that all pairs are tested in one coordinate at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.scene.meshes.formats import mesh_file_finding
from heuncli.scene.meshes.model import (
    IndexArray,
    connected_components,
    cross_columns,
    dot_columns,
    gather_corners,
    move_faces_inward,
    stable_order,
)

# Boxes

BITS_PER_AXIS = 10  # bits of the curve for each axis
SPREAD_MASKS = ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249))  # put two zero bits between bits
MAX_PAIRS = 40_000_000
MEMBERS_PER_NODE = 4  # boxes in a node
MAX_PAIRS_AT_ONCE = 1 << 13  # pairs of nodes handled together: their data fits in the cache


class BoxLevel(NamedTuple):
    """The members of the nodes of a level: the corners of their boxes (3, MEMBERS_PER_NODE, nodes)."""

    low: Array
    high: Array


def iter_overlapping(low: Array, high: Array) -> Iterator[tuple[IndexArray, IndexArray]]:
    """Yield the pairs of boxes (3, n) that touch or overlap, each once, some at a time. Raises Finding if they are too
    many.

    It is faster if boxes that are adjacent in order are close in space, as after `sort_along_curve`.
    """
    levels = build_levels(low, high)
    total = 0
    pending = [(len(levels) - 1, np.zeros(1, np.intp), np.zeros(1, np.intp))]
    while pending:
        level, a, b = pending.pop()
        if level < 0:
            total += len(a)
            if total > MAX_PAIRS:
                message = "its triangles overlap too much to check whether they intersect each other"
                raise Finding("too-large", message, "use a mesh with shorter triangles")
            yield a, b
            continue
        for i in range(0, len(a), MAX_PAIRS_AT_ONCE):
            pending.append(
                (
                    level - 1,
                    *find_member_pairs(
                        levels[level], a[i : i + MAX_PAIRS_AT_ONCE], b[i : i + MAX_PAIRS_AT_ONCE], level == 0
                    ),
                )
            )


def build_levels(low: Array, high: Array) -> list[BoxLevel]:
    """Build the levels from that of the boxes (3, n) up to a single node."""
    levels: list[BoxLevel] = []
    while not levels or low.shape[1] > 1:
        missing = -low.shape[1] % MEMBERS_PER_NODE
        ends = [np.pad(x, ((0, 0), (0, missing)), constant_values=e) for x, e in ((low, np.inf), (high, -np.inf))]
        level = BoxLevel(*(np.ascontiguousarray(x.reshape(3, -1, MEMBERS_PER_NODE).transpose(0, 2, 1)) for x in ends))
        levels.append(level)
        low, high = level.low.min(axis=1), level.high.max(axis=1)
    return levels


def find_member_pairs(level: BoxLevel, a: IndexArray, b: IndexArray, is_last: bool) -> tuple[IndexArray, IndexArray]:
    """Find the overlapping pairs of members of pairs of nodes, each once; at the last level no pair of a box with
    itself.
    """
    overlaps = np.ones((MEMBERS_PER_NODE, MEMBERS_PER_NODE, len(a)), dtype=bool)
    for low, high in zip(level.low, level.high, strict=True):
        bounds_a, bounds_b = (low.take(a, axis=1), high.take(a, axis=1)), (low.take(b, axis=1), high.take(b, axis=1))
        overlaps &= bounds_a[0][:, None] <= bounds_b[1]
        overlaps &= bounds_b[0] <= bounds_a[1][:, None]
    other_nodes = a != b
    one, other = [], []
    for i in range(MEMBERS_PER_NODE):
        for j in range(MEMBERS_PER_NODE):
            if j < i or (is_last and i == j):
                overlaps[i, j] &= other_nodes
            selected = np.flatnonzero(overlaps[i, j])
            one.append(MEMBERS_PER_NODE * a[selected] + i)
            other.append(MEMBERS_PER_NODE * b[selected] + j)
    return np.concatenate(one), np.concatenate(other)


def sort_along_curve(points: Array) -> IndexArray:
    """Return the order of points (3, n) along a space-filling curve, on which close points follow each other."""
    low, size = points.min(axis=1, keepdims=True), float(np.ptp(points, axis=1).max()) or 1.0
    cell = ((points - low) * ((2**BITS_PER_AXIS - 1) / size)).astype(np.int64)
    for shift, mask in SPREAD_MASKS:
        cell = (cell | (cell << shift)) & mask
    return stable_order(cell[0] | (cell[1] << 1) | (cell[2] << 2))


# Crossings

JOIN_HINT = "merge its solids in the CAD program, or give each solid its own file"
EDGE_CORNERS = ((0, 1), (1, 2), (2, 0))
# corners of the edges, in both directions
EDGE_BEGINS, EDGE_ENDS = (np.array([0, 1, 2, 1, 2, 0]), np.array([1, 2, 0, 0, 1, 2]))
NARROW_RATIO = 8.0  # times the tolerance: rounding rotates narrower triangles by 1/16 rad and more
JOINING_RATIO = 64.0  # times the tolerance: such triangles are almost lines, so edges that end there end at neighbours
MAX_NARROW_SHARE = 1e-4  # largest share of the area in triangles whose planes are not used
COMPUTING_ERROR = 1e-9  # of the tolerance: computing error in the distance of shared rims


class TriangleFaces(NamedTuple):
    """Triangles, all in columns.

    places: (3, 3, m) of their corners
    normals: (3, m) unit normals
    offsets: (m,) heights of their planes over the origin
    corners: (3, m) corner numbers
    joined_corners: (3, m) the same number for corners that are one, or joined by triangles with almost no width
    double_areas: (m,) twice their areas
    is_narrow: (m,) which are too narrow for their planes to be used
    has_joined_corners: whether any corners are joined
    """

    places: Array
    normals: Array
    offsets: Array
    corners: IndexArray
    joined_corners: IndexArray
    double_areas: Array
    is_narrow: Mask
    has_joined_corners: bool


def require_no_crossing(corners: Array, triangles: IndexArray, tolerance: float) -> None:
    """Raise Finding if triangles (m, 3) cross deeper than the tolerance; each fan of triangles needs corners of its
    own.
    """
    rotated = gather_corners(corners @ principal_axes(corners), triangles)  # so boxes along long bodies are narrow
    order = sort_along_curve(rotated.sum(axis=0))  # triangles that meet are close in memory
    triangles, rotated = triangles[order], rotated[..., order]
    faces = make_faces(corners, triangles, tolerance)
    if faces.double_areas[faces.is_narrow].sum() > MAX_NARROW_SHARE * faces.double_areas.sum():
        message = (
            "too many of its triangles are narrower than its digits resolve, so self-intersection cannot be checked"
        )
        raise mesh_file_finding(message, "export it near its origin and not finer than needed")
    pairs = [
        _find_suspects(faces, a, b, tolerance) for a, b in iter_overlapping(rotated.min(axis=0), rotated.max(axis=0))
    ]
    a, b = (np.concatenate([pair[i] for pair in pairs] or [np.empty(0, np.intp)]) for i in (0, 1))
    if not len(a):
        return
    inner = make_faces(
        move_faces_inward(corners, triangles, faces.normals.T, ~faces.is_narrow, 0.5 * tolerance), triangles, tolerance
    )
    is_crossing = _do_overlap(faces, a, b, tolerance)
    for one, other in ((a, b), (b, a)):
        is_crossing |= _is_pierced(faces, one, other, tolerance, tolerance) & _is_pierced(
            inner, one, other, 0.0, COMPUTING_ERROR * tolerance
        )
    if is_crossing.any():
        place_text = ", ".join(f"{x:.6g}" for x in faces.places[:, :, a[is_crossing][0]].mean(axis=0))
        count = int(is_crossing.sum())
        count_text = f"{count} pairs of triangles intersect" if count > 1 else "2 triangles intersect"
        message = (
            f"the surface intersects itself: {count_text} each other, first at about ({place_text}) in the file's units"
        )
        raise Finding("mesh-crosses-itself", message, JOIN_HINT)


def make_faces(corners: Array, triangles: IndexArray, tolerance: float) -> TriangleFaces:
    """Make the triangles with their planes."""
    places, numbers = gather_corners(corners, triangles), np.ascontiguousarray(triangles.T)
    edges = [places[j] - places[i] for i, j in EDGE_CORNERS]
    normals = cross_columns(edges[0], edges[1])
    double = np.sqrt(dot_columns(normals, normals))
    longest = np.sqrt(np.maximum.reduce([dot_columns(edge, edge) for edge in edges]))
    narrow = double <= NARROW_RATIO * tolerance * longest
    normals /= np.where(double > 0.0, double, 1.0)
    a, b, c = numbers[:, double <= JOINING_RATIO * tolerance * longest]
    joined = connected_components(len(corners), np.append(a, b), np.append(b, c))
    joins = bool((joined != np.arange(len(corners))).any())
    return TriangleFaces(
        places, normals, dot_columns(normals, places[0]), numbers, joined[numbers], double, narrow, joins
    )


def principal_axes(corners: Array) -> Array:
    """Return the axes (3, 3), in columns, along which the corners are spread least to most."""
    offsets = corners - corners.mean(axis=0)
    return np.asarray(np.linalg.eigh(offsets.T @ offsets)[1])


def _find_suspects(
    faces: TriangleFaces, a: IndexArray, b: IndexArray, tolerance: float
) -> tuple[IndexArray, IndexArray]:
    """Return the pairs that cross, or seem to at a rim."""
    a, b = _find_possible_crossings(faces, a, b, tolerance)
    is_suspect = (
        _is_pierced(faces, a, b, tolerance, tolerance)
        | _is_pierced(faces, b, a, tolerance, tolerance)
        | _do_overlap(faces, a, b, tolerance)
    )
    return a[is_suspect], b[is_suspect]


def _find_possible_crossings(
    faces: TriangleFaces, a: IndexArray, b: IndexArray, tolerance: float
) -> tuple[IndexArray, IndexArray]:
    """Return the pairs of which one may go behind the other, or that lie in one plane; none that share an edge."""
    corners_a, corners_b = faces.corners.take(a, axis=1), faces.corners.take(b, axis=1)
    others = 3 - _count_true(corners_a[i] == corners_b[j] for i in range(3) for j in range(3))
    selected = np.flatnonzero(others > 1)
    a, b, others, may_cross = a[selected], b[selected], others[selected], np.zeros(len(selected), dtype=bool)
    for _ in range(2):
        h = _corner_heights(faces, a, b)  # a shared corner is neither above nor below
        above, below = (_count_true(sides) for sides in (h > tolerance, h < -tolerance))
        has_plane = ~faces.is_narrow[b]
        may_cross |= ((below > 0) & (below < others) & has_plane) | ((above == 0) & (below == 0))
        selected = np.flatnonzero(((above < others) & (below < others)) | ~has_plane)
        a, b, others, may_cross = b[selected], a[selected], others[selected], may_cross[selected]
    return a[may_cross], b[may_cross]


def _count_true(masks: Iterable[Mask]) -> NDArray[np.int8]:
    """Count how many of some masks are true, elementwise."""
    return np.asarray(sum(mask.view(np.int8) for mask in masks))


def _corner_heights(faces: TriangleFaces, triangles: IndexArray, planes: IndexArray) -> Array:
    """Compute the heights of the corners of triangles over the planes of others, (3, k)."""
    normals, offsets = faces.normals.take(planes, axis=1), faces.offsets.take(planes)
    return np.stack([dot_columns(corner.take(triangles, axis=1), normals) - offsets for corner in faces.places])


def _is_pierced(faces: TriangleFaces, a: IndexArray, b: IndexArray, tolerance: float, rim_width: float) -> Mask:
    """Return whether an edge of a emerges behind b, inside it or up to `rim_width` outside its rim.

    The edge may start on b, but not at a corner that is one with a corner of b, or joined to it; nor may both ends be
    there.
    """
    own_corners = (faces.corners.take(a, axis=1)[:, None] == faces.corners.take(b, axis=1)).any(axis=1)
    h = np.where(own_corners, 0.0, _corner_heights(faces, a, b))
    behind, before = h < -tolerance, (h >= -tolerance) & ~faces.is_narrow[b]
    edge, pair = np.nonzero(before[EDGE_BEGINS] & behind[EDGE_ENDS])
    i, j = EDGE_BEGINS[edge], EDGE_ENDS[edge]
    to_check = np.flatnonzero((h[i, pair] <= tolerance) | faces.has_joined_corners)
    is_joined = [_is_joined(faces, a[pair[to_check]], k[to_check], b[pair[to_check]]) for k in (i, j)]
    is_free = np.ones(len(pair), dtype=bool)
    is_free[to_check] = ~(is_joined[0] & (is_joined[1] | (h[i[to_check], pair[to_check]] <= tolerance)))
    pair, i, j = pair[is_free], i[is_free], j[is_free]
    p, q, above = faces.places[i, :, a[pair]].T, faces.places[j, :, a[pair]].T, np.maximum(h[i, pair], 0.0)
    point = p + above / (above - h[j, pair]) * (q - p)
    is_crossing = np.zeros(len(a), dtype=bool)
    is_crossing[pair[_find_inside(faces, point, b[pair], rim_width)]] = True
    return is_crossing


def _is_joined(faces: TriangleFaces, a: IndexArray, corner: IndexArray, b: IndexArray) -> Mask:
    """Return whether any corner of a coincides with, or is joined to, a corner of b."""
    return np.asarray((faces.joined_corners[corner, a] == faces.joined_corners.take(b, axis=1)).any(axis=0))


def _find_inside(faces: TriangleFaces, points: Array, b: IndexArray, rim_width: float) -> IndexArray:
    """Return which of points (3, k) in the planes of triangles lie in them, or at most `rim_width` outside."""
    found = np.arange(len(b))
    for i, j in EDGE_CORNERS:
        first, normals = faces.places[i].take(b, axis=1), faces.normals.take(b, axis=1)
        edge = faces.places[j].take(b, axis=1) - first
        inward = dot_columns(cross_columns(normals, edge), points - first)
        selected = np.flatnonzero(inward >= -rim_width * np.sqrt(dot_columns(edge, edge)))
        found, points, b = found[selected], points.take(selected, axis=1), b[selected]
    return found


def _do_overlap(faces: TriangleFaces, a: IndexArray, b: IndexArray, tolerance: float) -> Mask:
    """Return whether two triangles of one plane and the same orientation have an area in common."""
    selected = np.flatnonzero(dot_columns(faces.normals.take(a, axis=1), faces.normals.take(b, axis=1)) > 0.0)
    selected = selected[np.abs(_corner_heights(faces, a[selected], b[selected])).max(axis=0) <= tolerance]
    selected = selected[~(faces.is_narrow[a[selected]] | faces.is_narrow[b[selected]])]
    for one, other in ((a, b), (b, a)):  # no edge of either separates them
        for i, j in EDGE_CORNERS:
            first, normals = faces.places[i].take(one[selected], axis=1), faces.normals.take(one[selected], axis=1)
            edge = faces.places[j].take(one[selected], axis=1) - first
            length = np.sqrt(dot_columns(edge, edge))
            inward = cross_columns(normals, edge) / np.where(length > 0.0, length, 1.0)
            reach = [dot_columns(corner.take(other[selected], axis=1) - first, inward) for corner in faces.places]
            selected = selected[np.maximum.reduce(reach) > tolerance]
    is_overlapping = np.zeros(len(a), dtype=bool)
    is_overlapping[selected] = True
    return is_overlapping
