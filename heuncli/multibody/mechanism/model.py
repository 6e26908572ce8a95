"""The mechanism as plain SI arrays: bodies, joints, drives and loads, before any tree is chosen; its size.

Vectors are (3,) float64. Bodies and joints are identified by number, in the order of the spec; body -1 is the ground.
Values in time stay expressions (scene/expressions/programs.py). Bodies, joints, drives, impulses, stops and conditions
use the classes of the spec (scene/file_format/models.py); its kinds of loads become five, by where they act
(multibody/mechanism/loads.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, Load, PairLoad, RopeLoad, ThreadLoad
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import loads, models
from heuncli.scene.file_format.models import SIMULTANEOUS, Condition, ImpactModel

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


class Law(NamedTuple):
    """The law that prescribes a coordinate or a length in time.

    owner: number as in `Mechanism.owner_path`
    name: of the drive, or of the rope that is drawn in and paid out
    """

    owner: int
    name: str
    quantity: Literal["angle", "travel", "length"]
    value: Expression
    is_rope: bool = False

    @property
    def path(self) -> str:
        """Its path in the spec."""
        return f"couplings.{self.name}.length" if self.is_rope else f"drives.{self.name}"


class StickingFriction(NamedTuple):
    """A place where friction may stick: its load, the row of that among all loads, and the coordinate that it holds."""

    load: JointLoad | ThreadLoad
    load_row: int
    quantity: Literal["angle", "travel", "thread"]

    @property
    def joint(self) -> int:
        """The joint whose coordinate it holds; -1 for a thread, which holds those of its coupling."""
        return self.load.joint if isinstance(self.load, JointLoad) else -1


@record
class NamedPoint:
    """A point whose position and velocity appear in expressions; place: on the body, its axes [m].

    axes (3, 3): the directions x, y, z of its components, as rows, in the axes of the mechanism
    offset (3,): added to its position along them, where these are not the world's (reduction/plane)
    """

    body: int
    place: Array
    axes: Array
    offset: Array


@record
class Mechanism:
    """A scene, ready to be assembled; gravity (3,): acceleration, world axes [m/s^2].

    points: those that appear in expressions, by their names there
    impacts: how impulses pass through closed contacts
    """

    title: str
    planar: bool
    gravity: Array
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    loads: tuple[Load, ...]
    impulses: tuple[Blow, ...] = ()
    stops: tuple[Stop, ...] = ()
    conditions: tuple[Condition, ...] = ()
    points: Mapping[str, NamedPoint] = MappingProxyType({})
    couplings: tuple[Coupling, ...] = ()
    impacts: ImpactModel = SIMULTANEOUS

    def owner_path(self, k: int) -> str:
        """Return the path of a closure row's owner: of joint k, or of a coupling for numbers after those of the
        joints.
        """
        joints = len(self.joints)
        if k < joints:
            return f"joints.{self.joints[k].name}"
        coupling = self.couplings[k - joints]
        return f"{'rolling' if coupling.entry.type == 'wheel' else 'couplings'}.{coupling.name}"

    @cached_property
    def scale_masses(self) -> Array:
        """The masses by which accelerations are estimated, (n,) [kg]: of a body without mass that of the lightest."""
        masses = np.array([body.mass for body in self.bodies])
        return np.where(masses > 0.0, masses, np.min(masses, initial=np.inf, where=masses > 0.0))

    @property
    def laws(self) -> tuple[Law, ...]:
        """The laws of all drives, then of the ropes whose lengths are driven."""
        drives = ((k, joint.drive) for k, joint in enumerate(self.joints) if joint.drive is not None)
        found = [Law(k, drive.name, drive.quantity, drive.value) for k, drive in drives]
        for owner, coupling in enumerate(self.couplings, len(self.joints)):
            if coupling.law is not None:
                found.append(Law(owner, coupling.name, "length", coupling.law, is_rope=True))
        return tuple(found)

    @property
    def piece_numbers(self) -> tuple[Expression, ...]:
        """The piece numbers of the lifts in segments, whose changes end a step."""
        parts = (part for coupling in self.couplings for row in coupling.rows for part in row.parts)
        return tuple(part.cam.piece_number for part in parts if part.cam is not None and part.cam.piece_number)

    def iter_load_rows(self) -> Iterator[tuple[Load, slice]]:
        """Yield the loads, each with its rows in the kernel's table of loads: one per motion for a load in a joint.

        A bushing has two, its shift and its turn.
        """
        first_row = 0
        for load in self.loads:
            count = load.count_rows(self.joints)
            yield load, slice(first_row, first_row + count)
            first_row += count

    def spec_block(self, load: Load) -> str:
        """Return the block of the spec that a load belongs to; those of belts, threads and elastic ropes are
        `couplings`.
        """
        if isinstance(load, PairLoad) and any(
            coupling.name == load.name and coupling.has_pretension for coupling in self.couplings
        ):
            return "couplings"
        return load.path.partition(".")[0]

    def rope_load_row(self, name: str) -> int:
        """Return the row of an elastic rope in that table; -1 if there is none, because the scene has no loads."""
        return next((rows.start for x, rows in self.iter_load_rows() if isinstance(x, RopeLoad) and x.name == name), -1)

    @property
    def joint_friction(self) -> tuple[JointLoad | ThreadLoad, ...]:
        """Friction that depends on the load of its joint or its thread."""
        return tuple(
            load for load in self.loads if isinstance(load, JointLoad | ThreadLoad) and load.presses is not None
        )

    def iter_sticking(self) -> Iterator[StickingFriction]:
        """Yield the places where friction may stick."""
        for load, rows in self.iter_load_rows():
            if isinstance(load, ThreadLoad) and load.static > 0.0:
                yield StickingFriction(load, rows.start, "thread")
            if not isinstance(load, JointLoad) or load.static == 0.0:
                continue
            motions = JOINTS[self.joints[load.joint].kind].motions_for_load(load.kind)
            for row, motion in enumerate(motions, rows.start):
                if len(motions) == 1 or (load.turning if motion == "turning" else load.sliding):
                    yield StickingFriction(load, row, "angle" if motion == "turning" else "travel")

    def describe_friction(self, load: JointLoad | ThreadLoad) -> str:
        """Return the path of such friction and of its joint; a thread has only its own."""
        return load.path + (f" in joints.{self.joints[load.joint].name}" if isinstance(load, JointLoad) else "")

    def iter_expressions(self) -> Iterator[Expression]:
        """Yield the values in time of the loads, then the laws of drives and ropes, the conditions, and the piece
        numbers of cams' lifts.
        """
        for load in self.loads:
            yield from load.values
        for law in self.laws:
            yield law.value
        for condition in self.conditions:
            yield condition.value
        yield from self.piece_numbers


@record
class Assembly:
    """Poses and rates at the start that fit all joints, world axes.

    position, velocity (n, 3): of the bodies' origins rotation (n, 3, 3), angular_velocity (n, 3)
    start_choices: sentences on start values that heun has chosen
    gap: largest closure gap [m]
    displaced_bodies: the bodies that had to leave their place in the drawing, each with its displacement
    start_motions: sentences on velocities that nothing in the spec prescribes, or that may be unexpected
    """

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array
    start_choices: tuple[str, ...]
    gap: float
    displaced_bodies: tuple[str, ...] = ()
    start_motions: tuple[str, ...] = ()


def scene_size(mechanism: Mechanism, start: Assembly) -> float:
    """Twice the largest distance of the bodies' extent points and the ground's joint points from their mean [m]; 1 if
    all coincide.
    """
    places = [
        start.position[i] + start.rotation[i] @ p
        for i, body in enumerate(mechanism.bodies)
        for p in extent_points(body)
    ]
    places += [j.p for j in mechanism.joints if j.a == GROUND] + [j.q for j in mechanism.joints if j.b == GROUND]
    x = np.array(places)
    reach = 2.0 * float(np.sqrt(np.max(np.sum(np.square(x - x.mean(axis=0)), axis=1))))
    return reach if reach > tolerances.ONE_PLACE * float(np.max(np.abs(x), initial=0.0)) else 1.0


def extent_points(body: Body) -> list[Array]:
    """Return points that represent a body's extent: its centre of mass and its named points, body axes.

    Where none of them is as far from the centre as the radius of gyration, points at that distance along the axes are
    added.
    """
    points = [body.center, *body.points.values()]
    gyration = math.sqrt(max(float(np.trace(body.inertia)), 0.0) / (2.0 * body.mass)) if body.mass > 0.0 else 0.0
    if max(x * x + y * y + z * z for x, y, z in (np.array(points) - body.center).tolist()) < gyration**2:
        points += [body.center + gyration * e for e in np.eye(3)]
    return points
