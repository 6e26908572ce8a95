"""Turn springs, dampers and other loads of MuJoCo that a spec has, too, into force entries; and limits into stops.

hinge      -k (q - springref) - d q'    a turn_spring, a damper
slide      the same along its axis      a torque (thrust) by its travel, a damper
negative   k or d, which drive          a torque by the coordinate or its rate
ball       -d sigma, relative           a damper
gravcomp   -gravcomp m g at the centre of mass: a force
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.scene.importers.description import DescribedEntry
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.laws import get_drawn_coordinate
from heuncli.scene.importers.mjcf.loop_closures import AssignName
from heuncli.scene.importers.mjcf.tendons import sum_joint_damping
from heuncli.scene.importers.mjcf.tree import (
    COORDINATE_KEYS,
    RATE_KEYS,
    BodyFrames,
    BodyPoints,
    JointTree,
    TreeJoint,
    to_vec,
)
from heuncli.scene.importers.spec_text import format_decimal, format_number


def iter_joint_loads(compiled: CompiledModel, tree: JointTree, assign_name: AssignName) -> Iterator[DescribedEntry]:
    """Yield the springs and dampers in the joints of the tree."""
    springs, dampers = not compiled.is_disabled("PASSIVE", "SPRING"), not compiled.is_disabled("PASSIVE", "DAMPER")
    for step in tree.steps:
        if step.joint is None:
            continue
        stiffness = float(compiled.model.jnt_stiffness[step.joint]) if springs else 0.0
        damping = sum_joint_damping(compiled, step.joint) if dampers else 0.0
        if stiffness and step.kind in COORDINATE_KEYS:
            reference = float(compiled.model.qpos_spring[compiled.model.jnt_qposadr[step.joint]])
            yield _make_spring(step, stiffness, reference - get_drawn_coordinate(compiled, step.joint), assign_name)
        if (step.kind in COORDINATE_KEYS and damping) or (step.kind == "ball" and damping > 0.0):
            yield _make_damper(step, damping, assign_name)


def _make_damper(step: TreeJoint, damping: float, assign_name: AssignName) -> DescribedEntry:
    entry_name = assign_name(f"damping_{step.name}")
    if damping > 0.0:
        return DescribedEntry(entry_name, {"type": "damper", "joint": step.name, "coefficient": damping})
    law = f"{format_decimal(-damping)}*{step.name}.{RATE_KEYS[step.kind]}"
    return DescribedEntry(entry_name, {"type": "torque", "joint": step.name, "value": law}, "negative damping")


def _make_spring(step: TreeJoint, stiffness: float, free_position: float, assign_name: AssignName) -> DescribedEntry:
    if step.kind == "pin" and stiffness > 0.0:
        keys = {
            "type": "turn_spring",
            "joint": step.name,
            "stiffness": stiffness,
            **({"angle": free_position} if free_position else {}),
        }
        return DescribedEntry(assign_name(f"spring_{step.name}"), keys)
    displacement = f"{step.name}.{COORDINATE_KEYS[step.kind]}"
    if free_position:
        displacement = f"({displacement} {'-' if free_position > 0.0 else '+'} {format_number(abs(free_position))})"
    keys = {"type": "torque", "joint": step.name, "value": f"{format_number(-stiffness)}*{displacement}"}
    remark = "a spring along the slide" if stiffness > 0.0 else "negative stiffness"
    return DescribedEntry(assign_name(f"spring_{step.name}"), keys, remark)


def iter_gravity_compensation(
    compiled: CompiledModel,
    frames: BodyFrames,
    tree: JointTree,
    points: BodyPoints,
    gravity: Any,
    assign_name: AssignName,
    free: bool,
) -> Iterator[DescribedEntry]:
    """Yield the forces of gravity compensation; none if springs and dampers are both disabled.

    What joints with `actuatorgravcomp` carry is left to their drives; free joints have no drive.
    """
    if compiled.is_disabled("PASSIVE") or (compiled.is_disabled("SPRING") and compiled.is_disabled("DAMPER")):
        return
    for body in range(1, int(compiled.model.nbody)):
        share, mass = float(compiled.model.body_gravcomp[body]), float(compiled.model.body_mass[body])
        if not (share and mass and frames.owners[body]) or not any(gravity):
            continue
        if not free and all(find_motor_compensation(compiled, body)):
            continue
        body_name = tree.names[frames.owners[body]]
        center = points.add(body_name, "center", frames.transform_point(body, compiled.model.body_ipos[body]))
        vector = to_vec(-share * mass * g for g in gravity)
        remark = f"gravcomp {format_number(share)} of {compiled.describe_part('body', body)}"
        yield DescribedEntry(
            assign_name(f"gravcomp_{body_name}"), {"type": "force", "on": center, "vector": vector}, remark
        )


def find_motor_compensation(compiled: CompiledModel, body: int) -> list[bool]:
    """For each joint that carries a body, return whether its motor carries the weight (`actuatorgravcomp`)."""
    found: list[bool] = []
    while body:
        first = int(compiled.model.body_jntadr[body])
        found += [
            bool(compiled.model.jnt_actgravcomp[k]) for k in range(first, first + int(compiled.model.body_jntnum[body]))
        ]
        body = int(compiled.model.body_parentid[body])
    return found


def iter_stops(
    compiled: CompiledModel, tree: JointTree, driven_joints: frozenset[int], assign_name: AssignName
) -> Iterator[DescribedEntry]:
    """Yield the limits of the joints without a drive as stops. At a stop, the coordinate meets an impact without
    rebound.
    """
    if compiled.is_disabled("LIMIT", "CONSTRAINT"):
        return
    for step in tree.steps:
        if step.joint is None or step.joint in driven_joints or not compiled.model.jnt_limited[step.joint]:
            continue
        if step.kind in COORDINATE_KEYS:
            low, high = (
                float(limit) - get_drawn_coordinate(compiled, step.joint)
                for limit in compiled.model.jnt_range[step.joint]
            )
            yield DescribedEntry(
                assign_name(f"limits_{step.name}"), {"joint": step.name, COORDINATE_KEYS[step.kind]: (low, high)}
            )
