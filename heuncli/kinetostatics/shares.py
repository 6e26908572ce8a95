"""Loads by their causes: every wrench as the sum of what gravity, each applied load, the drives and the motion do.

    M V. + ... = loads + J' lambda,   J V. + gamma = 0
At a configuration accelerations, multipliers and joint loads are affine in what is applied, in gravity, in the
prescribed accelerations and in the velocity terms. So they are the sum of one column a cause: each load alone on the
scene at rest; weight alone; the second derivatives of the drives alone; the velocity terms alone, which are quadratic
in the speed. The kernel answers all with the same factors (kernel/columns.py); here the same sums as of the whole are
taken of them, in arrays with an axis of causes before that of the instants, (n_c, n_t, ...).

What a force does to a piece has two parts: k', the force itself where it stands on the piece, and -m' x.., the inertia
of the piece against the acceleration that it causes, wherever it stands: k' and m'u of (59), both in P of (61); the
velocity terms are m'w, and Q of (61). The first is told apart as `direct_*`. manual/theory.md, "Shares by cause".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.integration.evaluator import CAUSES, Recovered
from heuncli.kinetostatics.actions import Action, joint_actions
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.couplings import CouplingLoads, coupling_actions, coupling_loads
from heuncli.kinetostatics.foundation import on_ground
from heuncli.kinetostatics.reactions import JointLoads, in_plane, joint_loads
from heuncli.mechanism.model import Mechanism
from heuncli.records import record, replace
from heuncli.response import Columns
from heuncli.results import Array, Block, Mask
from heuncli.shapes.rotations import cross_rows
from heuncli.tree.layout import Layout

GRAVITY, DRIVES, MOTION = "gravity", "drives", "motion"


@record
class Column:
    """What answers the causes, fields of tables by name: (n_c, n_t, n, ...), tree order; see reactions.Answers."""

    bodies: dict[str, Array]
    freedoms: dict[str, Array]
    rows: dict[str, Array]
    loads: dict[str, Array]
    parts: dict[str, Array]


@record
class Shares:
    """The causes that do anything, what answers each, and the joints' loads by them, (n_c, n_t, 3); what is applied.

    all: the causes in the order of the results, idle ones among them, as drives are where there are none.
    """

    all: tuple[str, ...]
    causes: tuple[str, ...]
    column: Column
    joints: list[JointLoads]
    couplings: list[CouplingLoads]
    applied: list[Action]

    @property
    def held(self) -> list[CouplingLoads]:
        """The couplings that hold something: ropes that stretch are among what is applied."""
        return [own for own in self.couplings if own.coupling.stretched is None]

    def place(self, cause: str) -> int:
        """Of a cause, on the axis of causes."""
        return self.causes.index(cause)

    def by_name(self, parts: Mapping[str, Array]) -> Block:
        """Blocks by the causes' names, of arrays over the causes; of idle ones zeros."""
        none = {name: np.zeros(values.shape[1:]) for name, values in parts.items()}
        block: Block = {cause: dict(none) for cause in self.all}
        for c, cause in enumerate(self.causes):
            block[cause] = {name: values[c] for name, values in parts.items()}
        return block


Members = Mapping[str, Sequence[int]]  # of a cause: which of the kernel's columns are its own


def members_of(mechanism: Mechanism) -> Members:
    """Of all causes of forces, in the order of the results: a load in a joint has a column a motion of it.

    A distributed load has one from either end.
    """
    rows: dict[str, list[int]] = {}
    n = 0
    for load, own in mechanism.load_rows():
        rows.setdefault(load.name, []).extend(range(own.start, own.stop))
        n = own.stop
    beside = {name: [n + k] for k, name in enumerate(CAUSES)}
    return {GRAVITY: beside[GRAVITY], **rows, DRIVES: beside[DRIVES], MOTION: beside[MOTION]}


def shares_of(
    layout: Layout, recovered: Recovered, states: BodyStates, applied: Sequence[Action], members: Members
) -> Shares:
    """The shares of the causes in the joints' loads, at instants that were recovered with their causes."""
    assert recovered.causes is not None, "recovered without causes"
    own = [action for action in applied if action.name in members]
    # what moves nothing, or falls freely, is felt by cuts all the same
    acting = {action.name for action in own if action.force.any() or action.moment.any()}
    acting |= {GRAVITY} if layout.mechanism.gravity.any() else set()
    busy = not_zero(recovered.causes)
    live = {name: places for name, places in members.items() if name in acting or busy[list(places)].any()}
    live = live or dict([*members.items()][-1:])
    column = column_of(recovered, recovered.causes, live)
    joints, couplings = joint_loads(layout, column, states), coupling_loads(layout, column, states)
    return Shares(tuple(members), tuple(live), column, joints, couplings, own)


