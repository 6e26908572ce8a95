"""Find what redundant joints leave indeterminate: the self-stresses of an instant and their shares in every joint.

A self-stress is a set of closure multipliers z with J' z = 0 on the tree's freedoms: internal loads that balance among
themselves and move nothing. A component in which some self-stress has a share is not determined by the laws of rigid
bodies. Moments and rotations are scaled by the island's length L, which makes rows of the order of 1; those with longer
levers are normalised to that. Shorter ones stay: a row that moves no freedom, in this pose or in all, holds what the
tree holds already, and its rounding must not become a direction. The verdict uses the instant's own null space.

One sweep of statics propagates a null vector to all joints. manual/theory.md, "Redundancy". Neighbouring poses,
displaced along admissible rates, show whether something is a rule or a coincidence of one pose.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.response import jacobian, multiplier_joint_loads
from heuncli.multibody.tree.islands import find_couples, mean_lever
from heuncli.multibody.tree.layout import Island, Layout
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.sharing import is_same
from heuncli.scene.shapes.rotations import quaternion_product

# Self stress


@record
class SelfStress:
    """The self-stresses at the requested instants, at most k of them (zero where an instant has fewer).

    shares (n_j, n_t, 6, k): for each joint, force and moment ON `to` about the `to` point, world axes
    largest (n_t, k): the largest share of each, in couplings too, moments divided by `length`
    count (n_t,): number of self-stresses
    length [m]: divisor of moments
    margins: how clear the rank is; None where no row depends on others and it was not needed (`find_margins`)
    dependent (n_t,): number of rows that depend on others, in a planar scene including those across the plane
    multipliers (n_t, rows, k): of the closure rows
    coupling_scale (rows,): weight of a coupling's multiplier as a share: 1, for a couple 1/length; 0 for joints
    """

    shares: Array
    largest: Array
    count: Array
    length: float
    margins: RankMargins | None
    dependent: Array
    multipliers: Array
    coupling_scale: Array

    def has_share(self, shares: Array, length: float = 1.0) -> Mask:
        """Return whether a self-stress has a share in components (..., n_t, c, k) -> (..., n_t, c); for moments give
        `length`.
        """
        limit = tolerances.OPEN_SHARE * np.where(self.largest > 0.0, self.largest, np.inf)
        return np.asarray((np.abs(shares) / length > limit[:, None, :]).any(axis=-1))


class RankMargins(NamedTuple):
    """The smallest relative singular value of J that counts towards the rank, and the largest that does not, (n_t,)."""

    smallest_kept: Array
    largest_dropped: Array


@record
class SelfStressPoses:
    """All data that the self-stresses of a scene depend on at some instants; loads and their effects are not among
    them.

    times (n_t,) [s], states (n_t, n) with all rates zero, gap (n_t,): as in Evaluation
    is_active, is_independent (n_t, rows), f, m (n_t, rows, 3): of the closure rows
    R (n_t, n_b, 3, 3), x (n_t, n_b, 3): of the bodies
    """

    times: Array
    states: Array
    gap: Array
    is_active: Array
    is_independent: Array
    f: Array
    m: Array
    R: Array
    x: Array

    def point_position(self, body: int, point: Array) -> Array:
        """Return the world position of a body's point, (n_t, 3)."""
        return self.x[:, body] + self.R[:, body] @ point if body != GROUND else np.broadcast_to(point, (len(self.x), 3))


@record
class CachedStress:
    """The self-stresses of some poses, computed before."""

    poses: SelfStressPoses
    stress: SelfStress


def make_stress_poses(layout: Layout, evaluation: Evaluation, states: BodyStates) -> SelfStressPoses:
    """Collect what self-stresses depend on at evaluated states."""
    rows, at_rest = evaluation.rows, stop_motion(layout, evaluation.states)
    return SelfStressPoses(
        times=evaluation.times, states=at_rest, gap=evaluation.gap, is_active=rows["closed"],
        is_independent=rows["chosen"], f=rows["f"], m=rows["m"], R=states.R, x=states.x,
    )  # fmt: skip


