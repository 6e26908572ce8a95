"""Cut a body whose surface consists of triangles by any plane, exactly.

Every triangle above a plane has a column down to the plane, which counts with the sign of the triangle's orientation.
Together the columns are the piece above (the divergence theorem for a field along the normal that vanishes in the
plane): no cap is needed, and holes and separate outlines need no special treatment. For a column over a triangle of
area A in the plane, corners at u, v and heights w,

    sum m = A <w>     sum m u = A <u w>     sum m w = A <w w>/2     sum m u v = A <u v w>     sum m u w = A <u w w>/2
    sum m w w = A <w w w>/3,   < > the means over the triangle of products of linear functions
For triangles wholly above, these are polynomials in the plane's height; those crossed are divided.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices
from heuncli.scene.meshes.model import cross_product_rows, middle_of_extent, stable_order, volume_moments
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia
from heuncli.scene.shapes.outlines import (
    MAX_CROSSINGS_AT_ONCE,
    Outline,
    Planes,
    TriangleCrossings,
    count_planes_below,
    find_crossings,
    intersection_lines,
    number_loops,
)
from heuncli.scene.shapes.rotations import cross_vectors, perpendicular_pair
from heuncli.scene.shapes.solids import ThickSolid

MAX_LEVELS = 100  # with at most this many heights of corners, all are listed as changes of the cross-sections
DIRECTION_COUNT = 24  # lines that enclose an outline: at most 1 % of its radius outside it
DIRECTION_ANGLES = 2.0 * np.pi * np.arange(DIRECTION_COUNT) / DIRECTION_COUNT


def sum_corners(x: Array) -> Array:
    """Sum values (3, q) over the corners of triangles."""
    return np.asarray(x[0] + x[1] + x[2])


def mean_of_product2(x: Array, y: Array) -> Array:
    """Compute the mean over triangles of a product of two linear functions with values (3, q) at the corners."""
    return np.asarray((sum_corners(x) * sum_corners(y) + sum_corners(x * y)) / 12.0)


def mean_of_product3(x: Array, y: Array, z: Array) -> Array:
    """Compute the mean over triangles of a product of three linear functions with values (3, q) at the corners."""
    X, Y, Z, xy = sum_corners(x), sum_corners(y), sum_corners(z), x * y
    pairs = X * sum_corners(y * z) + Y * sum_corners(x * z) + Z * sum_corners(xy)
    return np.asarray((X * Y * Z + pairs + 2.0 * sum_corners(xy * z)) / 60.0)


def column_moments(u: Array, v: Array, w: Array, A: Array) -> Array:
    """Compute the moments 1, u, v, w, uu, uv, vv, uw, vw, ww of the columns under triangles, (10, q)."""
    means = [
        sum_corners(w) / 3.0,
        mean_of_product2(u, w),
        mean_of_product2(v, w),
        0.5 * mean_of_product2(w, w),
        mean_of_product3(u, u, w),
        mean_of_product3(u, v, w),
        mean_of_product3(v, v, w),
        0.5 * mean_of_product3(u, w, w),
        0.5 * mean_of_product3(v, w, w),
        mean_of_product3(w, w, w) / 3.0,
    ]
    return A * np.array(means)


@record
class LocalSurface:
    """The surface in axes e, f, n about its middle, and planes in ascending order.

    axes: e, f, n in columns
    X: (3, n) the corners
    order: indices of the planes as they were given
    D: (k,) their heights
    low, high: see `count_planes_below`
    A: (m,) areas of the triangles projected onto the plane, negative where they face down
    """

    axes: Array
    X: Array
    order: Indices
    D: Array
    low: Indices
    high: Indices
    A: Array


@record
class Polyhedron(ThickSolid):
    """A body bounded by triangles.

    vertices: (n, 3) [m]
    triangles: (m, 3) of vertex numbers, counter-clockwise from outside
    density: [kg/m3]
    tolerance: deviation of corners of one plane from each other, due to the digits of the file [m]
    """

    vertices: Array
    triangles: Indices
    density: float
    tolerance: float

    @cached_property
    def middle(self) -> Array:
        """The middle of its extent, (3,)."""
        return middle_of_extent(self.vertices)

    def whole_inertia(self) -> Array:
        mass, first, second = volume_moments(self.vertices, self.triangles)
        G = np.eye(4)
        G[:3, 3] = self.middle
        return np.asarray(self.density * (G @ assemble_pseudo_inertia(np.array(mass), first, second) @ G.T))

    def localize(self, n: Array, d: Array, e1: Array | None = None) -> LocalSurface:
        """Transform the surface to the axes of planes; e1: the first axis in them."""
        first = perpendicular_pair(n) if e1 is None else (e1, cross_vectors(n, e1))
        axes = np.stack([*first, n], axis=1)
        X = np.ascontiguousarray(((self.vertices - self.middle) @ axes).T)
        heights = d - n @ self.middle
        order = np.argsort(heights, kind="stable")
        D = heights[order]
        low, high = count_planes_below(X[2], self.triangles, D)
        u, v = (X[i].take(self.triangles.T) for i in (0, 1))
        A = 0.5 * ((u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]))
        return LocalSurface(axes, X, order, D, low, high, A)

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        surface = self.localize(n, d)
        k = len(d)
        column_sums = self.moments_wholly_above(surface, k)
        for c in self.iter_crossings(surface):
            column_sums += moments_of_crossed(surface, c)
        one, u, v, w, uu, uv, vv, uw, vw, ww = self.density * column_sums
        first = np.stack([u, v, w], axis=-1)
        second = np.stack([uu, uv, uw, uv, vv, vw, uw, vw, ww], axis=-1).reshape(k, 3, 3)
        G = np.zeros((k, 4, 4))
        G[:, :3, :3], G[:, 3, 3] = surface.axes, 1.0
        G[:, :3, 3] = self.middle + surface.D[:, None] * n
        P = np.empty((k, 4, 4))
        P[surface.order] = G @ assemble_pseudo_inertia(one, first, second) @ G.transpose(0, 2, 1)
        return P

    def moments_wholly_above(self, surface: LocalSurface, k: int) -> Array:
        """Compute the moments (10, k) of the columns under triangles that are wholly above a plane.

        Heights are measured from the top, so that values near it lose no digits.
        """
        triangle_numbers = np.flatnonzero(surface.low)
        u, v, w = (surface.X[i].take(self.triangles[triangle_numbers].T) for i in range(3))
        top = float(surface.X[2].max())
        w = w - top
        U, V, W = sum_corners(u) / 3.0, sum_corners(v) / 3.0, sum_corners(w) / 3.0
        means = [
            np.ones(len(triangle_numbers)),
            U,
            V,
            W,
            mean_of_product2(u, u),
            mean_of_product2(u, v),
            mean_of_product2(v, v),
            mean_of_product2(u, w),
            mean_of_product2(v, w),
            mean_of_product2(w, w),
            mean_of_product3(u, u, w),
            mean_of_product3(u, v, w),
            mean_of_product3(v, v, w),
            mean_of_product3(u, w, w),
            mean_of_product3(v, w, w),
            mean_of_product3(w, w, w),
        ]
        # surface.low planes lie below such a triangle: it counts for each of them
        sums = np.array(
            [np.bincount(surface.low[triangle_numbers], surface.A[triangle_numbers] * mean, k + 1) for mean in means]
        )
        sums = np.cumsum(sums[:, ::-1], axis=1)[:, ::-1][:, 1:]
        one, U, V, W, uu, uv, vv, uw, vw, ww, uuw, uvw, vvw, uww, vww, www = sums
        h = top - surface.D
        return np.array([
            W + h * one, uw + h * U, vw + h * V, 0.5 * (ww + h * (2.0 * W + h * one)), uuw + h * uu, uvw + h * uv,
            vvw + h * vv, 0.5 * (uww + h * (2.0 * uw + h * U)), 0.5 * (vww + h * (2.0 * vw + h * V)),
            (www + h * (3.0 * ww + h * (3.0 * W + h * one))) / 3.0,
        ])  # fmt: skip

    def extent(self, n: Array) -> tuple[float, float]:
        heights = self.vertices @ n
        return float(heights.min()), float(heights.max())

    def corners(self, n: Array) -> Array:
        """Return the heights of the corners if they are few, else the two ends and the faces perpendicular to the
        normal.

        Between corners at many heights, the cross-sections are smooth except for the facets of a curved surface.
        """
        heights = self.vertices @ n
        levels_found = separate_values(heights, self.tolerance)
        if len(levels_found) <= MAX_LEVELS:
            return levels_found
        corner_heights = heights[self.triangles]
        is_flat = np.ptp(corner_heights, axis=1) <= 4.0 * self.tolerance
        places = separate_values(corner_heights[is_flat].mean(axis=1), 4.0 * self.tolerance)
        p = self.vertices[self.triangles[is_flat]]
        areas = 0.5 * np.abs(cross_product_rows(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) @ n)
        level_numbers = (
            np.abs(corner_heights[is_flat].mean(axis=1)[:, None] - places).argmin(axis=1)
            if len(places)
            else np.empty(0, int)
        )
        sums = np.bincount(level_numbers, areas, len(places))
        largest = np.sort(places[np.argsort(-sums, kind="stable")[:MAX_LEVELS]])
        return np.concatenate([levels_found[:1], largest, levels_found[-1:]])

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        surface = self.localize(n, d)
        moments = np.zeros((3, len(d)))
        for c in self.iter_crossings(surface):
            p, q = intersection_lines(surface.X, c)
            twice = p[0] * q[1] - p[1] * q[0]
            terms = (0.5 * twice, (p[0] + q[0]) * twice / 6.0, (p[1] + q[1]) * twice / 6.0)
            moments += np.array([np.bincount(c.plane, term, len(d)) for term in terms])
        areas, first = np.empty(len(d)), np.empty((len(d), 3))
        areas[surface.order] = moments[0]
        plane_origins = self.middle + surface.D[:, None] * n
        first[surface.order] = moments[1:].T @ surface.axes[:, :2].T + moments[0][:, None] * plane_origins
        return areas, first

    def iter_crossings(self, surface: LocalSurface) -> Iterator[TriangleCrossings]:
        """Yield the crossings for some planes at a time; those of one plane are together."""
        k = len(surface.D)
        count = np.cumsum(np.bincount(surface.low, minlength=k + 1) - np.bincount(surface.high, minlength=k + 1))[:k]
        batch_ends = np.arange(MAX_CROSSINGS_AT_ONCE, int(count.sum()), MAX_CROSSINGS_AT_ONCE)
        edges = np.unique([0, *np.searchsorted(np.cumsum(count), batch_ends).tolist(), k])
        for begin, end in pairwise(edges.tolist()):
            low, high = np.clip(surface.low, begin, end), np.clip(surface.high, begin, end)
            yield find_crossings(surface.X[2], self.triangles, surface.D, low, high)

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        """Find where the planes meet the body: each region as the polygon of lines in 24 directions that encloses
        it.
        """
        surface = self.localize(n, d)
        rank, plane, reach = self.find_regions(surface)
        sorted_index = np.argsort(surface.order, kind="stable")  # for each given plane its index in sorted order
        outlines = []
        for k in range(int(rank.max(initial=-1)) + 1):
            selected = rank == k
            region = np.full(len(d), -1)
            region[surface.order[plane[selected]]] = np.flatnonzero(selected)
            outlines.append(
                Outline(
                    region >= 0, partial(self.enclosing_polygons, surface, reach, region, sorted_index), part=id(self)
                )
            )
        return tuple(outlines)

    def find_regions(self, surface: LocalSurface) -> tuple[Indices, Indices, Array]:
        """Return for each region its number among those of its plane (r,), the plane, and its extent in 24 directions
        (r, 24).

        A region is a closed line with its inside to the left that encloses more than the rounding of the file's digits.
        """
        planes, reaches = [], []
        for c in self.iter_crossings(surface):
            loop_numbers = number_loops(c, len(self.vertices), len(surface.D))
            p, q = intersection_lines(surface.X, c)
            areas = np.bincount(loop_numbers, 0.5 * (p[0] * q[1] - p[1] * q[0]))
            perimeters = np.bincount(loop_numbers, np.sqrt(((q - p) ** 2).sum(axis=0)))
            plane = np.zeros(len(areas), dtype=np.intp)
            plane[loop_numbers] = c.plane
            outer = areas > self.tolerance * perimeters
            loop_order = stable_order(loop_numbers)
            starts = np.searchsorted(loop_numbers[loop_order], np.arange(len(areas)))
            projections = np.array([np.cos(DIRECTION_ANGLES), np.sin(DIRECTION_ANGLES)]).T @ p.take(loop_order, axis=1)
            reach = np.maximum.reduceat(projections, starts, axis=1).T
            planes.append(plane[outer])
            reaches.append(reach[outer])
        plane = np.concatenate([np.empty(0, np.intp), *planes])
        order = np.argsort(plane, kind="stable")
        plane = plane[order]
        rank = np.arange(len(plane)) - np.searchsorted(plane, plane)
        return rank, plane, np.concatenate([np.empty((0, DIRECTION_COUNT)), *reaches])[order]

    def enclosing_polygons(
        self, surface: LocalSurface, reach: Array, region: Indices, sorted_index: Indices, planes: Planes
    ) -> Array:
        """Compute the corners (c, 24, 3) of the polygons about the regions of some planes; where there is none, the
        middle.
        """
        h = reach[np.maximum(region[planes], 0)]
        next_h, angle = np.roll(h, -1, axis=1), 2.0 * np.pi / DIRECTION_COUNT
        along = (next_h - h * np.cos(angle)) / np.sin(angle)  # from a line's foot to its end at the next line
        u = h * np.cos(DIRECTION_ANGLES) - along * np.sin(DIRECTION_ANGLES)
        v = h * np.sin(DIRECTION_ANGLES) + along * np.cos(DIRECTION_ANGLES)
        is_met = (region[planes] >= 0)[:, None]
        u, v = np.where(is_met, u, 0.0), np.where(is_met, v, 0.0)
        w = np.broadcast_to(surface.D[sorted_index[planes], None], u.shape)
        return np.asarray(self.middle + np.stack([u, v, w], axis=-1) @ surface.axes.T)


@record
class ApproximatedSolid(Polyhedron):
    """A solid whose surface triangles approximate; cuts are those of the triangles.

    density: that with which the triangles have the mass of the solid [kg/m3]
    whole: the pseudo-inertia of the solid about the origin of the body (4, 4)
    """

    whole: Array

    def whole_inertia(self) -> Array:
        return self.whole


def separate_values(values: Array, tolerance: float) -> Array:
    """Sort values, and keep only the first of those within the tolerance of each other."""
    found = np.sort(values)
    return found[np.append(True, np.diff(found) > tolerance)] if len(found) else found


def moments_of_crossed(surface: LocalSurface, c: TriangleCrossings) -> Array:
    """Compute the moments (10, k) of the columns under the parts of crossed triangles that are above the planes."""
    A = surface.A[c.triangle]
    a, b, d = (surface.X[:2].take(own, axis=1) for own in c.lone)
    s, t = c.part
    p, q = a + s * (b - a), a + t * (d - a)
    zero = np.zeros_like(s)
    tip_area, lone_is_above = A * s * t, c.lone_is_above
    moments_above = np.zeros((10, len(surface.D)))
    parts = (
        (lone_is_above, (a, p, q), (c.h[0], zero, zero), tip_area),
        (~lone_is_above, (p, b, d), (zero, c.h[1], c.h[2]), A * (1.0 - s)),
        (~lone_is_above, (p, d, q), (zero, c.h[2], zero), A * s * (1.0 - t)),
    )
    for selected, corners, heights, areas in parts:
        u, v = (np.stack([corner[i][selected] for corner in corners]) for i in (0, 1))
        w = np.stack([height[selected] for height in heights])
        for row, moment in zip(moments_above, column_moments(u, v, w, areas[selected]), strict=True):
            row += np.bincount(c.plane[selected], moment, len(surface.D))
    return moments_above
