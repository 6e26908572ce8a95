"""Reactions read elsewhere: the two bearings that a joint stands for, and sensors.

Two bearings at a and b along the unit axis n from the reaction's origin carry R1 and R2, across n. From R1 + R2 = F_r
and n x (a R1 + b R2) = M_t, the parts of the force F and the moment M across n:

    R2 = (M x n - a F_r)/(b - a),   R1 = F_r - R2

A sensor reads the reaction of a joint, or the load of a cut, about another point and in the axes of another body. A
wrench (F, M) about the point O is about P, in axes with the unit vectors e_i:

    F_i = e_i . F,   M_i = e_i . (M + (O - P) x F)

Both are linear: shares by cause, self-stresses and errors take the same way. Axes before that of the instants, such as
that of causes, are kept. From the spec to the number:

    SensorEntry            as it is written (scene/file_format/format.py), then models.Sensor with its names resolved
    make_sensors           PlacedSensor: the body of its point and that of its axes, by number
    find_sensor_reaction   Reaction: what it reads, about its own origin, in world axes
    PlacedSensor.read      the numbers: moved to the point and turned; study/compose/section_blocks.py makes the block
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action, list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads, project_to_plane, rotate_to_axes
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.models import BearingPair, Spec
from heuncli.scene.shapes.rotations import cross_rows

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts

# Bearings


def split_to_bearings(pair: BearingPair, n: Array, force: Array, moment: Array) -> tuple[Array, Array]:
    """Return the loads of two bearings across the axis n (n_t, 3), (..., n_t, 3) each."""
    first, second = pair.at
    across = force - np.sum(force * n, axis=-1)[..., None] * n
    R2 = (cross_rows(moment, np.broadcast_to(n, moment.shape)) - first * across) / (second - first)
    return across - R2, R2


def find_axial_parts(pair: BearingPair, axial: Array) -> tuple[Array, Array]:
    """Return the parts of an axial load (..., n_t) on two bearings; nan where it is not stated which carries it."""
    if pair.axial is None:
        unknown = np.full_like(axial, np.nan)
        return unknown, unknown
    zero = np.zeros_like(axial)
    return (axial, zero) if pair.axial == 0 else (zero, axial)


def make_bearing_loads(load: JointLoads, planar: bool = False) -> Block:
    """Return the loads of a joint's two bearings, by their numbers: across its axis, and along it if the joint carries
    that. Of a scene declared planar no load along the axis exists.
    """
    pair, n = load.joint.bearings, load.axis
    assert pair is not None
    assert n is not None
    axial = np.sum(load.force * n, axis=-1)
    # in a planar scene it is 0 on both, known without a word on which carries it, so it is not open
    axials = (axial, axial) if planar else find_axial_parts(pair, axial)
    across = split_to_bearings(pair, n, load.force, load.moment)
    has_thrust = not load.slides
    return {
        str(i): {"radial_force": across[i]} | ({"axial": axials[i]} if has_thrust else {}) for i in range(len(across))
    }


def make_bearing_blocks(load: JointLoads, planar: bool) -> Block:
    """Make the blocks of a joint's bearings; the axial load is open where it is not stated which carries it."""
    pair = load.joint.bearings
    assert pair is not None
    assert load.axis is not None
    block: Block = {}
    for (key, own), place in zip(make_bearing_loads(load, planar).items(), pair.at, strict=True):
        radial = np.sqrt(np.sum(own["radial_force"] ** 2, axis=-1))
        is_open = "axial" in own and bool(np.isnan(own["axial"]).any())
        names = ["axial"] if is_open else []
        block[key] = {"point": load.point + place * load.axis, "radial": radial, "open": names} | own
    return block


def iter_bearing_terms(joints: Sequence[JointLoads]) -> Iterator[tuple[Array, float, float]]:
    """Yield the load of each bearing across its axis, with the factors by which errors of force and moment enter."""
    for load in joints:
        if load.joint.bearings is not None:
            by_force, by_moment = find_bearing_factors(load.joint.bearings)
            for own in make_bearing_loads(load).values():
                yield own["radial_force"], by_force, by_moment


