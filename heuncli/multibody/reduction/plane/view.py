"""A scene relative to a plane: which bodies cannot tilt out of it, and how its joints are oriented to it.

A body is upright if it is connected to the ground by joints that only turn about the normal or slide across it, or hold
it as two hinges hold a door. It moves along the plane at any height, and its joints carry all loads out of the plane.

A plane has axes, and each of some directions may be its normal:

    E = [e1; e2; n]      x' = E x: components along the plane's axes, the third across it

For a coordinate plane the axes are the world's in another order, and components are only permuted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import islice

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, ABOUT_TWO, ABOUT_Z, FLAT, JOINTS, LINE, NO_ROTATION, POINT, JointKind
from heuncli.base.records import record
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import body_state
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_vectors, perpendicular_pair

# Frame

MAX_CANDIDATES = 8  # directions that are tried: a normal is along or across each axis of a scene, so a few suffice


def plane_axes(n: Array) -> Array:
    """Return the axes of the plane normal to a direction, (3, 3), right-handed."""
    k = int(np.argmax(np.abs(n)))
    if np.abs(np.delete(n, k)).max() <= tolerances.FLAT * abs(float(n[k])):
        return np.eye(3)[[(k + 1) % 3, (k + 2) % 3, k]]
    n = n / np.sqrt(n @ n)
    e, f = perpendicular_pair(n)
    return np.array([e, f, n])


def iter_normals(scene: PreparedScene) -> Iterator[Array]:
    """Yield directions that may be the normal, the most likely ones first, each once."""
    if scene.mechanism.planar:
        yield np.array([0.0, 0.0, 1.0])
        return
    tried: list[Array] = []
    for n in _iter_directions(scene):
        size = float(np.sqrt(n @ n))
        if size > 0.0:
            n = n / size
            if not any(np.abs(cross_vectors(n, other)).max() <= tolerances.FLAT for other in tried):
                tried.append(n)
                yield n
        if len(tried) == MAX_CANDIDATES:
            return


def _iter_directions(scene: PreparedScene) -> Iterator[Array]:
    """Yield axes of pins and hinges, normals of in-plane vectors, world axes, normals of slides, axes of rotation, all
    others.
    """
    mechanism, start = scene.mechanism, scene.start
    axes = [(JOINTS[j.kind], body_state(start, j.a)[1] @ j.axis) for j in mechanism.joints]
    pins = [axis for kind, axis in axes if kind.turns == ("axis",) and not kind.shifts]
    yield from pins[:1]
    yield from islice(_iter_hinge_lines(scene), 1)
    yield from _iter_common_normal(_in_plane_vectors(scene))
    yield from np.eye(3)[::-1]
    yield from _iter_common_normal(np.array([axis for kind, axis in axes if kind.shifts]).reshape(-1, 3))
    yield from start.angular_velocity[:1]
    yield from (axis for kind, axis in axes if kind.has_axis)


def _iter_hinge_lines(scene: PreparedScene) -> Iterator[Array]:
    """Yield the vectors from one joint to another between the same two bodies, as along the hinges of a door."""
    first: dict[tuple[int, int], Array] = {}
    for joint in scene.mechanism.joints:
        x, R, _, _ = body_state(scene.start, joint.b)
        place = x + R @ joint.q
        ends = (min(joint.a, joint.b), max(joint.a, joint.b))
        if ends in first:
            yield place - first[ends]
        first.setdefault(ends, place)


def _in_plane_vectors(scene: PreparedScene) -> Array:
    """Return vectors that lie in the plane if there is one: between points of the scene, gravity, velocities."""
    mechanism, start = scene.mechanism, scene.start
    x, R = start.position, start.rotation
    places = [x[i] + R[i] @ body.center for i, body in enumerate(mechanism.bodies)]
    for joint in mechanism.joints:
        places += [p if b == GROUND else x[b] + R[b] @ p for b, p in ((joint.a, joint.p), (joint.b, joint.q))]
    found = np.array(places)
    return np.concatenate([found[1:] - found[0], start.velocity, mechanism.gravity[None]])


def _iter_common_normal(vectors: Array) -> Iterator[Array]:
    """Yield a direction normal to all vectors, if there is one; each counts by its direction."""
    size = np.sqrt(np.sum(np.square(vectors), axis=1))
    large = size > tolerances.FLAT * size.max(initial=0.0)
    if np.any(large):
        triangle = np.linalg.qr(vectors[large] / size[large, None], mode="r")  # many vectors, the same right-hand side
        yield np.linalg.svd(triangle, full_matrices=True)[2][2]


# View


@record
class JointOrientation:
    """How a joint is oriented to the plane: its axis, or one of its two, along the normal, or all of them across it.

    axis: the one along the normal, else its own, world axes
    misalignment: sine of the angle by which the axis is off the normal or the plane
    is_second: of two axes the second one is along the normal

    A joint without an axis counts as along the normal.
    """

    is_normal: bool
    axis: Array
    misalignment: float
    is_second: bool = False

    @property
    def turns_in_plane(self) -> bool:
        """Whether rotation about the joint's own axis is rotation in the plane."""
        return self.is_normal and not self.is_second

    def flat_kind(self, kind: JointKind) -> JointKind:
        """Return the kind of joint in the plane for a kind in space."""
        return FLAT[kind.name, self.is_normal]


