"""Recovered answers as blocks of the results: joints, foundation, sections, forces, motion, energy.

Each block is what `Results` holds under its name: arrays over the instants, SI units.

The way of a joint's reaction, a type each: the kernel's answers (`Recovered`) are summed up to `JointLoads`
(loads/kinetostatics/reactions.py), split where redundancy asks for it (loads/redundancy/resolve.py), and become a
`JointBlock` here, with shares by cause, turned into the axes asked for, and open where no law decides. JSON is written
of that block (output/tables/export.py). For CSV and tables it becomes a `Series` (study/quantities/series.py), for
tables a `NumberRow` a component (output/tables/table_blocks.py), whose text is a cell of a `TextTable`
(output/tables/text_table.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import Action, AppliedLoad, whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coordinates import coordinates, points
from heuncli.loads.kinetostatics.coupling_numbers import coupling_block
from heuncli.loads.kinetostatics.couplings import CouplingLoads, coupling_actions
from heuncli.loads.kinetostatics.energy import system_vector
from heuncli.loads.kinetostatics.foundation import element_keys, foundation
from heuncli.loads.kinetostatics.joint_axes import axes_at, put_in_axes
from heuncli.loads.kinetostatics.momentum import Momenta, momenta
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.multibody.mechanism.model import GROUND, BushingLoad, JointLoad, PairLoad
from heuncli.results.results import Array, Block, BodyBlock, ForceBlock, JointBlock, Mask
from heuncli.results.results_schema import SHARES
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.selection import chosen


def blocks(recovery: Recovery, wanted: Set[str]) -> dict[str, Any]:
    """The blocks of the reports that are wanted, by the names of the fields of `Results`.

    Joints, stops and foundation in this order: loads, their shares by cause, axes, and what of them is open.
    """
    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    recovered, states = recovery.recovered, recovery.states
    shown: dict[str, Any] = {}
    if "foundation" in wanted:
        shown["foundation"] = foundation(mechanism, states, recovery.standing, recovery.setup.about)
    if "joints" in wanted:
        shown["joints"] = {j.joint.name: joint_block(j) for j in recovery.asked_joints}
        shown["stops"] = stops(recovery.asked_joints)
        shown["couplings"] = {own.coupling.name: told_coupling(recovery, own) for own in recovery.couplings}
    if SHARES in wanted:
        from heuncli.study.compose.cause_shares import put_shares  # few runs ask for them

        put_shares(shown, recovery.shares, mechanism, states, recovery.setup.about)
    axes = recovery.setup.asked.axes
    for load in recovery.asked_joints if axes != "world" and "joints" in shown else ():
        put_in_axes(shown["joints"][load.joint.name], axes_at(load.joint, states, axes))
    if shown and recovery.decided is not None:
        recovery.decided.show(states, shown, recovery.couplings, axes, element_keys(mechanism))
    if "energy" in wanted:
        shown["energy"] = recovery.energy
    if "motion" in wanted:
        from heuncli.loads.kinetostatics.attitudes import quaternions, rodrigues  # tables do not show them

        turns = quaternions(layout, recovered)
        vectors = rodrigues(turns)
        moved = momenta(mechanism, states, recovery.setup.about)
        shown["bodies"] = {b.name: body_block(states, turns, vectors, moved, i) for i, b in enumerate(mechanism.bodies)}
        shown["momentum"] = moved.totals()
        shown["coordinates"] = coordinates(layout, recovered, states)
        shown["system_vector"] = system_vector(mechanism, states)
    if "points" in wanted:
        shown["points"] = points(mechanism, states)
    if "sections" in wanted:
        shown["sections"] = sections(recovery, SHARES in wanted)
    if "forces" in wanted:
        shown["forces"] = forces([own for own in recovery.loads if mechanism.block_of(own.load) == "forces"], states)
    return shown


def blocks_asked_for(recovery: Recovery, wanted: Set[str]) -> dict[str, Any]:
    """The blocks of the reports that are wanted; of a report of which single entries are asked for these alone."""
    return chosen(blocks(recovery, wanted), recovery.setup.asked)


def body_block(states: BodyStates, turns: Array, vectors: Array, moved: Momenta, i: int) -> BodyBlock:
    """Motion of one body; turns, vectors: quaternions and Rodrigues' vectors of all."""
    return {
        "position": states.x[:, i],
        "velocity": states.v[:, i],
        "rotation": states.R[:, i],
        "quaternion": turns[:, i],
        "center": states.centre[:, i],
        "center_velocity": states.v_centre[:, i],
        "center_acceleration": states.a_centre[:, i],
        "angular_velocity": states.omega[:, i],
        "angular_acceleration": states.alpha[:, i],
        "rodrigues": vectors[:, i],
        "momentum": moved.linear[:, i],
        "moment_of_momentum": moved.orbital[:, i] + moved.spin[:, i],
    }


