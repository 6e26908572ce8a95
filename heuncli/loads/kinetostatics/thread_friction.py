"""Compute the total load of a screw with friction, and its efficiency.

    force = N - friction along the axis        torque = N lead / (2 pi) + friction about it

N is the axial component of the flank pressure.

    force rise - torque = -loss / rate       rise = lead / (2 pi), the travel per unit of rotation

Of the two powers, force rise rate INTO what slides and -torque rate INTO what turns, the positive one is the output.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw


def total_screw_load(loads: CouplingLoads) -> tuple[Array, Array]:
    """Return thrust along the axis and the torque about it that it takes, (..., n_t), including friction."""
    screw, part, friction = loads.coupling.entry, loads.parts[0], loads.friction
    assert isinstance(screw, Screw)
    rise = screw.lead / math.tau
    force, torque = loads.multipliers[0], loads.multipliers[0] * rise
    if friction is None:
        return force, torque
    sense = 1.0 if friction.to_end.body == part.part.b else -1.0  # its opposite acts on the other body
    axial_friction = np.sum(friction.force * part.f, axis=-1)
    friction_torque = np.sum(friction.moment * part.m, axis=-1) / rise
    return force + sense * axial_friction, torque + sense * friction_torque


def efficiency(loads: CouplingLoads, zero_thrust: float) -> Array:
    """Return output power over input power, (n_t,); 1 at rest, because nothing slides, and 0 without a load.

    zero_thrust: a thrust that counts as zero compared with the loads of the scene [N]
    """
    screw = loads.coupling.entry
    assert isinstance(screw, Screw)
    force, torque = total_screw_load(loads)
    is_loaded = np.abs(force) > zero_thrust
    force = force * (screw.lead / math.tau)
    direction = np.where(torque < force, -1.0, 1.0)  # direction of rotation, because friction takes power
    powers = np.stack([direction * force, -direction * torque])
    output, input_power = np.maximum(powers.max(axis=0), 0.0), -powers.min(axis=0)
    return np.where(is_loaded & (input_power > 0.0), output / np.where(input_power > 0.0, input_power, 1.0), 0.0)
