"""Propose how to make a redundant model determinate: replace joints by less constrained ones, found by trying.

A less constrained joint holds part of what the original held, so where the number of freedoms stays the same, so does
the motion. Joints that are driven, loaded, limited by a stop, named in an expression or have a start value keep their
kind, because they need it. They may give way to the moments that others hold (split.py).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, product

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_Z, JOINTS, POINT
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.redundancy.count import count_redundancy
from heuncli.loads.redundancy.self_stress import find_neighbour_poses, find_self_stress
from heuncli.motion.integration.run.runner import Runner, make_runner
from heuncli.multibody.mechanism.loads import GROUND, JointLoad
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array, Block

MAX_TRIALS = 400  # replacements tried before the hint is given up

ZERO_MOMENT_STIFFNESS = (np.full(3, np.inf), np.zeros(3))  # a joint's force and moment stiffness: it takes no moments

Choices = Mapping[int, tuple[Joint, ...]]  # joint -> what may take its place


def propose_replacements(scene: PreparedScene, model: Block) -> list[str]:
    """Propose a replacement of joints that leaves nothing indeterminate and changes no freedom, or say that none was
    found.

    Returns nothing if nothing is redundant.
    """
    redundant = int(model["redundant"]) - int(model.get("given_way", 0))
    if not redundant:
        return []
    choices = find_choices(scene)
    for trial_number, replacements in enumerate(_iter_replacements(scene.mechanism.joints, choices, redundant)):
        if trial_number >= MAX_TRIALS:
            break
        if _count_remaining(scene, replacements, model) == 0:
            return [
                f"statically determinate with {format_replacements(scene, replacements, ' and ')}: "
                "same motion, no open reactions"
            ]
    return propose_stepwise(scene, choices, model, redundant)


def propose_stepwise(scene: PreparedScene, choices: Choices, model: Block, redundant: int) -> list[str]:
    """Replace joints one after another, inner ones first, wherever that leaves less indeterminate and changes no
    freedom.
    """
    replacements, redundant_left = dict[int, Joint](), redundant
    for k, kinds in choices.items():
        for replacement in reversed(kinds):
            trial = _count_remaining(scene, {**replacements, k: replacement}, model) if redundant_left else None
            if trial is not None and trial < redundant_left:
                replacements[k], redundant_left = replacement, trial
                break
    if not replacements:
        return [
            "joint types with fewer constraints do not help; give these joints a `stiffness` to distribute the load"
        ]
    if redundant_left == 0:
        return [
            f"statically determinate with {format_replacements(scene, replacements, ', ')}: same motion, no "
            "open reactions"
        ]
    rest = f"{redundant_left} of {redundant} redundant constraints remain; for those give joints a `stiffness`"
    return [f"with {format_replacements(scene, replacements, ', ')}, {rest}"]


def find_choices(scene: PreparedScene) -> Choices:
    """Return for each joint that may change the joints that may replace it; inner joints first."""
    mechanism = scene.mechanism
    joints = mechanism.joints
    used_names = {joints[load.joint].name for load in mechanism.loads if isinstance(load, JointLoad)}
    used_names |= {joints[stop.joint].name for stop in mechanism.stops}
    used_names |= {joints[k].name for coupling in mechanism.couplings for k in coupling.joints}
    used_names |= {name for value in mechanism.iter_expressions() for name, _ in value.uses}
    directions = find_indeterminate_directions(scene)
    choices: dict[int, tuple[Joint, ...]] = {}
    for k in sorted(range(len(joints)), key=lambda k: GROUND in (joints[k].a, joints[k].b)):
        j = joints[k]
        has_start_value = any(value is not None for value in (j.angle, j.rate, j.travel, j.speed))
        if j.drive is None and not has_start_value and j.name not in used_names:
            looser = JOINTS[j.kind].weaker_planar_kinds if mechanism.planar else JOINTS[j.kind].weaker_kinds
            replacements = (replace_joint(j, kind, directions[k]) for kind in looser)
            choices[k] = tuple(other for other in replacements if other is not None)
        elif JOINTS[j.kind].perpendicular_pairs and not mechanism.planar and j.stiffness is None:
            choices[k] = (replace(j, stiffness=ZERO_MOMENT_STIFFNESS),)
    return choices


def find_indeterminate_directions(scene: PreparedScene) -> list[Array | None]:
    """Return for each joint the single direction in `from` axes in which its force is indeterminate; None for more, or
    none.
    """
    runner = Runner(scene.layout)
    start = runner.evaluate(np.zeros(1), scene.layout.y0[None, :])
    poses = find_neighbour_poses(runner, 0.0, start.states[0], (tolerances.NEIGHBOUR,)) or start
    states = make_body_states(scene.layout, poses)
    stress = find_self_stress(runner, poses, states)
    assert stress is not None
    directions: list[Array | None] = []
    for joint, share in zip(scene.mechanism.joints, stress.shares, strict=True):
        F = share[:, :3] / np.where(stress.largest > 0.0, stress.largest, 1.0)[:, None]
        F = F if joint.a == GROUND else states.R[:, joint.a].transpose(0, 2, 1) @ F
        U, sigma, _ = np.linalg.svd(F.transpose(1, 0, 2).reshape(3, -1), full_matrices=False)
        n = U[:, 0] * np.sign(U[np.argmax(np.abs(U[:, 0])), 0])
        second_value, tolerance = float(sigma[1:].max(initial=0.0)), tolerances.ONE_DIRECTION
        directions.append(n if sigma[0] > tolerance and second_value <= tolerance * sigma[0] else None)
    return directions


def _count_remaining(scene: PreparedScene, replacements: Mapping[int, Joint], model: Block) -> int | None:
    """Return the remaining redundancy with these joints; None where they free something, or leave a spin
    undetermined.
    """
    joints = tuple(replacements.get(k, j) for k, j in enumerate(scene.mechanism.joints))
    new_scene, runner = make_runner(lay_out_scene(replace(scene.mechanism, joints=joints), scene.start))
    count = count_redundancy(new_scene, runner)
    freedoms = new_scene.layout.tree_freedoms - (count.active_rows - count.dependent) - scene.undetermined_count
    return (
        count.remaining
        if freedoms == model["freedoms"] and len(new_scene.idle_spins) <= len(scene.idle_spins)
        else None
    )


def _iter_replacements(joints: tuple[Joint, ...], choices: Choices, redundant: int) -> Iterator[dict[int, Joint]]:
    """Yield up to three replacements that together remove as many conditions as are redundant, few ones first.

    A joint that gives way removes as many of its moments as others hold, at least one.
    """

    def count_removed(k: int, other: Joint) -> tuple[int, int]:
        kind = JOINTS[joints[k].kind]
        fewer = kind.row_count - JOINTS[other.kind].row_count
        return (fewer, fewer) if fewer else (1, len(kind.perpendicular_pairs))

    max_reduction = max((count_removed(k, other)[1] for k, others in choices.items() for other in others), default=0)
    for n in (1, 2, 3):
        if n * max_reduction < redundant:
            continue
        for joint_numbers in combinations(choices, n):
            for others in product(*(choices[k] for k in joint_numbers)):
                min_reduction, reduction = (
                    sum(ends) for ends in zip(*map(count_removed, joint_numbers, others), strict=True)
                )
                if min_reduction <= redundant <= reduction:
                    yield dict(zip(joint_numbers, others, strict=True))


def replace_joint(joint: Joint, kind: str, direction: Array | None) -> Joint | None:
    """Return the joint as another kind at the same place, None where its axis is unknown.

    A joint that held the point and has no axis to slide along (a ball, or in the plane a pin) may slide along the one
    direction in which it is indeterminate; a kind that needs a second axis gets one perpendicular to its first.
    """
    old_kind, new_kind = JOINTS[joint.kind], JOINTS[kind]
    if old_kind.hold is POINT and new_kind.shifts == ("axis",) and (not old_kind.has_axis or new_kind.turn is ABOUT_Z):
        return replace(joint, kind=kind, axis=direction, to_axis=direction) if direction is not None else None
    if new_kind.to_axis != "required":
        return replace(joint, kind=kind)
    e = np.zeros(3)
    e[int(np.argmin(np.abs(joint.to_axis)))] = 1.0
    second_axis = e - (e @ joint.to_axis) * joint.to_axis
    return replace(joint, kind=kind, to_axis=second_axis / np.sqrt(second_axis @ second_axis), to_axis_given=True)


def format_replacements(scene: PreparedScene, replacements: Mapping[int, Joint], separator: str) -> str:
    """Format the replacements as the user would write them, with an axis where it is not the joint's own."""
    words = []
    for k, replacement in replacements.items():
        original = scene.mechanism.joints[k]
        kind = JOINTS[replacement.kind]
        text = f"{replacement.name} of type {kind.display_name or kind.name}"
        if replacement.kind == original.kind:
            text = f"stiffness: {{moment: 0}} on {replacement.name}"
        elif kind.to_axis == "required":
            text += f" (to_axis {_format_direction(replacement.to_axis)})"
        elif kind.has_axis and replacement.axis is not original.axis:
            text += f" (axis {_format_direction(replacement.axis)})"
        words.append(text)
    return separator.join(words)


def _format_direction(direction: Array) -> str:
    """Format a direction to all its digits, because a rounded one would misalign the joint."""
    exact = np.where(np.abs(direction) < tolerances.ZERO_COMPONENT, 0.0, direction)
    return "[" + ", ".join(f"{x:.15g}" for x in exact / np.abs(exact).max()) + "]"
