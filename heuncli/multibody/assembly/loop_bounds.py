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


class LoopPolygon:
    """The sides around a loop: the sum of those that are given, and lengths of others; normals: the directions that
    these are perpendicular to in all poses, None if not known. Mutable.
    """

    def __init__(self) -> None:
        self.fixed = np.zeros(3)
        self.lengths: list[float] = []
        self.normals: list[Array | None] = []

    def add_length(self, length: float, normal: Array | None = None) -> None:
        """Add a side of some length."""
        self.lengths.append(length)
        self.normals.append(normal)

    def find_least_gap(self, directions: Sequence[Array]) -> float:
        """Return by how much the longest side exceeds all others, with gaps along some directions; below 0: they
        close.
        """
        fixed = self.fixed
        if directions:
            Q, R = np.linalg.qr(np.array(directions).T)
            if np.abs(np.diag(R)).min() < tolerances.PARALLEL:
                return 0.0
            fixed = fixed - Q @ (Q.T @ fixed)
            if len(directions) > 1 or not all(_is_along(normal, directions[0]) for normal in self.normals):
                return _norm(fixed) - sum(self.lengths)
        sides = [_norm(fixed), *self.lengths]
        return 2.0 * max(sides) - sum(sides)


class LoopSides:
    """The sides of the polygons around an island's loops."""

    def __init__(self, island: AssemblyIsland, conditions: Sequence[JointCondition], poses: AssemblyPoses) -> None:
        self.poses = poses
        joints = zip(island.members, island.tree_joints, strict=True)
        self.conditions = {body: conditions[k] if k >= 0 else None for body, k in joints}

    def bound_distance(self, closure: JointCondition) -> float:
        """Return how far apart the points of a closure are at least, across what it leaves free [m]; 0: not known."""
        ends = ((-1.0, closure.a, closure.p), (1.0, closure.b, closure.q))
        branches = [self.list_branch(body) for _, body, _ in ends]
        shared = [body for body in branches[0] if body in branches[1]]
        polygon, joints, arms, rounding = LoopPolygon(), [closure], [], 0.0
        for (sign, root, arm), branch in zip(ends, branches, strict=True):
            for body in branch:
                if body in shared:
                    break
                condition = self.conditions[body]
                if condition is None or not self.poses.shifts[body]:
                    return 0.0  # it floats, or its joint may have a gap, too
                is_to = body == condition.b
                own, outer = (condition.q, condition.p) if is_to else (condition.p, condition.q)
                self._add_side(polygon, body, sign * (arm - own))
                rounding += _norm(arm) + _norm(own)
                arm, root = outer, condition.a if is_to else condition.b
                joints.append(condition)
            arms.append((sign, root, arm))
        if shared:
            self._add_side(polygon, shared[0], arms[1][2] - arms[0][2])
        else:
            for sign, root, arm in arms:
                polygon.fixed += sign * (self.poses.x[root] + self.poses.R[root] @ arm)
        directions = self._list_free_directions(joints, polygon)
        if directions is None:
            return 0.0
        rounding += sum(polygon.lengths) + _norm(polygon.fixed) + float(np.abs(self.poses.x).max(initial=0.0))
        return max(polygon.find_least_gap(directions) - tolerances.SUM_ROUNDING * rounding, 0.0)

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

    def _add_side(self, polygon: LoopPolygon, body: int, side: Array) -> None:
        """Add a side that is fixed in a body, in its axes: as a whole, its part along an axis that keeps its direction,
        or its length.
        """
        attitude = self.find_attitude(body)
        if attitude is not None:
            polygon.fixed += attitude @ side
            return
        condition = self.conditions[body]
        axis = None if condition is None else condition.to_axis if body == condition.b else condition.axis
        normal = None if axis is None else self.find_direction(body, axis)
        if axis is None or normal is None:
            polygon.add_length(_norm(side))
            return
        along = float(axis @ side)
        polygon.fixed += along * normal
        polygon.add_length(_norm(side - along * axis), normal)

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
        """Return the direction that a body's own has in all poses, world; None if it may turn."""
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
        own, outer = (condition.to_axis, condition.axis) if is_to else (condition.axis, condition.to_axis)
        for sign in (1.0, -1.0):
            if np.array_equal(direction, sign * own):
                return self.find_direction(parent, sign * outer)
        return None

    def _list_free_directions(self, joints: Sequence[JointCondition], polygon: LoopPolygon) -> list[Array] | None:
        """List the directions along which joints let points slide, world; None where they are not known. Rods are sides
        of the polygon.
        """
        directions: list[Array] = []
        for d in joints:
            if d.path is not None or d.pose.hold in ("none", "curve"):
                return None
            if d.pose.hold == "distance":
                polygon.add_length(d.length)
            elif d.pose.hold != "point":
                axis = self.find_direction(d.a, d.axis)
                if axis is None:
                    return None
                directions += [axis] if d.pose.hold == "line" else [*perpendicular_pair(axis)]
        return directions


def _is_along(normal: Array | None, direction: Array) -> bool:
    """Return whether a normal is known, and along a direction."""
    return normal is not None and abs(float(normal @ direction)) >= 1.0 - tolerances.SUM_ROUNDING


def _norm(a: Array) -> float:
    return math.sqrt(float(a @ a))
