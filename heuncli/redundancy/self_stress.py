"""What redundant joints leave open: the self-stresses of an instant and their shares in every joint.

A self-stress is a set of closure multipliers z with J' z = 0 on the tree's freedoms: internal loads that balance among
themselves and move nothing. A component that some self-stress has a share in is not a number the laws of rigid bodies
give. Moments and turns by the island's length L, which makes rows of the order of 1; those with longer levers are
shortened to that. Shorter ones stay: a row that moves no freedom, in this pose or in all, holds what the tree holds
already, and its rounding must not be made a direction. Verdicts by the instant's own null space.
design: closure Jacobian on tree coordinates, SVD, one statics sweep a null vector.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.kernel.choose import scene as kernel
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.closure_wrenches import closure_wrenches
from heuncli.mechanism.model import GROUND
from heuncli.records import record
from heuncli.results import Array, Mask
from heuncli.tree.layout import Layout
from heuncli.tree.tables import vectors


@record
class SelfStress:
    """Self-stresses at the asked instants, k of them at most (zero where an instant has fewer).

    shares: for each joint (n_t, 6, k), force and moment ON `to` about the `to` point, world axes; largest (n_t, k):
    each one's largest share, moments by `length`; count (n_t,): how many there are; dependent (n_t,): how many rows
    depend on others, in a planar scene also those across the plane; length [m]; least (n_t,): the smallest singular
    value that was kept, relative.
    """

    shares: tuple[Array, ...]
    largest: Array
    count: Array
    length: float
    least: Array
    dependent: Array

    def reaches(self, shares: Array, length: float = 1.0) -> Mask:
        """Whether a self-stress has a share in components (..., n_t, c, k) -> (..., n_t, c); moments: give `length`."""
        limit = tolerances.OPEN_SHARE * np.where(self.largest > 0.0, self.largest, np.inf)
        return np.asarray((np.abs(shares) / length > limit[:, None, :]).any(axis=-1))


def self_stress(layout: Layout, states: BodyStates, gap: Array) -> SelfStress | None:
    """All self-stresses, island by island; None where there can be none (no closed chain)."""
    if not layout.rows:
        return None
    n_t = len(states.x)
    wrenches = _row_wrenches(layout, states)
    sides = _sides(layout)
    columns: list[Array] = []
    counts = np.zeros(n_t, dtype=int)
    least = np.ones(n_t)
    length = _length(layout, range(len(layout.mechanism.joints)))
    for rows in islands(layout):
        L = _length(layout, {layout.rows[r] for r in rows})
        Z, count, smallest = _null_space(layout, states, wrenches, rows, L, gap)
        counts += count
        least = np.minimum(least, smallest)
        spread = np.zeros((n_t, len(layout.rows), Z.shape[2]))
        spread[:, rows] = Z
        columns.append(spread)
    Z = np.concatenate(columns, axis=2)
    dependent = counts
    shares = _statics(layout, states, wrenches, sides, Z)
    if layout.mechanism.planar:
        # what does not exist cannot be open
        shares = tuple(s * np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])[:, None] for s in shares)
        size = np.array([1.0, 1.0, 1.0, length, length, length])[:, None]
        stacked = np.concatenate([s / size for s in shares], axis=1)
        counts = np.linalg.matrix_rank(stacked, tol=tolerances.OPEN_SHARE) if stacked.shape[2] else counts
    parts = [np.abs(s[:, :3]).max(axis=1, initial=0.0) for s in shares]
    parts += [np.abs(s[:, 3:]).max(axis=1, initial=0.0) / length for s in shares]
    largest = np.max(parts, axis=0)
    largest = np.where(largest > tolerances.NO_SELF_STRESS, largest, 0.0)
    return SelfStress(shares, largest, counts, length, least, dependent)


def _length(layout: Layout, joints: Sequence[int] | range | set[int]) -> float:
    """Mean distance of the joints' points from the centres of their bodies [m]."""
    bodies = layout.mechanism.bodies
    of = [layout.mechanism.joints[k] for k in joints]
    arms = [p - bodies[b].center for j in of for b, p in ((j.a, j.p), (j.b, j.q)) if b != GROUND]
    mean = float(np.mean([np.sqrt(a @ a) for a in arms])) if arms else 0.0
    return mean or layout.size


