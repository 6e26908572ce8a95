"""Loads by cause: every wrench as the sum of the effects of gravity, each applied load, the drives and the motion.

    M V. + ... = loads + J' lambda,   J V. + gamma = 0

At a configuration, accelerations, multipliers and joint loads are affine in the applied loads, in gravity, in the
prescribed accelerations and in the velocity terms. So they are the sum of one column for each cause: each load alone on
the scene at rest; weight alone; the second derivatives of the drives alone; the velocity terms alone, which are
quadratic in the speed. The kernel solves all with the same factors (kernel/columns.py). Here the same sums as for the
total are taken of them, in arrays with an axis of causes before that of the instants, (n_c, n_t, ...).

The effect of a force on a piece has two parts: k', the force itself where it acts on the piece, and -m' x.., the
inertia of the piece against the acceleration that it causes, wherever it acts: k' and m'u of (59), both in P of (61);
the velocity terms are m'w, and Q of (61). The first is reported separately as `direct_*`. manual/theory.md, "Shares by
cause".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, list_joint_actions, list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads, find_coupling_loads, list_coupling_actions
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.foundation import find_ground_loads
from heuncli.loads.kinetostatics.piece_loads import (
    compute_acceleration_matrix,
    find_attachments,
    find_piece_loads,
    to_body_axes,
)
from heuncli.loads.kinetostatics.reactions import JointLoads, find_joint_loads, project_to_plane
from heuncli.loads.kinetostatics.sections import ABOUT_CENTROID, make_cut_places
from heuncli.motion.integration.evaluator import CAUSES, Evaluation
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Columns
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.rotations import cross_rows

GRAVITY, DRIVES, MOTION = "gravity", "drives", "motion"


@record
class CauseResults:
    """The results of the causes, fields of tables by name: (n_c, n_t, n, ...), tree order; see
    reactions.KernelResults.
    """

    bodies: dict[str, Array]
    freedoms: dict[str, Array]
    rows: dict[str, Array]
    loads: dict[str, Array]
    parts: dict[str, Array]


@record
class Shares:
    """The causes with an effect, their results, the joint loads by cause, (n_c, n_t, 3), and the applied actions.

    all_causes: the causes in the order of the results, including those without effect, such as drives where there are
    none
    """

    all_causes: tuple[str, ...]
    causes: tuple[str, ...]
    cause_results: CauseResults
    joints: list[JointLoads]
    couplings: list[CouplingLoads]
    applied_actions: list[Action]

    @property
    def rigid_couplings(self) -> list[CouplingLoads]:
        """The couplings without stretching ropes, which are among the applied actions."""
        return [own for own in self.couplings if own.coupling.stretched_row is None]

    def find_index(self, cause: str) -> int:
        """Return the index of a cause on the axis of causes."""
        return self.causes.index(cause)

    def to_blocks(self, parts: Mapping[str, Array]) -> Block:
        """Return blocks by the causes' names from arrays over the causes; zeros for causes without effect."""
        zeros = {name: np.zeros(values.shape[1:]) for name, values in parts.items()}
        block: Block = {cause: dict(zeros) for cause in self.all_causes}
        for c, cause in enumerate(self.causes):
            block[cause] = {name: values[c] for name, values in parts.items()}
        return block


CauseColumns = Mapping[str, Sequence[int]]  # of a cause: which of the kernel's columns are its own


def find_cause_columns(mechanism: Mechanism) -> CauseColumns:
    """Return the kernel's columns of each cause, in the order of the results.

    A load in a joint has one column for each motion of it, a distributed load one from either end.
    """
    rows: dict[str, list[int]] = {}
    n = 0
    for load, load_rows in mechanism.iter_load_rows():
        rows.setdefault(load.name, []).extend(range(load_rows.start, load_rows.stop))
        n = load_rows.stop
    other_columns = {name: [n + k] for k, name in enumerate(CAUSES)}
    return {GRAVITY: other_columns[GRAVITY], **rows, DRIVES: other_columns[DRIVES], MOTION: other_columns[MOTION]}


def find_shares(
    layout: Layout,
    evaluation: Evaluation,
    states: BodyStates,
    applied_actions: Sequence[Action],
    cause_columns: CauseColumns,
) -> Shares:
    """Find the shares of the causes in the joints' loads, at instants that were evaluated with their causes."""
    assert evaluation.causes is not None, "recovered without causes"
    forces = [action for action in applied_actions if action.name in cause_columns]
    # loads that move nothing, or free fall, still affect cuts
    acting_names = {action.name for action in forces if action.force.any() or action.moment.any()}
    acting_names |= {GRAVITY} if layout.mechanism.gravity.any() else set()
    has_effect = find_nonzero_columns(evaluation.causes)
    effective = {
        name: places for name, places in cause_columns.items() if name in acting_names or has_effect[list(places)].any()
    }
    effective = effective or dict([*cause_columns.items()][-1:])
    column = sum_by_cause(evaluation, evaluation.causes, effective)
    joints, couplings = find_joint_loads(layout, column, states), find_coupling_loads(layout, column, states)
    return Shares(tuple(cause_columns), tuple(effective), column, joints, couplings, forces)


