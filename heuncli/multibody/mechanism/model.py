"""The mechanism as plain SI arrays: bodies, joints, drives and loads, before any tree is chosen.

Vectors are (3,) float64. Bodies and joints are called by their numbers, in the order of the spec; body -1 is the
ground. Values in time stay expressions (scene/expressions/programs.py). Bodies, joints, drives, blows, stops and
conditions have the classes of the spec (scene/file_format/models.py); its kinds of loads become five, by where they
act.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import models
from heuncli.scene.file_format.models import SIMULTANEOUS, Condition, ImpactModel

GROUND = -1
if TYPE_CHECKING:
    Directed = models.Directed[Array]
    Body = models.Body[Array, Array]
    Elastic = models.Elastic[Array]
    Joint = models.Joint[int, Array]
    Blow = models.Blow[int, Array]
    Stop = models.Stop[int]
else:  # a record made by such an alias would be told of it, and refuse: 3 us each
    Directed, Body, Joint, Blow, Stop = models.Directed, models.Body, models.Joint, models.Blow, models.Stop
    Elastic = models.Elastic


@record
class Spread:
    """How a force is spread along a line of its body: densest at `start`, falling evenly to nothing at `end`.

    Both in the axes of the body that has the load; its resultant acts a third of the way from the start. So the force
    per length q there makes a force q l/2.
    """

    start: Array
    end: Array

    @property
    def half_length(self) -> float:
        """l/2 [m]."""
        run = self.end - self.start
        return 0.5 * float(np.sqrt(run @ run))

    @property
    def center(self) -> Array:
        """Where the resultant acts."""
        return np.asarray((2.0 * self.start + self.end) / 3.0)


@record
class PointLoad:
    """A force [N] at a body's point, or a couple [N m] on it (point None or where the couple enters).

    Two of one name that are spread, one from either end, make a distributed load: q(s) = q0 (1 - s/l) + q1 s/l. Of a
    rigid body's motion their resultants are all that counts; `vector` is then q0 or q1 [N/m].
    """

    name: str
    kind: Literal["force", "couple"]
    body: int
    point: Array | None
    vector: tuple[Expression, Expression, Expression]
    in_body: bool
    spread: Spread | None = None

    @property
    def factor(self) -> float:
        """By which the vector makes the force."""
        return 1.0 if self.spread is None else self.spread.half_length

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time."""
        return self.vector

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return False

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return ((self.body, self.point),) if self.point is not None else ()


@record
class PairLoad:
    """A spring or actuator along the line between two points; value [N], positive pushes apart; None for a spring.

    p, q: the points on the bodies a and b, their axes [m]; stiffness [N/m], length: relaxed [m], damping [N s/m].
    """

    name: str
    a: int
    p: Array
    b: int
    q: Array
    value: Expression | None
    stiffness: float
    length: float
    damping: float

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time."""
        return (self.value,) if self.value is not None else ()

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return self.value is None and self.damping == 0.0

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return (self.a, self.p), (self.b, self.q)


@record
class JointLoad:
    """A torque (thrust), turn spring, damper or friction in a joint; acts on `to`, opposite on `from`."""

    name: str
    kind: Literal["torque", "turn_spring", "damper", "friction"]
    joint: int
    value: Expression | None  # torque: N m about the axis, or N along the slide
    turning: float = 1.0  # damper, turn spring: N m s; friction: by which `value` is its size [N m]; torque: 1
    sliding: float = 1.0  # damper: N s/m; friction: by which `value` is its size [N]; thrust: 1
    speed: float = 1.0  # friction: where tanh(rate/speed) bends
    stiffness: float = 0.0  # turn spring: N m/rad
    angle: float = 0.0  # turn spring: where it is relaxed [rad]
    # friction: what of the joint's own load presses, if that tells its size; turning is then by it [m], sliding [1]
    presses: Literal["whole", "across", "ends"] | None = None
    reach: float = 0.0  # of two ends that press: their distance [m]

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time."""
        return (self.value,) if self.value is not None else ()

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return self.kind == "turn_spring" and self.turning == 0.0

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """None of its own: it acts at its joint."""
        return ()


@record
class BushingLoad:
    """Six springs and dampers between two bodies; ON b at its point q, opposite on a at the same place.

    p, q: the points on the bodies a and b, their axes [m]; frame (3, 3): its axes in a, as columns; to_frame: those in
    b that agree with them where it is not turned.
    """

    name: str
    a: int
    p: Array
    b: int
    q: Array
    frame: Array
    to_frame: Array
    shift: Elastic
    turn: Elastic
    kind: str = "bushing"

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time: of the shift, of the turn."""
        return (*self.shift.given, *self.turn.given)

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return not (np.any(self.shift.damping) or np.any(self.turn.damping))

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return (self.a, self.p), (self.b, self.q)


@record
class RopeLoad:
    """A rope that stretches: value [N], with the sign of a closure's multiplier, times the unit loads of its parts.

    It has the name of its coupling. stiffness [N/m] is that at the length [m] without load, which `law` tells in time
    if it is given; only_pulls: it keeps no work where it is shorter.
    """

    name: str
    parts: tuple[CouplingPart, ...]
    value: Expression
    stiffness: float
    length: float
    law: Expression | None
    damping: float
    only_pulls: bool
    kind: str = "rope"

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time: the pull, then the length without load where that varies."""
        return (self.value,) if self.law is None else (self.value, self.law)

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return self.damping == 0.0 and self.law is None

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return tuple(place for part in self.parts if not part.lies for place in part.places)