def joint_block(load: JointLoads) -> JointBlock:
    """Reaction of one joint, with its components along and across the axis."""
    block: JointBlock = {"point": load.point, "force": load.force, "moment": load.moment, "open": []}
    if load.drive is not None:
        block["drive"] = load.drive
    if load.axis is not None:
        axial = np.sum(load.force * load.axis, axis=1)
        across = load.force - axial[:, None] * load.axis
        tilting = load.moment - np.sum(load.moment * load.axis, axis=1)[:, None] * load.axis
        block["axial"] = axial
        block["radial"] = np.sqrt(np.sum(across**2, axis=1))
        block["tilting"] = np.sqrt(np.sum(tilting**2, axis=1))
    if load.torque is not None:
        block["torque"] = load.torque
    if load.tension is not None:
        block["tension"] = load.tension
    if load.joint.bearing is not None:
        carried = block["radial"] if "radial" in block else np.sqrt(np.sum(load.force**2, axis=1))
        block["pressure"] = carried / load.joint.bearing
    if load.joint.path is not None and load.joint.path.radius:
        block["contact_point"] = load.points.on_path(load.joint, load.point)
    return block


def stops(joints: Sequence[JointLoads]) -> Block:
    """What each stop exerts ON `to` along its coordinate."""
    return {
        own.stop.name: {"moment" if own.stop.quantity == "angle" else "force": own.value}
        for load in joints
        for own in load.stops
    }


def sections(recovery: Recovery, by_cause: bool = False) -> Block:
    """The blocks of all sections; by_cause: with their shares."""
    scene, states, stress = recovery.setup.scene, recovery.states, recovery.indeterminate
    block: Block = {}
    if not recovery.setup.cuts:
        return block
    # only scenes with sections load it
    from heuncli.loads.kinetostatics.sections import attachments, section

    actions = [*whole_joint_actions(recovery.joints), *recovery.applied, *coupling_actions(recovery.couplings)]
    for asked in recovery.setup.cuts:
        on = attachments(asked.body, states, actions)
        cuts = asked.laid_for(on)
        is_open: Mapping[str, Mask] = {}
        if stress is not None:
            from heuncli.loads.redundancy.open_components import names_in_section, open_in_section

            is_open = open_in_section(cuts, states, recovery.joints, recovery.couplings, stress)
        own = section(cuts, states, scene.mechanism.gravity, on, is_open, scene.mechanism.planar)
        block[cuts.name] = own | ({"open": names_in_section(is_open)} if is_open else {})
        if by_cause:
            from heuncli.loads.kinetostatics.section_shares import section_shares

            block[cuts.name]["shares"] = section_shares(cuts, scene.layout, states, recovery.shares, is_open)
    return block


def bushing(load: BushingLoad, applied: AppliedLoad, states: BodyStates) -> ForceBlock:
    """Shift and turn of a bushing, and what it exerts on `to`, in its own axes, which stand in `from`."""
    assert applied.strain is not None
    shift, turn = applied.strain[:, 0], applied.strain[:, 1]
    R = np.eye(3) if load.a == GROUND else states.R[:, load.a]
    force, moment = (own @ load.frame for own in (
        (applied.action.force[:, None] @ R)[:, 0], (applied.action.moment[:, None] @ R)[:, 0]
    ))  # fmt: skip
    return {"shift": shift, "turn": turn, "force": force, "moment": moment}


def told_coupling(recovery: Recovery, own: CouplingLoads) -> dict[str, Any]:
    """The block of a coupling, with the numbers that its kind alone has."""
    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    given, names = own.coupling.given, [body.name for body in mechanism.bodies]
    block = coupling_block(own, names, pretension(own, recovery.loads))
    if given.type in ("gear", "screw", "belt"):
        from heuncli.loads.kinetostatics.drives_told import TOLD  # few scenes have them

        struck = bool(recovery.recovered.loads.shape[1] < len(layout.tables["loads"]))  # in a blow no load acts
        block |= {k: v for k, v in TOLD[given.type](given, own.carried, struck).items() if k not in block}
    if own.friction is not None:
        from heuncli.loads.kinetostatics.thread_friction import efficiency  # few scenes have it

        block["efficiency"] = efficiency(own, tolerances.NO_FORCE * recovery.load_magnitudes.by_unit["N"])
    if given.type == "cam":
        from heuncli.loads.kinetostatics.cams import pressure_angle  # few scenes have them

        block["pressure_angle"] = pressure_angle(own, mechanism.joints, recovery.states)
    return block


def pretension(of: CouplingLoads, loads: Sequence[AppliedLoad]) -> list[Action]:
    """What a belt pulls its pulleys together with besides, a load by its name; in a blow no load acts."""
    if of.coupling.given.type != "belt":
        return []
    return [own.action for own in loads if own.load.name == of.coupling.name]


def forces(loads: Sequence[AppliedLoad], states: BodyStates) -> dict[str, ForceBlock]:
    """Values, lengths, rates and powers of applied loads that are forces of the spec."""
    block: dict[str, ForceBlock] = {}
    for applied in loads:
        own: ForceBlock = {"value": applied.value}
        if isinstance(applied.load, PairLoad):
            own["length"] = applied.length
        if isinstance(applied.load, JointLoad) and applied.load.kind == "turn_spring":
            own["angle"] = applied.length
        if isinstance(applied.load, BushingLoad):
            own |= bushing(applied.load, applied, states)
        if isinstance(applied.load, PairLoad | JointLoad):
            own["rate"] = applied.rate
        own["power"] = applied.power
        block[applied.load.name] = own
    return block
