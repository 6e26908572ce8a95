"""Compute the pressure angle of a cam.

cos a = 1 / |f| |w|        f . w = 1, w the velocity of the follower at the contact, or at its roller's centre,
                           per unit of its rate; a is the pressure angle
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


def pressure_angle(loads: CouplingLoads, joints: Sequence[Joint], states: BodyStates) -> Array:
    """Return the angle between the load of a cam and the motion of the follower there, (n_t,) [rad]."""
    (load,) = loads.parts
    size = np.sqrt(np.sum(load.f * load.f, axis=1))
    speed = follower_speed(load.part, joints[load.part.coordinates[1].joint], load.place, states)
    return np.asarray(np.arccos(np.clip(1.0 / (size * speed), 0.0, 1.0)))


def follower_speed(part: CouplingPart, joint: Joint, place: Array, states: BodyStates) -> Array:
    """Return |w|, (n_t,) [m or 1]: 1 if it slides, else the distance from the axis about which the follower swings."""
    assert part.cam is not None
    if not part.cam.swings:
        return np.ones(len(place))
    if part.cam.face is None:
        place = states.point_position(part.b, np.asarray(part.q))
    axis = states.world_direction(joint.a, joint.axis)
    arm = cross_rows(axis, place - states.point_position(joint.a, joint.p))
    return np.asarray(np.sqrt(np.sum(arm * arm, axis=1)))
