"""The kernel's answers at some instants made into Results: reactions, verdicts, sums, sections, foundation, energy.

Reads as the list of what is computed; each thing has its own module. Raises SolveError where no acceleration exists.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.integration.runner import Recovered, Runner
from heuncli.integration.solvable import refuse
from heuncli.kinetostatics.bodies import BodyStates, body_states
from heuncli.kinetostatics.coordinates import coordinates, points
from heuncli.kinetostatics.energy import energy, system_vector
from heuncli.kinetostatics.foundation import foundation, load_slots
from heuncli.kinetostatics.reactions import JointLoads, joint_loads
from heuncli.mechanism.model import JointLoad, Mechanism, PairLoad
from heuncli.results import Array, Block
from heuncli.study.checked import balance_residual, energy_drift
from heuncli.tree.prepare import Scene

if TYPE_CHECKING:  # loaded where a scene has closed chains, or sections
    from heuncli.redundancy.resolve import Decided
    from heuncli.redundancy.self_stress import SelfStress


@dataclass(frozen=True, eq=False)
class Composed:
    """The blocks of Results that are functions of the state, and how a split was chosen, in words."""

    blocks: dict[str, Any]
    sums: list[Block]
    split: tuple[str, ...]
    accuracy: Block
    decided: Decided | None


def compose(
    scene: Scene, runner: Runner, found: Recovered, about: Array, wanted: frozenset[str], least_norm: bool
) -> Composed:
    """All wanted blocks at the instants of `found`."""
    mechanism, layout = scene.mechanism, scene.layout
    states = body_states(layout, found)
    joints = joint_loads(layout, found, states)
    refuse(scene, found)
    decided = decided_of(scene, found, states, joints, least_norm)
    left, words = None, tuple[str, ...]()
    if decided is not None:
        joints, left, words = decided.joints, decided.left, decided.words
    power = energy(layout, found, states)
    reactions = {j.joint.name: joint_block(j) for j in joints}
    base = foundation(mechanism, found, states, joints, about)
    if decided is not None:
        decided.show(base, reactions)
    blocks: dict[str, Block] = {"foundation": base, "joints": reactions, "energy": power}
    if "motion" in wanted:
        blocks["bodies"] = {b.name: body_block(states, i) for i, b in enumerate(mechanism.bodies)}
        blocks["coordinates"] = coordinates(layout, found, states)
        blocks["system_vector"] = system_vector(mechanism, states)
    if "points" in wanted:
        blocks["points"] = points(mechanism, states)
    if "sections" in wanted:
        blocks["sections"] = sections(scene, found, states, joints, left)
    if "forces" in wanted:
        blocks["forces"] = forces(mechanism, found)
    sums = decided.sums(scene, runner, found) if decided is not None and "joints" in wanted else []
    lift = sum(body.mass for body in mechanism.bodies) * float(np.abs(mechanism.gravity).max()) * layout.size
    accuracy = {
        "energy_drift": energy_drift(power["kinetic"], power["potential"], power["work"], lift),
        "constraint_gap": float(found.gap.max(initial=0.0)),
        "balance_residual": balance_residual(mechanism, found, states, joints, layout.size),
    }
    shown = {name: block for name, block in blocks.items() if name not in ASKED or name in wanted}
    return Composed(shown, sums, words, accuracy, decided)


ASKED = frozenset({"foundation", "joints", "energy"})  # blocks that are made in any case, and shown where wanted


def decided_of(
    scene: Scene, found: Recovered, states: BodyStates, joints: list[JointLoads], least_norm: bool
) -> Decided | None:
    """What redundant joints leave open; None where there are no closed chains."""
    if not scene.layout.rows:
        return None
    from heuncli.redundancy.resolve import decide  # a tree starts faster without it

    return decide(scene, found, states, joints, least_norm)


def body_block(states: BodyStates, i: int) -> Block:
    """Motion of one body."""
    return {
        "position": states.x[:, i],
        "velocity": states.v[:, i],
        "rotation": states.R[:, i],
        "center": states.centre[:, i],
        "center_velocity": states.v_centre[:, i],
        "center_acceleration": states.a_centre[:, i],
        "angular_velocity": states.omega[:, i],
        "angular_acceleration": states.alpha[:, i],
    }


def joint_block(load: JointLoads) -> Block:
    """Reaction of one joint, with its components along and across the axis."""
    block: Block = {"point": load.point, "force": load.force, "moment": load.moment, "open": []}
    if load.drive is not None:
        block["drive"] = load.drive
    if load.axis is not None:
        axial = np.sum(load.force * load.axis, axis=1)
        across = load.force - axial[:, None] * load.axis
        tilting = load.moment - np.sum(load.moment * load.axis, axis=1)[:, None] * load.axis
        block["axial"] = axial
        block["radial"] = np.sqrt(np.sum(across**2, axis=1))
        block["tilting"] = np.sqrt(np.sum(tilting**2, axis=1))
    if load.tension is not None:
        block["tension"] = load.tension
    return block


def sections(
    scene: Scene, found: Recovered, states: BodyStates, joints: Sequence[JointLoads], stress: SelfStress | None
) -> Block:
    """The blocks of all sections."""
    block: Block = {}
    if not scene.cuts:
        return block
    # only scenes with sections load it
    from heuncli.kinetostatics.sections import joint_attachments, load_attachments, section

    for cuts in scene.cuts:
        on = joint_attachments(cuts.body, states, [(j.joint, j.point, *j.whole) for j in joints])
        on += load_attachments(scene.mechanism, cuts.body, found, states)
        shares = []
        if stress is not None:
            for k in range(stress.largest.shape[1]):
                parts = zip(joints, stress.shares, strict=True)
                wrenches = [(j.joint, j.point, s[:, :3, k], s[:, 3:, k]) for j, s in parts]
                shares.append(joint_attachments(cuts.body, states, wrenches))
        block[cuts.name] = section(cuts, states, scene.mechanism.gravity, on, stress, shares, scene.mechanism.planar)
    return block


def forces(mechanism: Mechanism, found: Recovered) -> Block:
    """Values, lengths, rates and powers of the applied loads."""
    block: Block = {}
    for load, slots in zip(mechanism.loads, load_slots(mechanism), strict=True):
        rows = found.loads[:, slots]
        block[load.name] = {"value": rows[:, 0, 12]}
        if isinstance(load, PairLoad):
            block[load.name] |= {"length": rows[:, 0, 13], "rate": rows[:, 0, 14]}
        elif isinstance(load, JointLoad):
            block[load.name] |= {"rate": rows[:, 0, 14]}
        block[load.name]["power"] = rows[:, :, 15].sum(axis=1)
    return block
