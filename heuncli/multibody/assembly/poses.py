"""Find poses that fit: place bodies outward along the tree, then fit the islands that this leaves open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.fit import IslandFit
from heuncli.multibody.assembly.islands import (
    MAX_BODIES,
    AssemblyIsland,
    Islands,
    does_not_fit,
    no_length,
    settle_islands,
    too_many,
)
from heuncli.multibody.assembly.rows import JointGaps
from heuncli.multibody.assembly.walk import (
    AssemblyPoses,
    PlacementTree,
    find_placement_tree,
    place_bodies,
    place_body,
    prescribed_coordinates,
    start_poses,
)
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism


class PoseAssembly:
    """The poses of a mechanism while they move from the drawing to where all joints are closed. Mutable.

    drawn: the poses at the start; poses: the present ones
    tree: how the walk reaches the bodies
    fitted: bodies fitted in an island
    folded: joints whose loop was folded in a fixed direction
    gap: the largest that is left [m]
    """

    def __init__(self, mechanism: Mechanism, conditions: Sequence[JointCondition], size: float) -> None:
        self.mechanism = mechanism
        self.conditions = conditions
        self.size = size
        self.drawn = start_poses(mechanism)
        self.poses = self.drawn.copy()
        self.tree, self.islands = _find_loops(mechanism, conditions)
        self.fitted: set[int] = set()
        self.folded: list[str] = []
        self.gap = 0.0
        self.limit = tolerances.OPEN_GAP
        self._prescribed = prescribed_coordinates(mechanism, conditions)
        self._gaps = JointGaps(conditions, [d.pose for d in conditions])

    def fit(self) -> None:
        """Close all joints. Raises SolveError: does-not-fit, held-conflict."""
        place_bodies(self.poses, self.tree, self.conditions)
        farthest = float(np.max(np.abs(self.poses.x), initial=0.0))
        self.limit = max(tolerances.OPEN_GAP, tolerances.GAP_ROUNDING * farthest / self.size)
        if stuck := settle_islands(self.tree, self.islands, self._find_open_joints, self._fit, self._place_again):
            raise self._fit_error(stuck)
        for d in self.conditions:
            if d.pose.hold == "none" and _point_distance(d, self.poses) < tolerances.NO_LENGTH * self.size:
                raise no_length(self.mechanism, d.joint)

    def _find_open_joints(self) -> list[int]:
        """Return the joints that are open."""
        distance, angle = self._gaps(self.poses.x, self.poses.R)
        self.gap = float(np.max(np.maximum(distance, self.size * angle), initial=0.0))
        is_open = np.maximum(distance / self.size, angle) > self.limit
        return [int(k) for k in np.flatnonzero(is_open)]

    def _place_again(self, body: int) -> None:
        self.poses.x[body], self.poses.R[body] = self.drawn.x[body], self.drawn.R[body]
        if self.tree.tree_joint[body] >= 0:
            place_body(self.poses, self.conditions[self.tree.tree_joint[body]], body)

    def _fit(self, island: AssemblyIsland, afresh: bool) -> None:
        if afresh:
            for body in island.members:
                self._place_again(body)
        if len(island.members) > MAX_BODIES:
            raise too_many(self.mechanism, island, "poses")
        fit = IslandFit(self.poses, island, self.conditions, self.tree.depth, self.size, self.mechanism.planar)
        before = fit.save_poses()
        drawn = self.drawn.x[island.members], self.drawn.R[island.members]
        can_close = fit.bound_gap() <= self.limit  # else it is fitted for what the error says alone
        closed, kick = fit.close_near_drawing(drawn, self.limit) if can_close else (False, 0)
        if can_close and not closed:
            closed = fit.follow_coordinates(drawn, self._prescribed, self.limit)
        if not closed:
            fit.restore_poses(before)
            closed, kick = self._fit_from_walk(fit)
        if closed:
            self.fitted.update(island.members)
            if kick:
                self.folded.append(self.mechanism.joints[(island.closures or island.tree_joints)[0]].name)
        elif self.islands.moving_body(island.parent) == GROUND:
            raise self._fit_error(fit.joints)
        else:
            fit.restore_poses(before)
            self.islands.widen(island.closures[0])  # the bodies that carry it may have to turn, too

    def _fit_from_walk(self, fit: IslandFit) -> tuple[bool, int]:
        """Return whether an island closes from the poses that the walk has found, and which kick it took."""
        bodies = [self.mechanism.bodies[i] for i in fit.island.members]
        fit.fit_to_near([(b.near_rotation is not None, b.near_position is not None) for b in bodies], self.limit)
        start_poses = fit.save_poses()
        closed, kick = fit.settle(self.limit)
        if closed:
            fit.polish(start_poses, self.limit)
        return closed, kick

    def _fit_error(self, joints: Sequence[int]) -> Exception:
        distance, angle = self._gaps(self.poses.x, self.poses.R)
        return does_not_fit(self.mechanism, distance, angle, self.size, joints)


def _point_distance(d: JointCondition, poses: AssemblyPoses) -> float:
    """Distance of a joint's points [m]."""
    D = poses.x[d.b] + poses.R[d.b] @ d.q - poses.x[d.a] - poses.R[d.a] @ d.p
    return float(np.sqrt(D @ D))


def _find_loops(mechanism: Mechanism, conditions: Sequence[JointCondition]) -> tuple[PlacementTree, Islands]:
    """Find the tree of the walk and its loops; roots are the ground, held positions and, in loops, `near` positions
    too.
    """
    bodies = mechanism.bodies
    constraints = [(d.a, d.b, d.pose) for d in conditions]
    is_link = [d.pose.hold != "none" for d in conditions]
    is_preferred = [b.rotation is not None for b in bodies]
    is_fixed = [b.position is not None and b.rotation is not None for b in bodies]
    is_held = [b.position is not None for b in bodies]
    tree = find_placement_tree(mechanism, constraints, is_held, is_preferred)
    islands = Islands(tree, conditions, is_link, is_fixed)
    roots = [
        root or (b.near_position is not None and islands.is_in_loop(i))
        for i, (b, root) in enumerate(zip(bodies, is_held, strict=True))
    ]
    if roots != is_held:
        tree = find_placement_tree(mechanism, constraints, roots, is_preferred)
        islands = Islands(tree, conditions, is_link, is_fixed)
    return tree, islands
