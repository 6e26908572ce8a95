"""What drives exert along the coordinates: e q'' + C = k + Q.

    Q_i = sum lambda_d dq_d/dq_i         lambda_d: the effort of the drive of q_d, `joints.J.drive`
Where the driven coordinates are among the chosen ones, Q_d is the effort itself, and 0 along all others.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import Chosen, candidates
from heuncli.analyses.lagrange.instant import Instant
from heuncli.base.records import record
from heuncli.results.results import Array


@record
class DriveRows:
    """The driven coordinates: names, the joint of each, their rows (d, f) on the rates of the chosen coordinates."""

    names: tuple[str, ...]
    joints: tuple[str, ...]
    rows: Array

    def along(self, left: Array) -> Array:
        """Q (f,): the part of what the equations leave that drives can exert."""
        return np.asarray(self.rows.T @ np.linalg.lstsq(self.rows.T, left, rcond=None)[0])


def drive_rows(at: Instant, by: Chosen) -> DriveRows:
    """The driven coordinates of an instant."""
    driven = at.freed.driven
    rows = candidates(at.freed.layout, at.found)
    unit = dict(zip(by.names, np.eye(len(by.names)), strict=True))
    own = [unit[name] if name in unit else rows[name] @ by.S for name in driven]
    return DriveRows(tuple(driven), tuple(driven.values()), np.array(own).reshape(len(own), len(by.names)))


def left_by_reactions(at: Instant, drives: DriveRows, left: Array) -> tuple[Array, Array]:
    """What e q'' + C - k leaves beside what drives exert by the joints' reactions, (f,), and where that is known.

    Where supports are redundant the effort of a drive may be open: what it acts along is not known then.
    """
    loads = {load.joint.name: load for load in at.recovery.joints} if not at.setup.model["redundant"] else {}
    known = np.ones(len(left), dtype=bool)
    for joint, row in zip(drives.joints, drives.rows, strict=True):
        load = loads.get(joint)
        if load is not None and load.drive is not None:
            left = left - float(load.drive[0]) * row
        else:
            known &= row == 0.0
    return left, known