@record
class PlaneView:
    """A scene and a plane: its axes E (3, 3), which bodies are upright, and the orientation of each joint."""

    scene: PreparedScene
    E: Array
    upright: tuple[bool, ...]
    orientations: tuple[JointOrientation, ...]
    reach: float  # of places [m]: the scene's size and how far it is from the origin

    @cached_property
    def n(self) -> Array:
        """The normal."""
        return np.asarray(self.E[2])

    def is_upright(self, body: int) -> bool:
        """Return whether nothing can tilt a body, or the ground, out of the plane."""
        return body == GROUND or self.upright[body]

    def point_height(self, body: int, point: Array) -> float:
        """Height of a body's point above the plane through the origin [m]."""
        x, R, _, _ = body_state(self.scene.start, body)
        return float(self.n @ (x + R @ point))

    def normal_components(self, body: int, in_body: bool = True) -> Array:
        """Return the normal in a body's axes, or in the world's."""
        return np.asarray(body_state(self.scene.start, body)[1].T @ self.n) if in_body else self.n

    def is_fixed_coordinate(self, joint: int, quantity: str) -> bool:
        """Return whether a coordinate cannot move in the plane."""
        spatial_joint = self.scene.mechanism.joints[joint]
        kind = JOINTS[spatial_joint.kind]
        return quantity in kind.coordinates and quantity not in self.orientations[joint].flat_kind(kind).coordinates


Neighbours = dict[int, dict[int, list[int]]]  # of a body or the ground: by neighbour, the joints between the two


def find_neighbours(scene: PreparedScene) -> Neighbours:
    """Find the neighbours of each body, with the joints between them."""
    adjacency: Neighbours = {}
    for k, joint in enumerate(scene.mechanism.joints):
        for a, b in ((joint.a, joint.b), (joint.b, joint.a)):
            adjacency.setdefault(a, {}).setdefault(b, []).append(k)
    return adjacency


def make_view(scene: PreparedScene, n: Array, adjacency: Neighbours | None = None) -> PlaneView:
    """Make the view of a scene from the plane normal to n; adjacency: its neighbours, if known (they do not depend on
    n).
    """
    E = plane_axes(n)
    mechanism, start = scene.mechanism, scene.start
    orientations = tuple(
        _find_orientation(j, body_state(start, j.a)[1], body_state(start, j.b)[1], E[2]) for j in mechanism.joints
    )
    upright = _find_upright(scene, orientations, E[2], find_neighbours(scene) if adjacency is None else adjacency)
    places = [start.position] + [p[None] for j in mechanism.joints for b, p in ((j.a, j.p), (j.b, j.q)) if b == GROUND]
    reach = scene.layout.size + float(np.abs(np.concatenate(places)).max(initial=0.0))
    return PlaneView(scene, E, upright, orientations, reach)


