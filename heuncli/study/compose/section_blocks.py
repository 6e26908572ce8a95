"""Make the blocks of sections and of sensors: the loads of cuts, and reactions about other points in other axes.

Both are linear in the joints' reactions: so are their shares by cause, and those of the self-stresses, which say what
is indeterminate. Only scenes that have them load this module.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from heuncli.loads.kinetostatics.actions import list_whole_joint_actions
from heuncli.loads.kinetostatics.couplings import list_coupling_actions
from heuncli.loads.kinetostatics.moved_reactions import PlacedSensor, find_sensor_reaction, move_shares
from heuncli.loads.kinetostatics.piece_loads import find_attachments
from heuncli.loads.kinetostatics.sections import make_section_block
from heuncli.results.results import Array, Block, Mask
from heuncli.study.compose.recovery import Recovery

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts
    from heuncli.loads.redundancy.self_stress import SelfStress


def make_section_blocks(recovery: Recovery, by_cause: bool = False) -> Block:
    """Make the blocks of all requested sections, `sections` of the results; by_cause: with their shares."""
    scene, states = recovery.setup.scene, recovery.states
    block: Block = {}
    actions = [
        *list_whole_joint_actions(recovery.joints),
        *recovery.applied_actions,
        *list_coupling_actions(recovery.couplings),
    ]
    for requested_cuts in recovery.setup.cuts:
        attached = find_attachments(requested_cuts.body, states, actions)
        cuts = requested_cuts.place_for_loads(attached)
        is_open = find_open_section(recovery, cuts)
        gravity, planar = scene.mechanism.gravity, scene.mechanism.planar
        block[cuts.name] = make_section_block(cuts, states, gravity, attached, is_open, planar)
        if is_open:
            from heuncli.loads.redundancy.indeterminate_components import list_indeterminate_section_names

            block[cuts.name]["open"] = list_indeterminate_section_names(is_open)
        if cuts.beam is not None:
            from heuncli.loads.kinetostatics.deflection import make_deflection_block  # few scenes ask for it

            find_open = partial(find_open_section, recovery)
            block[cuts.name] |= make_deflection_block(cuts, states, gravity, attached, find_open, planar)
        if by_cause:
            from heuncli.loads.kinetostatics.shares import make_section_shares_block

            block[cuts.name]["shares"] = make_section_shares_block(cuts, scene.layout, states, recovery.shares, is_open)
    return block


def find_open_section(recovery: Recovery, cuts: Cuts) -> Mapping[str, Mask]:
    """Return which loads of cuts are indeterminate, by name; empty where none is."""
    if recovery.indeterminate is None:
        return {}
    from heuncli.loads.redundancy.indeterminate_components import find_indeterminate_section

    return find_indeterminate_section(
        cuts, recovery.states, recovery.joints, recovery.couplings, recovery.indeterminate
    )


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
