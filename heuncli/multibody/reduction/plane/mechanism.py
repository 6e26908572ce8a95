"""Make a flat scene in the axes of its plane: the in-plane motion of its bodies, joints and loads.

    x' = E x for the world,   x' = S x for a body      with S = E where that leaves the body upright, else S = E R(0)

All bodies then turn about z from an attitude that is a rotation about z, and the coordinates are those of the scene
itself. Heights are dropped, except those of the ends of rods and of loads along a line, whose lengths depend on them.

Between bodies that cannot tilt a coupling sets the same condition in the plane as in space: load components out of the
plane do no work. For all others a condition must be its own mirror image: its points and forces lie in the plane, and
rotations are about the normal. No condition may contain a coordinate that cannot move in the plane.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart, Place
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, Load, Placement, PointLoad, TwoPointLoad
from heuncli.multibody.mechanism.model import Assembly, Blow, Body, Joint, Mechanism, NamedPoint
from heuncli.multibody.reduction.plane.view import Departure, PlaneView, height_departures
from heuncli.multibody.reduction.smaller_scene import (
    SceneTransform,
    first_direction_body,
    point_body,
    second_direction_body,
    transform_couplings,
)
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.pack import lay_out_like
from heuncli.multibody.tree.prepare import IdleSpin, PreparedScene
from heuncli.multibody.tree.starts import JointStart, body_state
from heuncli.results.results import Array
from heuncli.scene.expressions.composition import weighted_sum
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Expression

# directions of a part's load that lie in the plane, and axes that are normal to it, by the part's kind
IN_PLANE_DIRECTIONS: Mapping[str, str] = {
    "guide": "e", "mesh": "e", "touches": "e", "rolls": "e", "rolls_aside": "e", "ball_touches": "e", "ball_rolls": "e",
}  # fmt: skip
NORMAL_DIRECTIONS: Mapping[str, str] = {
    "turn": "e", "strand": "e", "arc": "e", "wound": "g", "mesh": "g", "touches": "g", "rolls": "g", "rolls_aside": "g",
    "cam": "e",
}  # fmt: skip
Axes = Callable[[int], Array]


def flat_transform(plane_view: PlaneView, axes: Axes, coupling: Coupling) -> SceneTransform:
    """Make the transformation of a coupling to the flat scene; axes: (3, 3) of a body or the ground, from its
    components.

    Points keep their heights over that of the first point, so that strands between two of them keep their lengths.
    """
    first = coupling.rows[0].parts[0]
    base = plane_view.point_height(point_body(first), np.asarray(first.p))

    def point(body: int, p: Place) -> Array:
        found: Array = axes(body) @ np.asarray(p)
        rise = plane_view.point_height(body, np.asarray(p)) - base
        found[2] = rise if abs(rise) > tolerances.FLAT * plane_view.reach else 0.0
        return found

    def direction(body: int, e: Place) -> Array:
        return remove_tilt(axes(body) @ np.asarray(e))

    return SceneTransform(body=int, joint=int, point=point, direction=direction)


def remove_tilt(x: Array) -> Array:
    """Set to zero the components of a direction that are rounding, out of the plane or off its normal."""
    return np.where(np.abs(x) <= tolerances.FLAT * np.sqrt(x @ x), 0.0, x)


def iter_coupling_departures(plane_view: PlaneView, height: float | None) -> Iterator[Departure]:
    """Yield what leaves the plane in the couplings; height: of the plane, or None if no body could tilt out of it."""
    mechanism = plane_view.scene.mechanism
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        name = mechanism.owner_path(owner)
        fixed_coordinates = list(_coordinate_departures(plane_view, coupling, name))
        yield from fixed_coordinates
        if height is not None and not fixed_coordinates and not all(plane_view.is_upright(i) for i in coupling.bodies):
            for part in (part for row in coupling.rows for part in row.parts):
                yield from _point_departures(plane_view, part, name, height)
                yield from _direction_departures(plane_view, part, name)


def _coordinate_departures(plane_view: PlaneView, coupling: Coupling, name: str) -> Iterator[Departure]:
    """Yield coordinates of a coupling that keep their start values in the plane."""
    joints = plane_view.scene.mechanism.joints
    for k, quantity in dict.fromkeys(x[:2] for row in coupling.rows for part in row.parts for x in part.coordinates):
        if plane_view.is_fixed_coordinate(k, quantity):
            yield Departure(f"{name} uses {joints[k].name}.{quantity}, an out-of-plane coordinate", 1.0, True)


def _point_departures(plane_view: PlaneView, part: CouplingPart, name: str, height: float) -> Iterator[Departure]:
    """Yield the points outside the plane at which a part acts on bodies that could tilt."""
    for body, point in part.body_points:
        yield from height_departures(plane_view, height, body, point, f"a point of {name}")


def _direction_departures(plane_view: PlaneView, part: CouplingPart, name: str) -> Iterator[Departure]:
    """Yield the directions out of the plane of a part between bodies that could tilt."""
    kind = part.kind
    if kind == "dot":
        yield Departure(f"{name} couples shafts that bend out of the plane", 1.0, True)
    directions = {
        "e": (first_direction_body(part), np.asarray(part.e)),
        "g": (second_direction_body(part), np.asarray(part.g)),
    }
    in_plane, normal = (
        [directions[key] for key in keys.get(kind, "")] for keys in (IN_PLANE_DIRECTIONS, NORMAL_DIRECTIONS)
    )
    if part.cam is not None:
        (normal if part.cam.swings else in_plane).append(directions["g"])
        in_plane += [] if part.cam.face is None else [(part.b, part.cam.face)]
    for body, x in in_plane:
        along, _ = _split_direction(plane_view, body, x)
        if along > tolerances.FLAT:
            yield Departure(f"the force of {name} points out of the plane by {along:.1g} (sine)", along, True)
    for body, x in normal:
        _, across = _split_direction(plane_view, body, x)
        if across > tolerances.FLAT:
            yield Departure(f"an axis of {name} deviates from the plane normal by {across:.1g} (sine)", across, True)


def _split_direction(plane_view: PlaneView, body: int, x: Array) -> tuple[float, float]:
    """Return the relative components of a body's direction along the normal and across it; zeros for a zero vector."""
    n, size = plane_view.normal_components(body), float(np.sqrt(x @ x))
    along = float(x @ n)
    transverse = x - along * n
    return (abs(along) / size, float(np.sqrt(transverse @ transverse)) / size) if size > 0.0 else (0.0, 0.0)