def find_bearing_factors(pair: BearingPair) -> tuple[float, float]:
    """Return the largest factors by which a force [1] and a moment [1/m] enter the load of a bearing."""
    first, second = pair.at
    distance = abs(second - first)
    return max(abs(first), abs(second), distance) / distance, 1.0 / distance


# Sensors


class Reaction(NamedTuple):
    """A force and its moment about an origin, world axes: origin (n_t, 3), force and moment (..., n_t, 3)."""

    origin: Array
    force: Array
    moment: Array


@record
class PlacedSensor:
    """What reads the reaction of a joint, or the load of a cut.

    joint, section: the name of the one, None for the other
    owner, point (3,): the body of the point that its moment is about, and the point there; None: the reaction's own
    axes: the body in whose axes it reads
    """

    name: str
    joint: str | None
    section: str | None
    owner: int
    point: Array | None
    axes: int

    def find_point(self, states: BodyStates, origin: Array) -> Array:
        """Return the point that its moment is about, (n_t, 3), world axes; origin: that of the reaction."""
        return origin if self.point is None else np.asarray(states.point_position(self.owner, self.point))

    def find_lever(self, states: BodyStates, origin: Array) -> Array:
        """Return the lever of the reaction's force about the point, (n_t, 3), world axes; origin: that of the
        reaction.
        """
        return origin - self.find_point(states, origin)

    def read(self, states: BodyStates, reaction: Reaction, planar: bool) -> tuple[Array, Array]:
        """Return the force and moment that it reads of a reaction; in a scene declared planar without what does not
        exist there.
        """
        origin, force, moment = reaction
        moment = moment + cross_rows(self.find_lever(states, origin), force)
        R = None if self.axes == GROUND else states.R[:, self.axes]
        force, moment = rotate_to_axes(force, R), rotate_to_axes(moment, R)
        return project_to_plane(force, moment) if planar else (force, moment)


def make_sensors(spec: Spec, mechanism: Mechanism) -> tuple[PlacedSensor, ...]:
    """Make the sensors of a spec."""
    bodies = {body.name: i for i, body in enumerate(mechanism.bodies)} | {"ground": GROUND}
    found = []
    for name, own in spec.sensors.items():
        end = own.point
        owner, point = (GROUND, None) if end is None else (bodies[end.body], np.array(end.point))
        found.append(PlacedSensor(name, own.joint, own.section, owner, point, bodies[own.body]))
    return tuple(found)


def find_sensor_reaction(
    sensor: PlacedSensor,
    mechanism: Mechanism,
    cuts: Sequence[Cuts],
    states: BodyStates,
    joints: Sequence[JointLoads],
    acting: Sequence[Action],
) -> Reaction:
    """Return the reaction that a sensor reads, (n_t, 3) each.

    Of a joint it is what its constraint exerts ON `to`, of a section the load of the far side ON the near side.

    cuts: those of the requested sections
    joints, acting: the reactions, and all other actions on bodies
    """
    if sensor.joint is not None:
        load = next(load for load in joints if load.joint.name == sensor.joint)
        return Reaction(load.point, load.force, load.moment)
    from heuncli.loads.kinetostatics.piece_loads import find_attachments  # few sensors read a cut
    from heuncli.loads.kinetostatics.sections import make_section_block

    own = next(own for own in cuts if own.name == sensor.section).for_impulse
    attached = find_attachments(own.body, states, [*list_whole_joint_actions(joints), *acting])
    block = make_section_block(own, states, mechanism.gravity, attached, {}, mechanism.planar)
    return Reaction(block["point"], block["force"], block["moment"])


def move_shares(sensor: PlacedSensor, states: BodyStates, origin: Array, shares: Array, planar: bool) -> Array:
    """Return what a sensor reads of shares of self-stresses about `origin`, force and moment, (n_t, 6, k)."""
    F, M = np.moveaxis(shares[:, :3], 2, 0), np.moveaxis(shares[:, 3:], 2, 0)
    parts = sensor.read(states, Reaction(origin, F, M), planar)
    return np.moveaxis(np.concatenate(parts, axis=2), 0, 2)
