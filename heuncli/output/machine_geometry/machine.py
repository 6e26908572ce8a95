"""A scene as something to look at: what its bodies look like in their own axes, and where its joints and loads stand.

Everything is in body axes [m]; where it comes to stand at an instant follows from the body's pose. A body with shapes
looks like them, with arms to points outside them; one without is drawn as the wheel that it is, as lines between its
points, or, where these are one place, as the ellipsoid that has its inertia.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.machine_geometry.acting import ActingLook, acting_of
from heuncli.output.machine_geometry.discs import Disc
from heuncli.output.machine_geometry.elements import ElementLooks, elements_of
from heuncli.output.machine_geometry.marks import Mark, marks_of
from heuncli.output.machine_geometry.pitch_lines import BeltLook
from heuncli.output.machine_geometry.ropes import RopeLook, ropes_of
from heuncli.output.machine_geometry.solids import ROUND, Surface, ellipsoid, reached, surfaces_of
from heuncli.output.machine_geometry.wheels import balls_of
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Actuator, Bushing, Shape, Spec, Spring
from heuncli.scene.file_format.names import GROUND

SEVERAL = 2  # discs, between which a body without shapes is a line
SMALL = 0.2  # of its radius of gyration: a body whose points lie within is drawn as it is spread
OUTSIDE = 1e-9  # of the way from a shape's axis to a point: what it lies outside that shape by rounding


class BodyLook(NamedTuple):
    """A body: its named points (3,), the surfaces of its shapes, lines on it: rims, spokes, threads, outlines of cams.

    spread: the surface is not its own, but of the ellipsoid that has its inertia. bars: lines between its points, or
    from these to its shapes: what it is itself.
    """

    name: str
    points: Mapping[str, Array]
    surfaces: tuple[Surface, ...]
    lines: tuple[Array, ...]
    spread: bool = False
    bars: tuple[Array, ...] = ()

    @property
    def strokes(self) -> tuple[Array, ...]:
        """Its bars and lines."""
        return (*self.bars, *self.lines)


class JointLook(NamedTuple):
    """A joint: its kind in the spec, its ends (body, point in its axes), its axis in the axes of `from`."""

    name: str
    kind: str
    a: str
    p: Array
    b: str
    q: Array
    axis: Array


class LineLook(NamedTuple):
    """What acts or holds between two points: a spring, an actuator, a rod, a rope, a bushing."""

    name: str
    kind: str
    a: str
    p: Array
    b: str
    q: Array


class Machine(NamedTuple):
    """All of a scene; grounded: points of the ground; paths: lines on it, along which points run, and circles.

    belts, ropes: what moves otherwise than one body does; marks: symbols that stand somewhere; acting: in joints.
    """

    title: str
    bodies: tuple[BodyLook, ...]
    joints: tuple[JointLook, ...]
    lines: tuple[LineLook, ...]
    grounded: Mapping[str, Array]
    paths: tuple[Array, ...] = ()
    belts: tuple[BeltLook, ...] = ()
    ropes: tuple[RopeLook, ...] = ()
    marks: tuple[Mark, ...] = ()
    acting: tuple[ActingLook, ...] = ()


def machine_of(spec: Spec, faces: int = ROUND, scene: PreparedScene | None = None) -> Machine:
    """What there is to be seen of a loaded spec; faces: of what is round, about its axis.

    scene: the spec as it is assembled; without it there are no ropes over sheaves and no marks.
    """
    joints = tuple(
        JointLook(name, j.kind, j.a, np.array(j.p), j.b, np.array(j.q), np.array(j.axis))
        for name, j in spec.joints.items()
    )
    lines = tuple(
        LineLook(name, f.type, f.from_.body, np.array(f.from_.point), f.to.body, np.array(f.to.point))
        for name, f in spec.forces.items()
        if isinstance(f, Spring | Actuator | Bushing)
    )
    elements = elements_of(spec, None if scene is None else scene.mechanism)
    bodies = tuple(_body(name, spec, (joints, lines), elements, faces) for name in spec.bodies)
    grounded = {name: np.array(point) for name, point in spec.ground.points.items()}
    paths = (*elements.lines.get(GROUND, ()), *(disc.rim for disc in elements.discs.get(GROUND, ())))
    acting = tuple(acting_of(spec))
    found = Machine(spec.title, bodies, joints, lines, grounded, paths, elements.belts, acting=acting)
    if scene is None:
        return found
    ropes = ropes_of(scene.mechanism)
    return found._replace(ropes=ropes, marks=tuple(marks_of(spec, scene, ropes)))


def shapes_of(spec: Spec, body: str, discs: Sequence[Disc]) -> Sequence[Shape]:
    """What a body is drawn by: its shapes; without any, the wheels that it is."""
    return spec.bodies[body].shapes or (*balls_of(spec, body), *(disc.shape for disc in discs if disc.solid))


def _body(
    name: str,
    spec: Spec,
    held: tuple[tuple[JointLook, ...], tuple[LineLook, ...]],
    elements: ElementLooks,
    faces: int,
) -> BodyLook:
    """What a body looks like; held: by which joints and lines."""
    body, discs = spec.bodies[name], elements.discs.get(name, ())
    points = {key: np.array(point, dtype=np.float64) for key, point in body.points.items()}
    ends = [own.p for part in held for own in part if own.a == name]
    ends += [own.q for part in held for own in part if own.b == name]
    ends += points.values()
    shapes = shapes_of(spec, name, discs)
    surfaces = tuple(surface for shape in shapes for surface in surfaces_of(shape, faces))
    rims = (disc.rim for disc in discs if body.shapes or not disc.solid)
    spokes = (line for disc in discs if disc.spins for line in disc.spokes(surfaces))
    drawn = (*elements.lines.get(name, ()), *rims, *spokes)
    if surfaces:
        ends += [np.array(shape.at) for shape in shapes if shape.type == "point"]
        if body.shapes or len(discs) < SEVERAL:
            return BodyLook(name, points, surfaces, drawn, bars=tuple(_arms(shapes, ends)))
        between = _through([*ends, np.array(body.center, dtype=np.float64)])
        return BodyLook(name, points, surfaces, drawn, bars=(between,))
    # of point masses alone neither centre nor inertia is known yet, nor needed
    centre = [np.array(shape.at) for shape in shapes] or [np.array(body.center, dtype=np.float64)]
    line = _through([*ends, *centre])
    moments = np.array(body.inertia, dtype=np.float64)
    gyration = np.sqrt(max(0.0, float(np.trace(moments)) / (2.0 * body.mass))) if body.mass > 0.0 else 0.0
    if not drawn and float(np.ptp(line, axis=0).max()) < SMALL * gyration:
        return BodyLook(name, points, (ellipsoid(body.mass, np.array(body.center), moments, faces),), (), True)
    return BodyLook(name, points, (), drawn, bars=(line,))


def _arms(shapes: Sequence[Shape], ends: Sequence[Array]) -> Iterator[Array]:
    """Lines (2, 3) to the points that lie outside all shapes, from the nearest one that has an extent."""
    solid = [shape for shape in shapes if shape.type != "point"]
    for end in np.unique(np.array(ends).reshape(-1, 3), axis=0):
        place, gap = min((reached(shape, end) for shape in solid), key=lambda found: found[1])
        if gap > OUTSIDE * float(np.linalg.norm(end - place)):
            yield np.array([place, end])


def _through(ends: list[Array]) -> Array:
    """A line through points, (n, 3), from one end of the longest way on to the nearest each time."""
    points: Array = np.unique(np.round(np.array(ends, dtype=np.float64), 12), axis=0)
    if len(points) < 3:
        return points
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    order = [int(np.unravel_index(np.argmax(apart), apart.shape)[0])]
    left = set(range(len(points))) - set(order)
    while left:
        order.append(min(left, key=lambda k: (apart[order[-1], k], k)))
        left.remove(order[-1])
    return np.asarray(points[order], dtype=np.float64)
