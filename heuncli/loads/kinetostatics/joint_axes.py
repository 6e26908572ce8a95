"""Express joint loads in the axes of one of the joint's bodies, as a bearing that turns with it carries them.

    F_i = e_i . F,   e_i (t) the axes of the body: F' = R^T F

Indeterminacy has a direction: a component along e_i is indeterminate where a self-stress has a share along e_i. So
shares of self-stresses are rotated as the loads are, and judged afterwards. Axes of the ground are the world's.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.results.results import Array, Block

JOINT_AXES = ("world", "from", "to")


def find_joint_axes(joint: Joint, states: BodyStates, axes: str) -> Array | None:
    """Return the axes in which a joint's loads are reported, as columns, (n_t, 3, 3); None: the world's."""
    body = {"from": joint.a, "to": joint.b}.get(axes, GROUND)
    return states.R[:, body] if body != GROUND else None


def rotate_to_axes(vectors: Array, R: Array | None) -> Array:
    """Return the components of vectors (..., n_t, 3) in the axes R."""
    return vectors if R is None else np.einsum("tji,...tj->...ti", R, vectors)


def rotate_shares(shares: Array, R: Array | None) -> Array:
    """Return the components in the axes R of shares of self-stresses, force and moment, (n_t, 6, k)."""
    if R is None:
        return shares
    return np.concatenate([np.einsum("tji,tjk->tik", R, part) for part in (shares[:, :3], shares[:, 3:])], axis=1)


def rotate_joint_loads(load: JointLoads, states: BodyStates, axes: str) -> JointLoads:
    """Return a joint's loads, or their shares, with force and moment in these axes."""
    R = find_joint_axes(load.joint, states, axes)
    if R is None:
        return load
    return replace(load, force=rotate_to_axes(load.force, R), moment=rotate_to_axes(load.moment, R))


def rotate_block(block: Block, R: Array | None) -> None:
    """Rotate the force and moment of a joint's block, and of their shares by cause, to these axes, in place."""
    for entry in (block, *block.get("shares", {}).values()):
        entry |= {name: rotate_to_axes(entry[name], R) for name in ("force", "moment") if name in entry}
