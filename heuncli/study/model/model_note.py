"""Make the block `model` of the results: which model heun made of the scene, in numbers and in sentences.

method_choice.py has the sentences on the method of integration.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.spelling import format_count, list_some
from heuncli.loads.redundancy.count import RedundancyCount
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.loads import BushingLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction.compose import ReducedScene
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Block, Mask
from heuncli.scene.file_format.couplings import Screw, ThreadFriction
from heuncli.scene.file_format.models import Spec

if TYPE_CHECKING:
    from heuncli.loads.kinetostatics.cuts import Cuts
    from heuncli.loads.redundancy.self_stress import SelfStress
    from heuncli.scene.shapes.member_section import MemberSection

MAX_MEMBERS = 3  # cross-sections of a section that are described: of a tapered member its first and its last


def make_model_block(scene: PreparedScene, runner: Runner, method: str, redundancy: RedundancyCount) -> Block:
    """Make the block `model`: freedoms, loops, redundancy, and the reasons in sentences.

    Spins that no law determines do not count as freedoms, though Grübler counts them.
    """
    mechanism, layout = scene.mechanism, scene.layout
    block: Block = {
        "space": "planar" if mechanism.planar else "spatial",
        "freedoms": layout.tree_freedoms - (redundancy.active_rows - redundancy.dependent) - scene.undetermined_count,
        "driven": len(mechanism.laws),
        "bodies": len(mechanism.bodies), "loops": len(layout.spanning.cut), "redundant": redundancy.generic,
        "method": method, "reasons": [], "joints": len(mechanism.joints), "grubler": count_grubler_freedoms(mechanism),
        "chosen": list(scene.start.start_choices), "notes": [],
    }  # fmt: skip
    if scene.start.displaced_bodies:
        block["moved"] = list(scene.start.displaced_bodies)
    if scene.start.start_motions:
        block["started"] = list(scene.start.start_motions)
    if mechanism.planar:
        block["plane"] = "declared"
    if mechanism.couplings:
        block["couplings"] = len(mechanism.couplings)
    block["reasons"] = describe_model(scene, block)
    if has_rolling_wheels(mechanism):
        from heuncli.loads.redundancy.count import count_pose_freedoms  # few scenes have wheels

        block["pose_freedoms"] = count_pose_freedoms(runner) - scene.undetermined_count
        block["reasons"].insert(1, describe_pose_freedoms(block))
    if layout.contacts:
        block["impacts"] = mechanism.impacts
        block["reasons"].append(describe_contacts(layout, runner.start_holding[: len(layout.contacts)] > 0.0))
    if redundancy.at_start > redundancy.generic:
        more = format_count(
            redundancy.at_start - redundancy.generic, "constraint is redundant", "constraints are redundant"
        )
        block["notes"].append(f"the start is a singular position: {more} only there")
    if redundancy.generic and redundancy.stress is not None:
        block["notes"] += describe_self_stresses(layout, redundancy.stress)
    block["notes"] += redundancy.giving
    if scene.undetermined_count:
        block["undetermined"] = scene.undetermined_count
        spins = format_count(scene.undetermined_count, "undetermined spin")
        block["notes"].append(f"{spins} not counted as degrees of freedom: without inertia or effect on other bodies")
    if redundancy.remaining < redundancy.generic:
        block["given_way"] = redundancy.generic - redundancy.remaining
    return block


def has_rolling_wheels(mechanism: Mechanism) -> bool:
    """Return whether wheels constrain speeds and not poses."""
    return any(row.parts[0].constrains_speed for coupling in mechanism.couplings for row in coupling.rows)


def describe_pose_freedoms(model: Block) -> str:
    """Say in a sentence how many freedoms the pose has, and how many the speeds."""
    poses, speeds = format_count(model["pose_freedoms"], "degree of freedom", "degrees of freedom"), model["freedoms"]
    return f"{poses} in position, {speeds} in velocity: rolling without slip constrains velocities, not positions"


def describe_reductions(left_out: Sequence[str], scene: PreparedScene, reduction: ReducedScene | None) -> Block:
    """Describe what was left out or reduced, what was not though one might expect it, and which results this hides.

    A scene that was found to stay in a plane is planar, too; results across the plane are given as in space.
    """
    found: Block = {"reduced": [*left_out]}
    if reduction is not None:
        found["reduced"] += reduction.explanations
        found |= {"not_reduced": list(reduction.exceptions), "cannot_tell": list(reduction.limitations)}
        if reduction.steps and reduction.steps[-1].scene.mechanism.planar and not scene.mechanism.planar:
            found |= {"space": "planar", "plane": "found"}
    return {key: value for key, value in found.items() if value}


def describe_files(spec: Spec) -> list[str]:
    """Say in sentences what was done to the points of tables, and which solids the bodies are."""
    shapes = [(name, shape) for name, body in spec.bodies.items() for shape in body.shapes or ()]
    return [
        *(note for table in spec.tables.values() for note in table.notes),
        *(f"{name}: {fact}" for name, shape in shapes if shape.mesh is not None for fact in shape.mesh.facts),
    ]


def add_rest_sentences(block: Block, sentences: Sequence[str]) -> Block:
    """Return the block `model` with sentences on the rest pose."""
    return block | {"rest": list(sentences), "notes": [*sentences, *block["notes"]]} if sentences else block


def count_grubler_freedoms(mechanism: Mechanism) -> int:
    """Grübler's count of freedoms: 6 (in the plane 3) per body minus the constraints of joints and drives."""
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    rows = sum(kind.planar_row_count if mechanism.planar else kind.row_count for kind in kinds)
    # a driven distance is constrained anyway
    driven_joints = sum(1 for j in mechanism.joints if j.drive is not None and not JOINTS[j.kind].keeps_distance)
    rows += sum(len(coupling.rows) for coupling in mechanism.couplings)
    return (3 if mechanism.planar else 6) * len(mechanism.bodies) - rows - driven_joints


