"""What redundant joints leave open: the self-stresses of an instant and their shares in every joint.

A self-stress is a set of closure multipliers z with J' z = 0 on the tree's freedoms: internal loads that balance among
themselves and move nothing. A component that some self-stress has a share in is not a number the laws of rigid bodies
give. Moments and turns by the island's length L, which makes rows of the order of 1; those with longer levers are
shortened to that. Shorter ones stay: a row that moves no freedom, in this pose or in all, holds what the tree holds
already, and its rounding must not be made a direction. Verdicts by the instant's own null space.
One sweep of statics carries a null vector to all joints. manual/theory.md, "Redundancy".
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.response import carried, jacobian
from heuncli.multibody.tree.islands import is_couple, mean_lever
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.sharing import same


@record
class SelfStress:
    """Self-stresses at the asked instants, k of them at most (zero where an instant has fewer).

    shares (n_j, n_t, 6, k): of each joint, force and moment ON `to` about the `to` point, world axes; largest (n_t, k):
    each one's largest share, of couplings too, moments by `length`; count (n_t,): how many there are; dependent (n_t,):
    how many rows depend on others, in a planar scene also those across the plane; length [m]; least, left (n_t,): the
    smallest singular value that was kept, relative, and the largest that was not, beyond what the gap may feign.
    """

    shares: Array
    largest: Array
    count: Array
    length: float
    least: Array
    left: Array
    dependent: Array
    multipliers: Array  # (n_t, rows, k) of the closure rows
    coupled: Array  # (rows,) by which a multiplier of a coupling counts as a share: 1, of a couple 1/length; else 0

    def reaches(self, shares: Array, length: float = 1.0) -> Mask:
        """Whether a self-stress has a share in components (..., n_t, c, k) -> (..., n_t, c); moments: give `length`."""
        limit = tolerances.OPEN_SHARE * np.where(self.largest > 0.0, self.largest, np.inf)
        return np.asarray((np.abs(shares) / length > limit[:, None, :]).any(axis=-1))


@record
class StressPoses:
    """All that the self-stresses of a scene hang on at some instants: no load, and nothing that answers one.

    times (n_t,) [s], states (n_t, n), gap (n_t,) as in Recovered; closed, chosen (n_t, rows), f, m (n_t, rows, 3): of
    the closure rows; R (n_t, n_b, 3, 3), x (n_t, n_b, 3): of the bodies.
    """

    times: Array
    states: Array
    gap: Array
    closed: Array
    chosen: Array
    f: Array
    m: Array
    R: Array
    x: Array

    def point_position(self, body: int, point: Array) -> Array:
        """World position of a body's point, (n_t, 3)."""
        return self.x[:, body] + self.R[:, body] @ point if body != GROUND else np.broadcast_to(point, (len(self.x), 3))


@record
class KnownStress:
    """The self-stresses of some poses, found before."""

    poses: StressPoses
    stress: SelfStress


def stress_poses(recovered: Recovered, states: BodyStates) -> StressPoses:
    """What self-stresses hang on at recovered states."""
    rows = recovered.rows
    return StressPoses(
        recovered.times, recovered.states, recovered.gap, rows["closed"], rows["chosen"], rows["f"], rows["m"],
        states.R, states.x,
    )  # fmt: skip


def self_stress(
    runner: Evaluator, recovered: Recovered, states: BodyStates, known: KnownStress | None = None
) -> SelfStress | None:
    """All self-stresses at recovered states, island by island; None where there can be none (no closed chain).

    known: of the same scene, loaded in any way; they are taken where the poses are the same to the bit.
    """
    if not runner.layout.rows:
        return None
    poses = stress_poses(recovered, states)
    if known is not None and same(poses, known.poses):
        return known.stress
    return stress_of(runner, poses)


def stress_of(runner: Evaluator, poses: StressPoses) -> SelfStress:
    """All self-stresses of poses."""
    layout, n_t = runner.layout, len(poses.times)
    J = jacobian(runner.workspace, layout, poses.times, poses.states)
    columns: list[Array] = []
    counts = np.zeros(n_t, dtype=int)
    least, left = np.ones(n_t), np.zeros(n_t)
    for island in layout.islands:
        closed, chosen = poses.closed[:, island.rows], poses.chosen[:, island.rows]
        null, values = _null_space(J.block(island.rows, island.freedoms), island, closed, chosen)
        counts += (closed - chosen).sum(axis=1).astype(int)
        least = np.minimum(least, values.kept)
        feigned = tolerances.RANK_OF_GAP * poses.gap / island.length
        left = np.maximum(left, np.where(values.left > feigned, values.left, 0.0))
        Z = np.zeros((n_t, len(layout.rows), null.shape[2]))
        Z[:, island.rows] = null
        columns.append(Z)
    Z = np.concatenate(columns, axis=2)
    dependent = counts
    length = mean_lever(layout, range(len(layout.mechanism.joints)))
    shares = _shares(runner, poses, Z)
    coupled = shares_of_couplings(layout, length)
    size = np.array([1.0, 1.0, 1.0, length, length, length])[:, None]
    if layout.mechanism.planar:
        # what does not exist cannot be open
        shares *= np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])[:, None]
        if Z.shape[2]:
            whole = np.concatenate([*(shares / size), Z * coupled[:, None]], axis=1)
            counts = np.linalg.matrix_rank(whole, tol=tolerances.OPEN_SHARE)
    largest = (np.abs(shares).max(axis=0, initial=0.0) / size).max(axis=1)
    largest = np.maximum(largest, np.abs(Z * coupled[:, None]).max(axis=1, initial=0.0))
    largest = np.where(largest > tolerances.NO_SELF_STRESS, largest, 0.0)
    return SelfStress(shares, largest, counts, length, least, left, dependent, Z, coupled)


