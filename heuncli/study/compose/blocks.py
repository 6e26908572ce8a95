"""Turn recovered solutions into blocks of the results: joints, foundation, sections, forces, motion, energy.

Each block is what `Results` holds under its name: arrays over the instants, SI units.

What a joint and its reaction pass through, from the file to a cell. Up to the number:

    AnyJoint                  scene/file_format/format_joints.py     the entry of the file: its keys, checked
    Joint of a Spec           scene/file_format/models.py            in SI units, bodies by name
    Joint of a Mechanism      multibody/mechanism/model.py           bodies by index, axes as arrays
    TreeLink, or closure rows multibody/tree/                        its place in the tree, or how it closes a loop
    tables of a Layout        multibody/tree/layout.py               the arrays that the kernel reads
    History                   study/solve/history.py                 finds the kernel's solutions at the instants
    Evaluation                motion/integration/evaluator.py        the kernel's forces of tree joints and multipliers
    Recovery                  study/compose/recovery.py              computes each of the following at its first use
    Resolution                loads/redundancy/resolve.py            in redundant scenes: what is determined
    JointLoads                loads/kinetostatics/reactions.py       by find_joint_loads: force and moment ON `to`
    JointBlock of the Results results/results.py, made here          by make_joint_block: components, shares, marks

JSON is written of that block (output/tables/export.py). After it:

    StoredArray               results/stored_arrays.py               stands for its arrays where a file holds long ones
    Channel                   study/quantities/channels.py           by iter_channels: path, unit, kind of error
    Extremes                  results/results.py                     least and greatest value, each with its instant
    RowGroup, TableBlock      output/tables/table_blocks.py          by build_block: channels that share rows of a table
    NumberCell                output/documents/document.py           by make_cells: display units, digits of its error
    OutputTable               output/documents/document.py           its cells, placed; no other form of the number

A section goes the same way: SectionEntry, Section, Cuts (loads/kinetostatics/cuts.py), its block, its channels. Those
of a series of cuts are a CutSeries (study/quantities/cut_series.py); a search cuts it as one whole length, a Stretch
(loads/kinetostatics/stretch.py). A sensor reads the one or the other (loads/kinetostatics/moved_reactions.py,
section_blocks.py here).
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import Action, AppliedLoad
from heuncli.loads.kinetostatics.balance import system_vector
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates, evaluate_point_motions
from heuncli.loads.kinetostatics.coupling_numbers import (
    DRIVE_ELEMENT_NUMBERS,
    efficiency,
    make_coupling_block,
    pressure_angle,
)
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import Momenta, find_momenta, foundation_block, make_element_keys
from heuncli.loads.kinetostatics.reactions import JointLoads, find_joint_axes, rotate_block
from heuncli.multibody.mechanism.loads import GROUND, BushingLoad, JointLoad, PairLoad
from heuncli.results.results import Array, Block, BodyBlock, ForceBlock, JointBlock
from heuncli.results.results_schema import SHARES
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.selection import select_blocks

if TYPE_CHECKING:
    pass


def make_blocks(recovery: Recovery, reports: Set[str]) -> dict[str, Any]:
    """Make the blocks of some reports, by the names of the fields of `Results`.

    Joints, stops and foundation in this order: loads, their shares by cause, axes, and which of them are indeterminate.
    Turning a block turns its shares with it, so they are there before; marks set single components to nan, which no
    rotation may mix with others, so they come last and in the axes that are shown.
    """
    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    solutions, states = recovery.solutions, recovery.states
    blocks_by_name: dict[str, Any] = {}
    if "foundation" in reports:
        blocks_by_name["foundation"] = foundation_block(
            mechanism, states, recovery.ground_actions, recovery.setup.moment_point, recovery.inner_forces
        )
    if "joints" in reports:
        blocks_by_name |= make_reaction_blocks(recovery, SHARES in reports)
    if SHARES in reports:
        from heuncli.study.solve.cause_shares import add_shares  # few runs need them

        add_shares(blocks_by_name, recovery.shares, mechanism, states, recovery.setup.moment_point)
    axes = recovery.setup.selection.axes
    for load in recovery.requested_joints if axes != "world" and "joints" in blocks_by_name else ():
        rotate_block(blocks_by_name["joints"][load.joint.name], find_joint_axes(load.joint, states, axes))
    if blocks_by_name and recovery.resolution is not None:
        recovery.resolution.mark(states, blocks_by_name, recovery.couplings, axes, make_element_keys(mechanism))
        if layout.friction_contacts and "foundation" in blocks_by_name:
            from heuncli.loads.redundancy.shared_friction import mark_elements  # few scenes have such friction

            elements = blocks_by_name["foundation"].get("elements", {})
            mark_elements(layout, solutions, elements, make_element_keys(mechanism))
    if "energy" in reports:
        blocks_by_name["energy"] = recovery.energy
    if "motion" in reports:
        blocks_by_name |= make_motion_blocks(recovery)
    if "points" in reports:
        blocks_by_name["points"] = evaluate_point_motions(mechanism, states)
    if "sections" in reports:
        blocks_by_name["sections"] = {}
        if recovery.setup.cuts:
            from heuncli.study.compose.section_blocks import make_section_blocks  # few scenes have sections

            blocks_by_name["sections"] = make_section_blocks(recovery, SHARES in reports)
    if "forces" in reports:
        blocks_by_name["forces"] = make_force_blocks(
            [own for own in recovery.loads if mechanism.spec_block(own.load) == "forces"], states
        )
    return blocks_by_name


def make_motion_blocks(recovery: Recovery) -> dict[str, Any]:
    """Make the blocks of the motion: bodies, their momenta, joint coordinates, Heun's system vector."""
    from heuncli.loads.kinetostatics.coordinates import (  # tables do not show them
        find_body_quaternions,
        find_rodrigues_vectors,
    )

    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    solutions, states = recovery.solutions, recovery.states
    attitude_quaternions = find_body_quaternions(layout, solutions)
    vectors = find_rodrigues_vectors(attitude_quaternions)
    body_momenta = find_momenta(mechanism, states, recovery.setup.moment_point)
    return {
        "bodies": {
            b.name: make_body_block(states, attitude_quaternions, vectors, body_momenta, i)
            for i, b in enumerate(mechanism.bodies)
        },
        "momentum": body_momenta.sum_bodies(),
        "coordinates": evaluate_joint_coordinates(layout, solutions, states),
        "system_vector": system_vector(mechanism, states),
    }