def path(layout: Layout, place: int) -> list[int]:
    """Sweep places from a body to the root; empty for the ground."""
    found = []
    while place >= 0:
        found.append(place)
        place = int(layout.bodies["parent"][place])
    return found


def _sides(layout: Layout) -> list[tuple[set[int], set[int]]]:
    """Of each row the bodies (sweep places) that carry its b side to the ground, and its a side, less common ones."""
    found = []
    for k in layout.rows:
        joint = layout.mechanism.joints[k]
        b, a = (set(path(layout, layout.place[x])) if x != GROUND else set() for x in (joint.b, joint.a))
        found.append((b - a, a - b))
    return found


def islands(layout: Layout) -> list[list[int]]:
    """Rows whose loops share a body, together."""
    sides = _sides(layout)
    owner: dict[int, int] = {}
    group = list(range(len(layout.rows)))

    def root(r: int) -> int:
        while group[r] != r:
            group[r] = group[group[r]]
            r = group[r]
        return r

    first: dict[int, int] = {}
    for r, (b, a) in enumerate(sides):
        for other in (owner.get(i) for i in b | a):
            if other is not None:
                group[root(r)] = root(other)
        for i in b | a:
            owner.setdefault(i, r)
        same = first.setdefault(layout.rows[r], r)
        group[root(r)] = root(same)
    found: dict[int, list[int]] = {}
    for r in range(len(layout.rows)):
        found.setdefault(root(r), []).append(r)
    return list(found.values())


def _row_wrenches(layout: Layout, states: BodyStates) -> Array:
    """Of each row, what lambda = 1 puts on b: force, moment about the world's origin, (n_t, m, 6)."""
    force, moment = closure_wrenches(layout, states, np.ones((len(states.x), len(layout.rows))))
    joints = [layout.mechanism.joints[k] for k in layout.rows]
    Q = np.stack([states.place(joint.b, joint.q) for joint in joints], axis=1)
    return np.concatenate([force, moment + np.cross(Q, force)], axis=2)


def _free_directions(layout: Layout, states: BodyStates, place: int) -> list[tuple[str, Array]]:
    """Directions that the joint of a body leaves free, ("turn" | "shift", (n_t, 3)); driven ones are not free."""
    h, body = layout.spanning.hangs[place], layout.bodies[place]
    found: list[tuple[str, Array]] = []
    if body["ball"]:
        found += [("turn", np.broadcast_to(e, states.x[:, 0].shape)) for e in np.eye(3)]
    for freedom in layout.tables["freedoms"][body["first_freedom"] : body["end_freedom"]]:
        if freedom["driven"]:
            continue
        owner = h.body if freedom["kind"] == kernel.TURN_IN_BODY else h.parent
        what = "shift" if freedom["kind"] == kernel.SHIFT else "turn"
        found.append((what, states.direction(owner, vectors(freedom["direction"]))))
    return found


