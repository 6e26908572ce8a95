"""A scene as something to look at: what its bodies look like in their own axes, and where its joints and loads stand.

Everything is in body axes [m]; where it comes to stand at an instant follows from the body's pose. A body with shapes
looks like them, with arms to points outside them; one without is drawn as the wheel that it is, as lines between its
points, or, where these are one place, as the ellipsoid that has its inertia.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.named_tuples import NamedTuple
from heuncli.results import Array
from heuncli.scenery.solids import ROUND, Surface, ellipsoid, reached, surfaces_of
from heuncli.scenery.wheels import spokes, wheel_shapes
from heuncli.spec.models import Actuator, Bushing, Shape, Spec, Spring

GROUND = "ground"
NOTHING: Mapping[str, tuple[Array, ...]] = MappingProxyType({})
SMALL = 0.2  # of its radius of gyration: a body whose points lie within is drawn as it is spread
OUTSIDE = 1e-9  # of the way from a shape's axis to a point: what it lies outside that shape by rounding


class BodyLook(NamedTuple):
    """A body: its named points (3,), the surfaces of its shapes, and lines between its points, or from these to it.

    spread: the surface is not its own, but of the ellipsoid that has its inertia.
    """

    name: str
    points: Mapping[str, Array]
    surfaces: tuple[Surface, ...]
    lines: tuple[Array, ...]
    spread: bool = False


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
    """All of a scene; grounded: points of the ground; paths: lines in it along which points run; strands: of belts.

    Strands stand on bodies and the ground, in their axes.
    """

    title: str
    bodies: tuple[BodyLook, ...]
    joints: tuple[JointLook, ...]
    lines: tuple[LineLook, ...]
    grounded: Mapping[str, Array]
    paths: tuple[Array, ...] = ()
    strands: Mapping[str, tuple[Array, ...]] = NOTHING


def machine_of(spec: Spec, faces: int = ROUND) -> Machine:
    """What there is to be seen of a loaded spec; faces: of what is round, about its axis."""
    joints = tuple(
        JointLook(name, j.kind, j.a, np.array(j.p), j.b, np.array(j.q), np.array(j.axis))
        for name, j in spec.joints.items()
    )
    lines = tuple(
        LineLook(name, f.type, f.from_.body, np.array(f.from_.point), f.to.body, np.array(f.to.point))
        for name, f in spec.forces.items()
        if isinstance(f, Spring | Actuator | Bushing)
    )
    bodies = tuple(_body(name, spec, joints, lines, faces) for name in spec.bodies)
    grounded = {name: np.array(point) for name, point in spec.ground.points.items()}
    paths = tuple(drawn_lines(spec, GROUND))
    kinds = {own.type for own in spec.couplings.values()}
    if "screw" in kinds:
        from heuncli.scenery.threads import threads_of  # few scenes have screws

        threads = threads_of(spec)
        bodies = tuple(body._replace(lines=(*body.lines, *threads.get(body.name, ()))) for body in bodies)
    if not kinds & {"gear", "belt"}:
        return Machine(spec.title, bodies, joints, lines, grounded, paths)
    from heuncli.scenery.pitch_lines import pitch_lines  # few scenes have gears

    circles, strands = pitch_lines(spec)
    bodies = tuple(body._replace(lines=(*body.lines, *circles.get(body.name, ()))) for body in bodies)
    return Machine(spec.title, bodies, joints, lines, grounded, paths, strands)


def drawn_lines(spec: Spec, body: str) -> Iterator[Array]:
    """Lines of a body, or of the ground: outlines of cams, and paths along which points run."""
    if any(given.type == "cam" for given in spec.couplings.values()) or any(j.path for j in spec.joints.values()):
        from heuncli.scenery.cams import cam_outlines, paths_of  # few scenes have them

        yield from cam_outlines(spec, body)
        yield from paths_of(spec, body)


def shapes_of(spec: Spec, body: str) -> Sequence[Shape]:
    """What a body is drawn by: its shapes; without any, the wheels that it is."""
    return spec.bodies[body].shapes or tuple(wheel_shapes(spec, body))


def _body(name: str, spec: Spec, joints: tuple[JointLook, ...], lines: tuple[LineLook, ...], faces: int) -> BodyLook:
    """What a body looks like."""
    body = spec.bodies[name]
    points = {key: np.array(point, dtype=np.float64) for key, point in body.points.items()}
    ends = [j.p for j in joints if j.a == name] + [j.q for j in joints if j.b == name]
    ends += [line.p for line in lines if line.a == name] + [line.q for line in lines if line.b == name]
    ends += points.values()
    shapes = shapes_of(spec, name)
    surfaces = tuple(surface for shape in shapes for surface in surfaces_of(shape, faces))
    if surfaces:
        ends += [np.array(shape.at) for shape in shapes if shape.type == "point"]
        return BodyLook(name, points, surfaces, (*_arms(shapes, ends), *spokes(spec, name), *drawn_lines(spec, name)))
    # of point masses alone neither centre nor inertia is known yet, nor needed
    centre = [np.array(shape.at) for shape in shapes] or [np.array(body.center, dtype=np.float64)]
    line, drawn = _through([*ends, *centre]), tuple(drawn_lines(spec, name))
    moments = np.array(body.inertia, dtype=np.float64)
    gyration = np.sqrt(max(0.0, float(np.trace(moments)) / (2.0 * body.mass))) if body.mass > 0.0 else 0.0
    if not drawn and float(np.ptp(line, axis=0).max()) < SMALL * gyration:
        return BodyLook(name, points, (ellipsoid(body.mass, np.array(body.center), moments, faces),), (), True)
    return BodyLook(name, points, (), (line, *drawn))


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
