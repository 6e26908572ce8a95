"""What engineers ask of gears, belts and screws, beside the load that these carry and what it does to each body.

    radial = |F| tan(alpha_n) / cos(beta)    axial = |F| tan(beta)    normal = along the line of action
    torque = F lead / (2 pi)                 tight, slack = T_0 +- |F| / 2
F: the load carried. In a blow it is an impulse, and the strands have no pull of their own beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as c


def gear_told(given: c.Gear, F: Array, struck: bool) -> dict[str, Array]:
    """Parts of a tooth force [N]."""
    radial = np.abs(F) * (math.tan(given.pressure_angle) / math.cos(given.helix))
    axial = np.abs(F) * abs(math.tan(given.helix))
    return {"radial": radial, "axial": axial, "normal": np.sqrt(F * F + radial * radial + axial * axial)}


def screw_told(given: c.Screw, F: Array, struck: bool) -> dict[str, Array]:
    """The torque that a thrust takes [N m]."""
    return {"torque": F * (given.lead / math.tau)}


def belt_told(given: c.Belt, F: Array, struck: bool) -> dict[str, Array]:
    """The pulls of both strands [N]."""
    at_rest = 0.0 if struck else given.pretension
    return {"tight": at_rest + 0.5 * np.abs(F), "slack": at_rest - 0.5 * np.abs(F)}


TOLD: dict[str, Callable[..., dict[str, Array]]] = {"gear": gear_told, "screw": screw_told, "belt": belt_told}
