"""What flanks push apart with where it is open which of several meshes carries how much.

The push hangs on a multiplier's size, not on its sign, and is not linear in self-stresses. So that nothing is called
certain which is not, the push of every mesh that some self-stress reaches counts as one more that is free.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.flanks import between, held_off, pushes_apart
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.loads.redundancy.self_stress import SelfStress
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def with_open_flanks(
    stress: SelfStress, layout: Layout, joints: Sequence[JointLoads], couplings: Sequence[CouplingLoads]
) -> SelfStress:
    """The self-stresses with a column for the push of every mesh that they reach."""
    if not pushes_apart(layout.mechanism):
        return stress
    columns = []
    for own in couplings:
        for r, part in own.parts_of_rows():
            unit = np.abs(stress.multipliers[:, r]) / np.where(stress.largest > 0.0, stress.largest, 1.0)
            if part.pushed is not None and unit.max(initial=0.0) > tolerances.OPEN_SHARE:
                columns.append(_column(layout, joints, part.pushed, part.place, between(layout, part.part)))
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


def _column(layout: Layout, joints: Sequence[JointLoads], push: Array, place: Array, held: dict[int, float]) -> Array:
    """The shares of a unit push in all joints, (n_j, n_t, 6)."""
    shares = np.zeros((len(joints), len(push), 6))
    size = np.max(np.sqrt(np.sum(push * push, axis=1)))
    for k, share in held.items():
        shares[k] = np.concatenate(held_off(joints[k], share / size * push, place), axis=1)
    return shares