@record
class ThreadLoad:
    """What rubs in a thread between the bodies a and b, by what its flanks press with along its axis; ON b at q.

    coupling: its number. q: a point of b on the axis, axis: in a, body axes [m]; coefficient [m]: of the torque by what
    presses; factor [1/m]: of the force along the axis by that torque; speed: where tanh(rate/speed) bends.
    """

    name: str
    coupling: int
    a: int
    b: int
    q: Array
    axis: Array
    coefficient: float
    factor: float
    speed: float
    kind: str = "thread friction"

    @property
    def values(self) -> tuple[Expression, ...]:
        """None: it has no value in time."""
        return ()

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential."""
        return False

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return ((self.b, self.q),)


Load = PointLoad | PairLoad | JointLoad | BushingLoad | ThreadLoad | RopeLoad


def path_of_load(load: Load) -> str:
    """Where a load stands in the spec, or in the results."""
    return f"{'couplings' if isinstance(load, RopeLoad | ThreadLoad) else 'forces'}.{load.name}"


class Law(NamedTuple):
    """What prescribes a coordinate or a length in time.

    owner: as of `Mechanism.owner`; name: of the drive, or of the rope that is drawn in and paid out.
    """

    owner: int
    name: str
    quantity: Literal["angle", "travel", "length"]
    value: Expression
    of_rope: bool = False

    @property
    def path(self) -> str:
        """Where it stands in the spec."""
        return f"couplings.{self.name}.length" if self.of_rope else f"drives.{self.name}"


@record
class NamedPoint:
    """A point whose place and velocity expressions name; place: on the body, its axes [m].

    axes (3, 3): the directions x, y, z along which it is told, as rows, in the axes of the mechanism; offset (3,): of
    its place along them, where these are not the world's (reduction/plane).
    """

    body: int
    place: Array
    axes: Array
    offset: Array


@record
class Mechanism:
    """A scene, ready to be assembled; gravity (3,): acceleration, world axes [m/s^2].

    points: those that expressions name, by their names there; impacts: how blows go through contacts that touch.
    """

    title: str
    planar: bool
    gravity: Array
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    loads: tuple[Load, ...]
    blows: tuple[Blow, ...] = ()
    stops: tuple[Stop, ...] = ()
    conditions: tuple[Condition, ...] = ()
    points: Mapping[str, NamedPoint] = MappingProxyType({})
    couplings: tuple[Coupling, ...] = ()
    impacts: ImpactModel = SIMULTANEOUS

    def owner(self, k: int) -> str:
        """What a closure row belongs to, as a path: the joint of a number, or after these the coupling."""
        joints = len(self.joints)
        if k < joints:
            return f"joints.{self.joints[k].name}"
        coupling = self.couplings[k - joints]
        return f"{'rolling' if coupling.given.type == 'wheel' else 'couplings'}.{coupling.name}"

    @property
    def laws(self) -> tuple[Law, ...]:
        """The laws of all drives, then of the ropes whose lengths are driven."""
        drives = ((k, joint.drive) for k, joint in enumerate(self.joints) if joint.drive is not None)
        found = [Law(k, drive.name, drive.quantity, drive.value) for k, drive in drives]
        for owner, own in enumerate(self.couplings, len(self.joints)):
            if own.law is not None:
                found.append(Law(owner, own.name, "length", own.law, of_rope=True))
        return tuple(found)

    def load_rows(self) -> Iterator[tuple[Load, slice]]:
        """The loads, each with its rows in the kernel's table of loads: of a load in a joint one a motion.

        Of a bushing its shift and its turn.
        """
        at = 0
        for load in self.loads:
            count = 1
            if isinstance(load, JointLoad):
                count = len(JOINTS[self.joints[load.joint].kind].moved_by(load.kind))
            elif isinstance(load, BushingLoad):
                count = 2
            yield load, slice(at, at + count)
            at += count

    def block_of(self, load: Load) -> str:
        """The block of the spec that a load belongs to: belts pull their pulleys, threads rub, ropes stretch."""
        if isinstance(load, PairLoad) and any(own.name == load.name and own.pulls for own in self.couplings):
            return "couplings"
        return path_of_load(load).partition(".")[0]

    def row_of_rope(self, name: str) -> int:
        """Which row of that table is a rope's that stretches; -1: none, for loads are left out of the scene."""
        return next((own.start for x, own in self.load_rows() if isinstance(x, RopeLoad) and x.name == name), -1)

    @property
    def rubbing(self) -> tuple[JointLoad | ThreadLoad, ...]:
        """Friction that hangs on what its joint or its thread carries."""
        return tuple(
            load
            for load in self.loads
            if isinstance(load, ThreadLoad) or (isinstance(load, JointLoad) and load.presses is not None)
        )

    def rubs_in(self, load: JointLoad | ThreadLoad) -> str:
        """Such friction and where it rubs, as paths: a load in a joint, or what a thread has itself."""
        if isinstance(load, ThreadLoad):
            return f"couplings.{load.name}"
        return f"forces.{load.name} in joints.{self.joints[load.joint].name}"

    def expressions(self) -> Iterator[Expression]:
        """The values in time of the loads, then the laws of drives and ropes, then the conditions."""
        for load in self.loads:
            yield from load.values
        for law in self.laws:
            yield law.value
        for condition in self.conditions:
            yield condition.value


@record
class Assembly:
    """Poses and rates at the start that fit all joints, world axes.

    position (n, 3) and velocity (n, 3) of the bodies' origins, rotation (n, 3, 3), angular_velocity (n, 3);
    chosen: sentences on what was chosen for the user; gap: largest closure gap [m]; moved: the bodies that had to leave
    the place in which they are drawn, each with its way; started: sentences on velocities that nothing in the spec
    asks for, or that one may expect otherwise.
    """

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array
    chosen: tuple[str, ...]
    gap: float
    moved: tuple[str, ...] = ()
    started: tuple[str, ...] = ()
