"""Check that products of a spec's quantities, a body's mass and inertia, stay within the range of computation.

An inertia is checked by an upper bound, m l^2 with the largest coordinate l of the body, and its own moments. Volumes
repeat those of shapes/, which is above the spec in the import order and needs NumPy; a test compares the two.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.errors import Finding
from heuncli.base.units import is_in_range, range_error
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.members import compute_mean_area, find_ends, find_member, is_member
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule


@rule("magnitude")
def check_magnitude(draft: DraftDocument) -> Iterator[Violation]:
    """The masses of shapes and the inertias of bodies are within the range of computation."""
    farthest = max((largest_magnitude(*position) for position in iter_positions(draft)), default=0.0)
    for name, body in draft.document.bodies.items():
        path: Path_ = ("bodies", name)
        masses = [shape_mass(shape) for shape in body.shapes or ()]
        out_of_range_shapes = [i for i, mass in enumerate(masses) if not is_in_range(mass)]
        for i in out_of_range_shapes:
            description = "the mass of this shape [kg] (density times volume)"
            yield make_violation((*path, "shapes", i), masses[i], description)
        if out_of_range_shapes:
            continue
        mass = body.mass if body.mass is not None else math.fsum(masses)
        coordinates = [body.center or (), *body.points.values(), *(shape_extent(shape) for shape in body.shapes or ())]
        reach = max((largest_magnitude(*x) for x in coordinates), default=0.0)
        inertia = max(largest_magnitude(*inertia_elements(body)), mass * reach**2)
        if not is_in_range(inertia):
            description = f"the inertia of this body [kg m^2] ({mass:g} kg times the square of {reach:g} m)"
            yield make_violation(path, inertia, description)
        elif mass * farthest**2 > inertia and not is_in_range(mass * farthest**2):
            description = f"the inertia of this body about the origin [kg m^2] ({mass:g} kg at up to {farthest:g} m)"
            yield make_violation(path, mass * farthest**2, description)


def make_violation(path: Path_, value: float, description: str) -> Violation:
    """Make the violation for a product that is out of range."""
    finding = range_error(value, description)
    return Violation(path, finding.message, finding.hint, key=True)


def largest_magnitude(*values: float) -> float:
    """Return the largest magnitude; 0 for no values."""
    return max(map(abs, values), default=0.0)


def iter_positions(draft: DraftDocument) -> Iterator[tuple[float, ...]]:
    """Yield points of the ground and positions of bodies, world axes [m]."""
    yield from draft.document.ground.points.values()
    for body in draft.document.bodies.values():
        yield body.position or ()
        yield (body.near.position if body.near is not None else None) or ()


def inertia_elements(body: f.BodyEntry) -> tuple[float, ...]:
    """Return the elements of the given inertia [kg m^2]."""
    inertia, deviation = body.inertia, body.deviation or ()
    if inertia is None or isinstance(inertia, float):
        return (inertia or 0.0, *deviation)
    rows = [row if isinstance(row, tuple) else (row,) for row in inertia]
    return (*(element for row in rows for element in row), *deviation)


def shape_extent(shape: fs.ShapeEntry) -> tuple[float, ...]:
    """Return lengths whose sum is an upper bound of the shape's coordinates [m]."""
    match shape:
        case fs.RodShape():
            return (*shape.from_, *shape.to)
        case fs.MemberShape():
            sizes = (shape.width, shape.height, shape.to_width or 0.0, shape.to_height or 0.0)
            return (*shape.from_, *shape.to, *sizes)
        case fs.ProfileShape():
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


def shape_mass(shape: fs.ShapeEntry) -> float:
    """Return the mass [kg]: as given, or density times volume; 0 for a mesh by density, whose file is read later."""
    if shape.mass is not None:
        return shape.mass
    if isinstance(shape, fs.RodShape):
        return (shape.line_density or 0.0) * math.dist(shape.from_, shape.to)
    if isinstance(shape, fs.MeshShape):
        return 0.0
    assert not isinstance(shape, fs.PointShape)
    if is_member(shape):
        return (shape.density or 0.0) * member_volume(shape)
    assert not isinstance(shape, fs.MemberShape | fs.ProfileShape)
    return (shape.density or 0.0) * shape_volume(shape)


def member_volume(shape: fs.ShapeEntry) -> float:
    """Return the volume of a member [m^3]; 0 if it cannot be one, which another rule reports."""
    try:
        return compute_mean_area(find_member(shape)) * math.dist(*find_ends(shape))
    except Finding:
        return 0.0


def shape_volume(shape: fs.CylinderShape | fs.ConeShape | fs.BoxShape | fs.SphereShape) -> float:
    """Return the volume [m^3]."""
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
