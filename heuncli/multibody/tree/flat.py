"""Whether a laid-out scene moves in the xy plane only, so that the kernel may drop all components normal to it."""

from __future__ import annotations

import math

import numpy as np

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array

TILTS = {"xz": 0.0, "yz": 0.0, "zx": 0.0, "zy": 0.0, "zz": 1.0}  # of an attitude that is a turn about z


def moves_in_plane(bodies: Table, freedoms: Table) -> bool:
    """Whether all bodies only turn about z and shift across it, exactly and at all times.

    Then velocities have three numbers, and components normal to the plane do no work: heights of points, products of
    inertia with z and forces along z load joints and move nothing.
    """
    directions, shifts = freedoms["direction"], freedoms["kind"] == kernel.SHIFT
    upright = all(bool(np.all(bodies["frame"][part] == value)) for part, value in TILTS.items())
    along = np.where(shifts, directions["z"] == 0.0, np.abs(directions["z"]) == 1.0)
    across = shifts | ((directions["x"] == 0.0) & (directions["y"] == 0.0))
    return upright and not bodies["ball"].any() and bool(np.all(along & across))


def remove_tilt(R: Array) -> Array:
    """Remove the tilt of an attitude, which is rounding in a scene declared planar."""
    c, s = float(R[0, 0] + R[1, 1]), float(R[1, 0] - R[0, 1])
    length = math.hypot(c, s)
    c, s = c / length, s / length
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def remove_direction_tilt(kind: int, direction: Array) -> Array:
    """Remove the rounding tilt of a freedom's direction (3,): along z for a rotation, normal to z for a shift."""
    if kind != kernel.SHIFT:
        return np.array([0.0, 0.0, math.copysign(1.0, direction[2])])
    return np.array([direction[0], direction[1], 0.0]) / math.hypot(direction[0], direction[1])
