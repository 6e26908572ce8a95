"""The steps of reduction, one after the other: each makes the scene that the one before it left smaller still."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.base.joint_kinds import JOINTS
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction.model import Reduced, Reduction
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.prepare import PreparedScene


def any_alike(scene: PreparedScene) -> bool:
    """Whether a joint bends in any plane, and so is none of a flat scene."""
    return any(JOINTS[joint.kind].turns_alike for joint in scene.mechanism.joints)


# in their order: the module under this one whose `step` it is, and whether it may concern a scene at all
STEPS: tuple[tuple[str, Callable[[PreparedScene], bool]], ...] = (
    ("welded_bodies", lambda scene: any(JOINTS[joint.kind].is_rigid for joint in scene.mechanism.joints)),
    ("immobile_bodies", lambda scene: any(k < len(scene.mechanism.joints) for k in scene.layout.rows)),
    ("spins", lambda scene: bool(scene.layout.bodies["ball"].any())),
    ("plane.step", lambda scene: bool(scene.mechanism.bodies) and not any_alike(scene)),
)


def whole(mechanism: Mechanism) -> list[str]:
    """Why a scene is moved as it is given, in sentences; none where it may be made smaller."""
    why = []
    if mechanism.rubbing:
        why.append("friction hangs on what joints carry, and in a smaller scene they carry less")
    if any(own.stretched is not None for own in mechanism.couplings):
        why.append("ropes that stretch pull at bodies that a smaller scene might be without")
    return [f"the scene is moved as it is given: {reason}" for reason in why]


def reduce(scene: PreparedScene, stages: Stages = ANEW) -> Reduced:
    """The smallest scene that moves as this one does; stages: each step is one."""
    if reasons := whole(scene.mechanism):
        return Reduced((), tuple(reasons))
    steps: list[Reduction] = []
    kept: list[str] = []
    for name, concerns in STEPS:
        if not concerns(scene):
            continue
        step = import_module(f"heuncli.multibody.reduction.{name}").step  # few scenes need it
        found = stages.run(step, scene)
        if isinstance(found, Reduction):
            steps.append(found)
            kept += found.kept
            scene = found.scene
        else:
            kept += found
    return Reduced(tuple(steps), tuple(kept))
