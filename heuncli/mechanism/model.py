"""The mechanism as plain SI arrays: bodies, joints, drives and loads, before any tree is chosen.

Vectors are (3,) float64. Body index -1 is the ground. Values in time stay expressions (spec.expression.Expression).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from heuncli.expressions.programs import Expression
from heuncli.joint_kinds import JOINTS
from heuncli.records import record
from heuncli.results import Array

GROUND = -1


@record
class Directed:
    """A vector given in world axes or in the body's own."""

    vector: Array
    in_body: bool


@record
class Body:
    """A rigid body: mass [kg], centre of mass [m] and inertia about it [kg m2] in body axes; what of its start is held.

    position and velocity are those of the body's origin; None means left out. `near_*` only guides the assembly.
    """

    name: str
    mass: float
    center: Array
    inertia: Array
    points: dict[str, Array]
    position: Array | None
    rotation: Array | None
    velocity: Directed | None
    angular_velocity: Directed | None
    near_position: Array | None
    near_rotation: Array | None


@record
class Drive:
    """A coordinate prescribed in time: angle [rad], travel [m] or length [m].

    from_start: the value is what is added to the coordinate since t = 0, whose start the assembly is yet to find.
    """

    name: str
    quantity: Literal["angle", "travel", "length"]
    value: Expression
    zero_assembled: bool
    from_start: bool = False

    @property
    def adds_to_start(self) -> bool:
        """Whether the value is to be added to what the coordinate is at the assembled start.

        An angle counted from there is zero there; a travel is zero where the points are level.
        """
        return self.from_start or (self.zero_assembled and self.quantity == "travel")


@record
class Joint:
    """A joint between the points p of body a ("from") and q of body b ("to"), both in their body's axes.

    axis: unit vector in a's axes (for `plane`: the normal); to_axis: unit vector in b's axes, the same components
    unless `to_axis_given`. Held initial values are None where left out. length: of a rod, None = as assembled.
    """

    name: str
    kind: str
    a: int
    p: Array
    b: int
    q: Array
    axis: Array
    to_axis: Array
    to_axis_given: bool
    angle: float | None
    rate: float | None
    travel: float | None
    speed: float | None
    length: float | None
    tension_only: bool
    stiffness: tuple[Array, Array] | None  # force (3,) [N/m] and moment (3,) [N m/rad], inf where not given
    drive: Drive | None
    restitution: float | None = None  # of a rope that goes slack and catches; None: the run ends where it would push


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
    """A spring or actuator along the line between two points; value None for a spring. Positive pushes apart [N]."""

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
    turning: float = 1.0  # damper, turn spring: N m s; friction: N m; torque: 1
    sliding: float = 1.0  # damper: N s/m; friction: N; thrust: 1
    speed: float = 1.0  # friction: where tanh(rate/speed) bends
    stiffness: float = 0.0  # turn spring: N m/rad
    angle: float = 0.0  # turn spring: where it is relaxed [rad]

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


Load = PointLoad | PairLoad | JointLoad


@record
class Blow:
    """An impulse [N s] at a body's point at one instant, or an impulsive couple [N m s] on it.

    Of a couple point is where it enters, which a cut asks for, or None.
    """

    name: str
    body: int
    point: Array | None
    vector: Array
    in_body: bool
    time: float
    kind: Literal["impulse", "couple"] = "impulse"


@record
class Stop:
    """Limits of a joint's coordinate [rad] or [m], None where there is none; restitution: of its strikes, 0 to 1."""

    name: str
    joint: int
    quantity: Literal["angle", "travel", "length"]
    low: float | None
    high: float | None
    restitution: float


@record
class Condition:
    """What is true or not (1 or 0), in time and coordinates; ends: whether the motion ends where it becomes true."""

    name: str
    value: Expression
    ends: bool = False


@record
class Mechanism:
    """A scene, ready to be assembled."""

    title: str
    planar: bool
    gravity: Array
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    loads: tuple[Load, ...]
    blows: tuple[Blow, ...] = ()
    stops: tuple[Stop, ...] = ()
    conditions: tuple[Condition, ...] = ()

    def load_rows(self) -> Iterator[tuple[Load, slice]]:
        """The loads, each with its rows in the kernel's table of loads: of a load in a joint one a motion."""
        at = 0
        for load in self.loads:
            count = 1
            if isinstance(load, JointLoad):
                count = len(JOINTS[self.joints[load.joint].kind].moved_by(load.kind))
            yield load, slice(at, at + count)
            at += count

    def expressions(self) -> Iterator[Expression]:
        """The values in time of the loads, then those of the drives, then the conditions."""
        for load in self.loads:
            yield from load.values
        for joint in self.joints:
            if joint.drive is not None:
                yield joint.drive.value
        for condition in self.conditions:
            yield condition.value


@record
class Assembly:
    """Poses and rates at the start that fit all joints, world axes.

    position (n, 3) and velocity (n, 3) of the bodies' origins, rotation (n, 3, 3), angular_velocity (n, 3);
    chosen: sentences on what was chosen for the user; gap: largest closure gap [m]; moved: the bodies that had to leave
    the place in which they are drawn, each with its way.
    """

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array
    chosen: tuple[str, ...]
    gap: float
    moved: tuple[str, ...] = ()