def make_reaction_blocks(recovery: Recovery, by_cause: bool) -> dict[str, Any]:
    """Make the blocks of joints, sensors, stops and couplings; by_cause: those of sensors with their shares."""
    planar = recovery.setup.scene.mechanism.planar
    blocks: dict[str, Any] = {
        "joints": {j.joint.name: make_joint_block(j, planar) for j in recovery.requested_joints},
        "stops": make_stop_blocks(recovery.requested_joints),
        "couplings": {own.coupling.name: make_coupling_results(recovery, own) for own in recovery.couplings},
    }
    if recovery.setup.sensors:
        from heuncli.study.compose.section_blocks import make_sensor_blocks  # few scenes have them

        blocks["sensors"] = make_sensor_blocks(recovery, by_cause)
    return blocks


def make_requested_blocks(recovery: Recovery, reports: Set[str]) -> dict[str, Any]:
    """Make the blocks of some reports, each with its requested entries only."""
    return select_blocks(make_blocks(recovery, reports), recovery.setup.selection)


def make_body_block(states: BodyStates, quaternions: Array, vectors: Array, momenta: Momenta, i: int) -> BodyBlock:
    """Make the block of one body's motion; quaternions and Rodrigues' vectors of all bodies are given."""
    return {
        "position": states.x[:, i],
        "velocity": states.v[:, i],
        "rotation": states.R[:, i],
        "quaternion": quaternions[:, i],
        "center": states.centre[:, i],
        "center_velocity": states.v_centre[:, i],
        "center_acceleration": states.a_centre[:, i],
        "angular_velocity": states.omega[:, i],
        "angular_acceleration": states.alpha[:, i],
        "rodrigues": vectors[:, i],
        "momentum": momenta.linear[:, i],
        "moment_of_momentum": momenta.orbital[:, i] + momenta.spin[:, i],
    }


def make_joint_block(load: JointLoads, planar: bool = False) -> JointBlock:
    """Make the block of one joint's reaction, with its components along and across the axis.

    planar: whether the scene is declared planar
    """
    block: JointBlock = {"point": load.point, "force": load.force, "moment": load.moment, "open": []}
    if load.drive is not None:
        block["drive"] = load.drive
    if load.axis is not None:
        axial = np.sum(load.force * load.axis, axis=1)
        radial_force = load.force - axial[:, None] * load.axis
        tilting_moment = load.moment - np.sum(load.moment * load.axis, axis=1)[:, None] * load.axis
        block["axial"] = axial
        block["radial"] = np.sqrt(np.sum(radial_force**2, axis=1))
        block["tilting"] = np.sqrt(np.sum(tilting_moment**2, axis=1))
    if load.torque is not None:
        block["torque"] = load.torque
    if load.tension is not None:
        block["tension"] = load.tension
    if load.joint.bearing is not None:
        carried = block["radial"] if "radial" in block else np.sqrt(np.sum(load.force**2, axis=1))
        block["pressure"] = carried / load.joint.bearing
    if load.joint.bearings is not None:
        from heuncli.loads.kinetostatics.moved_reactions import make_bearing_blocks  # few joints have them

        block["bearings"] = make_bearing_blocks(load, planar)
    if load.joint.path is not None and load.joint.path.radius:
        block["contact_point"] = load.points.contact_point(load.joint, load.point)
    return block


