"""Generalised forces of drives along the coordinates: e q'' + C = k + Q.
    Q_i = sum lambda_d dq_d/dq_i         lambda_d: the effort of the drive of q_d, `joints.J.drive`
If the driven coordinates are among the chosen ones, Q_d is the effort itself, and Q is 0 along all others.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import CoordinateChoice, make_candidate_rows
from heuncli.analyses.lagrange.instant import Instant
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record
from heuncli.results.results import Array


@record
class DriveRows:
    """The driven coordinates: names, the joint of each, their rows (d, f) on the rates of the chosen coordinates."""

    names: tuple[str, ...]
    joints: tuple[str, ...]
    rows: Array

    def project_on_drives(self, remainder: Array) -> Array:
        """Return Q (f,): the part of the equations' remainder that drives can exert."""
        return np.asarray(self.rows.T @ solve_least_squares(self.rows.T, remainder))


def make_drive_rows(instant: Instant, choice: CoordinateChoice) -> DriveRows:
    """Return the driven coordinates at an instant."""
    driven = instant.freed_scene.driven_coordinates
    rows = make_candidate_rows(instant.freed_scene.layout, instant.linear_equations)
    unit = dict(zip(choice.names, np.eye(len(choice.names)), strict=True))
    driven_rows = [unit[name] if name in unit else rows[name] @ choice.S for name in driven]
    return DriveRows(
        tuple(driven), tuple(driven.values()), np.array(driven_rows).reshape(len(driven_rows), len(choice.names))
    )


def subtract_drive_efforts(instant: Instant, drives: DriveRows, remainder: Array) -> tuple[Array, Array]:
    """Subtract the drives' efforts, as the joint reactions have them, from e q'' + C - k, (f,); also return where the
    result is known.

    If supports are redundant, the effort of a drive may be indeterminate: the coordinates along which it acts are then
    unknown.
    """
    loads = {load.joint.name: load for load in instant.recovery.joints} if not instant.setup.model["redundant"] else {}
    is_known = np.ones(len(remainder), dtype=bool)
    for joint, row in zip(drives.joints, drives.rows, strict=True):
        load = loads.get(joint)
        if load is not None and load.drive is not None:
            remainder = remainder - float(load.drive[0]) * row
        else:
            is_known &= row == 0.0
    return remainder, is_known
