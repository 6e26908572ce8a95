"""Apply the steps of reduction one after the other; each one reduces the scene that the previous one has made.

The smaller scene moves as the larger one does, and is integrated in its place:

    y = embed(t, y'),   y' = restrict(t, y)        states of the larger and of the smaller scene

The smaller scene has the same loads, drives, impulses, stops and contacts, in the same order, so that the branches of
expressions and the closed contacts mean the same in both; a load whose body is part of the ground acts on the ground.
It has the same size, so that tolerances mean the same. Results at an instant are computed from the larger scene, at y.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

# Model


@record
class Reduction:
    """One step to a smaller scene.

    embed: maps instants (n_t,) and states (n_t, n') of the smaller scene to those of the larger, (n_t, n)
    restrict: maps an instant and a state (n,) of the larger scene to that of the smaller, (n',)
    explanations: sentences on what was left out, and why that changes nothing
    limitations: sentences on what the smaller scene cannot show
    exceptions: sentences on what might have been left out, and was not
    """

    scene: PreparedScene
    embed: Callable[[Array, Array], Array]
    restrict: Callable[[float, Array], Array]
    explanations: tuple[str, ...]
    limitations: tuple[str, ...] = ()
    exceptions: tuple[str, ...] = ()


@record
class ReducedScene:
    """The smallest scene that was found, as the steps that lead to it from the given scene.

    exceptions: sentences why parts that a reader might expect to be left out were not
    """

    steps: tuple[Reduction, ...]
    exceptions: tuple[str, ...]

    @property
    def explanations(self) -> tuple[str, ...]:
        """Sentences on what was left out, and why that changes nothing."""
        return tuple(sentence for step in self.steps for sentence in step.explanations)

    @property
    def limitations(self) -> tuple[str, ...]:
        """Sentences on what the smaller scene cannot show."""
        return tuple(sentence for step in self.steps for sentence in step.limitations)

    def embed(self, times: Array, states: Array) -> Array:
        """Map states of the smallest scene to those of the given scene, (n_t, n)."""
        for step in reversed(self.steps):
            states = step.embed(times, states)
        return states

    def restrict(self, t: float, state: Array) -> Array:
        """Map a state of the given scene to one of the smallest."""
        for step in self.steps:
            state = step.restrict(t, state)
        return state


# Compose


def has_constant_velocity_joint(scene: PreparedScene) -> bool:
    """Return whether the scene has a constant-velocity joint, which may bend in any plane, so that the scene is not
    flat.
    """
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