def find_self_stress(
    runner: Evaluator, evaluation: Evaluation, states: BodyStates, cached_stress: CachedStress | None = None
) -> SelfStress | None:
    """Find all self-stresses at evaluated states, island by island; None where there can be none (no closed chain).

    Where the kernel finds all rows independent, there are none, and no singular values are computed.

    cached_stress: of the same scene, with any loads; it is used where the poses are equal to the bit
    """
    if not runner.layout.rows:
        return None
    poses = make_stress_poses(runner.layout, evaluation, states)
    if cached_stress is not None and is_same(poses, cached_stress.poses):
        return cached_stress.stress
    if not (poses.is_active - poses.is_independent).any():
        return make_no_stress(runner.layout, len(poses.times))
    return find_stress_of_poses(runner, poses)


def make_no_stress(layout: Layout, n_t: int) -> SelfStress:
    """Make the self-stresses of instants that have none."""
    length = mean_lever(layout, range(len(layout.mechanism.joints)))
    shares, multipliers = np.zeros((len(layout.mechanism.joints), n_t, 6, 0)), np.zeros((n_t, len(layout.rows), 0))
    none = np.zeros(n_t, dtype=int)
    scale = find_coupling_scale(layout, length)
    return SelfStress(shares, np.zeros((n_t, 0)), none, length, None, none, multipliers, scale)


def find_stress_of_poses(runner: Evaluator, poses: SelfStressPoses) -> SelfStress:
    """Find all self-stresses of poses."""
    layout = runner.layout
    Z, margins = find_null_vectors(runner, poses)
    dependent = counts = (poses.is_active - poses.is_independent).sum(axis=1).astype(int)
    length = mean_lever(layout, range(len(layout.mechanism.joints)))
    shares = _find_shares(runner, poses, Z)
    coupling_scale = find_coupling_scale(layout, length)
    size = np.array([1.0, 1.0, 1.0, length, length, length])[:, None]
    if layout.mechanism.planar:
        # components that do not exist cannot be indeterminate
        shares *= np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])[:, None]
        if Z.shape[2]:
            all_shares = np.concatenate([*(shares / size), Z * coupling_scale[:, None]], axis=1)
            counts = np.linalg.matrix_rank(all_shares, tol=tolerances.OPEN_SHARE)
    largest = (np.abs(shares).max(axis=0, initial=0.0) / size).max(axis=1)
    largest = np.maximum(largest, np.abs(Z * coupling_scale[:, None]).max(axis=1, initial=0.0))
    largest = np.where(largest > tolerances.NO_SELF_STRESS, largest, 0.0)
    return SelfStress(shares, largest, counts, length, margins, dependent, Z, coupling_scale)


def find_margins(runner: Evaluator, evaluation: Evaluation, states: BodyStates) -> RankMargins:
    """Find how clear the rank of the closures is at evaluated states."""
    return find_null_vectors(runner, make_stress_poses(runner.layout, evaluation, states))[1]


def find_null_vectors(runner: Evaluator, poses: SelfStressPoses) -> tuple[Array, RankMargins]:
    """Find the null vectors of J' at poses, island by island, (n_t, rows, k), and the margins of its rank.

    What the closure gap may simulate does not count as dropped.
    """
    layout, n_t = runner.layout, len(poses.times)
    J = jacobian(runner.workspace, layout, poses.times, poses.states)
    columns: list[Array] = []
    smallest_kept, largest_dropped = np.ones(n_t), np.zeros(n_t)
    for island in layout.islands:
        is_active, is_independent = poses.is_active[:, island.rows], poses.is_independent[:, island.rows]
        null, margins = _null_space(J.block(island.rows, island.freedoms), island, is_active, is_independent)
        smallest_kept = np.minimum(smallest_kept, margins.smallest_kept)
        simulated = tolerances.RANK_OF_GAP * poses.gap / island.length
        largest_dropped = np.maximum(
            largest_dropped, np.where(margins.largest_dropped > simulated, margins.largest_dropped, 0.0)
        )
        Z = np.zeros((n_t, len(layout.rows), null.shape[2]))
        Z[:, island.rows] = null
        columns.append(Z)
    return np.concatenate(columns, axis=2), RankMargins(smallest_kept, largest_dropped)


