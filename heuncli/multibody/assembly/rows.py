"""The residual of a joint, and how the rates of its two bodies change it.

    D = P_b − P_a                     from the joint's place on `from` to the point on `to`, world [m]
    u = v_b − v_a                     velocity of `to` against `from`, both at P_b [m/s]
    F u = hold,  T (σ_b − σ_a) = turn     F (h, 3), T (k, 3) directions, world

In the axes of `from` every gap changes as F u and T (σ_b − σ_a), however large it is (manual/theory.md, "Joints as
rows"; the lever at P_b). The right sides are the residuals: minus the gap, or what is missing in the rates, or in the
accelerations. A kind of `Hold` or `Turn` (base/joint_kinds.py) says here what it constrains: directions, gap, rates and
accelerations of one joint, and the sizes of the gaps of many (JointGaps).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint, condition_on_tangent
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows, cross_vectors, inverse_jacobian, vector_from_rotation

# Rows

NO_ROWS = np.zeros((0, 3))
NO_NUMBERS = np.zeros(0)
NEARLY_OPPOSITE = -0.99  # cosine: beyond, the turn's own bend would outweigh what closes it


@record
class Rows:
    """F (h, 3), T (k, 3), the residuals hold (h,) and turn (k,), and the levers (3,) from the bodies' pivots to P_b,
    world.
    """

    F: Array
    T: Array
    hold: Array
    turn: Array
    r_a: Array
    r_b: Array


def pose_rows(d: JointCondition, x: Array, R: Array, s: Array) -> Rows:
    """Compute the rows of a joint in a pose, with minus its gaps [m], [rad]; s (n+1, 3) pivots."""
    d = condition_on_tangent(d, x, R)
    Ra, Rb = R[d.a], R[d.b]
    P = x[d.b] + Rb @ d.q
    D = P - x[d.a] - Ra @ d.p
    F = _hold_directions(d, d.pose, Ra, D)
    hold = -(F @ D)
    if d.pose.hold == "distance":
        hold = hold + d.length
    T, turn = _turn_gap(d, Ra, Rb)
    return Rows(F, T, hold, turn, P - s[d.a], P - s[d.b])


def _hold_directions(d: JointCondition, constraint: JointConstraint, Ra: Array, D: Array) -> Array:
    """F: unit rows, perpendicular to each other."""
    if constraint.hold == "point":
        return Ra.T
    if constraint.hold == "line":
        return d.normals @ Ra.T
    if constraint.hold == "plane":
        return (Ra @ d.axis)[None, :]
    if constraint.hold == "distance":
        size = math.sqrt(float(D @ D))
        return (D / size if size > 0.0 else np.array([1.0, 0.0, 0.0]))[None, :]
    return NO_ROWS


def _turn_gap(d: JointCondition, Ra: Array, Rb: Array) -> tuple[Array, Array]:
    """Compute T and minus the gap: the vector of the smallest missing rotation, so that opposite axes are far from
    closed.
    """
    if d.pose.turn == "all":
        phi = vector_from_rotation(Ra.T @ Rb @ d.relative.T)
        return inverse_jacobian(phi) @ Ra.T, -phi
    if d.pose.turn == "axis":
        return _axis_gap(d, Ra, Rb)
    if d.pose.turn == "square":
        n, m = Ra @ d.axis, Rb @ d.to_axis
        return cross_vectors(m, n)[None, :], np.array([-(n @ m)])
    return NO_ROWS, NO_NUMBERS


def _axis_gap(d: JointCondition, Ra: Array, Rb: Array) -> tuple[Array, Array]:
    """Compute T and minus the gap of two axes that must agree, in the two directions across.

    The gap is the turn t = φ m from the axis of `from` to that of `to`.
    """
    E = d.normals @ Ra.T
    n, n_b = Ra @ d.axis, Rb @ d.to_axis
    m = cross_vectors(n, n_b)
    sin, cos = math.sqrt(float(m @ m)), float(n @ n_b)
    if sin < tolerances.PARALLEL:
        if cos > 0.0:
            return E, -(E @ m)
        m, sin = E[0], tolerances.PARALLEL  # exactly opposite: any direction will do
    else:
        m = m / sin
    phi = math.atan2(sin, cos)
    k = cross_vectors(m, n)
    T = np.outer(m, m) + np.outer(k, phi * (cos / sin * k - n)) if cos > NEARLY_OPPOSITE else np.outer(m, m)
    return E @ T, -phi * (E @ m)


def _turn_directions(d: JointCondition, Ra: Array, Rb: Array) -> Array:
    """Compute T of the rates, in a closed pose: unit rows, perpendicular to each other.

    A constant-velocity joint allows relative rotation only about lines in the plane that bisects its two axes.
    """
    if d.rate.turn == "all":
        return Ra.T
    if d.rate.turn == "axis":
        return d.normals @ Ra.T
    if d.rate.turn == "square":
        m = cross_vectors(Rb @ d.to_axis, Ra @ d.axis)
        return (m / math.sqrt(float(m @ m)))[None, :]
    if d.rate.turn == "alike":
        m = Ra @ d.axis + Rb @ d.to_axis
        return (m / math.sqrt(float(m @ m)))[None, :]
    return NO_ROWS


def rate_rows(d: JointCondition, x: Array, R: Array, s: Array) -> Rows:
    """Compute the rows of a joint on the rates [m/s], [rad/s], in a closed pose; the right sides hold for rest."""
    d = condition_on_tangent(d, x, R)
    Ra, Rb = R[d.a], R[d.b]
    P = x[d.b] + Rb @ d.q
    F, T = _hold_directions(d, d.rate, Ra, P - x[d.a] - Ra @ d.p), _turn_directions(d, Ra, Rb)
    return Rows(F, T, *_prescribed_rates(d, F, T, 0), P - s[d.a], P - s[d.b])


def _prescribed_rates(d: JointCondition, F: Array, T: Array, order: int) -> tuple[Array, Array]:
    """Return the prescribed rates (order 0) or accelerations (order 1) along the rows."""
    hold, turn = np.zeros(len(F)), np.zeros(len(T))
    if d.rate.hold == "point":
        hold = d.slip[order] * d.axis
    elif d.rate.hold == "distance":
        hold[0] = d.stretch[order]
    if d.rate.turn == "all":
        turn = d.spin[order] * d.axis
    return hold, turn


def rate_residuals(d: JointCondition, row: Rows, v: Array, w: Array) -> tuple[Array, Array]:
    """Residuals of the rates: hold − F u [m/s] and turn − T (σ_b − σ_a) [rad/s]; v, w (n+1, 3) of the pivots."""
    hold, turn = row.hold, row.turn
    if len(row.F):
        hold = hold - row.F @ (v[d.b] + cross_vectors(w[d.b], row.r_b) - v[d.a] - cross_vectors(w[d.a], row.r_a))
    if len(row.T):
        turn = turn - row.T @ (w[d.b] - w[d.a])
    return hold, turn


def acceleration_rows(d: JointCondition, row: Rows, x: Array, R: Array, v: Array, w: Array) -> Rows:
    """Compute the rows of a joint on the accelerations: −γ − g̈_t [m/s2], [rad/s2], from its rate rows and rates that
    fit them.
    """
    d = condition_on_tangent(d, x, R)
    wa, wb = w[d.a], w[d.b]
    u = v[d.b] + cross_vectors(wb, row.r_b) - v[d.a] - cross_vectors(wa, row.r_a)
    hold, turn = _prescribed_rates(d, row.F, row.T, 1)
    if len(row.F):
        centripetal = cross_vectors(wb, cross_vectors(wb, row.r_b)) - cross_vectors(wa, cross_vectors(wa, row.r_a))
        hold = hold - row.F @ (centripetal - 2.0 * cross_vectors(wa, u))
        hold = hold + (row.F @ (R[d.a] @ d.bend)) * float(d.axis @ R[d.a].T @ u) ** 2
    if d.rate.hold == "distance":  # the part of u across the rod turns it
        D = x[d.b] + R[d.b] @ d.q - x[d.a] - R[d.a] @ d.p
        hold = hold - (u @ u - (row.F[0] @ u) ** 2) / (row.F[0] @ D)
    if d.rate.turn == "square":
        n, m = R[d.a] @ d.axis, R[d.b] @ d.to_axis
        turn = turn - (wb - wa) @ (cross_vectors(cross_vectors(wb, m), n) + cross_vectors(m, cross_vectors(wa, n)))
    elif d.rate.turn == "alike":
        n, m = R[d.a] @ d.axis, R[d.b] @ d.to_axis
        turn = turn - (wb - wa) @ (cross_vectors(wa, n) + cross_vectors(wb, m)) / math.sqrt(float((n + m) @ (n + m)))
    elif len(row.T):
        turn = turn + row.T @ cross_vectors(wa, wb)
    return Rows(row.F, row.T, hold, turn, row.r_a, row.r_b)


# Gaps


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