def _null_space(
    layout: Layout, states: BodyStates, wrenches: Array, rows: list[int], L: float, gap: Array
) -> tuple[Array, Array, Array]:
    """Null vectors of J' on the island's rows (n_t, m, k_max), how many (n_t,), smallest kept singular value (n_t,)."""
    n_t, m = len(states.x), len(rows)
    sides = _sides(layout)
    members = sorted({i for r in rows for side in sides[r] for i in side})
    columns: list[Array] = []
    own = wrenches[:, rows]
    for i in members:
        h = layout.spanning.hangs[i]
        sign = np.array([1.0 if i in sides[r][0] else -1.0 if i in sides[r][1] else 0.0 for r in rows])
        on = np.flatnonzero(sign)
        r_i = states.place(h.body, layout.reference[i])
        for what, e in _free_directions(layout, states, i):
            parts = [e, np.zeros_like(e)] if what == "shift" else [np.cross(r_i, e), e]
            twist = np.concatenate(parts, axis=1)
            # v = e x (x - r) of a turn about a line through r: at the origin r x e
            column = np.zeros((n_t, m))
            column[:, on] = (own[:, on] @ twist[:, :, None])[:, :, 0] * (sign[on] / (1.0 if what == "shift" else L))
            columns.append(column)
    J = np.stack(columns, axis=2) if columns else np.zeros((n_t, m, 0))
    is_couple = np.abs(own[:, :, :3]).max(axis=2, initial=0.0) == 0.0
    J = J * np.where(is_couple, L, 1.0)[:, :, None]
    unit = np.maximum(np.sqrt(np.sum(J * J, axis=2)), 1.0)[:, :, None]
    J = J / unit
    # rows that never touch a free direction (across a flat mechanism, say) are self-stresses by themselves
    idle = np.abs(J).max(axis=(0, 2), initial=0.0) <= tolerances.RANK
    Z_rest, open_rest, kept = _null_of(J[:, ~idle], gap / L)
    k = Z_rest.shape[2]
    Z = np.zeros((n_t, m, k + int(idle.sum())))
    Z[:, ~idle, :k] = Z_rest
    Z[:, np.flatnonzero(idle), k + np.arange(int(idle.sum()))] = 1.0
    return Z / unit * np.where(is_couple, L, 1.0)[:, :, None], open_rest + int(idle.sum()), kept


def _null_of(J: Array, gap: Array) -> tuple[Array, Array, Array]:
    """Null vectors of J' (n_t, m, k_max) for J (n_t, m, n), rows up to 1; how many; least kept singular value."""
    n_t, m = J.shape[:2]
    if m == 0:
        return np.zeros((n_t, 0, 0)), np.zeros(n_t, dtype=int), np.ones(n_t)
    U, S, _ = np.linalg.svd(J, full_matrices=True)
    if S.shape[1] < m:
        S = np.concatenate([S, np.zeros((n_t, m - S.shape[1]))], axis=1)
    top = np.maximum(S.max(axis=1, initial=0.0), 1.0)
    limit = np.maximum(tolerances.RANK, tolerances.RANK_OF_GAP * gap) * top
    rank = np.sum(S > limit[:, None], axis=1)
    k_max = int((m - rank).max(initial=0))
    last = np.take_along_axis(S, np.maximum(rank - 1, 0)[:, None], axis=1)[:, 0]
    kept = np.where(rank > 0, last / top, 1.0)
    Z = U[:, :, m - k_max :].copy() if k_max else np.zeros((n_t, m, 0))
    for t in np.flatnonzero(m - rank < k_max):
        Z[t, :, : k_max - (m - rank[t])] = 0.0
    return Z, m - rank, kept


def _statics(
    layout: Layout, states: BodyStates, wrenches: Array, sides: list[tuple[set[int], set[int]]], Z: Array
) -> tuple[Array, ...]:
    """Shares of the null vectors in every joint, (n_t, 6, k) each: a joint of the tree balances what hangs on it."""
    hang_of = {h.joint: (i, h) for i, h in enumerate(layout.spanning.hangs) if h.joint >= 0}
    found = []
    for k, joint in enumerate(layout.mechanism.joints):
        if k in hang_of:
            i, h = hang_of[k]
            sign = np.array([1.0 if i in b else -1.0 if i in a else 0.0 for b, a in sides])
            on = np.flatnonzero(sign)
            total = -(wrenches[:, on] * sign[on, None]).transpose(0, 2, 1) @ Z[:, on]
            total = -total if h.reverse else total
        else:
            own = [r for r, owner in enumerate(layout.rows) if owner == k]
            total = wrenches[:, own].transpose(0, 2, 1) @ Z[:, own]
        Q = states.place(joint.b, joint.q)
        force, moment = total[:, :3], total[:, 3:]
        found.append(np.concatenate([force, moment - np.cross(Q[:, :, None], force, axis=1)], axis=1))
    return tuple(found)
