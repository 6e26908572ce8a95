"""Section loads by cause: the effect of the loads on the piece itself, and that of the piece's motion.

    s'_c = k'_c - m' x.._c + what the joints on the piece carry of the cause c,   M'_c likewise        (57), (58)

k'_c is the load itself, with gravity the weight of the piece: `direct_*`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.loads.kinetostatics.actions import list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import list_coupling_actions
from heuncli.loads.kinetostatics.cuts import Cuts
from heuncli.loads.kinetostatics.sections import (
    ABOUT_CENTROID,
    find_attachments,
    find_piece_loads,
    make_acceleration_matrix,
    make_cut_places,
    to_body_axes,
)
from heuncli.loads.kinetostatics.shares import GRAVITY, MOTION, Shares
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block, Mask
from heuncli.scene.shapes.rotations import cross_rows


def section_shares_block(
    cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares, is_open: Mapping[str, Mask]
) -> Block:
    """Return the shares in the loads of one section by cause; nan where the section's load is indeterminate."""
    direct_wrenches = find_direct_loads(cuts, layout.mechanism.gravity, states, shares)
    force, moment = piece_loads_by_cause(cuts, layout, states, shares)
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
        for name, values in cut_places.components(force, moment).items()
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


def piece_loads_by_cause(cuts: Cuts, layout: Layout, states: BodyStates, shares: Shares) -> tuple[Array, Array]:
    """Return the effect of the piece's inertia and of the joints on it for every cause, (3, n_c, n_t, k)."""
    actions = [*list_whole_joint_actions(shares.joints), *list_coupling_actions(shares.rigid_couplings)]
    joints = find_attachments(cuts.body, states, actions)
    return find_piece_loads(cuts, acceleration_matrix_by_cause(cuts.body, layout, states, shares), joints)


def find_direct_loads(cuts: Cuts, gravity: Array, states: BodyStates, shares: Shares) -> dict[str, tuple[Array, Array]]:
    """Return by cause the weight of the pieces, and the loads that act on them directly, (3, n_t, k)."""
    zeros = np.zeros((len(states.x), 3))
    weight = make_acceleration_matrix(zeros, zeros, to_body_axes(states.R[:, cuts.body], zeros - gravity))
    loads = {GRAVITY: find_piece_loads(cuts, weight, [])} if GRAVITY in shares.causes else {}
    for name in dict.fromkeys(action.name for action in shares.applied_actions):
        if attached_loads := find_attachments(
            cuts.body, states, [action for action in shares.applied_actions if action.name == name]
        ):
            loads[name] = find_piece_loads(cuts, np.zeros_like(weight), attached_loads)
    return loads


def acceleration_matrix_by_cause(body: int, layout: Layout, states: BodyStates, shares: Shares) -> Array:
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
    return make_acceleration_matrix(*(to_body_axes(R, x) for x in (omega, alpha, a)))
