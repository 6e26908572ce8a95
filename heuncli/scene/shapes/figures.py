"""Find the figures in which planes cut the single shapes of a body, if they are round, or rectangles along e1 and e2.

Beam theory assumes cuts perpendicular to the bar: then a cylinder, tube or cone shows a circle or ring, a box a
rectangle, and a sphere always a circle. For an oblique cut the result only says whether the plane meets the shape, and
why the figure is unknown.

A body of triangles is cut in polygons with holes; their properties follow from Green's theorem:

    A = sum c/2     Sx = sum (x + x') c/6     Ixx = sum (x x + x x' + x' x') c/12     c = x y' - x' y
over the edges from (x, y) to (x', y') with the inside to their left; higher ones likewise. About the centroid I1 = Iyy,
I2 = Ixx, I12 = Ixy; e1 and e2 are principal where I12 = 0. Torsion, by a stress function of the distance to the edge
whose slope is A(t)/L(t) (t the distance, A(t) and L(t) of the region farther inside; Makai, 1959; Polya, 1960):

    J >= 4 int A(t)^2/L(t) dt >= 4 A^3/(3 L^2),   L the length of all edges
if there are no more holes than parts, for then L(t) <= L; for thin walls this is J itself, for a circle two thirds of
it. Where there are more holes, L(t) <= L + 2 pi (holes - parts) rho, rho <= sqrt(A/pi) the radius of a circle that fits
in. A closed thin wall counts as one that is slit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.profiles import Family, Measures
from heuncli.scene.shapes.box import Box
from heuncli.scene.shapes.frustum import Frustum
from heuncli.scene.shapes.member_solid import MemberSolid
from heuncli.scene.shapes.outlines import intersection_lines, number_loops
from heuncli.scene.shapes.polyhedron import LocalSurface, Polyhedron
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.scene.shapes.solids import Ball, PointMass, Rod, Solid

# Figure kinds

Flags = NDArray[np.bool_]


@record
class CuttingPlanes:
    """Planes n.x = d (k,), with e1 in them.

    shifted_d: (k,) offsets slightly before or behind each plane, which decide what the plane meets
    """

    n: Array
    e1: Array
    d: Array
    shifted_d: Array


@record
class RoundFigure:
    """Circles or rings where planes meet a shape (is_met): centres (k, 3), outer and inner radii (k,) [m]."""

    is_met: Flags
    center: Array
    outer: Array
    inner: Array


@record
class RectangleFigure:
    """Rectangles of one size with sides along e1 (width) and e2 (height) [m], centres (k, 3)."""

    is_met: Flags
    center: Array
    width: float
    height: float


@record
class MemberFigure:
    """Cross-sections of a member.

    measures: of each that is met, by plane number
    frame (2, 2): components along e1 and e2 (rows) of the member's width and height axes (columns)
    """

    is_met: Flags
    family: Family
    measures: Mapping[int, Measures]
    frame: Array


@record
class UnknownFigure:
    """Figures of no other kind, and the reason."""

    is_met: Flags
    reason: str


@record
class ProfileFigure:
    """Figures of any outline.

    values: their properties (k,) by name
    missing: by plane number, why the properties of a figure are not known
    """

    is_met: Flags
    values: Mapping[str, Array]
    missing: Mapping[int, str]


Figure = RoundFigure | RectangleFigure | MemberFigure | ProfileFigure | UnknownFigure


# Figures


def find_figure(part: Solid, planes: CuttingPlanes) -> Figure | None:
    """Find the figure of a shape; None if the shape has no thickness."""
    if isinstance(part, Frustum):
        return find_frustum_figure(part, planes)
    if isinstance(part, Box):
        return find_box_figure(part, planes)
    if isinstance(part, Ball):
        h = planes.d - planes.n @ part.center
        radius = np.sqrt(np.maximum((part.radius - h) * (part.radius + h), 0.0))
        is_met = np.abs(planes.shifted_d - planes.n @ part.center) < part.radius
        return RoundFigure(is_met, part.center + h[:, None] * planes.n, radius, np.zeros_like(radius))
    if isinstance(part, PointMass | Rod):
        return None
    if isinstance(part, MemberSolid):
        return find_member_figure(part, planes)
    return find_profile_figure(part, planes)


def find_frustum_figure(part: Frustum, planes: CuttingPlanes) -> Figure:
    """Find the figure of a cylinder, tube or cone."""
    if not are_parallel(part.axis, planes.n):
        low, high = part.extent(planes.n)
        return UnknownFigure(
            (low < planes.shifted_d) & (planes.shifted_d < high), "a cylinder, tube or cone is cut obliquely"
        )
    c = float(part.axis @ planes.n)
    z, shifted_z = ((d - planes.n @ part.start) / c for d in (planes.d, planes.shifted_d))
    r, q = part.radii(np.clip(z, 0.0, part.length))
    return RoundFigure((shifted_z > 0.0) & (shifted_z < part.length), part.start + z[:, None] * part.axis, r, q)


def find_box_figure(part: Box, planes: CuttingPlanes) -> Figure:
    """Find the figure of a box, with sides along e1 and e2."""
    i = int(np.argmax(np.abs(part.axes.T @ planes.n)))
    h = planes.d - planes.n @ part.center
    if not are_parallel(part.axes[:, i], planes.n):
        low, high = part.extent(planes.n)
        return UnknownFigure((low < planes.shifted_d) & (planes.shifted_d < high), "a box is cut obliquely")
    is_met = np.abs(planes.shifted_d - planes.n @ part.center) < part.half_size[i]
    parallel_axes = [j for j in range(3) if j != i and are_parallel(part.axes[:, j], planes.e1)]
    if not parallel_axes:
        side = ", ".join(f"{x:.6g}" for x in (part.axes[:, (i + 1) % 3] + 0.0).tolist())
        return UnknownFigure(is_met, f"e1 is not parallel to a side of the box (use first_axis: [{side}])")
    width, height = (2.0 * float(part.half_size[j]) for j in (parallel_axes[0], 3 - i - parallel_axes[0]))
    return RectangleFigure(is_met, part.center + h[:, None] * planes.n, width, height)


def find_member_figure(part: MemberSolid, planes: CuttingPlanes) -> Figure:
    """Find the cross-section of a member cut square to it."""
    low, high = part.extent(planes.n)
    is_met = (low < planes.shifted_d) & (planes.shifted_d < high)
    if not are_parallel(part.axis, planes.n):
        return UnknownFigure(is_met, "a member is cut obliquely")
    fraction = (planes.d - planes.n @ part.start) / (float(part.axis @ planes.n) * part.length)
    measures = {int(k): part.find_measures(min(max(float(fraction[k]), 0.0), 1.0)) for k in np.flatnonzero(is_met)}
    axes = np.stack([part.first_axis, cross_rows(part.axis, part.first_axis)])
    frame = np.stack([planes.e1, cross_rows(planes.n, planes.e1)]) @ axes.T
    return MemberFigure(is_met, part.family, measures, frame)


def are_parallel(a: Array, b: Array) -> bool:
    """Return whether two unit vectors are parallel, or opposite."""
    cross_product = cross_rows(a, b)
    return float(np.sqrt(cross_product @ cross_product)) <= tolerances.PARALLEL


# Profiles


@record
class OutlineEdges:
    """Edges of outlines, from p (q, 2) to q (q, 2) along e1 and e2, with the numbers of their plane and closed line."""

    p: Array
    q: Array
    plane: Indices
    line: Indices

    def compute_moments(self, centers: Array) -> Array:
        """Compute A, Sx, Sy, Ixx, Ixy, Iyy, and the third moments xxx, xxy, xyy, yyy about points (k, 2) of the planes,
        (10, k).
        """
        (x, y), (u, v) = (self.p - centers[self.plane]).T, (self.q - centers[self.plane]).T
        c = x * v - u * y
        terms = (
            0.5 * c,
            (x + u) * c / 6.0,
            (y + v) * c / 6.0,
            (x * x + x * u + u * u) * c / 12.0,
            (2.0 * (x * y + u * v) + x * v + u * y) * c / 24.0,
            (y * y + y * v + v * v) * c / 12.0,
            triple_product_integral(x, u, x, u, x, u) * c,
            triple_product_integral(x, u, x, u, y, v) * c,
            triple_product_integral(x, u, y, v, y, v) * c,
            triple_product_integral(y, v, y, v, y, v) * c,
        )
        return np.array([np.bincount(self.plane, term, len(centers)) for term in terms])


def triple_product_integral(a: Array, b: Array, c: Array, d: Array, e: Array, f: Array) -> Array:
    """Integrate the product of three linear functions over the triangle between an edge and the origin, divided by
    twice its area.

    They are 0 at the origin, and a and b, c and d, e and f at the edge's ends.
    """
    A, C, E = a + b, c + d, e + f
    pairs = A * (c * e + d * f) + C * (a * e + b * f) + E * (a * c + b * d)
    return np.asarray((A * C * E + pairs + 2.0 * (a * c * e + b * d * f)) / 120.0)


def find_profile_figure(part: object, planes: CuttingPlanes) -> ProfileFigure | None:
    """Find the outlines in which planes cut a body of triangles; None for another body."""
    if not isinstance(part, Polyhedron):
        return None
    local = part.localize(planes.n, planes.shifted_d, planes.e1)
    k = len(planes.shifted_d)
    low, high = part.extent(planes.n)
    # corners scatter by less
    is_met = (low + 0.5 * part.tolerance < planes.shifted_d) & (planes.shifted_d < high - 0.5 * part.tolerance)
    rows = np.full((6, k), np.nan)
    missing: dict[int, str] = {}
    for edges in iter_edges(part, local):
        inside = np.zeros(k, dtype=bool)
        inside[np.unique(edges.plane)] = True
        found, reasons = profile_properties(edges, k, inside & is_met[local.order], part.tolerance, local)
        plane_numbers = local.order[inside]
        rows[:, plane_numbers] = found[:, inside]
        missing |= {int(local.order[i]): reason for i, reason in reasons.items()}
    names = ("area", "I1", "I2", "J", "c1", "c2")
    return ProfileFigure(is_met & np.isfinite(rows[0]), dict(zip(names, rows, strict=True)), missing)


def iter_edges(part: Polyhedron, local: LocalSurface) -> Iterator[OutlineEdges]:
    """Yield the edges of outlines, those of some planes at a time."""
    for c in part.iter_crossings(local):
        p, q = intersection_lines(local.X, c)
        yield OutlineEdges(p.T, q.T, c.plane, number_loops(c, len(part.vertices), len(local.D)))


def profile_properties(
    edges: OutlineEdges, k: int, is_met: Mask, tolerance: float, local: LocalSurface
) -> tuple[Array, dict[int, str]]:
    """Compute area, I1, I2, J, c1, c2 (6, k) of planes, and why they are not known, by plane number."""
    length = np.sqrt(((edges.q - edges.p) ** 2).sum(axis=1))
    L = np.bincount(edges.plane, length, k)
    A, Sx, Sy = edges.compute_moments(np.zeros((k, 2)))[:3]
    has_area = A > tolerances.EPS * L * L
    area = np.where(has_area, A, 1.0)
    centroid = np.where(has_area, [Sx, Sy], 0.0).T / area[:, None]
    A, _, _, I2, I12, I1, *thirds = edges.compute_moments(centroid)
    distances = np.abs(edges.p - centroid[edges.plane])
    c1, c2 = np.zeros(k), np.zeros(k)
    np.maximum.at(c1, edges.plane, distances[:, 0])
    np.maximum.at(c2, edges.plane, distances[:, 1])
    parts, holes = count_parts_and_holes(edges, length, k, tolerance)
    length_bound = L + 2.0 * np.sqrt(np.pi) * np.maximum(holes - parts, 0) * np.sqrt(np.abs(A))
    size = A * np.maximum(c1, c2) ** 3
    with np.errstate(divide="ignore", invalid="ignore"):
        coupling_ratio = np.abs(I12) / np.sqrt(I1 * I2)
        J = 4.0 / 3.0 * A**3 / length_bound**2
        asymmetry = np.abs(thirds).max(axis=0) / size
    missing: dict[int, str] = {}
    for i in np.flatnonzero(is_met).tolist():
        if not has_area[i]:
            missing[i] = "the cut has no area"
        elif parts[i] != 1:
            missing[i] = f"the outline of the mesh has {int(parts[i])} parts"
        elif not coupling_ratio[i] <= tolerances.OUTLINE_PRINCIPAL:
            axis = _format_principal_axis(I1[i], I2[i], I12[i], local)
            missing[i] = f"e1 is not a principal axis of the outline (use first_axis: [{axis}])"
        elif not asymmetry[i] <= tolerances.OUTLINE_SYMMETRIC:
            missing[i] = "the outline is not symmetric under rotation by 180 degrees, so shear forces may twist it"
    return np.array([A, I1, I2, J, c1, c2]), missing


def count_parts_and_holes(edges: OutlineEdges, length: Array, k: int, tolerance: float) -> tuple[Indices, Indices]:
    """Count the parts and holes of the outlines, (k,): closed lines that enclose more than the rounding of the file's
    digits.
    """
    (x, y), (u, v) = edges.p.T, edges.q.T
    areas = np.bincount(edges.line, 0.5 * (x * v - u * y))
    perimeters = np.bincount(edges.line, length)
    plane = np.zeros(len(areas), dtype=np.intp)
    plane[edges.line] = edges.plane
    parts, holes = plane[areas > tolerance * perimeters], plane[areas < -tolerance * perimeters]
    return np.bincount(parts, minlength=k), np.bincount(holes, minlength=k)


def _format_principal_axis(I1: float, I2: float, I12: float, local: LocalSurface) -> str:
    """Format the principal axis nearest to e1, in body axes: the one with I12 = 0."""
    side = 1.0 if I2 >= I1 else -1.0
    angle = 0.5 * float(np.arctan2(side * 2.0 * I12, side * (I2 - I1)))
    axis = local.axes[:, 0] * np.cos(angle) + local.axes[:, 1] * np.sin(angle)
    return ", ".join(f"{x:.6g}" for x in (np.round(axis, 12) + 0.0).tolist())
