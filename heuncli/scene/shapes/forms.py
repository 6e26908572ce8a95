"""Bodies built from shapes: their mass properties, and those of the pieces into which planes cut them.

All in body axes. A family of cuts has one unit normal n (3,) and offsets d (k,), the planes n.x = d; the piece is the
side the normal points into. side (k,): +1 the plane is just before what lies in it, -1 just beyond it, 0: the mean of
both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.shapes.box import Box
from heuncli.scene.shapes.frustum import Frustum
from heuncli.scene.shapes.outlines import count_regions
from heuncli.scene.shapes.solids import Ball, PointMass, Rod, Solid

Value = TypeVar("Value")
AT_ONCE = 2_000  # planes: those of a long run of cuts together take a gigabyte through a box


def given(value: Value | None) -> Value:
    """A value that the spec layer guarantees for this type of shape."""
    if value is None:
        raise TypeError("a shape without one of its measures")
    return value


def vector(value: Vec | None) -> Array:
    return np.array(given(value), dtype=np.float64)


def rod(shape: Shape, density: float) -> Solid:
    return Rod(vector(shape.from_), vector(shape.to), density)


def revolved(shape: Shape, density: float, to_radius: float, inner_radius: float) -> Solid:
    start, end = vector(shape.from_), vector(shape.to)
    length = float(np.sqrt((end - start) @ (end - start)))
    radii = given(shape.radius), to_radius
    return Frustum(start, (end - start) / length, length, radii, (inner_radius, inner_radius), density)


def cylinder(shape: Shape, density: float) -> Solid:
    return revolved(shape, density, given(shape.radius), shape.inner_radius or 0.0)


def cone(shape: Shape, density: float) -> Solid:
    return revolved(shape, density, given(shape.to_radius), 0.0)


def box(shape: Shape, density: float) -> Solid:
    axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
    return Box(vector(shape.center), 0.5 * vector(shape.size), axes, density)


def sphere(shape: Shape, density: float) -> Solid:
    return Ball(vector(shape.center), given(shape.radius), density)


def point(shape: Shape, density: float) -> Solid:
    return PointMass(vector(shape.at), density)


def mesh(shape: Shape, density: float) -> Solid:
    from heuncli.scene.meshes.welding import resolution  # few scenes have them
    from heuncli.scene.shapes.polyhedron import Polyhedron

    surface, scale = given(shape.mesh), given(shape.scale)
    axes = np.array(given(shape.rotation), dtype=np.float64)
    places = vector(shape.at) + (scale * surface.corners) @ axes.T
    return Polyhedron(places, surface.triangles, density, scale * resolution(surface.corners))


# density: kg/m3; of a rod kg/m, of a point kg
SOLIDS: dict[str, Callable[[Shape, float], Solid]] = {
    "rod": rod,
    "cylinder": cylinder,
    "cone": cone,
    "box": box,
    "sphere": sphere,
    "point": point,
    "mesh": mesh,
}


def solid(shape: Shape) -> Solid:
    """The solid of a shape; a given mass is spread evenly over it."""
    make = SOLIDS[shape.type]
    if shape.mass is None:
        return make(shape, given(shape.line_density if shape.density is None else shape.density))
    return make(shape, shape.mass / float(make(shape, 1.0).whole()[3, 3]))


@record
class CrossSections:
    """How planes meet a body, one entry a plane.

    area (k,) [m2] and centroid (k, 3) [m] of all figures together, overlaps counted as often as they occur; where only
    rods are met: area 0 and the mean of the points; where nothing is: nan. places (k,): how many separate figures.
    """

    area: Array
    centroid: Array
    regions: NDArray[np.intp]


def shares(count: int) -> Iterator[slice]:
    """The planes a share at a time; one if there is none."""
    return (slice(begin, begin + AT_ONCE) for begin in range(0, max(count, 1), AT_ONCE))


@record
class Form:
    """The shapes of a body; `near` [m] is how far off a plane still counts as in it."""

    parts: tuple[Solid, ...]
    near: float

    def whole(self) -> Array:
        """Pseudo-inertia of the body about its origin, (4, 4)."""
        return np.asarray(np.sum([part.whole() for part in self.parts], axis=0))

    def pieces(self, n: Array, d: Array, side: Array) -> Array:
        """Pseudo-inertia of the pieces about the body's origin, (k, 4, 4)."""
        own = [
            np.sum([part.beyond(n, d[at], side[at], self.near) for part in self.parts], axis=0) for at in shares(len(d))
        ]
        return np.concatenate(own)

    def extent(self, n: Array) -> tuple[float, float]:
        """Least and largest n.x of the body [m]."""
        low, high = zip(*(part.extent(n) for part in self.parts), strict=True)
        return min(low), max(high)

    def corners(self, n: Array) -> Array:
        """Where along n the cross-sections change their form [m]."""
        return np.concatenate([part.corners(n) for part in self.parts])

    def masses_in_plane(self, n: Array, d: Array) -> NDArray[np.bool_]:
        """Whether a point mass lies in the plane, (k,): such a cut needs a side."""
        return self.in_plane(PointMass, n, d)

    def rods_in_plane(self, n: Array, d: Array) -> NDArray[np.bool_]:
        """Whether the plane contains a rod, (k,): on which side the rod's mass counts is then a choice."""
        return self.in_plane(Rod, n, d)

    def in_plane(self, kind: type[PointMass] | type[Rod], n: Array, d: Array) -> NDArray[np.bool_]:
        flags = [part.lies_in(n, d, self.near) for part in self.parts if isinstance(part, kind)]
        return np.asarray(np.any([np.zeros(len(d), dtype=bool), *flags], axis=0))

    def cross_sections(self, n: Array, d: Array, side: Array) -> CrossSections:
        """Where the planes meet the body: limits from the given side, so that end faces and shoulders count."""
        own = [self.limits(n, d[at], side[at]) for at in shares(len(d))]
        area, centroid, regions = (np.concatenate(rows) for rows in zip(*own, strict=True))
        return CrossSections(area, centroid, regions)

    def limits(self, n: Array, d: Array, side: Array) -> tuple[Array, Array, NDArray[np.intp]]:
        """Areas, centroids and numbers of regions of some planes at once."""
        limits = self.cross_sections_at(n, np.concatenate([d - self.near, d + self.near]))
        count, centroids = limits.regions.reshape(2, -1), limits.centroid.reshape(2, -1, 3)
        share = np.array([0.5 * (1.0 + side), 0.5 * (1.0 - side)]) * (count > 0)
        areas = share * limits.area.reshape(2, -1)
        weight = np.where(areas.any(axis=0), areas, share)
        moment = weight[..., None] * np.where(weight[..., None] > 0.0, centroids, 0.0)
        with np.errstate(invalid="ignore"):
            area = areas.sum(axis=0) / share.sum(axis=0)
            centroid = moment.sum(axis=0) / weight.sum(axis=0)[:, None]
        return area, centroid, np.where(share > 0.0, count, 0).max(axis=0)

    def cross_sections_at(self, n: Array, d: Array) -> CrossSections:
        """Where exactly these planes meet the body; for a plane in an end face the result depends on rounding."""
        outlines = [outline for part in self.parts for outline in part.outlines(n, d)]
        if not outlines:
            return CrossSections(np.zeros(len(d)), np.full((len(d), 3), np.nan), np.zeros(len(d), dtype=np.intp))
        area, moment = (np.sum(terms, axis=0) for terms in zip(*(part.area(n, d) for part in self.parts), strict=True))
        weight = area.copy()
        bare = np.flatnonzero(area == 0.0)
        for outline in outlines if len(bare) else ():
            met = outline.met[bare]
            weight[bare] += met
            moment[bare] += met[:, None] * outline.corners(bare)[:, 0]
        with np.errstate(invalid="ignore"):
            return CrossSections(
                area, moment / weight[:, None], count_regions(outlines, n, tolerances.TOUCHING * self.near)
            )


def form(shapes: Iterable[Shape]) -> Form:
    """The form of a body from the spec's shapes."""
    parts = tuple(solid(shape) for shape in shapes)
    reach = [max(abs(h) for h in part.extent(axis)) for part in parts for axis in np.eye(3)]
    return Form(parts, max(tolerances.IN_PLANE * max(reach), *(part.near for part in parts)))
