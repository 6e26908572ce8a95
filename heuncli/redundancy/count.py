"""The engineer's note on the model: freedoms, loops, and what is held twice."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heuncli.integration.runner import Runner
from heuncli.joint_kinds import JOINTS
from heuncli.kinetostatics.bodies import body_states
from heuncli.results import Block
from heuncli.tree.layout import Layout
from heuncli.tree.prepare import Scene

if TYPE_CHECKING:
    from heuncli.redundancy.self_stress import SelfStress

NEIGHBOUR = 1e-3  # [rad] or of the size: poses in which the generic rank is counted


def freedoms_of_tree(layout: Layout) -> int:
    """Freedoms of the tree alone: scalar ones that are not driven, three for each ball."""
    balls = sum(1 for i in range(len(layout.place)) if layout.I[layout.I[10] + 8 * i + 1])
    return sum(1 for f in layout.freedoms if f.q >= 0) + 3 * balls


class Redundancy(NamedTuple):
    """How many conditions hold what others hold: near the start (a singular pose does not count), and just at it.

    dependent: the same near the start, in a planar scene with those across the plane, which are not told.
    """

    generic: int
    at_start: int
    dependent: int
    stress: SelfStress | None


def redundancy(scene: Scene, runner: Runner) -> Redundancy:
    """Count what is held twice."""
    layout = scene.layout
    if not layout.rows:
        return Redundancy(0, 0, 0, None)
    from heuncli.redundancy.neighbours import neighbours  # a tree starts faster without them
    from heuncli.redundancy.self_stress import self_stress

    here = runner.recovered(np.zeros(1), layout.y0[None, :])
    stress = self_stress(layout, body_states(layout, here), here.gap)
    assert stress is not None
    near = neighbours(runner, 0.0, here.states[0], (NEIGHBOUR,))
    if near is None:
        return Redundancy(int(stress.count[0]), int(stress.count[0]), int(stress.dependent[0]), stress)
    beside = self_stress(layout, body_states(layout, near), near.gap)
    assert beside is not None
    at_start = int(stress.count[0])
    dependent = min(stress.dependent[0], beside.dependent.min())
    return Redundancy(int(min(at_start, beside.count.min())), at_start, int(dependent), beside)


def model_of(scene: Scene, runner: Runner, method: str) -> Block:
    """The model block: what was chosen to be solved, and why."""
    mechanism, layout = scene.mechanism, scene.layout
    found = redundancy(scene, runner)
    redundant, at_start, stress = found.generic, found.at_start, found.stress
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    rows = sum(kind.rows_in_plane if mechanism.planar else kind.rows for kind in kinds)
    driven = sum(1 for j in mechanism.joints if j.drive is not None)
    grubler = (3 if mechanism.planar else 6) * len(mechanism.bodies) - rows - driven
    rods = sum(1 for j in mechanism.joints if j.drive is not None and JOINTS[j.kind].keeps_distance)
    freedoms = freedoms_of_tree(layout) - (len(layout.rows) - found.dependent)
    block: Block = {
        "space": "planar" if mechanism.planar else "spatial", "freedoms": freedoms, "driven": driven,
        "bodies": len(mechanism.bodies), "loops": len(layout.spanning.cut), "redundant": redundant, "method": method,
        "reasons": [], "joints": len(mechanism.joints), "grubler": grubler + rods,
        "chosen": list(scene.start.chosen), "notes": [],
    }  # fmt: skip
    block["reasons"] = reasons(scene, block)
    if at_start > redundant:
        more = _count(at_start - redundant, "condition depends", "conditions depend")
        block["notes"].append(f"the start is a singular pose: {more} on the others just there")
    if redundant and stress is not None:
        block["notes"] += held_twice(layout, stress)
    return block


def reasons(scene: Scene, model: Block) -> list[str]:
    """The model in sentences."""
    mechanism, layout = scene.mechanism, scene.layout
    where = "in the plane" if mechanism.planar else "in space"
    bodies = _count(len(layout.place), "body", "bodies")
    found = [f"{bodies} {where}, {_count(model['freedoms'], 'freedom', 'freedoms')}"]
    cut = [mechanism.joints[k].name for k in layout.spanning.cut]
    if cut:
        found.append(f"closed at {_some(cut)}; the other joints make the tree that carries the motion")
    driven = [j.name for j in mechanism.joints if j.drive is not None]
    if driven:
        found.append(f"driven: {_some(driven)}")
    floating = [mechanism.bodies[h.body].name for h in layout.spanning.hangs if h.joint < 0]
    if floating:
        found.append(f"carried by nothing, free: {_some(floating)}")
    if model["redundant"]:
        found.append(
            f"Grübler counts {model['grubler']}, there are {model['freedoms']}: "
            f"{_count(model['redundant'], 'condition holds', 'conditions hold')} what others hold already"
        )
    for spin in scene.idle:
        name = mechanism.bodies[spin.body].name
        found.append(f"{name}: the spin about its own axis is undetermined and harmless; taken as zero")
    return found


def held_twice(layout: Layout, stress: SelfStress) -> list[str]:
    """Which joints take part in the self-stresses, and by which loads."""
    notes = []
    for joint, share in zip(layout.mechanism.joints, stress.shares, strict=True):
        size = np.where(stress.largest > 0.0, stress.largest, 1.0)
        parts = np.abs(share / size[:, None, :]).max(axis=(0, 2))
        parts[3:] /= stress.length
        names = [f"{'F' if i < 3 else 'M'}{'xyz'[i % 3]}" for i in range(6) if parts[i] > 1e-8]
        if names:
            notes.append(f"held more than once: {joint.name} {', '.join(names)}")
    return notes


def _count(n: int, one: str, many: str) -> str:
    return f"{n} {one if n == 1 else many}"


def _some(names: list[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