def find_nonzero_columns(columns: Columns) -> Mask:
    """Return which columns have an effect at some instant, (n_c,); most do at the first."""

    def has_effect(part: Columns) -> Mask:
        bodies = [part.bodies[name].any(axis=(0, 2, 3)) for name in ("alpha", "a", "joint_moment", "joint_force")]
        rest = [x.any(axis=(0, 2)) for x in (part.freedoms["drive"], part.multipliers)]
        return np.asarray(np.any([*bodies, *rest], axis=0))

    is_nonzero = has_effect(columns.select(np.arange(1)))
    unchecked = np.flatnonzero(~is_nonzero)
    if len(unchecked):
        is_nonzero[unchecked] = has_effect(
            Columns(columns.bodies[:, unchecked], columns.freedoms[:, unchecked], columns.multipliers[:, unchecked])
        )
    return is_nonzero


def sum_by_cause(evaluation: Evaluation, columns: Columns, cause_columns: CauseColumns) -> CauseResults:
    """Sum the kernel's columns by cause."""

    def by_cause(values: Array) -> Array:
        indices = [list(places) for places in cause_columns.values()]
        return np.stack([values[:, some[0]] if len(some) == 1 else values[:, some].sum(axis=1) for some in indices])

    bodies = {name: by_cause(columns.bodies[name]) for name in ("alpha", "a", "joint_moment", "joint_force")}
    rows = {name: evaluation.rows[name] for name in ("f", "m", "closed")} | {
        "multiplier": by_cause(columns.multipliers)
    }
    parts = {name: evaluation.parts[name] for name in ("f", "m", "Q", "on_a", "on_b")}
    value = evaluation.loads["value"]
    load_values = np.zeros((len(cause_columns), *value.shape))
    for c, indices in enumerate(cause_columns.values()):
        load_indices = [k for k in indices if k < value.shape[1]]
        load_values[c][:, load_indices] = value[:, load_indices]
    return CauseResults(bodies, {"drive": by_cause(columns.freedoms["drive"])}, rows, {"value": load_values}, parts)


def make_joint_shares_block(shares: Shares, load: JointLoads) -> Block:
    """Return the shares in one joint's load by cause."""
    parts = {"force": load.force, "moment": load.moment, "drive": load.drive, "tension": load.tension}
    parts["torque"] = load.torque
    return shares.to_blocks({name: values for name, values in parts.items() if values is not None})


def make_foundation_shares_blocks(
    mechanism: Mechanism, states: BodyStates, shares: Shares, reference: Array
) -> dict[tuple[str, ...], Block]:
    """Return the shares in the loads on the ground: of the total, of each support and element, by its keys in the
    block.

    The total is the sum of supports and elements, moments shifted to `reference`. direct_*: what is applied from
    outside, k of (55).
    """
    n_c, n_t = len(shares.causes), len(states.x)
    force, moment = np.zeros((2, n_c, n_t, 3))
    parts: dict[tuple[str, ...], Block] = {}
    inner_actions = [action for action in shares.applied_actions if action.from_end is not None]
    ground_actions = [
        *(make_cause_action(shares, action) for action in inner_actions),
        *list_joint_actions(shares.joints),
    ]
    for keys, load in find_ground_loads(
        mechanism, [*ground_actions, *list_coupling_actions(shares.rigid_couplings)]
    ).items():
        force, moment = force + load.force, moment + cross_rows(load.point - reference, load.force) + load.moment
        parts[keys] = shares.to_blocks({"force": load.force, "moment": load.moment})
    if mechanism.planar:
        force, moment = project_to_plane(force, moment)
    total = shares.to_blocks({"force": force, "moment": moment})
    for cause, (F, M) in find_outside_loads(mechanism, states, shares, reference).items():
        F, M = project_to_plane(F, M) if mechanism.planar else (F, M)
        total[cause] |= {"direct_force": F, "direct_moment": M}
    return {(): total, **parts}


def make_cause_action(shares: Shares, action: Action) -> Action:
    """Return a load's action by cause: all of it belongs to its own cause."""
    index = shares.find_index(action.name) if action.name in shares.causes else None

    def by_cause(values: Array) -> Array:
        found = np.zeros((len(shares.causes), *values.shape))
        if index is not None:
            found[index] = values
        return found

    opposite = None if action.opposite is None else by_cause(action.opposite)
    return replace(action, force=by_cause(action.force), moment=by_cause(action.moment), opposite=opposite)


