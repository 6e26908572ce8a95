"""What a screw with friction carries in all, and what of the power that goes in comes out.

    force = N - friction along the axis        torque = N lead / (2 pi) + friction about it
N is what the flanks press with along the axis.
    force rise - torque = -loss / rate       rise = lead / (2 pi), the travel for a unit of turning
Of the two powers, force rise rate INTO what slides and -torque rate INTO what turns, the one above zero comes out.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Screw


def whole_load(loads: CouplingLoads) -> tuple[Array, Array]:
    """Thrust along the axis and the torque about it that it takes, (..., n_t), friction with them."""
    given, part, rubs = loads.coupling.given, loads.parts[0], loads.friction
    assert isinstance(given, Screw)
    rise = given.lead / math.tau
    force, torque = loads.multipliers[0], loads.multipliers[0] * rise
    if rubs is None:
        return force, torque
    sense = 1.0 if rubs.to.body == part.part.b else -1.0  # its own opposite stands on the other body
    along = np.sum(rubs.force * part.f, axis=-1)
    about = np.sum(rubs.moment * part.m, axis=-1) / rise
    return force + sense * along, torque + sense * about


def efficiency(loads: CouplingLoads, none: float) -> Array:
    """The power that comes out by the power that goes in, (n_t,); at rest 1, for nothing rubs, and 0 without a load.

    none: a thrust that is none beside the loads of the scene [N].
    """
    given = loads.coupling.given
    assert isinstance(given, Screw)
    force, torque = whole_load(loads)
    carries = np.abs(force) > none
    force = force * (given.lead / math.tau)
    turns = np.where(torque < force, -1.0, 1.0)  # the way it turns, for friction takes power
    into = np.stack([turns * force, -turns * torque])
    out, taken = np.maximum(into.max(axis=0), 0.0), -into.min(axis=0)
    return np.where(carries & (taken > 0.0), out / np.where(taken > 0.0, taken, 1.0), 0.0)
