"""The steps of reduction, one after the other: each makes the scene that the one before it left smaller still."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.joint_kinds import JOINTS
from heuncli.reduction.model import Reduced, Reduction
from heuncli.stages import ANEW, Stages
from heuncli.tree.prepare import PreparedScene

# in their order: the module under this one whose `step` it is, and whether it may concern a scene at all
STEPS: tuple[tuple[str, Callable[[PreparedScene], bool]], ...] = (
    ("welded_bodies", lambda scene: any(JOINTS[joint.kind].is_rigid for joint in scene.mechanism.joints)),
    ("immobile_bodies", lambda scene: bool(scene.layout.rows)),
    ("spins", lambda scene: bool(scene.layout.bodies["ball"].any())),
    ("plane.step", lambda scene: bool(scene.mechanism.bodies)),
)


def reduce(scene: PreparedScene, stages: Stages = ANEW) -> Reduced:
    """The smallest scene that moves as this one does; stages: each step is one.

    Where friction hangs on what joints carry nothing is left out, for in a smaller scene they carry less; nor where
    couplings look at bodies and coordinates that a smaller scene might be without, or where a point runs along a path.
    """
    mechanism = scene.mechanism
    if mechanism.rubbing or mechanism.couplings or any(joint.path is not None for joint in mechanism.joints):
        return Reduced((), ())
    steps: list[Reduction] = []
    kept: list[str] = []
    for name, concerns in STEPS:
        if not concerns(scene):
            continue
        step = import_module(f"heuncli.reduction.{name}").step  # few scenes need it
        found = stages.run(step, scene)
        if isinstance(found, Reduction):
            steps.append(found)
            kept += found.kept
            scene = found.scene
        else:
            kept += found
    return Reduced(tuple(steps), tuple(kept))