def shares_of_couplings(layout: Layout, length: float) -> Array:
    """By which the multiplier of each closure row counts as a share, (rows,): joints are told by their own."""
    own = np.array(layout.rows) >= len(layout.mechanism.joints)
    couples = [is_couple(layout, r) for r in range(len(layout.rows))]
    return np.where(own, np.where(couples, 1.0 / length, 1.0), 0.0)


class Values(NamedTuple):
    """Of the singular values of an island's J, relative, the least that is kept and the largest that is not, (n_t,)."""

    kept: Array
    left: Array


def _null_space(J: Array, island: Island, closed: Array, chosen: Array) -> tuple[Array, Values]:
    """Null vectors of J' on the island's rows (n_t, m, k_max), of which as many are `chosen` (n_t, m) as its rank.

    A contact that is open carries nothing: it gives way along a direction of its own, and no self-stress loads it.
    """
    L = island.length
    measure = np.where(island.couples, L, 1.0)[:, None]
    J = J * measure / np.where(island.turns, L, 1.0)
    unit = np.maximum(np.sqrt(np.sum(J * J, axis=2)), 1.0)[:, :, None]
    J, apart = J / unit, closed == 0.0
    if apart.any():
        J = np.concatenate([np.where(apart[:, :, None], 0.0, J), np.eye(len(island.rows)) * apart[:, None, :]], axis=2)
        chosen = chosen + apart
    # rows that never touch a free direction (across a flat mechanism, say) are self-stresses by themselves
    idle = np.abs(J).max(axis=(0, 2), initial=0.0) <= tolerances.NOT_QUITE
    idle &= ~chosen.any(axis=0)
    Z_rest, values = _null_of(J[:, ~idle], chosen.sum(axis=1).astype(int))
    k, alone = Z_rest.shape[2], int(idle.sum())
    Z = np.zeros((len(J), len(idle), k + alone))
    Z[:, ~idle, :k] = Z_rest
    Z[:, np.flatnonzero(idle), k + np.arange(alone)] = 1.0
    return Z / unit * measure, values


def _null_of(J: Array, rank: Indices) -> tuple[Array, Values]:
    """Null vectors of J' (n_t, m, k_max) for J (n_t, m, n), rows up to 1, of given rank (n_t,)."""
    n_t, m = J.shape[:2]
    if m == 0:
        return np.zeros((n_t, 0, 0)), Values(np.ones(n_t), np.zeros(n_t))
    S = np.linalg.svd(J, compute_uv=False)
    top = np.maximum(S.max(axis=1, initial=0.0), 1.0)
    S = np.concatenate([np.ones((n_t, 1)), S / top[:, None], np.zeros((n_t, m))], axis=1)
    kept, left = (np.take_along_axis(S, rank[:, None] + i, axis=1)[:, 0] for i in (0, 1))
    values = Values(np.asarray(kept), np.asarray(left))
    k_max = int((m - rank).max(initial=0))
    if k_max == 0:  # the vectors cost several times the values
        return np.zeros((n_t, m, 0)), values
    U, _, _ = np.linalg.svd(J, full_matrices=True)
    Z = U[:, :, m - k_max :].copy()
    for t in np.flatnonzero(m - rank < k_max):
        Z[t, :, : k_max - (m - rank[t])] = 0.0
    return Z, values


def _shares(runner: Evaluator, poses: StressPoses, Z: Array) -> Array:
    """Shares of multipliers Z (n_t, rows, k) in every joint with its drive and its stops, (n_j, n_t, 6, k).

    A joint of the tree balances what hangs on it; a cut one carries its rows; stops carry theirs beside it.
    """
    layout = runner.layout
    joints, hangs = layout.mechanism.joints, layout.spanning.hangs
    n_t, _, k = Z.shape
    shares = np.zeros((len(joints), n_t, 6, k))
    loads = carried(runner.workspace, poses.times, poses.states, Z.transpose(0, 2, 1), len(hangs))
    places = [i for i, h in enumerate(hangs) if h.joint >= 0]
    of_tree = [hangs[i].joint for i in places]
    moment_and_force = loads[:, :, places].transpose(2, 0, 3, 1)
    shares[of_tree, :, :3], shares[of_tree, :, 3:] = moment_and_force[:, :, 3:], moment_and_force[:, :, :3]
    for h in hangs:
        if h.reverse:  # the load is ON `from`, and about its point
            joint = joints[h.joint]
            arm = poses.point_position(joint.a, joint.p) - poses.point_position(joint.b, joint.q)
            force = shares[h.joint, :, :3]
            shares[h.joint, :, 3:] += np.cross(arm[:, :, None], force, axis=1)
            shares[h.joint] *= -1.0
    rows = np.array(layout.rows)
    unit = np.concatenate([poses.f, poses.m], axis=2).transpose(0, 2, 1)
    for k in dict.fromkeys(k for k in layout.rows if k < len(joints)):
        own = np.flatnonzero(rows == k)
        shares[k] += unit[:, :, own] @ Z[:, own]
    return shares
