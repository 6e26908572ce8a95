"""Joint rows of an island, reduced to the freedoms that the tree leaves; the smallest solution is taken.

    z = t + B y        turn and shift (by the scene's size L) of all members, from the freedoms y
    C y = e            the remaining rows: closures, and tree joints that a held body cannot follow
    z = t + Q v, A v = e   the same in as many v, |v| the length of Q v: how a row constrains motions shows its rank

Tree joints are solved outward body by body, so that dense algebra is needed only for the freedoms and the closures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, cached_property

import numpy as np

from heuncli.base.linear_algebra import count_rank, solve_with_null_space
from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.islands import AssemblyIsland
from heuncli.multibody.assembly.rows import Rows
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_matrix

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
