"""Compare the loads with and without counterweights: the scene is solved at the cycle's rate, with its loads, both
times.

Compared are the force and moment on the foundation, the drive, and the force in every joint (across its axis, if it has
one): root mean square over the cycle and largest magnitude. Values that redundant joints leave indeterminate are None.
All are computed from their squares, which are smooth where a magnitude is not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.analyses.balancing.cycle_magnitudes import compute_square_root_magnitudes
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.loaded_scene import LoadedScene, make_loaded_scene
from heuncli.analyses.balancing.results import CycleLoad
from heuncli.base import tolerances
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import Recovery

MOMENTS = ("moment", "drive")


def compute_cycle_loads(
    scene: LoadedScene, plan: CyclePlan, reference_point: Array
) -> tuple[dict[str, CycleLoad], tuple[str, ...]]:
    """Return rms and peak over the cycle of force, moment, drive and joint forces, by name, and the notes of the
    run.
    """
    first_recovery = scene.recover_samples()
    names = [*compute_squares(first_recovery, plan, reference_point)]
    indeterminate: set[str] = set()

    def compute_columns(recovery: Recovery) -> Array:
        own = compute_squares(recovery, plan, reference_point)
        indeterminate.update(name for name, values in own.items() if np.isnan(values).any())
        return np.nan_to_num(np.stack([own[name] for name in names], axis=1))

    numbers = scene.resolve_numbers(
        compute_columns,
        [1] * len(names),
        compute_rounding(compute_columns(first_recovery), names, scene.setup.scene.layout.size),
    )
    residuals = compute_square_root_magnitudes(
        {name: numbers.values[:, k] for k, name in enumerate(names)}, numbers.nodes
    )
    loads = {
        name: CycleLoad(None, None) if name in indeterminate else CycleLoad(own.rms, own.peak, own.error)
        for name, own in residuals.items()
    }
    return loads, numbers.notes


def compute_squares(recovery: Recovery, plan: CyclePlan, reference_point: Array) -> dict[str, Array]:
    """Return the squares of force, moment, drive and joint forces by name, (n,) each; nan means indeterminate."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    ma, spin = inertia_loads(mechanism, states)
    moment = -(cross_rows(states.centre - reference_point, ma) + spin).sum(axis=1)
    if mechanism.planar:
        moment = moment * np.array([0.0, 0.0, 1.0])
    squared = {"force": np.sum(ma.sum(axis=1) ** 2, axis=1), "moment": np.sum(moment**2, axis=1)}
    joints: Mapping[str, Mapping[str, Array]] = make_blocks(recovery, frozenset({"joints"}))["joints"]
    squared["drive"] = joints[plan.joint]["drive"] ** 2
    for name, own in joints.items():
        squared[f"joints.{name}"] = own["radial"] ** 2 if "radial" in own else np.sum(own["force"] ** 2, axis=1)
    return squared


def compute_rounding(values: Array, names: Sequence[str], size: float) -> list[float]:
    """Return the rounding level of the squares (n, m), per column, from the largest force; a moment is compared with
    that force times the size [m] too.
    """
    force = max(float(values[:, k].max()) for k, name in enumerate(names) if name not in MOMENTS)
    moment = max(force * size**2, *(float(values[:, k].max()) for k, name in enumerate(names) if name in MOMENTS))
    return [tolerances.ORDERS_SETTLED * tolerances.NO_SQUARE * (moment if name in MOMENTS else force) for name in names]


def compare_loads(
    spec: Spec, scene: PreparedScene, heavier: Mechanism, plan: CyclePlan, reference_point: Array
) -> tuple[dict[str, CycleLoad], dict[str, CycleLoad], tuple[str, ...]]:
    """Return the loads without and with the counterweights, and the notes of both runs.

    heavier: the mechanism that includes them
    """
    rate = plan.rate or 1.0
    mechanisms: Sequence[Mechanism] = (scene.mechanism, heavier)
    (before, notes), (after, more) = (
        compute_cycle_loads(make_loaded_scene(spec, scene, own, plan, rate), plan, reference_point)
        for own in mechanisms
    )
    return before, after, (*notes, *more)
