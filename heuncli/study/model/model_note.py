"""The engineer's note on the model: which one was made of the scene, and why; the block `model` of the results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.redundancy.count import Redundancy
from heuncli.motion.integration.methods.method import GLOBAL, QUATERNION, RECENTRED, Method
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import BushingLoad, Mechanism, ThreadLoad
from heuncli.multibody.reduction.model import Reduced
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Block, Mask
from heuncli.study.model.counts_and_lists import count, some

if TYPE_CHECKING:  # loaded where a scene has closed chains
    from heuncli.loads.redundancy.self_stress import SelfStress

COUNTED_FROM = {GLOBAL: "counted from the drawn ones: none can pass a half turn", RECENTRED: "anew in each step"}


def model_note(scene: PreparedScene, runner: Runner, method: str, found: Redundancy) -> Block:
    """The block `model`: freedoms, loops, redundancy, and the reasons in sentences.

    found: what is held twice. Spins that no law determines are no freedoms, though Grübler counts them.
    """
    mechanism, layout = scene.mechanism, scene.layout
    block: Block = {
        "space": "planar" if mechanism.planar else "spatial",
        "freedoms": layout.tree_freedoms - (found.closed - found.dependent) - scene.undetermined,
        "driven": len(mechanism.laws),
        "bodies": len(mechanism.bodies), "loops": len(layout.spanning.cut), "redundant": found.generic,
        "method": method, "reasons": [], "joints": len(mechanism.joints), "grubler": grubler(mechanism),
        "chosen": list(scene.start.chosen), "notes": [],
    }  # fmt: skip
    if scene.start.moved:
        block["moved"] = list(scene.start.moved)
    if scene.start.started:
        block["started"] = list(scene.start.started)
    if mechanism.planar:
        block["plane"] = "declared"
    if mechanism.couplings:
        block["couplings"] = len(mechanism.couplings)
    block["reasons"] = reasons(scene, block)
    if rolls(mechanism):
        from heuncli.loads.redundancy.poses import freedoms_of_pose  # few scenes have wheels

        block["pose_freedoms"] = freedoms_of_pose(runner) - scene.undetermined
        block["reasons"].insert(1, poses_and_speeds(block))
    if layout.contacts:
        block["impacts"] = mechanism.impacts
        block["reasons"].append(one_sided(layout, runner.start_holding[: len(layout.contacts)] > 0.0))
    if found.at_start > found.generic:
        more = count(found.at_start - found.generic, "condition depends", "conditions depend")
        block["notes"].append(f"the start is a singular pose: {more} on the others just there")
    if found.generic and found.stress is not None:
        block["notes"] += held_twice(layout, found.stress)
    block["notes"] += found.giving
    if scene.undetermined:
        block["undetermined"] = scene.undetermined
        spins = count(scene.undetermined, "undetermined spin")
        block["notes"].append(f"{spins} left out of the freedoms: without inertia, and nothing else moves with them")
    if found.open < found.generic:
        block["given_way"] = found.generic - found.open
    return block


def rolls(mechanism: Mechanism) -> bool:
    """Whether wheels hold speeds and no poses."""
    return any(row.parts[0].holds_speed for coupling in mechanism.couplings for row in coupling.rows)


def poses_and_speeds(model: Block) -> str:
    """How many freedoms poses have, and how many speeds, in a sentence."""
    poses, speeds = count(model["pose_freedoms"], "freedom", "freedoms"), model["freedoms"]
    return f"{poses} of pose, {speeds} of speed: what rolls without slip holds speeds, and no pose"


def reductions(left_out: Sequence[str], scene: PreparedScene, reduced: Reduced | None) -> Block:
    """What was left out or made smaller, what was not though one might expect it, what cannot be told: sentences.

    A scene that was found to stay in a plane is planar, too; what is across that is told as in space.
    """
    found: Block = {"reduced": [*left_out]}
    if reduced is not None:
        found["reduced"] += reduced.told
        found |= {"not_reduced": list(reduced.kept), "cannot_tell": list(reduced.hidden)}
        if reduced.steps and reduced.steps[-1].scene.mechanism.planar and not scene.mechanism.planar:
            found |= {"space": "planar", "plane": "found"}
    return {key: value for key, value in found.items() if value}


def rested(block: Block, told: Sequence[str]) -> Block:
    """The block `model` with how the scene rests, in sentences."""
    return block | {"rest": list(told), "notes": [*told, *block["notes"]]} if told else block


def grubler(mechanism: Mechanism) -> int:
    """Grübler's count of freedoms: 6 (in the plane 3) a body less the joints' conditions and the drives."""
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    rows = sum(kind.rows_in_plane if mechanism.planar else kind.rows for kind in kinds)
    # a driven distance is held anyway
    drives = sum(1 for j in mechanism.joints if j.drive is not None and not JOINTS[j.kind].keeps_distance)
    rows += sum(len(coupling.rows) for coupling in mechanism.couplings)
    return (3 if mechanism.planar else 6) * len(mechanism.bodies) - rows - drives


def reasons(scene: PreparedScene, model: Block) -> list[str]:
    """The model in sentences."""
    mechanism, layout = scene.mechanism, scene.layout
    where = "in the plane" if mechanism.planar else "in space"
    bodies = count(len(layout.place), "body", "bodies")
    sentences = [f"{bodies} {where}, {count(model['freedoms'], 'freedom', 'freedoms')}"]
    cut = [mechanism.joints[k].name for k in layout.spanning.cut]
    if cut:
        sentences.append(f"closed at {some(cut)}; the other joints make the tree that carries the motion")
    coupled = [f"{own.name} ({own.given.type})" for own in mechanism.couplings if own.stretched is None]
    if coupled:
        sentences.append(f"coupled: {some(coupled)}")
    if any(isinstance(load, ThreadLoad) for load in mechanism.loads):
        from heuncli.study.model.thread_note import of_threads  # few scenes have them

        sentences += of_threads(mechanism)
    driven = [mechanism.owner(law.owner).partition(".")[2] for law in mechanism.laws]
    if driven:
        sentences.append(f"driven: {some(driven)}")
    bushings = [load.name for load in mechanism.loads if isinstance(load, BushingLoad)]
    if bushings:
        sentences.append(f"on bushings, which leave all freedoms: {some(bushings)}")
    ropes = [own.name for own in mechanism.couplings if own.stretched is not None]
    if ropes:
        sentences.append(f"on ropes that stretch, which leave all freedoms: {some(ropes)}")
    floating = [mechanism.bodies[h.body].name for h in layout.spanning.hangs if h.joint < 0]
    if floating:
        sentences.append(f"carried by nothing, free: {some(floating)}")
    spins = f" and {count(scene.undetermined, 'undetermined spin')}" if scene.undetermined else ""
    if model["redundant"]:
        sentences.append(
            f"Grübler counts {model['grubler']}, there are {model['freedoms']}{spins}: "
            f"{count(model['redundant'], 'condition holds', 'conditions hold')} what others hold already"
        )
    for spin in scene.idle:
        name = mechanism.bodies[spin.body].name
        which = "the spin about its own axis" if len(spin.axes) == 1 or mechanism.planar else "its spin"
        sentences.append(f"{name}: {which} is undetermined and harmless; taken as zero")
    return sentences


def attitudes(method: Method, integrated: Layout) -> list[str]:
    """How a method holds attitudes within a step, if not as quaternions, in a sentence."""
    if method.attitude == QUATERNION:
        return []
    if not integrated.bodies["ball"].any():
        return [f"{method.name}: of what is integrated no body hangs on a ball or floats, so this is DOP853"]
    return [f"{method.name}: attitudes by Rodrigues' numbers, {COUNTED_FROM[method.attitude]}"]


def one_sided(layout: Layout, closed: Mask) -> str:
    """What opens and closes, and what of it is closed at the start, in a sentence."""
    contacts = layout.contacts
    names = list(dict.fromkeys(contact.name for contact in contacts))
    shut = list(dict.fromkeys(contact.name for contact, held in zip(contacts, closed, strict=True) if held))
    return f"opens and closes: {some(names)}; closed at the start: {some(shut) if shut else 'none'}"


def held_twice(layout: Layout, stress: SelfStress) -> list[str]:
    """Which joints take part in the self-stresses, and by which loads."""
    notes = []
    for joint, share in zip(layout.mechanism.joints, stress.shares, strict=True):
        size = np.where(stress.largest > 0.0, stress.largest, 1.0)
        parts = np.abs(share / size[:, None, :]).max(axis=(0, 2))
        parts[3:] /= stress.length
        names = [f"{'F' if i < 3 else 'M'}{'xyz'[i % 3]}" for i in range(6) if parts[i] > tolerances.OPEN_SHARE]
        if names:
            notes.append(f"held more than once: {joint.name} {', '.join(names)}")
    for r, owner in enumerate(layout.rows):
        size = np.where(stress.largest > 0.0, stress.largest, 1.0)
        unit = stress.length if layout.tables["closures"]["measure"][r] != 1.0 else 1.0
        share = np.abs(stress.multipliers[:, r] / size).max(initial=0.0) / unit
        if owner >= len(layout.mechanism.joints) and share > tolerances.OPEN_SHARE:
            notes.append(f"held more than once: {layout.mechanism.owner(owner)}")
    return notes