def not_zero(columns: Columns) -> Mask:
    """Which columns answer anything at some instant, (n_c,); most do at the first."""

    def some(part: Columns) -> Mask:
        bodies = [part.bodies[name].any(axis=(0, 2, 3)) for name in ("alpha", "a", "joint_moment", "joint_force")]
        rest = [x.any(axis=(0, 2)) for x in (part.freedoms["drive"], part.multipliers)]
        return np.asarray(np.any([*bodies, *rest], axis=0))

    found = some(columns.at(np.arange(1)))
    left = np.flatnonzero(~found)
    if len(left):
        found[left] = some(Columns(columns.bodies[:, left], columns.freedoms[:, left], columns.multipliers[:, left]))
    return found


def column_of(recovered: Recovered, columns: Columns, members: Members) -> Column:
    """The kernel's columns summed by cause."""

    def by_cause(values: Array) -> Array:
        own = [list(places) for places in members.values()]
        return np.stack([values[:, some[0]] if len(some) == 1 else values[:, some].sum(axis=1) for some in own])

    bodies = {name: by_cause(columns.bodies[name]) for name in ("alpha", "a", "joint_moment", "joint_force")}
    rows = {name: recovered.rows[name] for name in ("f", "m", "closed")} | {"multiplier": by_cause(columns.multipliers)}
    parts = {name: recovered.parts[name] for name in ("f", "m", "Q", "on_a", "on_b")}
    value = recovered.loads["value"]
    alone = np.zeros((len(members), *value.shape))
    for c, own in enumerate(members.values()):
        of_load = [k for k in own if k < value.shape[1]]
        alone[c][:, of_load] = value[:, of_load]
    return Column(bodies, {"drive": by_cause(columns.freedoms["drive"])}, rows, {"value": alone}, parts)


def joint_shares(shares: Shares, load: JointLoads) -> Block:
    """The shares in one joint's load, cause by cause."""
    parts = {"force": load.force, "moment": load.moment, "drive": load.drive, "tension": load.tension}
    parts["torque"] = load.torque
    return shares.by_name({name: values for name, values in parts.items() if values is not None})


def foundation_shares(
    mechanism: Mechanism, states: BodyStates, shares: Shares, about: Array
) -> dict[tuple[str, ...], Block]:
    """The shares in what stands on the ground: of the total, of each support and element, by its keys in the block.

    The total is the sum of supports and elements, moments shifted to `about`. direct_*: what is applied from outside,
    k of (55).
    """
    n_c, n_t = len(shares.causes), len(states.x)
    force, moment = np.zeros((2, n_c, n_t, 3))
    parts: dict[tuple[str, ...], Block] = {}
    inner = [action for action in shares.applied if action.from_ is not None]
    standing = [*(alone(shares, action) for action in inner), *joint_actions(shares.joints)]
    for keys, on in on_ground(mechanism, [*standing, *coupling_actions(shares.held)]).items():
        force, moment = force + on.force, moment + cross_rows(on.about - about, on.force) + on.moment
        parts[keys] = shares.by_name({"force": on.force, "moment": on.moment})
    if mechanism.planar:
        force, moment = in_plane(force, moment)
    whole = shares.by_name({"force": force, "moment": moment})
    for cause, (F, M) in from_outside(mechanism, states, shares, about).items():
        F, M = in_plane(F, M) if mechanism.planar else (F, M)
        whole[cause] |= {"direct_force": F, "direct_moment": M}
    return {(): whole, **parts}


def alone(shares: Shares, action: Action) -> Action:
    """A load's action by cause: it is all its own."""
    own = shares.place(action.name) if action.name in shares.causes else None

    def by_cause(values: Array) -> Array:
        found = np.zeros((len(shares.causes), *values.shape))
        if own is not None:
            found[own] = values
        return found

    opposite = None if action.opposite is None else by_cause(action.opposite)
    return replace(action, force=by_cause(action.force), moment=by_cause(action.moment), opposite=opposite)


def from_outside(
    mechanism: Mechanism, states: BodyStates, shares: Shares, about: Array
) -> dict[str, tuple[Array, Array]]:
    """Force and moment about a point of the whole weight, and of each applied load: nothing of what acts inside."""
    found = {}
    if GRAVITY in shares.all:
        weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
        levers = np.sum(cross_rows(states.centre - about, weight), axis=1)
        found[GRAVITY] = np.broadcast_to(weight.sum(axis=0), levers.shape), levers
    for action in shares.applied:
        M = action.moment + cross_rows(action.to.position - about, action.force)
        inside = action.from_ is not None
        found[action.name] = (np.zeros_like(M), np.zeros_like(M)) if inside else (action.force, M)
    return found
