"""Build bodies from shapes, and compute their mass properties and those of the pieces into which planes cut them.

All in body axes. A family of cuts has one unit normal n (3,) and offsets d (k,), the planes n.x = d; the piece is on
the side to which the normal points. side (k,): +1 the plane is just before what lies in it, -1 just behind it, 0: the
mean of both.
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
MAX_PLANES_AT_ONCE = 2_000  # planes; all cuts of a long run through a box would take a gigabyte


def require_value(value: Value | None) -> Value:
    """Return a value that validation guarantees for this type of shape. Raises TypeError without it."""
    if value is None:
        raise TypeError("a shape lacks one of its dimensions")
    return value


def to_vector(value: Vec | None) -> Array:
    return np.array(require_value(value), dtype=np.float64)


def make_rod(shape: Shape, density: float) -> Solid:
    return Rod(to_vector(shape.from_), to_vector(shape.to), density)


def make_frustum(shape: Shape, density: float, to_radius: float, inner_radius: float) -> Solid:
    start, end = to_vector(shape.from_), to_vector(shape.to)
    length = float(np.sqrt((end - start) @ (end - start)))
    radii = require_value(shape.radius), to_radius
    return Frustum(start, (end - start) / length, length, radii, (inner_radius, inner_radius), density)


def make_cylinder(shape: Shape, density: float) -> Solid:
    return make_frustum(shape, density, require_value(shape.radius), shape.inner_radius or 0.0)


def make_cone(shape: Shape, density: float) -> Solid:
    return make_frustum(shape, density, require_value(shape.to_radius), 0.0)


def make_box(shape: Shape, density: float) -> Solid:
    axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation, dtype=np.float64)
    return Box(to_vector(shape.center), 0.5 * to_vector(shape.size), axes, density)


def make_sphere(shape: Shape, density: float) -> Solid:
    return Ball(to_vector(shape.center), require_value(shape.radius), density)


def make_point_mass(shape: Shape, density: float) -> Solid:
    return PointMass(to_vector(shape.at), density)


def make_polyhedron(shape: Shape, density: float) -> Solid:
    from heuncli.scene.meshes.closure import coordinate_resolution  # few scenes have meshes
    from heuncli.scene.meshes.model import volume_moments
    from heuncli.scene.shapes.inertia import assemble_pseudo_inertia
    from heuncli.scene.shapes.polyhedron import ApproximatedSolid, Polyhedron

    surface, scale = require_value(shape.mesh), require_value(shape.scale)
    axes = np.array(require_value(shape.rotation), dtype=np.float64)
    places = to_vector(shape.at) + (scale * surface.corners) @ axes.T
    resolution = scale * coordinate_resolution(surface.corners)
    if surface.moments is None:
        return Polyhedron(places, surface.triangles, density, resolution)
    volume, center, second = surface.moments
    G = np.eye(4)
    G[:3, :3], G[:3, 3] = axes, to_vector(shape.at) + axes @ center
    whole = density * (G @ assemble_pseudo_inertia(np.array(volume), np.zeros(3), second) @ G.T)
    cut_density = density * volume / volume_moments(surface.corners, surface.triangles)[0]
    return ApproximatedSolid(places, surface.triangles, cut_density, resolution, whole)


def make_member(shape: Shape, density: float) -> Solid:
    from heuncli.scene.shapes.member_solid import make_member_solid  # few scenes have members

    return make_member_solid(require_value(shape.member), to_vector(shape.from_), to_vector(shape.to), density)


# density in kg/m3; of a rod in kg/m, of a point in kg
SOLID_MAKERS: dict[str, Callable[[Shape, float], Solid]] = {
    "rod": make_rod,
    "cylinder": make_cylinder,
    "cone": make_cone,
    "box": make_box,
    "sphere": make_sphere,
    "point": make_point_mass,
    "mesh": make_polyhedron,
    "member": make_member,
}


def make_solid(shape: Shape) -> Solid:
    """Make the solid of a shape; a given mass is distributed evenly over it."""
    make = SOLID_MAKERS[shape.type]
    if shape.mass is None:
        return make(shape, require_value(shape.line_density if shape.density is None else shape.density))
    return make(shape, shape.mass / float(make(shape, 1.0).whole_inertia()[3, 3]))


@record
class CrossSections:
    """How planes meet a body, one entry a plane.

    area: (k,) [m2] of all figures together, overlaps counted as often as they occur
    centroid: (k, 3) [m] of all figures together; nan if nothing is met. If only rods are met, the area is 0 and this is
    the mean of their points.
    regions: (k,) number of separate figures
    """

    area: Array
    centroid: Array
    regions: NDArray[np.intp]


def iter_batches(count: int) -> Iterator[slice]:
    """Yield slices of the planes in batches; one empty batch if there are none."""
    return (slice(begin, begin + MAX_PLANES_AT_ONCE) for begin in range(0, max(count, 1), MAX_PLANES_AT_ONCE))


@record
class CompositeSolid:
    """The shapes of a body.

    tolerance: the distance within which a plane counts as touching a point or rod [m]
    """

    parts: tuple[Solid, ...]
    tolerance: float

    def whole_inertia(self) -> Array:
        """Compute the pseudo-inertia of the body about its origin, (4, 4)."""
        return np.asarray(np.sum([part.whole_inertia() for part in self.parts], axis=0))

    def piece_inertias(self, n: Array, d: Array, side: Array) -> Array:
        """Compute the pseudo-inertia of the pieces about the body's origin, (k, 4, 4)."""
        batches = [
            sum(
                (part.piece_inertia(n, d[batch], side[batch], self.tolerance) for part in self.parts),
                np.zeros((len(d[batch]), 4, 4)),
            )
            for batch in iter_batches(len(d))
        ]
        return np.concatenate(batches)

    def extent(self, n: Array) -> tuple[float, float]:
        """Return the least and largest n.x of the body [m]."""
        low, high = zip(*(part.extent(n) for part in self.parts), strict=True)
        return min(low), max(high)

    def corners(self, n: Array) -> Array:
        """Return where along n the cross-sections change their form [m]."""
        return np.concatenate([np.zeros(0), *(part.corners(n) for part in self.parts)])

    def has_mass_in_plane(self, n: Array, d: Array) -> NDArray[np.bool_]:
        """Return whether a point mass lies in the plane, (k,): such a cut needs a side."""
        return self.has_kind_in_plane(PointMass, n, d)

    def has_rod_in_plane(self, n: Array, d: Array) -> NDArray[np.bool_]:
        """Return whether the plane contains a rod, (k,): then `side` decides to which piece the rod's mass belongs."""
        return self.has_kind_in_plane(Rod, n, d)

    def has_kind_in_plane(self, kind: type[PointMass] | type[Rod], n: Array, d: Array) -> NDArray[np.bool_]:
        flags = [part.lies_in(n, d, self.tolerance) for part in self.parts if isinstance(part, kind)]
        return np.asarray(np.any([np.zeros(len(d), dtype=bool), *flags], axis=0))

    def cross_sections(self, n: Array, d: Array, side: Array) -> CrossSections:
        """Compute where the planes meet the body, as limits from the given side, so that end faces and shoulders
        count.
        """
        batches = [self.one_sided_sections(n, d[batch], side[batch]) for batch in iter_batches(len(d))]
        area, centroid, regions = (np.concatenate(rows) for rows in zip(*batches, strict=True))
        return CrossSections(area, centroid, regions)

    def one_sided_sections(self, n: Array, d: Array, side: Array) -> tuple[Array, Array, NDArray[np.intp]]:
        """Compute areas, centroids and numbers of regions of some planes at once, as limits from their sides."""
        limits = self.exact_cross_sections(n, np.concatenate([d - self.tolerance, d + self.tolerance]))
        count, centroids = limits.regions.reshape(2, -1), limits.centroid.reshape(2, -1, 3)
        share = np.array([0.5 * (1.0 + side), 0.5 * (1.0 - side)]) * (count > 0)
        areas = share * limits.area.reshape(2, -1)
        weight = np.where(areas.any(axis=0), areas, share)
        moment = weight[..., None] * np.where(weight[..., None] > 0.0, centroids, 0.0)
        with np.errstate(invalid="ignore"):
            area = areas.sum(axis=0) / share.sum(axis=0)
            centroid = moment.sum(axis=0) / weight.sum(axis=0)[:, None]
        return area, centroid, np.where(share > 0.0, count, 0).max(axis=0)

    def exact_cross_sections(self, n: Array, d: Array) -> CrossSections:
        """Compute where exactly these planes meet the body; for a plane in an end face the result depends on
        rounding.
        """
        outlines = [outline for part in self.parts for outline in part.section_outlines(n, d)]
        if not outlines:
            return CrossSections(np.zeros(len(d)), np.full((len(d), 3), np.nan), np.zeros(len(d), dtype=np.intp))
        area, moment = (
            np.sum(terms, axis=0) for terms in zip(*(part.section_area(n, d) for part in self.parts), strict=True)
        )
        weight = area.copy()
        without_area = np.flatnonzero(area == 0.0)
        for outline in outlines if len(without_area) else ():
            met = outline.is_met[without_area]
            weight[without_area] += met
            moment[without_area] += met[:, None] * outline.corners(without_area)[:, 0]
        with np.errstate(invalid="ignore"):
            return CrossSections(
                area, moment / weight[:, None], count_regions(outlines, n, tolerances.TOUCHING * self.tolerance)
            )


NO_MATTER = CompositeSolid((), 0.0)  # of a body without mass: it may be cut, and nothing lies beyond a cut


def make_composite_solid(shapes: Iterable[Shape]) -> CompositeSolid:
    """Make the solid of a body from the spec's shapes."""
    parts = tuple(make_solid(shape) for shape in shapes)
    extents = [max(abs(h) for h in part.extent(axis)) for part in parts for axis in np.eye(3)]
    return CompositeSolid(parts, max(tolerances.IN_PLANE * max(extents), *(part.tolerance for part in parts)))