def find_coupling_scale(layout: Layout, length: float) -> Array:
    """Return the factor with which the multiplier of each closure row counts as a share, (rows,); 0 for joints, which
    have shares.
    """
    is_coupling = np.array(layout.rows) >= len(layout.mechanism.joints)
    return np.where(is_coupling, np.where(find_couples(layout), 1.0 / length, 1.0), 0.0)


def _null_space(J: Array, island: Island, is_active: Array, is_independent: Array) -> tuple[Array, RankMargins]:
    """Return null vectors of J' on the island's rows (n_t, m, k_max); is_independent (n_t, m) marks as many rows as its
    rank.

    An open contact carries nothing: it gets a direction of its own to yield along, and no self-stress loads it.
    """
    L = island.length
    measure = np.where(island.couples, L, 1.0)[:, None]
    J = J * measure / np.where(island.turns, L, 1.0)
    unit = np.maximum(np.sqrt(np.sum(J * J, axis=2)), 1.0)[:, :, None]
    J, is_open = J / unit, is_active == 0.0
    if is_open.any():
        J = np.concatenate(
            [np.where(is_open[:, :, None], 0.0, J), np.eye(len(island.rows)) * is_open[:, None, :]], axis=2
        )
        is_independent = is_independent + is_open
    # rows that never touch a free direction (across a flat mechanism, say) are self-stresses by themselves
    is_untouched = np.abs(J).max(axis=(0, 2), initial=0.0) <= tolerances.NEARLY_DEPENDENT
    is_untouched &= ~is_independent.any(axis=0)
    Z_rest, values = _find_null_vectors(J[:, ~is_untouched], is_independent.sum(axis=1).astype(int))
    k, untouched_count = Z_rest.shape[2], int(is_untouched.sum())
    Z = np.zeros((len(J), len(is_untouched), k + untouched_count))
    Z[:, ~is_untouched, :k] = Z_rest
    Z[:, np.flatnonzero(is_untouched), k + np.arange(untouched_count)] = 1.0
    return Z / unit * measure, values


def _find_null_vectors(J: Array, rank: Indices) -> tuple[Array, RankMargins]:
    """Return null vectors of J' (n_t, m, k_max) for J (n_t, m, n), rows up to 1, of given rank (n_t,)."""
    n_t, m = J.shape[:2]
    if m == 0:
        return np.zeros((n_t, 0, 0)), RankMargins(np.ones(n_t), np.zeros(n_t))
    S = np.linalg.svd(J, compute_uv=False)
    top = np.maximum(S.max(axis=1, initial=0.0), 1.0)
    S = np.concatenate([np.ones((n_t, 1)), S / top[:, None], np.zeros((n_t, m))], axis=1)
    smallest_kept, largest_dropped = (np.take_along_axis(S, rank[:, None] + i, axis=1)[:, 0] for i in (0, 1))
    values = RankMargins(np.asarray(smallest_kept), np.asarray(largest_dropped))
    k_max = int((m - rank).max(initial=0))
    if k_max == 0:  # the vectors cost several times the values
        return np.zeros((n_t, m, 0)), values
    U, _, _ = np.linalg.svd(J, full_matrices=True)
    Z = U[:, :, m - k_max :].copy()
    for t in np.flatnonzero(m - rank < k_max):
        Z[t, :, : k_max - (m - rank[t])] = 0.0
    return Z, values