def _find_upright(
    scene: PreparedScene, orientations: Sequence[JointOrientation], n: Array, adjacency: Neighbours
) -> tuple[bool, ...]:
    """Find the bodies connected to the ground by joints that keep them upright, whether these are in the tree or
    not.
    """
    mechanism = scene.mechanism
    reached, waiting = {GROUND}, [GROUND]
    while waiting:
        for body, joints in adjacency.get(waiting.pop(), {}).items():
            if body in reached:
                continue
            is_kept_upright = any(_keeps_upright(JOINTS[mechanism.joints[k].kind], orientations[k]) for k in joints)
            if is_kept_upright or _is_hinged(scene, [(mechanism.joints[k], orientations[k]) for k in joints], n):
                reached.add(body)
                waiting.append(body)
    return tuple(mechanism.planar or i in reached for i in range(len(mechanism.bodies)))


def _is_hinged(scene: PreparedScene, joints: Sequence[tuple[Joint, JointOrientation]], n: Array) -> bool:
    """Return whether joints between two bodies hold points of one line along the normal, as two hinges hold a door.

    One of them holds its point entirely, the other one keeps it on that line.
    """
    points = []
    for joint, orientation in joints:
        hold = JOINTS[joint.kind].hold
        if hold is POINT or (hold is LINE and orientation.is_normal and orientation.misalignment <= tolerances.FLAT):
            x, R, _, _ = body_state(scene.start, joint.b)
            points.append((x + R @ joint.q, hold is POINT))
    for i, (x, is_fixed) in enumerate(points):
        for y, is_other_fixed in points[:i]:
            lever = abs(float((y - x) @ n))
            transverse = y - x - ((y - x) @ n) * n
            is_on_line = float(np.sqrt(transverse @ transverse)) <= tolerances.FLAT * lever
            if (is_fixed or is_other_fixed) and lever > tolerances.NO_LENGTH * scene.layout.size and is_on_line:
                return True
    return False


def _find_orientation(joint: Joint, R_a: Array, R_b: Array, n: Array) -> JointOrientation:
    kind = JOINTS[joint.kind]
    if not kind.has_axis:
        return JointOrientation(True, n, 0.0)
    axes = [R_a @ joint.axis, *([R_b @ joint.to_axis] if kind.turn is ABOUT_TWO else [])]
    components = [float(axis @ n) for axis in axes]
    misalignments = [float(np.sqrt(np.sum(np.square(axis - c * n)))) for axis, c in zip(axes, components, strict=True)]
    k = int(np.argmin(misalignments))
    # of two axes, which stay square, one is along the normal where the other is across, or both are across
    if misalignments[k] < max(map(abs, components)):
        others = [abs(c) for i, c in enumerate(components) if i != k]
        return JointOrientation(True, np.copysign(1.0, components[k]) * n, max([misalignments[k], *others]), k == 1)
    return JointOrientation(False, axes[0], max(map(abs, components)))


def _keeps_upright(kind: JointKind, orientation: JointOrientation) -> bool:
    """Return whether a joint leaves only rotations about the normal and shifts across it."""
    if orientation.misalignment > tolerances.FLAT:
        return False
    turns = kind.turn in (NO_ROTATION, ABOUT_Z) or (kind.turn is ABOUT_AXIS and orientation.is_normal)
    return turns and (not kind.shifts or kind.turn is ABOUT_Z or not orientation.is_normal)


# Departure


@record
class Departure:
    """What leaves the plane, in words, and by how much relative to the largest possible; acts: it is a load, impulse or
    drive.
    """

    what: str
    size: float
    acts: bool = False


def height_departures(plane_view: PlaneView, height: float, body: int, point: Array, what: str) -> Iterator[Departure]:
    """Yield a departure if a body's point, described by `what`, does not lie in the plane."""
    distance = abs(plane_view.point_height(body, point) - height)
    if distance > tolerances.FLAT * plane_view.reach:
        yield Departure(f"{what} is {distance:.1g} m off the plane", distance / plane_view.reach)
