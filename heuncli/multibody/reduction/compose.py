"""Apply the steps of reduction one after the other; each one reduces the scene that the previous one has made."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.base.joint_kinds import JOINTS
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.reduction.model import ReducedScene, Reduction
from heuncli.multibody.stages import NO_CACHE, Stages
from heuncli.multibody.tree.prepare import PreparedScene


def has_constant_velocity_joint(scene: PreparedScene) -> bool:
    """Whether the scene has a constant-velocity joint, which may bend in any plane, so that the scene is not flat."""
    return any(JOINTS[joint.kind].is_constant_velocity for joint in scene.mechanism.joints)


# in their order: the module in this package whose `step` it is, and whether it may apply to a scene
STEPS: tuple[tuple[str, Callable[[PreparedScene], bool]], ...] = (
    ("welded_bodies", lambda scene: any(JOINTS[joint.kind].is_rigid for joint in scene.mechanism.joints)),
    ("immobile_bodies", lambda scene: any(k < len(scene.mechanism.joints) for k in scene.layout.rows)),
    ("spins", lambda scene: bool(scene.layout.bodies["ball"].any())),
    ("plane.step", lambda scene: bool(scene.mechanism.bodies) and not has_constant_velocity_joint(scene)),
)


def reasons_against_reduction(mechanism: Mechanism) -> list[str]:
    """Return the reasons why a scene must not be reduced, as sentences; empty if it may be."""
    reasons = []
    if mechanism.joint_friction:
        reasons.append("friction depends on the joint loads, and a reduced model would change them")
    if any(coupling.stretched_row is not None for coupling in mechanism.couplings):
        reasons.append("elastic ropes act on bodies that a reduced model might omit")
    return [f"the full model is solved: {reason}" for reason in reasons]


def reduce(scene: PreparedScene, stages: Stages = NO_CACHE) -> ReducedScene:
    """Find the smallest scene that moves as this one does; each step is a stage."""
    if reasons := reasons_against_reduction(scene.mechanism):
        return ReducedScene((), tuple(reasons))
    steps: list[Reduction] = []
    exceptions: list[str] = []
    for name, concerns in STEPS:
        if not concerns(scene):
            continue
        step = import_module(f"heuncli.multibody.reduction.{name}").step  # few scenes need it
        result = stages.run(step, scene)
        if isinstance(result, Reduction):
            steps.append(result)
            exceptions += result.exceptions
            scene = result.scene
        else:
            exceptions += result
    return ReducedScene(tuple(steps), tuple(exceptions))
