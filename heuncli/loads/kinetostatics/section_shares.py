"""Section loads by their causes: what the loads do where they stand on the piece, and what its motion does.

    s'_c = k'_c - m' x.._c + what the joints on the piece carry of the cause c,   M'_c likewise        (57), (58)
k'_c is the load itself, the weight of the piece with gravity: `direct_*`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.loads.kinetostatics.actions import whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import coupling_actions
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.sections import (
    ABOUT_CENTROID,
    accelerations_as_matrix,
    attachments,
    in_body_axes,
    piece_loads,
    planes,
)
from heuncli.loads.kinetostatics.shares import GRAVITY, MOTION, Shares
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.rotations import cross_rows


def section_shares(
    cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares, is_open: Mapping[str, Mask]
) -> Block:
    """The shares in the loads of one section, cause by cause; nan where the section's load is open."""
    direct = direct_loads(cuts, layout.mechanism.gravity, states, shares)
    force, moment = loads_by_cause(cuts, layout, states, shares)
    for cause, (F, M) in direct.items():
        if cause not in shares.causes:
            continue  # a load of nothing
        force[:, shares.place(cause)] += F
        moment[:, shares.place(cause)] += M
    if layout.mechanism.planar:
        for F, M in ((force, moment), *direct.values()):
            F[2], M[:2] = 0.0, 0.0
    where = planes(cuts, states)
    whole = {
        name: np.where(is_open[name], np.nan, values) if name in is_open else values
        for name, values in where.components(force, moment).items()
        if name not in ABOUT_CENTROID
    }
    block = shares.by_name(whole)
    none = np.zeros_like(whole["force"][0])
    for cause in [*({GRAVITY} & set(shares.all)), *(action.name for action in shares.applied)]:
        F, M = (where.in_world_axes(x) for x in where.wrench(*direct[cause])) if cause in direct else (none, none)
        block[cause] |= {"direct_force": F, "direct_moment": M}
    if cuts.s is None:
        return {cause: {name: values[:, 0] for name, values in own.items()} for cause, own in block.items()}
    return block


def loads_by_cause(cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares) -> tuple[Array, Array]:
    """What the piece's inertia and the joints on it make of every cause, (3, n_c, n_t, k)."""
    actions = [*whole_joint_actions(shares.joints), *coupling_actions(shares.held)]
    joints = attachments(cuts.body, states, actions)
    return piece_loads(cuts, acceleration_matrix_by_cause(cuts.body, layout, states, shares), joints)


def direct_loads(cuts: Cuts, gravity: Array, states: BodyStates, shares: Shares) -> dict[str, tuple[Array, Array]]:
    """By cause the weight of the pieces, and each load that stands on the body where it stands on them, (3, n_t, k)."""
    none = np.zeros((len(states.x), 3))
    weight = accelerations_as_matrix(none, none, in_body_axes(states.R[:, cuts.body], none - gravity))
    found = {GRAVITY: piece_loads(cuts, weight, [])} if GRAVITY in shares.causes else {}
    for name in dict.fromkeys(action.name for action in shares.applied):
        if on := attachments(cuts.body, states, [action for action in shares.applied if action.name == name]):
            found[name] = piece_loads(cuts, np.zeros_like(weight), on)
    return found


def acceleration_matrix_by_cause(body: int, layout: Layout, states: BodyStates, shares: Shares) -> Array:
    """Acc = [hat(sigma.) + hat(sigma)^2, x_o..] of every cause, (3, n_c, n_t, 4): sigma is the motion's alone."""
    i, R = layout.place[body], states.R[:, body]
    alpha, a = (shares.column.bodies[name][:, :, i] for name in ("alpha", "a"))
    arm = -R @ layout.reference[i]
    a = a + cross_rows(alpha, arm)
    omega = np.zeros_like(alpha)
    if MOTION in shares.causes:
        omega[shares.place(MOTION)] = w = states.omega[:, body]
        a[shares.place(MOTION)] += cross_rows(w, cross_rows(w, arm))
    if GRAVITY in shares.causes:
        a[shares.place(GRAVITY)] += layout.mechanism.gravity  # the kernel's is less g
    return accelerations_as_matrix(*(in_body_axes(R, x) for x in (omega, alpha, a)))
