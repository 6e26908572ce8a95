"""The residual of a joint, and how the rates of its two bodies change it.

    D = P_b − P_a                     from the joint's place on `from` to the point on `to`, world [m]
    u = v_b − v_a                     velocity of `to` against `from`, both at P_b [m/s]
    F u = hold,  T (σ_b − σ_a) = turn     F (h, 3), T (k, 3) directions, world

In the axes of `from` every gap changes as F u and T (σ_b − σ_a), however large it is (manual/theory.md, "Joints as
rows"; the lever at P_b). The right sides are the residuals: minus the gap, or what is missing in the rates, or in the
accelerations.

The rows of an island's joints are reduced to the freedoms that the tree leaves; the smallest solution is taken:

    z = t + B y        turn and shift (by the scene's size L) of all members, from the freedoms y
    C y = e            the remaining rows: closures, and tree joints that a held body cannot follow
    z = t + Q v, A v = e   the same in as many v, |v| the length of Q v: how a row constrains motions shows its rank

Tree joints are solved outward body by body, so that dense algebra is needed only for the freedoms and the closures.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache, cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import count_rank, solve_with_null_space
from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint, condition_on_tangent
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_matrix, cross_vectors, inverse_jacobian, vector_from_rotation

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


# Row reduction

MemberFreedoms = Sequence[tuple[bool, bool]]  # whether each member may turn, and shift


@record
class MemberStep:
    """How a body of the loop moves with its parent: z = offset + transfer z_parent + N y_here.

    parent: index of the parent, -1 for none
    rest (r, 6): rows on z_parent that the member cannot follow because it is held
    lack (r,): their right side
    """

    own: Array
    follow: Array
    N: Array
    parent: int
    rest: Array
    lack: Array


class ReducedIsland:
    """An island's rows in its freedoms. Bodies that are no members stay."""

    def __init__(
        self,
        island: AssemblyIsland,
        conditions: Sequence[JointCondition],
        rows: Mapping[int, Rows],
        free: MemberFreedoms,
        size: float,
    ) -> None:
        place = {body: i for i, body in enumerate(island.members)}
        self.free = free
        self.steps = [
            _member_step(body, conditions[k], rows[k], place, free[i], size) if k >= 0 else _root_step(free[i])
            for i, (body, k) in enumerate(zip(island.members, island.tree_joints, strict=True))
        ]
        self.starts = np.cumsum([0, *(step.N.shape[1] for step in self.steps)]).tolist()
        pieces = [self._pull_back([(step.parent, step.rest)], step.lack) for step in self.steps if len(step.lack)]
        for k in island.closures:
            d = conditions[k]
            J_a, J_b, c = _row_blocks(rows[k], size)
            pieces.append(self._pull_back([(place.get(d.a, -1), J_a), (place.get(d.b, -1), J_b)], c))
        self.C = np.concatenate([C for C, _ in pieces] or [np.zeros((0, self.count))])
        self.e = np.concatenate([e for _, e in pieces] or [np.zeros(0)])

    @property
    def count(self) -> int:
        """The number of freedoms."""
        return int(self.starts[-1])

    def _pull_back(self, terms: Sequence[tuple[int, Array]], c: Array) -> tuple[Array, Array]:
        """Transform rows on the members' z into rows on y, with their right side."""
        C, e = np.zeros((len(c), self.count)), c.copy()
        pending: dict[int, Array] = {}
        for i, J in terms:
            if i >= 0:
                pending[i] = pending[i] + J if i in pending else J
        while pending:
            i = max(pending)
            J, step = pending.pop(i), self.steps[i]
            C[:, self.starts[i] : self.starts[i + 1]] = J @ step.N
            e -= J @ step.own
            if step.parent >= 0:
                before = J @ step.follow
                pending[step.parent] = pending[step.parent] + before if step.parent in pending else before
        return C, e

    @cached_property
    def B(self) -> Array:
        """B of z = t + B y, (6m, n)."""
        B = np.zeros((6 * len(self.steps), self.count))
        for i, step in enumerate(self.steps):
            start, end = self.starts[i], self.starts[i + 1]
            B[6 * i : 6 * i + 6, start:end] = step.N
            if step.parent >= 0:
                B[6 * i : 6 * i + 6, :start] = step.follow @ B[6 * step.parent : 6 * step.parent + 6, :start]
        return B

    @cached_property
    def t(self) -> Array:
        """t of z = t + B y, (6m,)."""
        t = np.zeros(6 * len(self.steps))
        for i, step in enumerate(self.steps):
            t[6 * i : 6 * i + 6] = step.own
            if step.parent >= 0:
                t[6 * i : 6 * i + 6] += step.follow @ t[6 * step.parent : 6 * step.parent + 6]
        return t

    def orthonormalize(self, shift: float = 1.0) -> tuple[Array, Array]:
        """Compute Q (6m, n) and A (h, n); a shift counts `shift` times a turn."""
        weight = np.array([1.0, 1.0, 1.0, shift, shift, shift] * len(self.steps))[:, None]
        Q, R = np.linalg.qr(weight * self.B)
        return Q / weight, np.linalg.solve(R.T, self.C.T).T


