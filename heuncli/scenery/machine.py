"""A scene as something to look at: what its bodies look like in their own axes, and where its joints and loads stand.

Everything is in body axes [m]; where it comes to stand at an instant follows from the body's pose. A body with shapes
looks like them; one without is drawn as lines between its points.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.named_tuples import NamedTuple
from heuncli.results import Array
from heuncli.scenery.solids import Surface, surfaces_of
from heuncli.spec.models import Actuator, Spec, Spring

GROUND = "ground"


class BodyLook(NamedTuple):
    """A body: its named points (3,), the surfaces of its shapes, and, where it has none, lines between its points."""

    name: str
    points: Mapping[str, Array]
    surfaces: tuple[Surface, ...]
    lines: tuple[Array, ...]


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
    """What acts or holds along a line between two points: a spring, an actuator, a rod, a rope."""

    name: str
    kind: str
    a: str
    p: Array
    b: str
    q: Array


class Machine(NamedTuple):
    """All of a scene; grounded: the points of the ground."""

    title: str
    bodies: tuple[BodyLook, ...]
    joints: tuple[JointLook, ...]
    lines: tuple[LineLook, ...]
    grounded: Mapping[str, Array]


def machine_of(spec: Spec) -> Machine:
    """What there is to be seen of a loaded spec."""
    joints = tuple(
        JointLook(name, j.kind, j.a, np.array(j.p), j.b, np.array(j.q), np.array(j.axis))
        for name, j in spec.joints.items()
    )
    lines = tuple(
        LineLook(name, f.type, f.from_.body, np.array(f.from_.point), f.to.body, np.array(f.to.point))
        for name, f in spec.forces.items()
        if isinstance(f, Spring | Actuator)
    )
    bodies = tuple(_body(name, spec, joints, lines) for name in spec.bodies)
    grounded = {name: np.array(point) for name, point in spec.ground.points.items()}
    return Machine(spec.title, bodies, joints, lines, grounded)


def _body(name: str, spec: Spec, joints: tuple[JointLook, ...], lines: tuple[LineLook, ...]) -> BodyLook:
    """What a body looks like."""
    body = spec.bodies[name]
    points = {key: np.array(point, dtype=np.float64) for key, point in body.points.items()}
    surfaces = tuple(surface for shape in body.shapes or () for surface in surfaces_of(shape))
    if surfaces:
        return BodyLook(name, points, surfaces, ())
    ends = [j.p for j in joints if j.a == name] + [j.q for j in joints if j.b == name]
    ends += [line.p for line in lines if line.a == name] + [line.q for line in lines if line.b == name]
    ends += [*points.values(), np.array(body.center, dtype=np.float64)]
    return BodyLook(name, points, (), (_through(ends),))


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
