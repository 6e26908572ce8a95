"""Make triangles a closed surface: merge their corners, check that it is closed, find its inside, count its shells.

Closed means that every edge is used once in each direction. Then each shell has an inside, of positive volume if its
triangles are counter-clockwise from outside. A shell that lies in no other bounds material; one that lies in another is
a hole. The number of times that a shell encloses a point is its solid angle there over 4 pi (van Oosterom, Strackee,
1983).

Corners of equal coordinates are merged first, then those closer than the digits of a float32: STL gives every triangle
corners of its own. If programs round them twice, they differ in the last digit.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.formats import mesh_file_finding
from heuncli.scene.meshes.model import (
    IndexArray,
    TriangleSoup,
    connected_components,
    cross_product_rows,
    max_of_three,
    min_of_three,
    number_components,
    stable_order,
)

# Closure

MAX_SOLID_ANGLES = 50_000_000  # most solid angles computed to find which shell lies in which
TRIED_TRIANGLES = (
    8  # triangles of a shell, the largest first, whose middles are tried as places clear of the other shells
)
MAX_WINDING_ERROR = (
    0.1  # deviation of the winding number from a whole one, below which a place is clear of the other shell's faces
)
REPAIR_HINT = "repair it in the CAD program, or export the solid with a finer tolerance"
ONE_SOLID_HINT = "export the solid alone, as one body; give touching solids as separate shapes"
OUTWARD_HINT = "recalculate its normals outward in the CAD program"


class MeshEdges(NamedTuple):
    """The edges of triangles, three for each.

    ends: (3 m, 2) corners, in the direction of the edge
    order: edges sorted so that those with the same ends are adjacent
    starts, counts: where in `order` each distinct edge begins, and how often it occurs
    """

    ends: IndexArray
    order: IndexArray
    starts: IndexArray
    counts: IndexArray


def find_edges(triangles: IndexArray) -> MeshEdges:
    """Find the edges; edge 3 k + i of triangle k runs from its corner i to the next."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = np.minimum(ends[:, 0], ends[:, 1]), np.maximum(ends[:, 0], ends[:, 1])
    key = low * (int(triangles.max(initial=0)) + 1) + high
    order = stable_order(key)
    ordered = key[order]
    starts = np.flatnonzero(np.append(True, ordered[1:] != ordered[:-1])) if len(key) else np.empty(0, np.intp)
    return MeshEdges(ends, order, starts, np.diff(np.append(starts, len(key))))


def find_open_corners(edges: MeshEdges) -> IndexArray:
    """Return the corners of edges that belong to only one triangle."""
    return np.unique(edges.ends[edges.order[edges.starts[edges.counts == 1]]])


def find_edge_neighbours(soup: TriangleSoup, edges: MeshEdges) -> tuple[IndexArray, IndexArray]:
    """Find the two triangles of each edge. Raises Finding for open edges, more than two triangles, or opposite
    orientations.
    """
    single = edges.counts == 1
    if single.any():
        wrong_edges = edges.order[edges.starts[single]]
        message = (
            f"{_format_edge_count(len(wrong_edges))} open, "
            f"{_format_hole_count(edges.ends[wrong_edges], len(soup.corners))}"
        )
        raise Finding(
            "open-mesh",
            f"the surface is not closed: {message}: {_format_first_edge(soup, edges.ends[wrong_edges[0]])}",
            REPAIR_HINT,
        )
    is_shared = edges.counts > 2
    if is_shared.any():
        wrong_edges = edges.order[edges.starts[is_shared]]
        message = (
            f"{_format_edge_count(len(wrong_edges))} shared by more than two triangles: "
            f"{_format_first_edge(soup, edges.ends[wrong_edges[0]])}"
        )
        raise Finding("mesh-crosses-itself", f"the surface touches itself: {message}", ONE_SOLID_HINT)
    one, other = edges.order[edges.starts], edges.order[edges.starts + 1]
    same_direction = edges.ends[one, 0] == edges.ends[other, 0]
    if same_direction.any():
        wrong_edges = one[same_direction]
        message = (
            f"at {_format_edge_count(len(wrong_edges), plain=True)} the adjacent triangles have opposite orientation: "
        )
        raise Finding("mesh-orientation", message + _format_first_edge(soup, edges.ends[wrong_edges[0]]), OUTWARD_HINT)
    return one // 3, other // 3


def _format_edge_count(count: int, plain: bool = False) -> str:
    if plain:
        return f"{count} edge{'s' if count > 1 else ''}"
    return f"{count} edges are" if count > 1 else "1 edge is"


def _format_hole_count(ends: IndexArray, corners: int) -> str:
    first = connected_components(corners, ends[:, 0], ends[:, 1])
    holes = len(np.unique(first[ends[:, 0]]))
    return f"around {holes} hole{'s' if holes > 1 else ''}"


def _format_first_edge(soup: TriangleSoup, ends: IndexArray) -> str:
    one, other = (f"({', '.join(f'{x:.6g}' for x in soup.corners[end])})" for end in ends)
    return f"the first from {one} to {other} in the file's units"


