"""Products of a spec's quantities: what a body's mass and inertia come to is computed with, too.

An inertia is judged by what it cannot exceed, m l^2 with the largest coordinate l of the body, and its own moments.
Volumes are those of shapes/, which stands above the spec and takes NumPy; a test holds the two together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.number_range import is_in_range, out_of_range
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule


@rule("magnitude")
def magnitude(draft: DraftDocument) -> Iterator[Violation]:
    """The masses of shapes, and the inertias of bodies, are of magnitudes that are computed with."""
    farthest = max((largest(*place) for place in places(draft)), default=0.0)
    for name, body in draft.document.bodies.items():
        path: Path_ = ("bodies", name)
        masses = [mass_of(shape) for shape in body.shapes or ()]
        wrong = [i for i, mass in enumerate(masses) if not is_in_range(mass)]
        for i in wrong:
            what = "the mass of this shape [kg], its density times its volume,"
            yield violation((*path, "shapes", i), masses[i], what)
        if wrong:
            continue
        mass = body.mass if body.mass is not None else math.fsum(masses)
        own = [body.center or (), *body.points.values(), *(extent(shape) for shape in body.shapes or ())]
        reach = max((largest(*x) for x in own), default=0.0)
        inertia = max(largest(*moments(body)), mass * reach**2)
        if not is_in_range(inertia):
            what = f"the inertia of this body [kg m^2], {mass:g} kg times the square of {reach:g} m,"
            yield violation(path, inertia, what)
        elif mass * farthest**2 > inertia and not is_in_range(mass * farthest**2):
            what = f"the inertia of this body about the origin [kg m^2], {mass:g} kg at up to {farthest:g} m,"
            yield violation(path, mass * farthest**2, what)


def violation(path: Path_, value: float, what: str) -> Violation:
    """A product that is out of range."""
    found = out_of_range(value, what)
    return Violation(path, found.message, found.hint, key=True)


def largest(*values: float) -> float:
    """The largest magnitude; 0 of nothing."""
    return max(map(abs, values), default=0.0)


def places(draft: DraftDocument) -> Iterator[tuple[float, ...]]:
    """Points of the ground, and places of bodies, world axes [m]."""
    yield from draft.document.ground.points.values()
    for body in draft.document.bodies.values():
        yield body.position or ()
        yield (body.near.position if body.near is not None else None) or ()


def moments(body: f.BodyEntry) -> tuple[float, ...]:
    """The elements of the inertia that is given [kg m^2]."""
    given, off = body.inertia, body.deviation or ()
    if given is None or isinstance(given, float):
        return (given or 0.0, *off)
    rows = [row if isinstance(row, tuple) else (row,) for row in given]
    return (*(element for row in rows for element in row), *off)


def extent(shape: fs.ShapeEntry) -> tuple[float, ...]:
    """Lengths of which none of the shape's coordinates exceeds the sum [m]."""
    match shape:
        case fs.RodShape():
            return (*shape.from_, *shape.to)
        case fs.CylinderShape():
            return (*shape.from_, *shape.to, shape.radius)
        case fs.ConeShape():
            return (*shape.from_, *shape.to, shape.radius, shape.to_radius)
        case fs.BoxShape():
            return (*shape.center, *shape.size)
        case fs.SphereShape():
            return (*shape.center, shape.radius)
        case fs.PointShape():
            return shape.at
        case fs.MeshShape():
            return shape.at or ()


def mass_of(shape: fs.ShapeEntry) -> float:
    """The mass [kg]: as given, or the density times the volume; of a mesh by density 0, its file is read later."""
    if shape.mass is not None:
        return shape.mass
    if isinstance(shape, fs.RodShape):
        return (shape.line_density or 0.0) * math.dist(shape.from_, shape.to)
    if isinstance(shape, fs.MeshShape):
        return 0.0
    assert not isinstance(shape, fs.PointShape)
    return (shape.density or 0.0) * volume(shape)


def volume(shape: fs.CylinderShape | fs.ConeShape | fs.BoxShape | fs.SphereShape) -> float:
    """The volume [m^3]."""
    match shape:
        case fs.CylinderShape():
            inner = shape.inner_radius or 0.0
            return math.pi * (shape.radius - inner) * (shape.radius + inner) * math.dist(shape.from_, shape.to)
        case fs.ConeShape():
            a, b = shape.radius, shape.to_radius
            return math.pi / 3.0 * (a * a + a * b + b * b) * math.dist(shape.from_, shape.to)
        case fs.BoxShape():
            return math.prod(shape.size)
        case fs.SphereShape():
            return 4.0 / 3.0 * math.pi * shape.radius**3
