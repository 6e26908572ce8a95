"""Bound from below the gap that an island of loops keeps in every pose: a polygon whose longest side is longer than all
others together does not close.

    P_b − P_a = V + Σ u + Σ w      around the loop of a closure, from one of its points to the other
    |P_b − P_a| >= |V| − Σ|u|      V of bodies whose attitudes are given, u of the others: their lengths are known; w of
                                   lines and planes, along which bodies slide: V then counts across these only

Without w every side may be the longest. So a fit knows that loops cannot close, and that a gap cannot become smaller.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.assembly.walk import AssemblyPoses
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import perpendicular_pair


def bound_least_gap(
    island: AssemblyIsland, conditions: Sequence[JointCondition], poses: AssemblyPoses, size: float
) -> float:
    """Return the least root of the sum of squares of its gaps, by the size, in any poses that a fit can reach; 0 where
    none is known.
    """
    loops = LoopSides(island, conditions, poses)
    return math.sqrt(sum((loops.bound_distance(conditions[k]) / size) ** 2 for k in island.closures))


class LoopSides:
    """The sides of the polygons around an island's loops."""

    def __init__(self, island: AssemblyIsland, conditions: Sequence[JointCondition], poses: AssemblyPoses) -> None:
        self.poses = poses
        joints = zip(island.members, island.tree_joints, strict=True)
        self.conditions = {body: conditions[k] if k >= 0 else None for body, k in joints}

    def bound_distance(self, closure: JointCondition) -> float:
        """Return how far apart the points of a closure are at least, across what it leaves free [m]; 0: not known."""
        ends = [(closure.a, closure.p), (closure.b, closure.q)]
        branches = [self.list_branch(body) for body, _ in ends]
        shared = set(branches[0]) & set(branches[1])
        joints = [closure, *(self.conditions[i] for branch in branches for i in branch if i not in shared)]
        fixed, lengths, meeting = np.zeros(3), [], []
        rounding = 0.0
        for sign, (_, point), branch in zip((-1.0, 1.0), ends, branches, strict=True):
            arm, own_branch = point, [body for body in branch if body not in shared]
            for body in own_branch:
                condition = self.conditions[body]
                if condition is None or not self.poses.shifts[body]:
                    return 0.0  # it floats, or its joint may have a gap, too
                is_to = body == condition.b
                own, parent_point = (condition.q, condition.p) if is_to else (condition.p, condition.q)
                side, attitude = arm - own, self.find_attitude(body)
                if attitude is None:
                    lengths.append(_norm(side))
                else:
                    fixed += sign * (attitude @ side)
                rounding += _norm(arm) + _norm(own)
                arm = parent_point
            meeting.append((branch[len(own_branch)] if len(own_branch) < len(branch) else None, arm))
        if not self._add_last_side(meeting, branches, ends, fixed, lengths):
            return 0.0
        directions = self._list_free_directions(joints, lengths)
        if directions is None:
            return 0.0
        rounding += sum(lengths) + _norm(fixed) + float(np.abs(self.poses.x).max(initial=0.0))
        return max(_lack(fixed, lengths, directions) - tolerances.SUM_ROUNDING * rounding, 0.0)

    def list_branch(self, body: int) -> list[int]:
        """List the members from a body inward."""
        branch = []
        while body in self.conditions:
            branch.append(body)
            condition = self.conditions[body]
            if condition is None:
                break
            body = condition.a if body == condition.b else condition.b
        return branch

    def find_attitude(self, body: int) -> Array | None:
        """Return the attitude that a body has in all poses, (3, 3); None if it may turn."""
        condition = self.conditions.get(body)
        if body not in self.conditions or not self.poses.turns[body]:
            return np.asarray(self.poses.R[body])
        if condition is None or condition.pose.turn != "all":
            return None
        is_to = body == condition.b
        parent = self.find_attitude(condition.a if is_to else condition.b)
        return None if parent is None else parent @ (condition.relative if is_to else condition.relative.T)

    def find_direction(self, body: int, direction: Array) -> Array | None:
        """Return the direction that a body's own has in all poses, world, but for its sign; None if it may turn."""
        attitude = self.find_attitude(body)
        if attitude is not None:
            return np.asarray(attitude @ direction)
        condition = self.conditions[body]
        if condition is None or condition.pose.turn not in ("axis", "all"):
            return None
        is_to = body == condition.b
        parent = condition.a if is_to else condition.b
        if condition.pose.turn == "all":
            return self.find_direction(parent, (condition.relative if is_to else condition.relative.T) @ direction)
        own, other = (condition.to_axis, condition.axis) if is_to else (condition.axis, condition.to_axis)
        is_along = np.array_equal(direction, own) or np.array_equal(direction, -own)
        return self.find_direction(parent, other) if is_along else None

    def _add_last_side(
        self,
        meeting: Sequence[tuple[int | None, Array]],
        branches: Sequence[list[int]],
        ends: Sequence[tuple[int, Array]],
        fixed: Array,
        lengths: list[float],
    ) -> bool:
        """Add the side of the body where both branches meet, or of the bodies that stay; return whether that is
        known.
        """
        (body, arm), (other, other_arm) = meeting
        if body is not None or other is not None:
            if body != other or body is None:
                return False
            attitude = self.find_attitude(body)
            if attitude is None:
                lengths.append(_norm(other_arm - arm))
            else:
                fixed += attitude @ (other_arm - arm)
            return True
        for sign, (_, point), (end, _), branch in zip((-1.0, 1.0), meeting, ends, branches, strict=True):
            root = end
            if branch:
                condition = self.conditions[branch[-1]]
                assert condition is not None
                root = condition.a if branch[-1] == condition.b else condition.b
            fixed += sign * (self.poses.x[root] + self.poses.R[root] @ point)
        return True

    def _list_free_directions(
        self, joints: Sequence[JointCondition | None], lengths: list[float]
    ) -> list[Array] | None:
        """List the directions along which joints let points slide, world; None where they are not known. Rods add
        lengths.
        """
        directions: list[Array] = []
        for d in joints:
            if d is None or d.path is not None or d.pose.hold in ("none", "curve"):
                return None
            if d.pose.hold == "distance":
                lengths.append(d.length)
            elif d.pose.hold != "point":
                axis = self.find_direction(d.a, d.axis)
                if axis is None:
                    return None
                directions += [axis] if d.pose.hold == "line" else [*perpendicular_pair(axis)]
        return directions


def _lack(fixed: Array, lengths: Sequence[float], directions: Sequence[Array]) -> float:
    """Return by how much the longest side exceeds all others; below 0: they close."""
    if directions:
        Q, R = np.linalg.qr(np.array(directions).T)
        if np.abs(np.diag(R)).min() < tolerances.PARALLEL:
            return 0.0
        return _norm(fixed - Q @ (Q.T @ fixed)) - sum(lengths)
    sides = [_norm(fixed), *lengths]
    return 2.0 * max(sides) - sum(sides)


def _norm(a: Array) -> float:
    return math.sqrt(float(a @ a))
