"""A flat scene in the axes of its plane: what of its bodies, joints and loads moves in it.

    x' = E x for the world,   x' = S x for a body      with S = E where that leaves the body upright, else S = E R(0)
All bodies then turn about z from an attitude that is one about z, and coordinates are those of the scene itself.
Heights are left out, but of the ends of rods and of what acts along a line, whose lengths they are part of.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import (
    GROUND,
    Assembly,
    Blow,
    Body,
    BushingLoad,
    Joint,
    JointLoad,
    Load,
    Mechanism,
    NamedPoint,
    PairLoad,
    PointLoad,
)
from heuncli.multibody.reduction.plane.view import View
from heuncli.multibody.tree.idle_spins import IdleSpin
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.pack import lay_out_like
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import JointStart, pose
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.sums import weighted_sum

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
ZERO = Expression.of(0.0)


class NotTold(Exception):
    """A load whose components along the plane's axes cannot be written down."""


@record
class Attitude:
    """A body's axes in the plane: S (3, 3) takes components to them; turn: cosine and sine of its attitude about z."""

    S: Array
    turn: tuple[float, float]


def attitude(E: Array, R: Array) -> Attitude:
    """Of a body that starts with the rotation R."""
    A = E @ R @ E.T
    if np.abs([A[0, 2], A[1, 2], A[2, 0], A[2, 1]]).max() <= tolerances.FLAT and A[2, 2] > 0.0:
        return Attitude(E, about_z(A))
    return Attitude(E @ R, (1.0, 0.0))


def about_z(A: Array) -> tuple[float, float]:
    """Cosine and sine of a rotation that is one about z but for rounding."""
    c, s = float(A[0, 0] + A[1, 1]), float(A[1, 0] - A[0, 1])
    size = math.sqrt(c * c + s * s)
    return (1.0, 0.0) if c > 0.0 and abs(s) <= 8.0 * tolerances.EPS * size else (c / size, s / size)


