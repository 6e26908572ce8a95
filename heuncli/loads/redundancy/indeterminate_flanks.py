"""Handle separating forces of tooth flanks where it is indeterminate which of several meshes carries how much.

The force depends on the magnitude of a multiplier, not on its sign, and is not linear in self-stresses. To be on the
safe side, the separating force of every mesh that some self-stress reaches counts as one more free load.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.flanks import find_joints_between, has_separating_forces, transfer_force
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def add_flank_columns(
    stress: SelfStress, layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]
) -> SelfStress:
    """Return the self-stresses with a column for the separating force of every mesh that they reach."""
    if not has_separating_forces(layout.mechanism):
        return stress
    columns = []
    for own in couplings:
        for r, part in own.iter_row_parts():
            unit = np.abs(stress.multipliers[:, r]) / np.where(stress.largest > 0.0, stress.largest, 1.0)
            if part.separating_force is not None and unit.max(initial=0.0) > tolerances.OPEN_SHARE:
                columns.append(
                    _flank_column(
                        layout, joints, part.separating_force, part.place, find_joints_between(layout, part.part)
                    )
                )
    if not columns:
        return stress
    shares = np.concatenate([stress.shares, np.stack(columns, axis=3)], axis=3)
    ones = np.ones((len(stress.largest), len(columns)))
    rows = np.zeros((*stress.multipliers.shape[:2], len(columns)))
    found: SelfStress = replace(
        stress, shares=shares, largest=np.concatenate([stress.largest, ones], axis=1),
        multipliers=np.concatenate([stress.multipliers, rows], axis=2),
    )  # fmt: skip
    return found


def _flank_column(
    layout: Layout, joints: Sequence[JointLoads], push: Array, place: Array, factors: dict[int, float]
) -> Array:
    """Return the shares of a unit separating force in all joints, (n_j, n_t, 6)."""
    shares = np.zeros((len(joints), len(push), 6))
    size = np.max(np.sqrt(np.sum(push * push, axis=1)))
    for k, share in factors.items():
        shares[k] = np.concatenate(transfer_force(joints[k], share / size * push, place), axis=1)
    return shares