X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
ZERO = Expression.from_number(0.0)


class UnrepresentableLoadError(Exception):
    """A load whose components along the plane's axes cannot be expressed."""


@record
class FlatAttitude:
    """A body's axes in the plane: S (3, 3) transforms components to them; turn: cosine and sine of its rotation about
    z.
    """

    S: Array
    turn: tuple[float, float]


def make_attitude(E: Array, R: Array) -> FlatAttitude:
    """Make the axes of a body that starts with the rotation R."""
    A = E @ R @ E.T
    if np.abs([A[0, 2], A[1, 2], A[2, 0], A[2, 1]]).max() <= tolerances.FLAT and A[2, 2] > 0.0:
        return FlatAttitude(E, cosine_and_sine(A))
    return FlatAttitude(E @ R, (1.0, 0.0))


def cosine_and_sine(A: Array) -> tuple[float, float]:
    """Cosine and sine of a rotation that is one about z up to rounding."""
    c, s = float(A[0, 0] + A[1, 1]), float(A[1, 0] - A[0, 1])
    size = math.sqrt(c * c + s * s)
    return (1.0, 0.0) if c > 0.0 and abs(s) <= 8.0 * tolerances.EPS * size else (c / size, s / size)


def rotation_about_z(turn: tuple[float, float]) -> Array:
    """Return the rotation about z with this cosine and sine."""
    c, s = turn
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class FlatSceneBuilder:
    """Builds the parts of the flat scene; used for one call of `flat_scene`."""

    def __init__(self, plane_view: PlaneView) -> None:
        self.plane_view, self.scene = plane_view, plane_view.scene
        self.start = plane_view.scene.start
        self.attitudes = [make_attitude(plane_view.E, R) for R in self.start.rotation]
        self.artificial_inertia = {spin.body: spin.artificial_inertia for spin in plane_view.scene.idle_spins}

    def body_axes(self, body: int) -> Array:
        """Return S of a body; E of the ground."""
        return self.plane_view.E if body == GROUND else self.attitudes[body].S

    def point_in_plane(self, body: int, point: Array) -> Array:
        """Return a body's point, without its height."""
        return _drop_z(self.body_axes(body) @ point)

    def end_points(self, a: int, p: Array, b: int, q: Array) -> tuple[Array, Array]:
        """Return two points whose distance matters, with the difference of their heights."""
        rise = self.plane_view.point_height(b, q) - self.plane_view.point_height(a, p)
        if abs(rise) <= tolerances.FLAT * self.plane_view.reach:
            rise = 0.0
        return self.point_in_plane(a, p), self.point_in_plane(b, q) + rise * Z

    def moment_of_inertia(self, i: int, J: Array) -> float:
        """A body's moment of inertia about the normal; 0 where it is rounding."""
        n = self.plane_view.normal_components(i)
        about = float(n @ J @ n)
        return about if about > tolerances.NO_INERTIA * float(np.trace(J)) else 0.0

    def build_body(self, i: int) -> Body:
        """Build body i: its mass, centre and moment of inertia."""
        body = self.scene.mechanism.bodies[i]
        inertia = _flat_inertia(self.moment_of_inertia(i, body.inertia))
        return Body(
            name=body.name, mass=body.mass, center=self.point_in_plane(i, body.center), inertia=inertia,
            points={}, position=None, rotation=None, velocity=None, angular_velocity=None, near_position=None,
            near_rotation=None,
        )  # fmt: skip

    def build_joint(self, k: int) -> Joint:
        """Build joint k, of its kind in the plane."""
        joint, stance = self.scene.mechanism.joints[k], self.plane_view.orientations[k]
        kind, path = JOINTS[joint.kind], None
        if joint.path is not None:
            axis, path = X, self.build_path(joint.a, joint.path)
        elif stance.is_normal:
            axis = float(np.sign(stance.axis @ self.plane_view.n)) * Z
        else:
            axis = _unit(_drop_z(self.body_axes(joint.a) @ joint.axis))
        ends = self.point_in_plane(joint.a, joint.p), self.point_in_plane(joint.b, joint.q)
        p, q = self.end_points(joint.a, joint.p, joint.b, joint.q) if kind.keeps_distance else ends
        return replace(joint, kind=stance.flat_kind(kind).name, p=p, q=q, axis=axis, to_axis=axis, path=path)

    def build_path(self, body: int, path: Path) -> Path:
        """Build a path that is fixed in a body, without its height."""
        rotated = path.rotate(self.body_axes(body))
        return replace(rotated, coefficients=_drop_z(rotated.coefficients), normal=np.rint(rotated.normal))

    def build_joint_start(self, k: int) -> JointStart:
        """Build the start of joint k: its coordinates are unchanged, R_ref is a rotation about z."""
        joint, stance = self.scene.mechanism.joints[k], self.plane_view.orientations[k]
        start, kind = self.scene.layout.starts[k], stance.flat_kind(JOINTS[joint.kind])
        if "angle" in kind.coordinates:
            R_ref = rotation_about_z(cosine_and_sine(self.body_axes(joint.a) @ start.R_ref @ self.body_axes(joint.b).T))
            return JointStart(R_ref, start.angle, start.rate, 0.0, 0.0)
        turns = [(1.0, 0.0) if end == GROUND else self.attitudes[end].turn for end in (joint.a, joint.b)]
        R_ref = rotation_about_z(cosine_and_sine(rotation_about_z(turns[0]).T @ rotation_about_z(turns[1])))
        rate = 0.0
        if kind.turns:
            axis = stance.axis if kind.turns == ("axis",) else self.plane_view.n
            rate = float(axis @ (body_state(self.start, joint.b)[3] - body_state(self.start, joint.a)[3]))
        slides = "travel" in kind.coordinates
        return JointStart(R_ref, 0.0, rate, start.travel if slides else 0.0, start.speed if slides else 0.0)

    def build_load(self, load: Load) -> Load:
        """Build a load with its components in the plane. Raises UnrepresentableLoadError."""
        if isinstance(load, TwoPointLoad):
            p, q = self.end_points(load.a, load.p, load.b, load.q)
            return load.move(*(Placement(i, x, self.body_axes(i)) for i, x in ((load.a, p), (load.b, q))))
        if isinstance(load, JointLoad):
            return self.build_turn_spring(load) if load.row.has_potential else load
        assert isinstance(load, PointLoad), load  # scenes with ropes, threads that rub are moved as given (compose.py)
        if load.body == GROUND:
            return load
        S = self.body_axes(load.body) if load.in_body else self.plane_view.E
        point = None if load.point is None else self.point_in_plane(load.body, load.point)
        active = (2,) if load.is_couple else (0, 1)
        vector = tuple(self.build_component(load, S[k]) if k in active else ZERO for k in range(3))
        return replace(load, point=point, vector=vector)

    def build_turn_spring(self, load: JointLoad) -> Load:
        """Build a spring about a joint's axis; one about another axis than the normal moves nothing.

        The angle of a former universal is counted from the start there.
        """
        if not self.plane_view.orientations[load.joint].turns_in_plane:
            return PointLoad(load.name, "couple", GROUND, None, (ZERO, ZERO, ZERO), False)
        has_angle = "angle" in JOINTS[self.scene.mechanism.joints[load.joint].kind].coordinates
        start = 0.0 if has_angle else self.scene.layout.starts[load.joint].angle
        return replace(load, angle=load.angle - start)

    def build_component(self, load: PointLoad, direction: Array) -> Expression:
        """Build a load's component along a direction. Raises UnrepresentableLoadError where it cannot be expressed."""
        factors = np.where(np.abs(direction) <= tolerances.FLAT, 0.0, direction).tolist()
        expression = weighted_sum(list(zip(factors, load.vector, strict=True)))
        if expression is None:
            raise UnrepresentableLoadError(
                f"forces.{load.name}.vector is defined by cases, and its axes are not axes of the plane"
            )
        return expression

    def build_impulse(self, impulse: Blow) -> Blow:
        """Build an impulse with its components in the plane."""
        if impulse.body == GROUND:
            return impulse
        vector = (self.body_axes(impulse.body) if impulse.in_body else self.plane_view.E) @ impulse.vector
        vector = _drop_z(vector) if impulse.kind == "impulse" else vector[2] * Z
        return replace(
            impulse,
            vector=vector,
            point=None if impulse.point is None else self.point_in_plane(impulse.body, impulse.point),
        )

    def build_point(self, point: NamedPoint) -> NamedPoint:
        """Build a point that expressions use: its height is constant, and is added along the directions out of the
        plane.
        """
        axes, n = point.axes @ self.plane_view.E.T, self.plane_view.n
        height = self.plane_view.point_height(point.body, point.place)
        offset = point.offset + height * (point.axes @ n)
        return NamedPoint(point.body, self.point_in_plane(point.body, point.place), _drop_z(axes), offset)

    def build_couplings(self) -> tuple[Coupling, ...]:
        """Build the couplings, with the same conditions."""
        if not self.scene.mechanism.couplings:
            return ()
        return transform_couplings(self.scene.layout, lambda own: flat_transform(self.plane_view, self.body_axes, own))

    def build_idle_spins(self) -> tuple[IdleSpin, ...]:
        """Build the artificial inertias about the normal."""
        moments = [(i, self.moment_of_inertia(i, inertia)) for i, inertia in self.artificial_inertia.items()]
        return tuple(IdleSpin(i, Z[None], _flat_inertia(moment)) for i, moment in moments if moment > 0.0)

    def build_assembly(self) -> Assembly:
        """Build the poses and rates at the start."""
        start, E = self.start, self.plane_view.E
        rotation = np.array([rotation_about_z(body_attitude.turn) for body_attitude in self.attitudes]).reshape(
            -1, 3, 3
        )
        return replace(
            start, position=_drop_z(start.position @ E.T), rotation=rotation,
            velocity=_drop_z(start.velocity @ E.T), angular_velocity=np.outer(start.angular_velocity @ E[2], Z),
        )  # fmt: skip

    def build_mechanism(self) -> Mechanism:
        """Build all parts. Raises UnrepresentableLoadError."""
        original = self.scene.mechanism
        return Mechanism(
            title=original.title,
            planar=True,
            gravity=_drop_z(self.plane_view.E @ original.gravity),
            bodies=tuple(self.build_body(i) for i in range(len(original.bodies))),
            joints=tuple(self.build_joint(k) for k in range(len(original.joints))),
            loads=tuple(self.build_load(load) for load in original.loads),
            impulses=tuple(self.build_impulse(impulse) for impulse in original.impulses),
            stops=original.stops,
            conditions=original.conditions,
            points={name: self.build_point(point) for name, point in original.points.items()},
            couplings=self.build_couplings(),
        )


