"""A member as a solid: the outlines at its two ends, joined by flat faces along it.

The outlines are polygons, with chords for arcs (member_outline.py), each about its own centroid, which lies on the line
from end to end. A tapered member has the measures of both ends and, in between, those that go linearly from one to the
other, so that every face is flat, and its cross-sections are those of the measures there but for a shift of the
centroid.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Indices
from heuncli.scene.file_format.models import Member
from heuncli.scene.file_format.profiles import Family, Measures
from heuncli.scene.shapes.member_outline import RoundedPolygon, make_outline
from heuncli.scene.shapes.polyhedron import Polyhedron
from heuncli.scene.shapes.rotations import cross_vectors
from heuncli.scene.shapes.section_axes import make_first_axis


@record
class MemberSolid(Polyhedron):
    """A member between two points.

    start, axis, length: where it begins, its direction, and how long it is [m]
    first_axis: direction of its width
    family, measures: what it is, at its two ends
    """

    start: Array
    axis: Array
    length: float
    first_axis: Array
    family: Family
    measures: tuple[Measures, Measures]

    def corners(self, n: Array) -> Array:
        """Return where along n the cross-sections change their form: along the member at its ends only."""
        c = float(self.axis @ n)
        if abs(c) < 1.0 - tolerances.PARALLEL:
            return super().corners(n)
        ends = n @ self.start + np.array([0.0, self.length * c])
        return np.sort(ends)

    def find_measures(self, fraction: float) -> Measures:
        """Return the measures at a fraction of the length, 0 to 1."""
        first, last = self.measures
        if first == last:
            return first
        return Measures(*((1.0 - fraction) * a + fraction * b for a, b in zip(first, last, strict=True)))


def make_member_solid(member: Member, start: Array, end: Array, density: float) -> MemberSolid:
    """Make the solid of a member between two points."""
    length = float(np.sqrt((end - start) @ (end - start)))
    axis = (end - start) / length
    e1 = make_first_axis(axis, member.first_axis)
    frame = np.stack([e1, cross_vectors(axis, e1)])
    rings = make_end_polygons(member.family, member.start, member.end)
    corners = [
        place + (ring - _find_centroid(polygons)) @ frame
        for polygons, place in zip(rings, (start, end), strict=True)
        for ring in polygons
    ]
    vertices = np.concatenate(corners)
    sizes = [len(ring) for ring in rings[0]]
    triangles = _join_ends(sizes, rings)
    reach = float(np.abs(vertices).max())
    return MemberSolid(
        vertices=vertices, triangles=triangles, density=density, tolerance=tolerances.SUM_ROUNDING * reach, start=start,
        axis=axis, length=length, first_axis=e1, family=member.family, measures=(member.start, member.end),
    )  # fmt: skip


def make_unrounded(member: Member) -> Member:
    """Make the member without its fillets and roundings, as it is drawn."""
    start, end = (measures._replace(radius=0.0, toe_radius=0.0) for measures in (member.start, member.end))
    return member._replace(start=start, end=end)


def _find_centroid(polygons: list[Array]) -> Array:
    """Find the centroid (2,) of a polygon with its hole."""
    moments = sum((RoundedPolygon(ring, np.zeros(len(ring))).compute_moments() for ring in polygons), np.zeros(6))
    return np.asarray(moments[1:3] / moments[0])


def make_end_polygons(family: Family, first: Measures, last: Measures) -> tuple[list[Array], list[Array]]:
    """Make the polygons at the two ends, corner for corner; an arc at either end, or in the hole, makes chords at
    all.
    """
    outlines = [make_outline(family, m) for m in (first, last)]
    radii = [part.radii for ends in outlines for part in ends]
    rounded = [np.max(radii, axis=0) > 0.0] * len(outlines[0])
    at_first, at_last = ([part.make_polygon(r) for part, r in zip(ends, rounded, strict=True)] for ends in outlines)
    return at_first, at_last


def _join_ends(sizes: list[int], rings: tuple[list[Array], list[Array]]) -> Indices:
    """Join the polygons at the two ends by triangles, (m, 3), counter-clockwise from outside."""
    count = sum(sizes)
    triangles: list[tuple[int, int, int]] = []
    offset = 0
    for size in sizes:
        for k in range(size):
            a, b = offset + k, offset + (k + 1) % size
            triangles += [(a, b, b + count), (a, b + count, a + count)]
        offset += size
    for polygons, base, is_last in ((rings[0], 0, False), (rings[1], count, True)):
        cap = triangulate(polygons[0]) if len(polygons) == 1 else _triangulate_ring(sizes[0])
        triangles += [(base + a, base + b, base + c) if is_last else (base + c, base + b, base + a) for a, b, c in cap]
    return np.array(triangles, dtype=np.intp)


def _triangulate_ring(size: int) -> list[tuple[int, int, int]]:
    """Triangulate the ring between a counter-clockwise polygon and its clockwise hole, corner facing corner."""
    triangles = []
    for k in range(size):
        following = (k + 1) % size
        # the hole begins with the corner that faces the last arc's end
        facing, next_facing = 2 * size - 1 - k, 2 * size - 1 - following
        triangles += [(k, following, next_facing), (k, next_facing, facing)]
    return triangles


def triangulate(polygon: Array) -> list[tuple[int, int, int]]:
    """Triangulate a simple polygon (n, 2), counter-clockwise, by cutting off its ears."""
    remaining = list(range(len(polygon)))
    triangles: list[tuple[int, int, int]] = []
    while len(remaining) > 3:
        ears = ((remaining[i - 1], remaining[i], remaining[(i + 1) % len(remaining)]) for i in range(len(remaining)))
        ear = next(ear for ear in ears if _is_ear(polygon, ear, remaining))
        triangles.append(ear)
        remaining.remove(ear[1])
    triangles.append((remaining[0], remaining[1], remaining[2]))
    return triangles


def _is_ear(polygon: Array, ear: tuple[int, int, int], remaining: list[int]) -> bool:
    """Whether the triangle at a corner turns left and no other corner lies in it."""
    corners = polygon[list(ear)]
    edges = np.roll(corners, -1, axis=0) - corners
    if edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0] < 0.0:
        return False
    others = polygon[[k for k in remaining if k not in ear]]
    arms = others[:, None] - corners
    sides = edges[:, 0] * arms[..., 1] - edges[:, 1] * arms[..., 0]
    is_corner = (arms == 0.0).all(axis=2).any(axis=1)
    return not ((sides >= 0.0).all(axis=1) & ~is_corner).any()