def describe_model(scene: PreparedScene, model: Block) -> list[str]:
    """Describe the model in sentences."""
    mechanism, layout = scene.mechanism, scene.layout
    space = "planar" if mechanism.planar else "spatial"
    bodies = format_count(len(layout.place), "body", "bodies")
    sentences = [
        f"{space} model of {bodies}, {format_count(model['freedoms'], 'degree of freedom', 'degrees of freedom')}"
    ]
    cut = [mechanism.joints[k].name for k in layout.spanning.cut]
    if cut:
        sentences.append(f"loop-closing joint{'s' * (len(cut) > 1)}: {list_some(cut)}; the other joints form the tree")
    coupled = [f"{own.name} ({own.entry.type})" for own in mechanism.couplings if own.stretched_row is None]
    if coupled:
        sentences.append(f"coupled: {list_some(coupled)}")
    if any(isinstance(load, ThreadLoad) for load in mechanism.loads):
        sentences += describe_threads(mechanism)
    driven = [mechanism.owner_path(law.owner).partition(".")[2] for law in mechanism.laws]
    if driven:
        sentences.append(f"driven: {list_some(driven)}")
    bushings = [load.name for load in mechanism.loads if isinstance(load, BushingLoad)]
    if bushings:
        sentences.append(f"elastic bushings, without constraints: {list_some(bushings)}")
    ropes = [own.name for own in mechanism.couplings if own.stretched_row is not None]
    if ropes:
        sentences.append(f"elastic ropes, without constraints: {list_some(ropes)}")
    floating = [mechanism.bodies[h.body].name for h in layout.spanning.links if h.joint < 0]
    if floating:
        sentences.append(f"bodies without a joint in the tree: {list_some(floating)}")
    spins = f" and {format_count(scene.undetermined_count, 'undetermined spin')}" if scene.undetermined_count else ""
    if model["redundant"]:
        sentences.append(
            f"Grübler count {model['grubler']}, actual {model['freedoms']}{spins}: "
            f"{format_count(model['redundant'], 'redundant constraint')}"
        )
    for spin in scene.idle_spins:
        name = mechanism.bodies[spin.body].name
        which = "the spin about its own axis" if len(spin.axes) == 1 or mechanism.planar else "its spin"
        sentences.append(f"{name}: {which} is undetermined but harmless; set to zero")
    return sentences


def describe_contacts(layout: Layout, is_closed: Mask) -> str:
    """Say in a sentence which contacts open and close, and which are closed at the start."""
    contacts = layout.contacts
    names = list(dict.fromkeys(contact.name for contact in contacts))
    closed_names = list(
        dict.fromkeys(contact.name for contact, is_held in zip(contacts, is_closed, strict=True) if is_held)
    )
    return (
        f"contacts that open and close: {list_some(names)}; closed at the start: "
        f"{list_some(closed_names) if closed_names else 'none'}"
    )