class MeshShells(NamedTuple):
    """The shells of a surface.

    number: (m,) for each triangle its shell, from 0
    volumes: (s,) of each shell
    triangles: oriented so that all face outward
    is_reversed: whether they were reversed for that
    """

    number: IndexArray
    volumes: Array
    triangles: IndexArray
    is_reversed: bool


def find_shells(
    soup: TriangleSoup, edge_neighbours: tuple[IndexArray, IndexArray], tetrahedron_volumes: Array
) -> MeshShells:
    """Find the shells of a surface that does not cross itself. Raises Finding [mesh-orientation].

    edge_neighbours: the two triangles of each edge
    tetrahedron_volumes: (m,) of the tetrahedra between the triangles and the middle of the surface
    """
    number = number_components(connected_components(len(soup.triangles), *edge_neighbours))[1]
    volumes: Array = np.asarray(np.bincount(number, tetrahedron_volumes), dtype=np.float64)
    total_volume = float(volumes.sum())
    size = (0.5 * float(np.ptp(soup.corners, axis=0).max())) ** 3
    if not abs(total_volume) > size * np.finfo(float).eps * 64.0:
        raise Finding(
            "mesh-orientation", "the surface encloses no volume", "check whether the mesh is flat; a solid is needed"
        )
    if len(volumes) == 1:
        is_reversed = total_volume < 0.0
    else:
        is_reversed = _are_inward(soup, number, volumes)
    triangles: IndexArray = soup.triangles[:, [0, 2, 1]] if is_reversed else soup.triangles
    return MeshShells(number, -volumes if is_reversed else volumes, triangles, is_reversed)


def _are_inward(soup: TriangleSoup, number: IndexArray, volumes: Array) -> bool:
    """Return whether all shells are inside out. Raises Finding if only some are."""
    order = np.argsort(number, kind="stable")
    starts = np.searchsorted(number[order], np.arange(len(volumes)))
    triangles_by_shell = np.split(order, starts[1:])
    places = soup.corners[soup.triangles]
    low = np.minimum.reduceat(min_of_three(places)[order], starts)
    high = np.maximum.reduceat(max_of_three(places)[order], starts)
    outer, wrong = [], []
    for k, enclosing_count in enumerate(_count_enclosing(places, triangles_by_shell, low, high)):
        if enclosing_count == 0:
            outer.append(k)
        wrong.append((volumes[k] > 0.0) == (enclosing_count % 2 == 0))
    sign = volumes[outer[0]] < 0.0 if outer else False
    bad = [k for k, orientation in enumerate(wrong) if orientation == sign]
    if bad:
        where = ", ".join(f"{x:.6g}" for x in 0.5 * (low[bad[0]] + high[bad[0]]))
        message = f"{len(bad)} of {len(volumes)} shells are inside out for their location, one at about ({where})"
        hint = f"the normals of a cavity point into the cavity, a solid within another counts twice; {OUTWARD_HINT}"
        raise Finding("mesh-orientation", message, hint)
    return bool(sign)


def _count_enclosing(places: Array, triangles_by_shell: list[IndexArray], low: Array, high: Array) -> Iterator[int]:
    """Yield for each shell the number of other shells in which it lies."""
    angles = 0
    for k, triangles in enumerate(triangles_by_shell):
        may_enclose = ((low <= low[k]) & (high >= high[k])).all(axis=1)
        may_enclose[k] = False
        others = [triangles_by_shell[j] for j in np.flatnonzero(may_enclose).tolist()]
        angles += sum(map(len, others))
        if angles > MAX_SOLID_ANGLES:
            raise Finding(
                "too-large",
                f"{len(triangles_by_shell)} shells within each other are too many to tell apart",
                "use one file for each solid",
            )
        yield sum(_lies_in_shell(places[triangles], places[other]) for other in others)


def _lies_in_shell(shell: Array, other: Array) -> bool:
    """Return whether a shell (m, 3, 3) lies in another that it does not cross, by a place on it that is clear of the
    other.
    """
    normals = cross_product_rows(shell[:, 1] - shell[:, 0], shell[:, 2] - shell[:, 0])
    largest = np.argsort(-(normals**2).sum(axis=1), kind="stable")[:TRIED_TRIANGLES]
    windings = 0.0
    for middle in shell[largest].mean(axis=1):
        windings = abs(winding_number(other - middle))
        if abs(windings - round(windings)) < MAX_WINDING_ERROR:
            break
    return windings > 0.5 + MAX_WINDING_ERROR


def winding_number(places: Array) -> float:
    """Compute how often triangles (m, 3, 3) enclose the origin: their solid angles over 4 pi."""
    a, b, c = places.transpose(1, 0, 2)
    la, lb, lc = (np.sqrt((x * x).sum(axis=1)) for x in (a, b, c))
    triple_product = (a * cross_product_rows(b, c)).sum(axis=1)
    denominator = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    return float(np.arctan2(triple_product, denominator).sum() / (2.0 * np.pi))


# Welding

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