def make_flat_scene(plane_view: PlaneView) -> PreparedScene:
    """Make the scene in the axes of its plane. Raises UnrepresentableLoadError where a load cannot be expressed."""
    builder = FlatSceneBuilder(plane_view)
    mechanism, start, idle_spins = builder.build_mechanism(), builder.build_assembly(), builder.build_idle_spins()
    artificial_inertia = {spin.body: spin.artificial_inertia for spin in idle_spins}
    inertias = np.array([body.inertia + artificial_inertia.get(i, 0.0) for i, body in enumerate(mechanism.bodies)])
    starts = [builder.build_joint_start(k) for k in range(len(mechanism.joints))]
    layout: Layout = lay_out_like(plane_view.scene.layout, mechanism, start, inertias, starts)
    return PreparedScene(mechanism, start, idle_spins, layout)


def _drop_z(x: Array) -> Array:
    """Return vectors (..., 3) without their component along z."""
    found = np.array(x)
    found[..., 2] = 0.0
    return found


def _unit(x: Array) -> Array:
    size = float(np.sqrt(x @ x))
    return x if size == 1.0 else np.asarray(x / size)


def _flat_inertia(moment: float) -> Array:
    """Return the inertia of a flat body with this moment about z."""
    return np.diag([0.5 * moment, 0.5 * moment, moment])
