"""The gaps of all joints at once, for any number of poses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows


class JointGaps:
    """Computes the gaps of all joints at once, for any number of poses: joints with the same constraint are stacked."""

    def __init__(self, conditions: Sequence[JointCondition], constraints: Sequence[JointConstraint]) -> None:
        self.count = len(conditions)
        self.groups = []
        for constraint in sorted(set(constraints)):
            k = [i for i in range(len(conditions)) if constraints[i] == constraint]
            columns = {
                name: np.array([getattr(conditions[i], name) for i in k])
                for name in ("a", "b", "p", "q", "axis", "to_axis", "relative", "length", "path")
            }
            self.groups.append((constraint, np.array(k), columns))

    def __call__(self, x: Array, R: Array) -> tuple[Array, Array]:
        """Return the distances [m] and angles [rad] by which the joints are open, each (..., n_joints).

        x (..., n+1, 3), R (..., n+1, 3, 3): origins and attitudes, the ground last
        """
        distance = np.zeros((*x.shape[:-2], self.count))
        angle = np.zeros_like(distance)
        for constraint, k, c in self.groups:
            Ra, Rb = R[..., c["a"], :, :], R[..., c["b"], :, :]
            D = x[..., c["b"], :] + _apply(Rb, c["q"]) - x[..., c["a"], :] - _apply(Ra, c["p"])
            if constraint.hold == "curve":
                D = D - _nearest_path_points(c["path"], Ra, D)
            distance[..., k] = _distance(constraint, D, _apply(Ra, c["axis"]), c["length"])
            angle[..., k] = _angle(constraint, Ra, Rb, c)
        return distance, angle


def _apply(R: Array, a: Array) -> Array:
    return np.asarray(np.einsum("...ij,...j->...i", R, a))


def _nearest_path_points(paths: Array, Ra: Array, D: Array) -> Array:
    """Find the point of each path that is nearest to its joint's point, world axes, (..., n, 3); paths as objects."""
    points = np.einsum("...ji,...j->...i", Ra, D)
    for i, path in enumerate(paths):
        points[..., i, :] = path.evaluate(path.find_nearest(points[..., i, :]))[0]
    return _apply(Ra, points)


def _distance(constraint: JointConstraint, D: Array, n: Array, length: Array) -> Array:
    along: Array = np.einsum("...i,...i->...", D, n)
    if constraint.hold == "plane":
        return np.abs(along)
    if constraint.hold == "none":
        return np.zeros(along.shape)
    if constraint.hold == "line":
        D = D - along[..., None] * n
    size: Array = np.sqrt(np.einsum("...i,...i->...", D, D))
    return np.abs(size - length) if constraint.hold == "distance" else size


def _angle(constraint: JointConstraint, Ra: Array, Rb: Array, c: dict[str, Array]) -> Array:
    if constraint.turn in ("free", "alike"):
        return np.zeros(Ra.shape[:-2])
    if constraint.turn == "all":
        # sin from the skew part, cos from the trace: exact near zero and near half a turn
        E = np.swapaxes(Ra, -1, -2) @ Rb @ np.swapaxes(c["relative"], -1, -2)
        skew = np.stack([E[..., 2, 1] - E[..., 1, 2], E[..., 0, 2] - E[..., 2, 0], E[..., 1, 0] - E[..., 0, 1]], -1)
        return np.asarray(np.arctan2(np.sqrt(np.sum(skew * skew, -1)), np.trace(E, axis1=-2, axis2=-1) - 1.0))
    n, m = _apply(Ra, c["axis"]), _apply(Rb, c["to_axis"])
    cos = np.einsum("...i,...i->...", n, m)
    sine = cross_rows(n, m)
    sin = np.sqrt(np.einsum("...i,...i->...", sine, sine))
    return np.asarray(np.abs(np.arctan2(cos, sin)) if constraint.turn == "square" else np.arctan2(sin, cos))


def mean_arm(mechanism: Mechanism) -> float:
    """Mean distance of the joints' points from the centres of mass of their bodies [m]; 1 where that is zero."""
    arms = [
        point - mechanism.bodies[body].center
        for j in mechanism.joints
        for body, point in ((j.a, j.p), (j.b, j.q))
        if body != GROUND
    ]
    mean = float(np.mean(np.sqrt(np.sum(np.square(arms), axis=-1)))) if arms else 0.0
    return mean if mean > 0.0 else 1.0
