"""A body whose surface is triangles, cut by any plane, exactly.

Every triangle above a plane stands on a column down to it, which counts by the way the triangle faces. Together the
columns are the piece beyond (the divergence theorem for a field along the normal, which vanishes in the plane): no cap
is needed, holes and separate outlines take care of themselves. Of a column over a triangle of area A in the plane,
corners at u, v and heights w,

    sum m = A <w>     sum m u = A <u w>     sum m w = A <w w>/2     sum m u v = A <u v w>     sum m u w = A <u w w>/2
    sum m w w = A <w w w>/3,   < > the means over the triangle of products of linear functions
Of triangles wholly above, these are polynomials in the plane's height; those crossed are divided.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array, Indices
from heuncli.scene.meshes.model import crossed, in_order, middle_of, moments
from heuncli.scene.shapes.crossed_triangles import AT_ONCE, CrossedTriangles, crossings, levels, loops, met_at
from heuncli.scene.shapes.inertia import assembled
from heuncli.scene.shapes.outlines import Outline, Planes
from heuncli.scene.shapes.rotations import cross, perpendicular
from heuncli.scene.shapes.solids import Thick

MOST_LEVELS = 100  # heights of corners along a normal up to which each is a corner of the cross-sections
DIRECTIONS = 24  # of the lines that enclose an outline: 1 % of its radius outside it
AROUND = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS


def total(x: Array) -> Array:
    """The sum over the corners of triangles, of values (3, q)."""
    return np.asarray(x[0] + x[1] + x[2])


def mean2(x: Array, y: Array) -> Array:
    """The mean over triangles of a product of two linear functions with values (3, q) at the corners."""
    return np.asarray((total(x) * total(y) + total(x * y)) / 12.0)


def mean3(x: Array, y: Array, z: Array) -> Array:
    """The same of three."""
    X, Y, Z, xy = total(x), total(y), total(z), x * y
    pairs = X * total(y * z) + Y * total(x * z) + Z * total(xy)
    return np.asarray((X * Y * Z + pairs + 2.0 * total(xy * z)) / 60.0)


def columns(u: Array, v: Array, w: Array, A: Array) -> Array:
    """Moments 1, u, v, w, uu, uv, vv, uw, vw, ww of the columns under triangles, (10, q)."""
    means = [
        total(w) / 3.0, mean2(u, w), mean2(v, w), 0.5 * mean2(w, w), mean3(u, u, w), mean3(u, v, w), mean3(v, v, w),
        0.5 * mean3(u, w, w), 0.5 * mean3(v, w, w), mean3(w, w, w) / 3.0,
    ]  # fmt: skip
    return A * np.array(means)


@record
class LocalSurface:
    """The surface in axes e, f, n about its middle: X (3, n), and planes in ascending order.

    order: which of the planes asked for they are; D (k,): their heights; low, high: see `levels`; A (m,): of the
    triangles in the plane, negative where they face down.
    """

    axes: Array
    X: Array
    order: Indices
    D: Array
    low: Indices
    high: Indices
    A: Array


@record
class Polyhedron(Thick):
    """Corners (n, 3) [m], triangles (m, 3) of their numbers, counter-clockwise from outside; density [kg/m3].

    near [m]: how far corners of one plane may lie apart by the digits of the file.
    """

    corners_at: Array
    triangles: Indices
    density: float
    near: float

    @cached_property
    def middle(self) -> Array:
        """The middle of its extent, (3,)."""
        return middle_of(self.corners_at)

    def whole(self) -> Array:
        mass, first, second = moments(self.corners_at, self.triangles)
        G = np.eye(4)
        G[:3, 3] = self.middle
        return np.asarray(self.density * (G @ assembled(np.array(mass), first, second) @ G.T))

    def local(self, n: Array, d: Array, e1: Array | None = None) -> LocalSurface:
        """The surface before planes; e1: the first axis in them."""
        first = perpendicular(n) if e1 is None else (e1, cross(n, e1))
        axes = np.stack([*first, n], axis=1)
        X = np.ascontiguousarray(((self.corners_at - self.middle) @ axes).T)
        heights = d - n @ self.middle
        order = np.argsort(heights, kind="stable")
        D = heights[order]
        low, high = levels(X[2], self.triangles, D)
        u, v = (X[i].take(self.triangles.T) for i in (0, 1))
        A = 0.5 * ((u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]))
        return LocalSurface(axes, X, order, D, low, high, A)

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        at = self.local(n, d)
        k = len(d)
        found = self.wholly_above(at, k)
        for c in self.crossed(at):
            found += parts_above(at, c)
        one, u, v, w, uu, uv, vv, uw, vw, ww = self.density * found
        first = np.stack([u, v, w], axis=-1)
        second = np.stack([uu, uv, uw, uv, vv, vw, uw, vw, ww], axis=-1).reshape(k, 3, 3)
        G = np.zeros((k, 4, 4))
        G[:, :3, :3], G[:, 3, 3] = at.axes, 1.0
        G[:, :3, 3] = self.middle + at.D[:, None] * n
        P = np.empty((k, 4, 4))
        P[at.order] = G @ assembled(one, first, second) @ G.transpose(0, 2, 1)
        return P

    def wholly_above(self, at: LocalSurface, k: int) -> Array:
        """Moments (10, k) of the columns under triangles that are wholly above a plane.

        Heights are taken from the top: what is near it loses no digits.
        """
        own = np.flatnonzero(at.low)
        u, v, w = (at.X[i].take(self.triangles[own].T) for i in range(3))
        top = float(at.X[2].max())
        w = w - top
        U, V, W = total(u) / 3.0, total(v) / 3.0, total(w) / 3.0
        means = [
            np.ones(len(own)), U, V, W, mean2(u, u), mean2(u, v), mean2(v, v), mean2(u, w), mean2(v, w), mean2(w, w),
            mean3(u, u, w), mean3(u, v, w), mean3(v, v, w), mean3(u, w, w), mean3(v, w, w), mean3(w, w, w),
        ]  # fmt: skip
        # low planes lie below such a triangle: it counts for all of them
        sums = np.array([np.bincount(at.low[own], at.A[own] * mean, k + 1) for mean in means])
        sums = np.cumsum(sums[:, ::-1], axis=1)[:, ::-1][:, 1:]
        one, U, V, W, uu, uv, vv, uw, vw, ww, uuw, uvw, vvw, uww, vww, www = sums
        h = top - at.D
        return np.array([
            W + h * one, uw + h * U, vw + h * V, 0.5 * (ww + h * (2.0 * W + h * one)), uuw + h * uu, uvw + h * uv,
            vvw + h * vv, 0.5 * (uww + h * (2.0 * uw + h * U)), 0.5 * (vww + h * (2.0 * vw + h * V)),
            (www + h * (3.0 * ww + h * (3.0 * W + h * one))) / 3.0,
        ])  # fmt: skip

    def extent(self, n: Array) -> tuple[float, float]:
        heights = self.corners_at @ n
        return float(heights.min()), float(heights.max())

    def corners(self, n: Array) -> Array:
        """The heights of its corners, where there are few; else its ends and those of faces across the normal.

        Between corners of many heights the cross-sections are smooth but for the facets of a curved surface.
        """
        heights = self.corners_at @ n
        found = told_apart(heights, self.near)
        if len(found) <= MOST_LEVELS:
            return found
        own = heights[self.triangles]
        flat = np.ptp(own, axis=1) <= 4.0 * self.near
        places = told_apart(own[flat].mean(axis=1), 4.0 * self.near)
        p = self.corners_at[self.triangles[flat]]
        areas = 0.5 * np.abs(crossed(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) @ n)
        which = np.abs(own[flat].mean(axis=1)[:, None] - places).argmin(axis=1) if len(places) else np.empty(0, int)
        sums = np.bincount(which, areas, len(places))
        largest = np.sort(places[np.argsort(-sums, kind="stable")[:MOST_LEVELS]])
        return np.concatenate([found[:1], largest, found[-1:]])

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        at = self.local(n, d)
        moments = np.zeros((3, len(d)))
        for c in self.crossed(at):
            p, q = met_at(at.X, c)
            twice = p[0] * q[1] - p[1] * q[0]
            terms = (0.5 * twice, (p[0] + q[0]) * twice / 6.0, (p[1] + q[1]) * twice / 6.0)
            moments += np.array([np.bincount(c.plane, term, len(d)) for term in terms])
        areas, first = np.empty(len(d)), np.empty((len(d), 3))
        areas[at.order] = moments[0]
        about = self.middle + at.D[:, None] * n
        first[at.order] = moments[1:].T @ at.axes[:, :2].T + moments[0][:, None] * about
        return areas, first

    def crossed(self, at: LocalSurface) -> Iterator[CrossedTriangles]:
        """The crossings, some planes at a time: all of a plane together."""
        k = len(at.D)
        count = np.cumsum(np.bincount(at.low, minlength=k + 1) - np.bincount(at.high, minlength=k + 1))[:k]
        most = np.arange(AT_ONCE, int(count.sum()), AT_ONCE)
        edges = np.unique([0, *np.searchsorted(np.cumsum(count), most).tolist(), k])
        for begin, end in pairwise(edges.tolist()):
            low, high = np.clip(at.low, begin, end), np.clip(at.high, begin, end)
            yield crossings(at.X[2], self.triangles, at.D, low, high)

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        """Where the planes meet the body: each region by the lines in 24 directions that enclose it."""
        at = self.local(n, d)
        rank, plane, reach = self.regions(at)
        place = np.argsort(at.order, kind="stable")  # of each plane asked for, where it stands in order
        found = []
        for k in range(int(rank.max(initial=-1)) + 1):
            own = rank == k
            region = np.full(len(d), -1)
            region[at.order[plane[own]]] = np.flatnonzero(own)
            found.append(Outline(region >= 0, partial(self.enclosing, at, reach, region, place), part=id(self)))
        return tuple(found)

    def regions(self, at: LocalSurface) -> tuple[Indices, Indices, Array]:
        """Of each region its number among those of its plane (r,), the plane, and how far it reaches (r, 24).

        A region is a closed line with its inside to the left that encloses more than the digits of the file.
        """
        planes, reaches = [], []
        for c in self.crossed(at):
            line = loops(c, len(self.corners_at), len(at.D))
            p, q = met_at(at.X, c)
            areas = np.bincount(line, 0.5 * (p[0] * q[1] - p[1] * q[0]))
            around = np.bincount(line, np.sqrt(((q - p) ** 2).sum(axis=0)))
            plane = np.zeros(len(areas), dtype=np.intp)
            plane[line] = c.plane
            outer = areas > self.near * around
            by_line = in_order(line)
            starts = np.searchsorted(line[by_line], np.arange(len(areas)))
            along = np.array([np.cos(AROUND), np.sin(AROUND)]).T @ p.take(by_line, axis=1)
            reach = np.maximum.reduceat(along, starts, axis=1).T
            planes.append(plane[outer])
            reaches.append(reach[outer])
        plane = np.concatenate([np.empty(0, np.intp), *planes])
        order = np.argsort(plane, kind="stable")
        plane = plane[order]
        rank = np.arange(len(plane)) - np.searchsorted(plane, plane)
        return rank, plane, np.concatenate([np.empty((0, DIRECTIONS)), *reaches])[order]

    def enclosing(self, at: LocalSurface, reach: Array, region: Indices, place: Indices, planes: Planes) -> Array:
        """Corners (c, 24, 3) of the polygons about the regions of some planes; where there is none its middle."""
        h = reach[np.maximum(region[planes], 0)]
        following, angle = np.roll(h, -1, axis=1), 2.0 * np.pi / DIRECTIONS
        along = (following - h * np.cos(angle)) / np.sin(angle)  # from the foot of a line to where the next one meets
        u = h * np.cos(AROUND) - along * np.sin(AROUND)
        v = h * np.sin(AROUND) + along * np.cos(AROUND)
        met = (region[planes] >= 0)[:, None]
        u, v = np.where(met, u, 0.0), np.where(met, v, 0.0)
        w = np.broadcast_to(at.D[place[planes], None], u.shape)
        return np.asarray(self.middle + np.stack([u, v, w], axis=-1) @ at.axes.T)


def told_apart(values: Array, near: float) -> Array:
    """Values in order, of those nearer than that to each other the first."""
    found = np.sort(values)
    return found[np.append(True, np.diff(found) > near)] if len(found) else found


def parts_above(at: LocalSurface, c: CrossedTriangles) -> Array:
    """Moments (10, k) of the columns under the parts of triangles that are above the planes which cross these."""
    A = at.A[c.triangle]
    a, b, d = (at.X[:2].take(own, axis=1) for own in c.lone)
    s, t = c.part
    p, q = a + s * (b - a), a + t * (d - a)
    zero = np.zeros_like(s)
    tip, up = A * s * t, c.up
    found = np.zeros((10, len(at.D)))
    parts = (
        (up, (a, p, q), (c.h[0], zero, zero), tip),
        (~up, (p, b, d), (zero, c.h[1], c.h[2]), A * (1.0 - s)),
        (~up, (p, d, q), (zero, c.h[2], zero), A * s * (1.0 - t)),
    )
    for on, corners, heights, areas in parts:
        u, v = (np.stack([corner[i][on] for corner in corners]) for i in (0, 1))
        w = np.stack([height[on] for height in heights])
        for row, moment in zip(found, columns(u, v, w, areas[on]), strict=True):
            row += np.bincount(c.plane[on], moment, len(at.D))
    return found