def make_stop_blocks(joints: Sequence[JointLoads]) -> Block:
    """Make the blocks of stops: the load that each exerts ON `to` along its coordinate."""
    return {
        own.stop.name: {"moment" if own.stop.quantity == "angle" else "force": own.value}
        for load in joints
        for own in load.stops
    }


def make_bushing_block(load: BushingLoad, applied_load: AppliedLoad, states: BodyStates) -> ForceBlock:
    """Make the block of a bushing: its shift, its turn, and its load on `to`, in axes fixed in `from`."""
    assert applied_load.strain is not None
    shift, turn = applied_load.strain[:, 0], applied_load.strain[:, 1]
    R = np.eye(3) if load.a == GROUND else states.R[:, load.a]
    force, moment = (own @ load.frame for own in (
        (applied_load.action.force[:, None] @ R)[:, 0], (applied_load.action.moment[:, None] @ R)[:, 0]
    ))  # fmt: skip
    return {"shift": shift, "turn": turn, "force": force, "moment": moment}


def make_coupling_results(recovery: Recovery, coupling_loads: CouplingLoads) -> dict[str, Any]:
    """Make the block of a coupling, with the numbers that only its kind has."""
    mechanism, layout = recovery.setup.scene.mechanism, recovery.setup.scene.layout
    spec_coupling, names = coupling_loads.coupling.entry, [body.name for body in mechanism.bodies]
    block = make_coupling_block(coupling_loads, names, find_pretension(coupling_loads, recovery.loads))
    if spec_coupling.type in DRIVE_ELEMENT_NUMBERS:
        is_impulse = bool(recovery.solutions.loads.shape[1] < len(layout.tables["loads"]))  # at an impulse no load acts
        block |= {
            k: v
            for k, v in DRIVE_ELEMENT_NUMBERS[spec_coupling.type](
                spec_coupling, coupling_loads.carried_load, is_impulse
            ).items()
            if k not in block
        }
    if coupling_loads.friction is not None:
        found = efficiency(coupling_loads, tolerances.NO_FORCE * recovery.load_magnitudes.by_unit["N"])
        own_load = next((own for own in recovery.loads if own.action is coupling_loads.friction), None)
        if own_load is not None and own_load.reserve is not None:
            found = np.where(own_load.reserve > 0.0, 0.0, found)
            block["reserve"] = own_load.reserve
        block["efficiency"] = found
    if spec_coupling.type == "cam":
        block["pressure_angle"] = pressure_angle(coupling_loads, mechanism.joints, recovery.states)
    return block


def find_pretension(coupling: CouplingLoads, loads: Sequence[AppliedLoad]) -> list[Action]:
    """Return the additional pull of a belt on its pulleys, a load with the belt's name; at an impulse no load acts."""
    if coupling.coupling.entry.type != "belt":
        return []
    return [own.action for own in loads if own.load.name == coupling.coupling.name]


def make_force_blocks(loads: Sequence[AppliedLoad], states: BodyStates) -> dict[str, ForceBlock]:
    """Make the blocks of the spec's forces: values, lengths, rates and powers of applied loads."""
    block: dict[str, ForceBlock] = {}
    for applied_load in loads:
        force_block: ForceBlock = {"value": applied_load.value}
        if isinstance(applied_load.load, PairLoad):
            force_block["length"] = applied_load.length
        if isinstance(applied_load.load, JointLoad) and applied_load.load.row.has_potential:
            force_block["angle"] = applied_load.length
        if isinstance(applied_load.load, BushingLoad):
            force_block |= make_bushing_block(applied_load.load, applied_load, states)
        if isinstance(applied_load.load, PairLoad | JointLoad):
            force_block["rate"] = applied_load.rate
        force_block["power"] = applied_load.power
        if applied_load.reserve is not None:
            force_block["reserve"] = applied_load.reserve
            if np.isnan(applied_load.value).any():
                force_block["open"] = ["value"]
        block[applied_load.load.name] = force_block
    return block
