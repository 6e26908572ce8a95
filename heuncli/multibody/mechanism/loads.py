"""The loads of a mechanism, by where they act: on points, between two points, in joints, along ropes and threads.

Vectors are (3,) float64, in body axes unless a name says otherwise; bodies and joints are numbers, in the spec's order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.load_kinds import LOAD_KINDS, LoadKind
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import loads, models

if TYPE_CHECKING:
    Directed = models.FramedVector[Array]
    Body = models.Body[Array, Array]
    Elastic = loads.Elastic[Array, Array]
    Joint = models.Joint[int, Array]
    Blow = models.AppliedImpulse[int, Array]
    Stop = models.Stop[int]
else:  # such an alias would slow each of its records down by 3 us
    Directed, Body, Joint, Stop = models.FramedVector, models.Body, models.Joint, models.Stop
    Blow = models.AppliedImpulse
    Elastic = loads.Elastic


GROUND = -1


@record
class TriangularDistribution:
    """A force distributed along a line of its body: largest at `start`, falling linearly to zero at `end`.

    Both points are in the axes of the body. With a force q per length at the start, the resultant is q l/2, at a third
    of the length from the start.
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
        """The point where the resultant acts."""
        return np.asarray((2.0 * self.start + self.end) / 3.0)


class Placement(NamedTuple):
    """Where an end of a load is put: its body, its point there, and the axes (3, 3) of the former body in the new."""

    body: int
    point: Array
    axes: Array


class AnyLoad:
    """The interface of all loads, with defaults that hold for most of them."""

    kind: str
    name: str
    damping: float = 0.0  # 0 where a kind has none of one number
    presses: str | None = None  # of friction: what of the load of its joint or thread presses, if that tells its size

    @property
    def row(self) -> LoadKind:
        """Its kind."""
        return LOAD_KINDS[self.kind]

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time."""
        return ()

    @property
    def is_damped(self) -> bool:
        """Whether what has a potential takes energy, too."""
        return self.damping != 0.0

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential, and nothing else."""
        return self.row.has_potential and not self.is_damped

    @property
    def has_value(self) -> bool:
        """Whether it has one value, a force or torque, that an input can change."""
        return False

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes; empty where it acts at its joint."""
        return ()

    @property
    def path(self) -> str:
        """Its path in the spec and in the results."""
        return f"{'couplings' if self.row.place in ('rope', 'thread') else 'forces'}.{self.name}"

    def count_rows(self, joints: Sequence[Joint]) -> int:
        """Return the number of its rows in the kernel's table of loads: one for each of its laws."""
        return len(self.row.kernel_laws)


@record
class PointLoad(AnyLoad):
    """A force [N] at a body's point, or a couple [N m] on it (point None or where the couple enters).

    Two of one name with a spread, one from either end, make a distributed load: q(s) = q0 (1 - s/l) + q1 s/l. For the
    motion of a rigid body only their resultants count; `vector` is then q0 or q1 [N/m].
    """

    name: str
    kind: str
    body: int
    point: Array | None
    vector: tuple[Expression, Expression, Expression]
    in_body: bool
    spread: TriangularDistribution | None = None

    @property
    def is_couple(self) -> bool:
        """Whether it is a couple."""
        return self.row.unit == "N·m"

    @property
    def factor(self) -> float:
        """Factor from the vector to the force."""
        return 1.0 if self.spread is None else self.spread.half_length

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time."""
        return self.vector

    @property
    def has_value(self) -> bool:
        """Whether it is not distributed."""
        return self.spread is None

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return ((self.body, self.point),) if self.point is not None else ()


class ValuedLoad(AnyLoad):
    """A load whose size is one value in time; None if a law of the kernel gives it."""

    value: Expression | None

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its value in time."""
        return (self.value,) if self.value is not None else ()

    @property
    def has_value(self) -> bool:
        """Whether it has one."""
        return self.value is not None


class TwoPointLoad(AnyLoad):
    """A load between points p and q of the bodies a and b."""

    a: int
    p: Array
    b: int
    q: Array

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return (self.a, self.p), (self.b, self.q)

    def move(self, a: Placement, b: Placement) -> Self:
        """Return it between other points, whose bodies may have other axes."""
        return replace(self, a=a.body, p=a.point, b=b.body, q=b.point)


