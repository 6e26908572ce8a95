"""The properties of the outlines in which planes cut a body of triangles: of polygons with holes, by Green's theorem.

    A = sum c/2     Sx = sum (x + x') c/6     Ixx = sum (x x + x x' + x' x') c/12     c = x y' - x' y
over the edges from (x, y) to (x', y') with the inside to their left; higher ones likewise. About the centroid I1 = Iyy,
I2 = Ixx, I12 = Ixy; e1 and e2 are principal where I12 = 0. Torsion, by a stress function of the distance to the edge
whose slope is A(t)/L(t) (t the distance, A(t) and L(t) of what is farther inside; Makai, 1959; Polya, 1960):

    J >= 4 int A(t)^2/L(t) dt >= 4 A^3/(3 L^2),   L the length of all edges
if there are no more holes than parts, for then L(t) <= L; of thin walls J itself, of a circle two thirds. Where there
are more, L(t) <= L + 2 pi (holes - parts) rho, rho <= sqrt(A/pi) the radius of a circle that fits in. A closed thin
wall counts as one that is slit.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.shapes.crossed_triangles import loops, met_at
from heuncli.scene.shapes.figure_kinds import CuttingPlanes, Profile
from heuncli.scene.shapes.polyhedron import LocalSurface, Polyhedron


@record
class OutlineEdges:
    """Edges of outlines, from p (q, 2) to q (q, 2) along e1 and e2, of which plane and of which closed line."""

    p: Array
    q: Array
    plane: Indices
    line: Indices

    def moments(self, about: Array) -> Array:
        """A, Sx, Sy, Ixx, Ixy, Iyy, and the third xxx, xxy, xyy, yyy about points (k, 2) of the planes, (10, k)."""
        (x, y), (u, v) = (self.p - about[self.plane]).T, (self.q - about[self.plane]).T
        c = x * v - u * y
        terms = (
            0.5 * c, (x + u) * c / 6.0, (y + v) * c / 6.0, (x * x + x * u + u * u) * c / 12.0,
            (2.0 * (x * y + u * v) + x * v + u * y) * c / 24.0, (y * y + y * v + v * v) * c / 12.0,
            third(x, u, x, u, x, u) * c, third(x, u, x, u, y, v) * c, third(x, u, y, v, y, v) * c,
            third(y, v, y, v, y, v) * c,
        )  # fmt: skip
        return np.array([np.bincount(self.plane, term, len(about)) for term in terms])


def third(a: Array, b: Array, c: Array, d: Array, e: Array, f: Array) -> Array:
    """Of the triangle between an edge and the origin the integral of three linear functions over twice its area.

    They are 0 in the origin, a and b, c and d, e and f at the edge's ends.
    """
    A, C, E = a + b, c + d, e + f
    pairs = A * (c * e + d * f) + C * (a * e + b * f) + E * (a * c + b * d)
    return np.asarray((A * C * E + pairs + 2.0 * (a * c * e + b * d * f)) / 120.0)


def of_polyhedron(part: object, at: CuttingPlanes) -> Profile | None:
    """The outlines in which planes cut a body of triangles; None of another one."""
    if not isinstance(part, Polyhedron):
        return None
    local = part.local(at.n, at.beside, at.e1)
    k = len(at.beside)
    low, high = part.extent(at.n)
    met = (low + 0.5 * part.near < at.beside) & (at.beside < high - 0.5 * part.near)  # corners spread by less
    rows = np.full((6, k), np.nan)
    missing: dict[int, str] = {}
    for edges in edges_of(part, local):
        inside = np.zeros(k, dtype=bool)
        inside[np.unique(edges.plane)] = True
        found, why = properties(edges, k, inside & met[local.order], part.near, local)
        own = local.order[inside]
        rows[:, own] = found[:, inside]
        missing |= {int(local.order[i]): reason for i, reason in why.items()}
    names = ("area", "I1", "I2", "J", "c1", "c2")
    return Profile(met & np.isfinite(rows[0]), dict(zip(names, rows, strict=True)), missing)


def edges_of(part: Polyhedron, local: LocalSurface) -> Iterator[OutlineEdges]:
    """The edges of outlines, those of some planes at a time."""
    for c in part.crossed(local):
        p, q = met_at(local.X, c)
        yield OutlineEdges(p.T, q.T, c.plane, loops(c, len(part.corners_at), len(local.D)))


def properties(
    edges: OutlineEdges, k: int, met: Mask, near: float, local: LocalSurface
) -> tuple[Array, dict[int, str]]:
    """Area, I1, I2, J, c1, c2 (6, k) of planes, and why they are not known, by the planes' numbers."""
    length = np.sqrt(((edges.q - edges.p) ** 2).sum(axis=1))
    L = np.bincount(edges.plane, length, k)
    A, Sx, Sy = edges.moments(np.zeros((k, 2)))[:3]
    thick = A > tolerances.EPS * L * L
    area = np.where(thick, A, 1.0)
    centroid = np.where(thick, [Sx, Sy], 0.0).T / area[:, None]
    A, _, _, I2, I12, I1, *thirds = edges.moments(centroid)
    off = np.abs(edges.p - centroid[edges.plane])
    c1, c2 = np.zeros(k), np.zeros(k)
    np.maximum.at(c1, edges.plane, off[:, 0])
    np.maximum.at(c2, edges.plane, off[:, 1])
    parts, holes = counted(edges, length, k, near)
    longest = L + 2.0 * np.sqrt(np.pi) * np.maximum(holes - parts, 0) * np.sqrt(np.abs(A))
    size = A * np.maximum(c1, c2) ** 3
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = np.abs(I12) / np.sqrt(I1 * I2)
        J = 4.0 / 3.0 * A**3 / longest**2
        lopsided = np.abs(thirds).max(axis=0) / size
    missing: dict[int, str] = {}
    for i in np.flatnonzero(met).tolist():
        if not thick[i]:
            missing[i] = "the cut has no area"
        elif parts[i] != 1:
            missing[i] = f"the outline of the mesh has {int(parts[i])} parts"
        elif not turned[i] <= tolerances.OUTLINE_PRINCIPAL:
            axis = _axis(I1[i], I2[i], I12[i], local)
            missing[i] = f"e1 is no principal axis of the outline (as first_axis: [{axis}] is)"
        elif not lopsided[i] <= tolerances.OUTLINE_SYMMETRIC:
            missing[i] = "shear forces twist the outline, which is not the same turned by 180 degrees"
    return np.array([A, I1, I2, J, c1, c2]), missing


def counted(edges: OutlineEdges, length: Array, k: int, near: float) -> tuple[Indices, Indices]:
    """How many parts and holes the outlines have, (k,): closed lines that enclose more than the digits of the file."""
    (x, y), (u, v) = edges.p.T, edges.q.T
    areas = np.bincount(edges.line, 0.5 * (x * v - u * y))
    around = np.bincount(edges.line, length)
    plane = np.zeros(len(areas), dtype=np.intp)
    plane[edges.line] = edges.plane
    parts, holes = plane[areas > near * around], plane[areas < -near * around]
    return np.bincount(parts, minlength=k), np.bincount(holes, minlength=k)


def _axis(I1: float, I2: float, I12: float, local: LocalSurface) -> str:
    """The principal axis nearest to e1, body axes: about it I12 is 0."""
    side = 1.0 if I2 >= I1 else -1.0
    angle = 0.5 * float(np.arctan2(side * 2.0 * I12, side * (I2 - I1)))
    along = local.axes[:, 0] * np.cos(angle) + local.axes[:, 1] * np.sin(angle)
    return ", ".join(f"{x:.6g}" for x in (np.round(along, 12) + 0.0).tolist())
