"""Sensors: the reaction of a joint, or the load of a cut, about another point and in the axes of another body.

A wrench (F, M) about the point O is about P, in axes with the unit vectors e_i:

    F_i = e_i . F,   M_i = e_i . (M + (O - P) x F)

This is linear: shares by cause, self-stresses and errors take the same way. Axes before that of the instants, such as
that of causes, are kept. From the spec to the number:

    SensorEntry            as it is written (scene/file_format/format.py), then models.Sensor with its names resolved
    make_sensors           PlacedSensor: the body of its point and that of its axes, by number
    find_sensor_reaction   Reaction: what it reads, about its own origin, in world axes
    PlacedSensor.read      the numbers: moved to the point and turned; study/compose/sensors.py makes the block
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action, list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads, project_to_plane, rotate_to_axes
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import cross_rows

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts


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
    from heuncli.loads.kinetostatics.sections import find_attachments, make_section_block  # few sensors read a cut

    own = next(own for own in cuts if own.name == sensor.section).for_impulse
    attached = find_attachments(own.body, states, [*list_whole_joint_actions(joints), *acting])
    block = make_section_block(own, states, mechanism.gravity, attached, {}, mechanism.planar)
    return Reaction(block["point"], block["force"], block["moment"])


def move_shares(sensor: PlacedSensor, states: BodyStates, origin: Array, shares: Array, planar: bool) -> Array:
    """Return what a sensor reads of shares of self-stresses about `origin`, force and moment, (n_t, 6, k)."""
    F, M = np.moveaxis(shares[:, :3], 2, 0), np.moveaxis(shares[:, 3:], 2, 0)
    parts = sensor.read(states, Reaction(origin, F, M), planar)
    return np.moveaxis(np.concatenate(parts, axis=2), 0, 2)