def turned(turn: tuple[float, float]) -> Array:
    """The rotation about z of that cosine and sine."""
    c, s = turn
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class Flat:
    """Makes the parts of the flat scene; lives for one call of `flat_scene`."""

    def __init__(self, seen: View) -> None:
        self.seen, self.scene = seen, seen.scene
        self.start = seen.scene.start
        self.of = [attitude(seen.E, R) for R in self.start.rotation]
        self.lent = {spin.body: spin.lent for spin in seen.scene.idle}

    def axes(self, body: int) -> Array:
        """S of a body; E of the ground."""
        return self.seen.E if body == GROUND else self.of[body].S

    def place(self, body: int, point: Array) -> Array:
        """A body's point, without its height."""
        return _in_plane(self.axes(body) @ point)

    def ends(self, a: int, p: Array, b: int, q: Array) -> tuple[Array, Array]:
        """Two points the distance of which matters, with the difference of their heights."""
        rise = self.seen.height(b, q) - self.seen.height(a, p)
        if abs(rise) <= tolerances.FLAT * self.seen.reach:
            rise = 0.0
        return self.place(a, p), self.place(b, q) + rise * Z

    def moment(self, i: int, J: Array) -> float:
        """A body's moment of inertia about the normal; none where it is rounding."""
        n = self.seen.normal_in(i)
        about = float(n @ J @ n)
        return about if about > tolerances.NO_INERTIA * float(np.trace(J)) else 0.0

    def body(self, i: int) -> Body:
        """Body i: its mass, centre and moment of inertia."""
        body = self.scene.mechanism.bodies[i]
        inertia = _flat(self.moment(i, body.inertia))
        return Body(
            name=body.name, mass=body.mass, center=self.place(i, body.center), inertia=inertia,
            points={}, position=None, rotation=None, velocity=None, angular_velocity=None, near_position=None,
            near_rotation=None,
        )  # fmt: skip

    def joint(self, k: int) -> Joint:
        """Joint k, of the kind that it is in the plane."""
        joint, stance = self.scene.mechanism.joints[k], self.seen.stances[k]
        kind, path = JOINTS[joint.kind], None
        if joint.path is not None:
            axis, path = X, self.path(joint.a, joint.path)
        elif stance.along:
            axis = float(np.sign(stance.axis @ self.seen.n)) * Z
        else:
            axis = _unit(_in_plane(self.axes(joint.a) @ joint.axis))
        ends = self.place(joint.a, joint.p), self.place(joint.b, joint.q)
        p, q = self.ends(joint.a, joint.p, joint.b, joint.q) if kind.keeps_distance else ends
        return replace(joint, kind=stance.flat(kind).name, p=p, q=q, axis=axis, to_axis=axis, path=path)

    def path(self, body: int, path: Path) -> Path:
        """A path that is fixed in a body, without its height."""
        found = path.turned(self.axes(body))
        return replace(found, coefficients=_in_plane(found.coefficients), normal=np.rint(found.normal))

    def joint_start(self, k: int) -> JointStart:
        """Where joint k stands: coordinates as they are, R_ref about z."""
        joint, stance = self.scene.mechanism.joints[k], self.seen.stances[k]
        given, kind = self.scene.layout.starts[k], stance.flat(JOINTS[joint.kind])
        if "angle" in kind.coordinates:
            R_ref = turned(about_z(self.axes(joint.a) @ given.R_ref @ self.axes(joint.b).T))
            return JointStart(R_ref, given.angle, given.rate, 0.0, 0.0)
        turns = [(1.0, 0.0) if end == GROUND else self.of[end].turn for end in (joint.a, joint.b)]
        R_ref = turned(about_z(turned(turns[0]).T @ turned(turns[1])))
        rate = 0.0
        if kind.turns:
            axis = stance.axis if kind.turns == ("axis",) else self.seen.n
            rate = float(axis @ (pose(self.start, joint.b)[3] - pose(self.start, joint.a)[3]))
        slides = "travel" in kind.coordinates
        return JointStart(R_ref, 0.0, rate, given.travel if slides else 0.0, given.speed if slides else 0.0)

    def load(self, load: Load) -> Load:
        """A load with what of it acts in the plane. Raises NotTold."""
        if isinstance(load, PairLoad):
            p, q = self.ends(load.a, load.p, load.b, load.q)
            return replace(load, p=p, q=q)
        if isinstance(load, BushingLoad):
            p, q = self.ends(load.a, load.p, load.b, load.q)
            frames = self.axes(load.a) @ load.frame, self.axes(load.b) @ load.to_frame
            return replace(load, p=p, q=q, frame=frames[0], to_frame=frames[1])
        if isinstance(load, JointLoad):
            return self.turn_spring(load) if load.kind == "turn_spring" else load
        assert isinstance(load, PointLoad), load  # scenes with ropes, threads that rub are moved as given (compose.py)
        if load.body == GROUND:
            return load
        S = self.axes(load.body) if load.in_body else self.seen.E
        point = None if load.point is None else self.place(load.body, load.point)
        acts = (0, 1) if load.kind == "force" else (2,)
        vector = tuple(self.component(load, S[k]) if k in acts else ZERO for k in range(3))
        return replace(load, point=point, vector=vector)

    def turn_spring(self, load: JointLoad) -> Load:
        """A spring about a joint's axis: what acts about another axis than the normal moves nothing.

        The angle of what was a universal is counted from the start there.
        """
        if not self.seen.stances[load.joint].winds:
            return PointLoad(load.name, "couple", GROUND, None, (ZERO, ZERO, ZERO), False)
        counted = "angle" in JOINTS[self.scene.mechanism.joints[load.joint].kind].coordinates
        start = 0.0 if counted else self.scene.layout.starts[load.joint].angle
        return replace(load, angle=load.angle - start)

    def component(self, load: PointLoad, direction: Array) -> Expression:
        """A load's component along a direction. Raises NotTold where its program cannot be written down."""
        factors = np.where(np.abs(direction) <= tolerances.FLAT, 0.0, direction).tolist()
        found = weighted_sum(list(zip(factors, load.vector, strict=True)))
        if found is None:
            raise NotTold(f"forces.{load.name}.vector branches, and no axis of the plane is one of its own")
        return found

    def blow(self, blow: Blow) -> Blow:
        """A blow with what of it acts in the plane."""
        if blow.body == GROUND:
            return blow
        vector = (self.axes(blow.body) if blow.in_body else self.seen.E) @ blow.vector
        vector = _in_plane(vector) if blow.kind == "impulse" else vector[2] * Z
        return replace(blow, vector=vector, point=None if blow.point is None else self.place(blow.body, blow.point))

    def point(self, point: NamedPoint) -> NamedPoint:
        """A point that expressions name: its height stays, and counts along what points out of the plane."""
        axes, n = point.axes @ self.seen.E.T, self.seen.n
        height = self.seen.height(point.body, point.place)
        offset = point.offset + height * (point.axes @ n)
        return NamedPoint(point.body, self.place(point.body, point.place), _in_plane(axes), offset)

    def couplings(self) -> tuple[Coupling, ...]:
        """The couplings, which ask for the same there."""
        if not self.scene.mechanism.couplings:
            return ()
        from heuncli.multibody.reduction.plane.coupled import seen_from  # few scenes have them
        from heuncli.multibody.reduction.restated_couplings import couplings_seen

        return couplings_seen(self.scene.layout, lambda own: seen_from(self.seen, self.axes, own))

    def idle(self) -> tuple[IdleSpin, ...]:
        """The inertia that is lent about the normal."""
        found = [(i, self.moment(i, lent)) for i, lent in self.lent.items()]
        return tuple(IdleSpin(i, Z[None], _flat(about)) for i, about in found if about > 0.0)

    def assembly(self) -> Assembly:
        """Poses and rates at the start."""
        start, E = self.start, self.seen.E
        rotation = np.array([turned(of.turn) for of in self.of]).reshape(-1, 3, 3)
        return replace(
            start, position=_in_plane(start.position @ E.T), rotation=rotation,
            velocity=_in_plane(start.velocity @ E.T), angular_velocity=np.outer(start.angular_velocity @ E[2], Z),
        )  # fmt: skip

    def mechanism(self) -> Mechanism:
        """All parts. Raises NotTold."""
        of = self.scene.mechanism
        return Mechanism(
            title=of.title, planar=True, gravity=_in_plane(self.seen.E @ of.gravity),
            bodies=tuple(self.body(i) for i in range(len(of.bodies))),
            joints=tuple(self.joint(k) for k in range(len(of.joints))),
            loads=tuple(self.load(load) for load in of.loads), blows=tuple(self.blow(blow) for blow in of.blows),
            stops=of.stops, conditions=of.conditions,
            points={name: self.point(point) for name, point in of.points.items()}, couplings=self.couplings(),
        )  # fmt: skip


def flat_scene(seen: View) -> PreparedScene:
    """The scene in the axes of its plane. Raises NotTold where a load cannot be written down."""
    flat = Flat(seen)
    mechanism, start, idle = flat.mechanism(), flat.assembly(), flat.idle()
    lent = {spin.body: spin.lent for spin in idle}
    inertias = np.array([body.inertia + lent.get(i, 0.0) for i, body in enumerate(mechanism.bodies)])
    starts = [flat.joint_start(k) for k in range(len(mechanism.joints))]
    layout: Layout = lay_out_like(seen.scene.layout, mechanism, start, inertias, starts)
    return PreparedScene(mechanism, start, idle, layout)


def _in_plane(x: Array) -> Array:
    """Vectors (..., 3) without their component along z."""
    found = np.array(x)
    found[..., 2] = 0.0
    return found


def _unit(x: Array) -> Array:
    size = float(np.sqrt(x @ x))
    return x if size == 1.0 else np.asarray(x / size)


def _flat(moment: float) -> Array:
    """The inertia of a flat body with that moment about z."""
    return np.diag([0.5 * moment, 0.5 * moment, moment])