def find_outside_loads(
    mechanism: Mechanism, states: BodyStates, shares: Shares, reference: Array
) -> dict[str, tuple[Array, Array]]:
    """Return force and moment about a point of the total weight, and of each applied load; zero for inner loads."""
    loads = {}
    if GRAVITY in shares.all_causes:
        weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
        levers = np.sum(cross_rows(states.centre - reference, weight), axis=1)
        loads[GRAVITY] = np.broadcast_to(weight.sum(axis=0), levers.shape), levers
    for action in shares.applied_actions:
        M = action.moment + cross_rows(action.to_end.position - reference, action.force)
        is_inner = action.from_end is not None
        loads[action.name] = (np.zeros_like(M), np.zeros_like(M)) if is_inner else (action.force, M)
    return loads


def make_section_shares_block(
    cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares, is_open: Mapping[str, Mask]
) -> Block:
    """Return the shares in the loads of one section by cause; nan where the section's load is indeterminate.

    s'_c = k'_c - m' x.._c + what the joints on the piece carry of the cause c,   M'_c likewise        (57), (58)

    k'_c is the load itself, with gravity the weight of the piece: `direct_*`.
    """
    direct_wrenches = find_direct_loads(cuts, layout.mechanism.gravity, states, shares)
    force, moment = find_piece_loads_by_cause(cuts, layout, states, shares)
    for cause, (F, M) in direct_wrenches.items():
        if cause not in shares.causes:
            continue  # a load without effect
        force[:, shares.find_index(cause)] += F
        moment[:, shares.find_index(cause)] += M
    if layout.mechanism.planar:
        for F, M in ((force, moment), *direct_wrenches.values()):
            F[2], M[:2] = 0.0, 0.0
    cut_places = make_cut_places(cuts, states)
    component_shares = {
        name: np.where(is_open[name], np.nan, values) if name in is_open else values
        for name, values in cut_places.compute_components(force, moment).items()
        if name not in ABOUT_CENTROID
    }
    block = shares.to_blocks(component_shares)
    zeros = np.zeros_like(component_shares["force"][0])
    for cause in [*({GRAVITY} & set(shares.all_causes)), *(action.name for action in shares.applied_actions)]:
        F, M = (
            (cut_places.to_world_axes(x) for x in cut_places.shift_wrench(*direct_wrenches[cause]))
            if cause in direct_wrenches
            else (zeros, zeros)
        )
        block[cause] |= {"direct_force": F, "direct_moment": M}
    if cuts.s is None:
        return {cause: {name: values[:, 0] for name, values in entries.items()} for cause, entries in block.items()}
    return block


def find_piece_loads_by_cause(cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares) -> tuple[Array, Array]:
    """Return the effect of the piece's inertia and of the joints on it for every cause, (3, n_c, n_t, k)."""
    actions = [*list_whole_joint_actions(shares.joints), *list_coupling_actions(shares.rigid_couplings)]
    joints = find_attachments(cuts.body, states, actions)
    return find_piece_loads(cuts, find_acceleration_matrix_by_cause(cuts.body, layout, states, shares), joints)


def find_direct_loads(cuts: Cuts, gravity: Array, states: BodyStates, shares: Shares) -> dict[str, tuple[Array, Array]]:
    """Return by cause the weight of the pieces, and the loads that act on them directly, (3, n_t, k)."""
    zeros = np.zeros((len(states.x), 3))
    weight = compute_acceleration_matrix(zeros, zeros, to_body_axes(states.R[:, cuts.body], zeros - gravity))
    loads = {GRAVITY: find_piece_loads(cuts, weight, [])} if GRAVITY in shares.causes else {}
    for name in dict.fromkeys(action.name for action in shares.applied_actions):
        if attached_loads := find_attachments(
            cuts.body, states, [action for action in shares.applied_actions if action.name == name]
        ):
            loads[name] = find_piece_loads(cuts, np.zeros_like(weight), attached_loads)
    return loads


def find_acceleration_matrix_by_cause(body: int, layout: Layout, states: BodyStates, shares: Shares) -> Array:
    """Return Acc = [hat(sigma.) + hat(sigma)^2, x_o..] of every cause, (3, n_c, n_t, 4); only the motion has a
    sigma.
    """
    i, R = layout.place[body], states.R[:, body]
    alpha, a = (shares.cause_results.bodies[name][:, :, i] for name in ("alpha", "a"))
    arm = -R @ layout.reference[i]
    a = a + cross_rows(alpha, arm)
    omega = np.zeros_like(alpha)
    if MOTION in shares.causes:
        omega[shares.find_index(MOTION)] = w = states.omega[:, body]
        a[shares.find_index(MOTION)] += cross_rows(w, cross_rows(w, arm))
    if GRAVITY in shares.causes:
        a[shares.find_index(GRAVITY)] += layout.mechanism.gravity  # the kernel's is less g
    return compute_acceleration_matrix(*(to_body_axes(R, x) for x in (omega, alpha, a)))
