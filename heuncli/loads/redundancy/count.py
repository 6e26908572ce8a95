"""How many conditions of the joints hold what others hold already, and how many freedoms are left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.frame import without_loads
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression, pack_of

if TYPE_CHECKING:
    from heuncli.loads.redundancy.self_stress import KnownStress, SelfStress


class Redundancy(NamedTuple):
    """How many conditions hold what others hold: near the start (a singular pose does not count), and just at it.

    dependent: the same near the start, in a planar scene with those across the plane, which are not counted; closed:
    how many rows take part at the start. open: how many are left where joints give way; giving: what these do.
    here: the self-stresses at the start.
    """

    generic: int
    at_start: int
    dependent: int
    closed: int
    stress: SelfStress | None
    open: int
    giving: tuple[str, ...] = ()
    here: KnownStress | None = None


def redundancy(scene: PreparedScene, runner: Runner, stages: Stages = ANEW) -> Redundancy:
    """Count what is held twice: it hangs on no load; stages: that is one, of the scene without loads."""
    if not scene.layout.rows:
        return Redundancy(0, 0, 0, 0, None, 0)
    drives = tuple(law.value for law in scene.mechanism.laws)
    bare, holding = without_loads(scene.layout), runner.start_holding
    return stages.run(counted_without_loads, bare, drives, holding, by=lambda: counted(runner))


def counted_without_loads(layout: Layout, drives: tuple[Expression, ...], holding: Array) -> Redundancy:
    """Count what is held twice in a scene without loads.

    drives: whose programs it has; holding (contacts,): which are closed at the start.
    """
    return counted(Evaluator(replace(layout, pack=pack_of(drives)), lambda _: holding))


def counted(runner: Evaluator) -> Redundancy:
    """Count what is held twice in a scene with closed chains."""
    from heuncli.loads.redundancy.neighbours import neighbours  # a tree starts faster without them
    from heuncli.loads.redundancy.self_stress import KnownStress, self_stress, stress_of, stress_poses

    layout = runner.layout
    here = runner.recovered(np.zeros(1), layout.y0[None, :])
    closed = int(here.rows["closed"][0].sum())
    states = body_states(layout, here)
    poses = stress_poses(here, states)
    stress = stress_of(runner, poses)
    known = KnownStress(poses, stress)
    at_start, joints = int(stress.count[0]), layout.mechanism.joints
    near = neighbours(runner, 0.0, here.states[0], (tolerances.NEIGHBOUR,))
    if near is None:
        left, giving = left_open(stress, joints, states)
        return Redundancy(at_start, at_start, int(stress.dependent[0]), closed, stress, left, giving, known)
    around = body_states(layout, near)
    beside = self_stress(runner, near, around)
    assert beside is not None
    dependent = min(stress.dependent[0], beside.dependent.min())
    generic = int(min(at_start, beside.count.min()))
    left, giving = left_open(beside, joints, around)
    return Redundancy(generic, at_start, int(dependent), closed, beside, min(generic, left), giving, known)


def left_open(stress: SelfStress, joints: Sequence[Joint], states: BodyStates) -> tuple[int, tuple[str, ...]]:
    """How many self-stresses are left at each pose once joints have given way, and what these do, in words."""
    if all(joint.stiffness is None for joint in joints):
        return int(stress.count.min()), ()
    from heuncli.loads.redundancy.split import with_least_strain
    from heuncli.loads.redundancy.zero_stiffness import soft_maps, told, vanishing

    maps = vanishing(stress, soft_maps(joints, states, stress.length))
    _, left = with_least_strain(stress, maps)
    return int(left.count.min()) if left is not None else 0, told(joints, maps)