def _row_blocks(row: Rows, size: float) -> tuple[Array, Array, Array]:
    """Build the rows on (turn, shift/L) of `from` and of `to`, (h+k, 6) each, and the right side, lengths by L."""
    h, k = len(row.F), len(row.T)
    J_a, J_b = np.zeros((h + k, 6)), np.zeros((h + k, 6))
    if h:
        J_b[:h, :3], J_b[:h, 3:] = -(row.F @ cross_matrix(row.r_b)) / size, row.F
        J_a[:h, :3], J_a[:h, 3:] = (row.F @ cross_matrix(row.r_a)) / size, -row.F
    J_b[h:, :3], J_a[h:, :3] = row.T, -row.T
    return J_a, J_b, np.concatenate([row.hold / size, row.turn])


def _member_step(
    body: int, d: JointCondition, row: Rows, place: Mapping[int, int], freedoms: tuple[bool, bool], size: float
) -> MemberStep:
    J_a, J_b, c = _row_blocks(row, size)
    J, J_parent, parent = (J_b, J_a, d.a) if body == d.b else (J_a, J_b, d.b)
    E = _root_step(freedoms).N
    U, S, V = np.linalg.svd(J @ E)
    rank = count_rank(S)
    inverse = E @ ((V[:rank].T / S[:rank]) @ U[:, :rank].T)
    rest = U[:, rank:].T
    return MemberStep(
        inverse @ c, -(inverse @ J_parent), E @ V[rank:].T, place.get(parent, -1), rest @ J_parent, rest @ c
    )  # fmt: skip


@cache
def _root_step(freedoms: tuple[bool, bool]) -> MemberStep:
    N = np.eye(6)[:, np.repeat(np.array(freedoms), 3)]
    return MemberStep(np.zeros(6), np.zeros((6, 6)), N, -1, np.zeros((0, 6)), np.zeros(0))


def least_motion(r: ReducedIsland, displacements: Array, shift_weight: float = 0.0) -> tuple[Array, Array]:
    """Find z (6m,) with C y = e and least Σ(turns)², then least Σ(shifts)², of z + displacements; and the residual of C
    y = e.

    shift_weight: both in one least sum, in which a shift counts so many times a turn

    Only motions that are free count.
    """
    Q, A = r.orthonormalize()
    v, N, lack = solve_with_null_space(A, r.e)
    is_free = np.repeat(np.array(r.free, dtype=bool).reshape(-1, 2), 3, axis=1).ravel()
    turns = np.arange(is_free.size) % 6 < 3
    weight = np.where(turns, 1.0, shift_weight or 1.0)
    for mask in (is_free,) if shift_weight else (is_free & turns, is_free & ~turns):
        W = weight[mask, None] * Q[mask]
        step, null, _ = solve_with_null_space(W @ N, -(weight * (r.t + displacements))[mask] - W @ v)
        v = v + N @ step
        N = N @ null
    return r.t + Q @ v, lack
