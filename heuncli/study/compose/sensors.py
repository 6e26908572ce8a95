"""Make the results of sensors: reactions of joints and loads of cuts about other points, in other axes.

What a sensor reads is linear in the reaction (loads/kinetostatics/sensors.py): so are the shares by cause, and those of
the self-stresses, which say what is indeterminate.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heuncli.loads.kinetostatics.couplings import list_coupling_actions
from heuncli.loads.kinetostatics.sensors import PlacedSensor, find_sensor_reaction, move_shares
from heuncli.results.results import Array, Block
from heuncli.study.compose.recovery import Recovery

if TYPE_CHECKING:
    from heuncli.loads.redundancy.self_stress import SelfStress


def make_sensor_blocks(recovery: Recovery, by_cause: bool) -> Block:
    """Make the blocks of all sensors; by_cause: with their shares."""
    return {sensor.name: make_sensor_block(recovery, sensor, by_cause) for sensor in recovery.setup.sensors}


def make_sensor_block(recovery: Recovery, sensor: PlacedSensor, by_cause: bool) -> Block:
    """Make the block of one sensor; nan where the reaction is indeterminate."""
    states, mechanism = recovery.states, recovery.setup.scene.mechanism
    planar = mechanism.planar
    acting = [*recovery.applied_actions, *list_coupling_actions(recovery.couplings)]
    reaction = find_sensor_reaction(sensor, mechanism, recovery.setup.cuts, states, recovery.joints, acting)
    origin = reaction.origin
    force, moment = sensor.read(states, reaction, planar)
    block: Block = {"point": sensor.find_point(states, origin), "force": force, "moment": moment, "open": []}
    if by_cause:
        from heuncli.study.solve.cause_shares import find_sensor_shares  # few runs ask for shares

        shares = recovery.shares
        F, M = sensor.read(states, find_sensor_shares(recovery.setup, sensor, states, shares), planar)
        block["shares"] = shares.to_blocks({"force": F, "moment": M})
    stress = recovery.indeterminate
    if stress is not None:
        from heuncli.loads.redundancy.indeterminate_components import (  # few scenes have self-stresses
            find_indeterminate_wrench,
            list_indeterminate_names,
            mask_parts,
        )

        share = move_shares(sensor, states, origin, find_stress_shares(recovery, sensor, stress), planar)
        parts = dict(zip(("force", "moment"), find_indeterminate_wrench(stress, share), strict=True))
        mask_parts(block, parts)
        block["open"] = list_indeterminate_names(parts)
    return block


def find_stress_shares(recovery: Recovery, sensor: PlacedSensor, stress: SelfStress) -> Array:
    """Return the shares of the self-stresses in a sensor's reaction, (n_t, 6, k)."""
    from heuncli.loads.redundancy.indeterminate_components import iter_self_stress_components

    states, joints = recovery.states, recovery.joints
    if sensor.joint is not None:
        load, share = next(x for x in zip(joints, stress.shares, strict=True) if x[0].joint.name == sensor.joint)
        return load.split_wrenches(states, share)[0]
    cuts = next(cuts for cuts in recovery.setup.cuts if cuts.name == sensor.section).for_impulse
    components = iter_self_stress_components(cuts, states, joints, recovery.couplings, stress)
    return np.stack([np.concatenate([own["force"][:, 0], own["moment"][:, 0]], axis=1) for own in components], axis=2)