@record
class PairLoad(ValuedLoad, TwoPointLoad):
    """A load along the line between two points.

    p, q: the points on the bodies a and b, body axes [m]
    value: [N], positive pushes the points apart; None for a spring stiffness [N/m], length: without load [m], damping
    [N s/m]
    """

    name: str
    kind: str
    a: int
    p: Array
    b: int
    q: Array
    value: Expression | None
    stiffness: float = 0.0
    length: float = 0.0
    damping: float = 0.0

    @property
    def needs_direction(self) -> bool:
        """Whether it has a force where its line has no length: all but a spring without free length, and nothing."""
        return self.stiffness * self.length != 0.0 if self.value is None else self.value.constant != 0.0

    @property
    def is_linear(self) -> bool:
        """Whether its force is proportional to the vector between its points."""
        return self.value is None and self.length == 0.0 and self.damping == 0.0


@record
class JointLoad(ValuedLoad):
    """A torque (thrust), turn spring, damper or friction in a joint; acts on `to`, opposite on `from`."""

    name: str
    kind: str
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
    static: float = 0.0  # friction that sticks: by which its size, or what presses, is what it can hold; 0: smoothed

    @property
    def is_damped(self) -> bool:
        """Whether a spring is damped."""
        return self.turning != 0.0

    def count_rows(self, joints: Sequence[Joint]) -> int:
        """Return the number of its rows in the kernel's table of loads: one for each motion that it acts on."""
        return len(JOINTS[joints[self.joint].kind].motions_for_load(self.kind))


@record
class BushingLoad(TwoPointLoad):
    """Six springs and dampers between two bodies; ON b at its point q, opposite on a at the same place.

    p, q: the points on the bodies a and b, their axes [m]
    frame (3, 3): its axes in a, as columns
    to_frame (3, 3): the axes in b that coincide with them where it is not turned
    coupling (3, 3): force by rotation [N/rad], its transpose moment by shift; coupling_damping [N s]: by the rates
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
    coupling: Array
    coupling_damping: Array
    kind: str = "bushing"

    @property
    def values(self) -> tuple[Expression, ...]:
        """Its values in time: of the shift, of the turn."""
        return (*self.shift.extra_load, *self.turn.extra_load)

    @property
    def is_damped(self) -> bool:
        """Whether some motion is."""
        return bool(np.any(self.shift.damping) or np.any(self.turn.damping))  # semidefinite: none couples alone

    def move(self, a: Placement, b: Placement) -> BushingLoad:
        """Return it between other points, its axes turned with those of their bodies."""
        return replace(super().move(a, b), frame=a.axes @ self.frame, to_frame=b.axes @ self.to_frame)


@record
class RopeLoad(AnyLoad):
    """An elastic rope: value [N], with the sign of a closure's multiplier, times the unit loads of its parts.

    It has the name of its coupling.

    stiffness [N/m]: at the unloaded length [m], which `law` gives in time if it is not None; 0 of a given tension
    only_pulls: it stores no energy where it is shorter
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
        """Its values in time: the pull, then the unloaded length where that varies."""
        return (self.value,) if self.law is None else (self.value, self.law)

    @property
    def is_conservative(self) -> bool:
        """Whether it has a potential, and nothing else."""
        return self.stiffness > 0.0 and self.law is None and not self.is_damped

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return tuple(place for part in self.parts if not part.lies_on_sheave for place in part.body_points)


@record
class ThreadLoad(AnyLoad):
    """Friction in a thread between the bodies a and b, from the axial force on its flanks; ON b at q.

    coupling: its number
    q: a point of b on the axis; axis: in a, body axes [m]
    coefficient [m]: torque per axial force
    factor [1/m]: axial force per torque
    speed: of the transition tanh(rate/speed)
    static [m]: torque per axial force up to which it sticks; 0: smoothed
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
    static: float = 0.0
    kind: str = "thread friction"
    presses: str = "thrust"

    @property
    def points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it acts on them, body axes."""
        return ((self.b, self.q),)


Load = PointLoad | PairLoad | JointLoad | BushingLoad | ThreadLoad | RopeLoad