def describe_self_stresses(layout: Layout, stress: SelfStress) -> list[str]:
    """Say which joints take part in the self-stresses, and by which loads."""
    notes = []
    for joint, share in zip(layout.mechanism.joints, stress.shares, strict=True):
        size = np.where(stress.largest > 0.0, stress.largest, 1.0)
        parts = np.abs(share / size[:, None, :]).max(axis=(0, 2))
        parts[3:] /= stress.length
        names = [f"{'F' if i < 3 else 'M'}{'xyz'[i % 3]}" for i in range(6) if parts[i] > tolerances.OPEN_SHARE]
        if names:
            notes.append(f"redundantly constrained: {joint.name} {', '.join(names)}")
    for r, owner in enumerate(layout.rows):
        size = np.where(stress.largest > 0.0, stress.largest, 1.0)
        unit = stress.length if layout.tables["closures"]["unit_load_size"][r] != 1.0 else 1.0
        share = np.abs(stress.multipliers[:, r] / size).max(initial=0.0) / unit
        if owner >= len(layout.mechanism.joints) and share > tolerances.OPEN_SHARE:
            notes.append(f"redundantly constrained: {layout.mechanism.owner_path(owner)}")
    return notes


SELF_LOCKING = "self-locking"


def describe_threads(mechanism: Mechanism) -> Iterator[str]:
    """Yield a sentence for each thread with friction."""
    for coupling in mechanism.couplings:
        if isinstance(coupling.entry, Screw) and coupling.entry.friction is not None:
            yield f"{coupling.name}: {describe_thread(coupling.entry.lead, coupling.entry.friction)}"


def describe_thread(lead: float, friction: ThreadFriction) -> str:
    """Describe a thread by its slope, its angle of friction, and its efficiency at full friction.

    eta = tan(lambda) / tan(lambda + rho) of turning into thrust, tan(lambda - rho) / tan(lambda) of thrust into turning
    """
    slope, mu = abs(lead) / (math.tau * friction.radius), friction.coefficient
    a, b = (f"{math.degrees(math.atan(x)):.4g} deg" for x in (slope, mu))
    angles = f"(slope {a}, angle of friction {b})"
    if slope * mu >= 1.0:
        return f"no torque rotates it against a thrust {angles}"
    efficiency = f"efficiency {slope * (1.0 - slope * mu) / (slope + mu):.3g} from torque to thrust"
    if slope <= mu:
        return f"{SELF_LOCKING} {angles}: no thrust rotates it; {efficiency}"
    return (
        f"not {SELF_LOCKING} {angles}: {efficiency}, {(slope - mu) / (1.0 + slope * mu) / slope:.3g} "
        "from thrust to torque"
    )


def describe_members(cuts: Sequence[Cuts]) -> Block:
    """Describe in sentences the cross-sections of members for which stresses are computed."""
    sentences: list[str] = []
    for section in cuts:
        if not section.cuts_members or section.properties is None:
            continue
        from heuncli.loads.kinetostatics import member_stress  # few scenes have members

        kind, values = section.properties
        if kind != "auto":
            member = member_stress.find_given_factors(kind, values).section
            sentences.append(f"{section.name}: {_describe_member(kind, member)}")
            continue
        found = [group for group in section.auto_properties.groups if group.member is not None]
        found.sort(key=lambda group: int(np.argmax(group.cut_mask)))
        for group in found if len(found) <= MAX_MEMBERS else [found[0], found[-1]]:
            place = "" if section.s is None else f" at s = {section.s[group.cut_mask][0]:.6g} m"
            assert group.member is not None
            sentences.append(f"{section.name}{place}: {_describe_member(group.kind, group.member.section)}")
    return {"members": sentences} if sentences else {}


def _describe_member(family: str, section: MemberSection) -> str:
    """Describe a cross-section: its numbers, and how far they are approximate."""
    W = section.moduli
    text = (
        f"{family}, A = {section.area * 1e4:.4g} cm², I = {section.Ivv * 1e8:.4g} cm⁴ about its width and "
        f"{section.Iuu * 1e8:.4g} cm⁴ about its height, W = {W[0] * 1e6:.4g} and {W[1] * 1e6:.4g} cm³ (exact), "
        f"J = {section.J * 1e8:.3g} cm⁴ (within 6 %)"
    )
    first, second, angle = section.principal
    if abs(section.Iuv) > tolerances.PRINCIPAL * first:
        turned = f"the first {math.degrees(angle):.2f}° from the width"
        text += f", principal I = {first * 1e8:.4g} and {second * 1e8:.4g} cm⁴, {turned}"
    if section.shear_center.any():
        u, v = section.shear_center.tolist()
        text += f", shear centre ({u * 1e3:.3g}, {v * 1e3:.3g}) mm from the centroid (thin walls)"
    return text
