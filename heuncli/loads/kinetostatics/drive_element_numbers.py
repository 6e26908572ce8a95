"""Report further numbers of gears, belts and screws, besides the load that they carry and their loads on each body.

    radial = |F| tan(alpha_n) / cos(beta)    axial = |F| tan(beta)    normal = along the line of action
    torque = F lead / (2 pi)                 tight, slack = T_0 +- |F| / 2

F: the load carried. In an impulse it is an impulse, and the strands have no pretension.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as c


def gear_numbers(gear: c.Gear, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the components of a tooth force [N]."""
    radial = np.abs(F) * (math.tan(gear.pressure_angle) / math.cos(gear.helix))
    axial = np.abs(F) * abs(math.tan(gear.helix))
    return {"radial": radial, "axial": axial, "normal": np.sqrt(F * F + radial * radial + axial * axial)}


def screw_numbers(screw: c.Screw, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the torque that a thrust takes [N m]."""
    return {"torque": F * (screw.lead / math.tau)}


def belt_numbers(belt: c.Belt, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the pulls of both strands [N]."""
    pretension = 0.0 if is_impulse else belt.pretension
    return {"tight": pretension + 0.5 * np.abs(F), "slack": pretension - 0.5 * np.abs(F)}


DRIVE_ELEMENT_NUMBERS: dict[str, Callable[..., dict[str, Array]]] = {
    "gear": gear_numbers,
    "screw": screw_numbers,
    "belt": belt_numbers,
}
