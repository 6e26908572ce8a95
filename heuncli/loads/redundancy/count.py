"""Count the redundant conditions of the joints, and the remaining freedoms.

Where wheels roll, poses have more freedoms than speeds: wheels constrain only these.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.response import jacobian
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout, find_speed_rows, remove_loads
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression, make_pack

if TYPE_CHECKING:
    from heuncli.loads.redundancy.self_stress import CachedStress, SelfStress


# Count


class RedundancyCount(NamedTuple):
    """The numbers of redundant conditions and of rows of a scene.

    generic: redundant conditions near the start, where a singular position does not count
    at_start: the same exactly at the start
    dependent: dependent rows near the start; in a planar scene also those across the plane, which `generic` leaves out
    active_rows: rows that take part at the start
    stress: the self-stresses near the start; None without closed chains
    remaining: redundant conditions left once joints have given way
    giving: sentences on what these joints do
    start_stress: the self-stresses at the start, to be reused
    """

    generic: int
    at_start: int
    dependent: int
    active_rows: int
    stress: SelfStress | None
    remaining: int
    giving: tuple[str, ...] = ()
    start_stress: CachedStress | None = None


def count_redundancy(scene: PreparedScene, runner: Runner, stage_cache: Stages = NO_CACHE) -> RedundancyCount:
    """Count the redundancy of a scene, which depends on no load and no rate; stage_cache: caches the count of the scene
    without them.
    """
    if not scene.layout.rows:
        return RedundancyCount(0, 0, 0, 0, None, 0)
    drives = tuple(law.value for law in scene.mechanism.laws)
    from heuncli.loads.redundancy.self_stress import stop_motion  # a tree starts faster without it

    layout, holding = scene.layout, scene.layout.open_followers(runner.start_holding)
    evaluator = Evaluator(layout, lambda _: holding) if layout.friction_contacts else runner
    bare_layout = replace(remove_loads(layout), y0=stop_motion(layout, layout.y0))
    return stage_cache.run(
        count_without_loads, bare_layout, drives, holding, fallback=lambda: count_self_stresses(evaluator)
    )


def count_without_loads(layout: Layout, drives: tuple[Expression, ...], holding: Array) -> RedundancyCount:
    """Count the redundancy of a scene without loads.

    drives: the expressions whose programs it has
    holding (contacts,): which contacts are closed at the start
    """
    return count_self_stresses(Evaluator(replace(layout, pack=make_pack(drives)), lambda _: holding))


def count_self_stresses(runner: Evaluator) -> RedundancyCount:
    """Count the redundancy of a scene with closed chains."""
    from heuncli.loads.redundancy.self_stress import (
        CachedStress,
        find_neighbour_poses,  # a tree starts faster without them
        find_self_stress,
        find_stress_of_poses,
        make_stress_poses,
        stop_motion,
    )

    layout = runner.layout
    start = runner.evaluate(np.zeros(1), stop_motion(layout, layout.y0[None, :]))
    active_rows = int(start.rows["closed"][0].sum())
    states = make_body_states(layout, start)
    poses = make_stress_poses(layout, start, states)
    stress = find_stress_of_poses(runner, poses)
    start_stress = CachedStress(poses, stress)
    at_start, joints = int(stress.count[0]), layout.mechanism.joints
    neighbour_poses = find_neighbour_poses(runner, 0.0, start.states[0], (tolerances.NEIGHBOUR,))
    if neighbour_poses is None:
        remaining, giving = count_after_yielding(stress, joints, states)
        return RedundancyCount(
            at_start, at_start, int(stress.dependent[0]), active_rows, stress, remaining, giving, start_stress
        )
    neighbour_states = make_body_states(layout, neighbour_poses)
    neighbour_stress = find_self_stress(runner, neighbour_poses, neighbour_states)
    assert neighbour_stress is not None
    dependent = min(stress.dependent[0], neighbour_stress.dependent.min())
    generic = int(min(at_start, neighbour_stress.count.min()))
    remaining, giving = count_after_yielding(neighbour_stress, joints, neighbour_states)
    return RedundancyCount(
        generic, at_start, int(dependent), active_rows, neighbour_stress, min(generic, remaining), giving, start_stress
    )


def count_after_yielding(
    stress: SelfStress, joints: Sequence[Joint], states: BodyStates
) -> tuple[int, tuple[str, ...]]:
    """Count the self-stresses left at each pose once joints have given way; also return sentences on these joints."""
    if all(joint.stiffness is None for joint in joints):
        return int(stress.count.min()), ()
    from heuncli.loads.redundancy.split import describe_yielding, find_vanishing, make_yield_maps, minimise_strain

    maps = find_vanishing(stress, make_yield_maps(joints, states, stress.length))
    _, remaining = minimise_strain(stress, maps)
    return int(remaining.count.min()) if remaining is not None else 0, describe_yielding(joints, maps)


# Poses


def count_pose_freedoms(evaluator: Evaluator) -> int:
    """Return the freedoms of the tree minus the rank of the rows that constrain poses, at the start."""
    layout = evaluator.layout
    rank = 0
    for island in layout.islands:
        rows = island.rows[~find_speed_rows(layout)[island.rows]]
        J = jacobian(evaluator.workspace, layout, np.zeros(1), layout.y0[None, :]).block(rows, island.freedoms)[0]
        J = J * layout.tables["closures"]["unit_load_size"][rows][:, None] * layout.velocity_scale[island.freedoms]
        rank += int(np.linalg.matrix_rank(J, tol=tolerances.RANK)) if J.size else 0
    return layout.tree_freedoms - rank