def _find_shares(runner: Evaluator, poses: SelfStressPoses, Z: Array) -> Array:
    """Return the shares of multipliers Z (n_t, rows, k) in every joint with its drive and its stops, (n_j, n_t, 6, k).

    A joint of the tree balances the bodies beyond it; a cut one carries its rows; stops carry theirs in addition.
    """
    layout = runner.layout
    joints, links = layout.mechanism.joints, layout.spanning.links
    n_t, _, k = Z.shape
    shares = np.zeros((len(joints), n_t, 6, k))
    loads = multiplier_joint_loads(runner.workspace, poses.times, poses.states, Z.transpose(0, 2, 1), len(links))
    joint_links = [i for i, h in enumerate(links) if h.joint >= 0]
    tree_joints = [links[i].joint for i in joint_links]
    moment_and_force = loads[:, :, joint_links].transpose(2, 0, 3, 1)
    shares[tree_joints, :, :3], shares[tree_joints, :, 3:] = moment_and_force[:, :, 3:], moment_and_force[:, :, :3]
    for h in links:
        if h.reverse:  # the load is ON `from`, and about its point
            joint = joints[h.joint]
            arm = poses.point_position(joint.a, joint.p) - poses.point_position(joint.b, joint.q)
            force = shares[h.joint, :, :3]
            shares[h.joint, :, 3:] += np.cross(arm[:, :, None], force, axis=1)
            shares[h.joint] *= -1.0
    rows = np.array(layout.rows)
    unit = np.concatenate([poses.f, poses.m], axis=2).transpose(0, 2, 1)
    for k in dict.fromkeys(k for k in layout.rows if k < len(joints)):
        joint_rows = np.flatnonzero(rows == k)
        shares[k] += unit[:, :, joint_rows] @ Z[:, joint_rows]
    return shares


# Neighbours

DIRECTIONS = 3
SEED = 1901  # fixed: the same scene gives the same verdicts


def find_neighbour_poses(
    runner: Evaluator, t: float, state: Array, step_sizes: Sequence[float], holding: Array | None = None
) -> Evaluation | None:
    """Return poses displaced by each step size (rad, or relative to the size) along fixed pseudo-random admissible
    rates, in both directions.

    Returns None if nothing moves. holding: the closed contacts, by default as at the start.
    """
    layout = runner.layout
    rng = np.random.default_rng(SEED)
    random_states = np.repeat(state[None, :], DIRECTIONS, axis=0)
    slots = find_rate_indices(layout)
    random_states[:, slots] = rng.uniform(-1.0, 1.0, (DIRECTIONS, len(slots))) / layout.weights[slots]
    admissible = runner.evaluate(np.full(DIRECTIONS, t), random_states, holding=holding).states
    largest = np.abs(admissible[:, slots] * layout.weights[slots]).max(axis=1, initial=0.0)
    is_moving = largest > tolerances.REMAINING_RATE
    if not is_moving.any():
        return None
    steps = [
        (k, sign * step / largest[k]) for k in np.flatnonzero(is_moving) for step in step_sizes for sign in (1.0, -1.0)
    ]
    displaced_states = [displace_along_rates(layout, admissible[k], step) for k, step in steps]
    evaluation = runner.evaluate(np.full(len(steps), t), np.array(displaced_states), holding=holding)
    is_closed = evaluation.gap <= tolerances.OPEN_GAP * layout.size
    if not is_closed.any():
        return None
    return evaluation.select(is_closed)


def find_rate_indices(layout: Layout) -> Array:
    """Return the indices of the controlled rates in the state."""
    groups = layout.tables["groups"]
    indices: Array = np.concatenate([np.arange(g["rates"], g["end"]) for g in groups]).astype(int)
    return indices


def stop_motion(layout: Layout, states: Array) -> Array:
    """Return states (..., n) with all rates zero."""
    at_rest = states.copy()
    at_rest[..., find_rate_indices(layout)] = 0.0
    return at_rest


def displace_along_rates(layout: Layout, state: Array, factor: float) -> Array:
    """Return the state with its coordinates displaced by rates times a factor."""
    displaced_state = state.copy()
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude, rate = body["attitude_at"], body["rate_at"]
        q, w = state[attitude : attitude + 4], 0.5 * factor * state[rate : rate + 3]
        turn = quaternion_product(np.array([0.0, *w]), q)
        displaced_state[attitude : attitude + 4] = (q + turn) / np.sqrt(np.sum((q + turn) ** 2))
    for freedom in layout.freedoms:
        if freedom.q >= 0:
            displaced_state[freedom.q] += factor * state[freedom.u]
    return displaced_state
