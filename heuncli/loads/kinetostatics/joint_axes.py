"""Joint loads in the axes of one of the joint's bodies, as a bearing feels them that turns with it.

    F_i = e_i . F,   e_i (t) the axes of the body: F' = R^T F
What is open is so in a direction: a component along e_i is open where a self-stress has a share along e_i. So shares of
self-stresses are turned as the loads are, and judged then. Axes of the ground are the world's.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.results.results import Array, Block

JOINT_AXES = ("world", "from", "to")


def axes_at(joint: Joint, states: BodyStates, axes: str) -> Array | None:
    """The axes in which a joint's loads are told, as columns, (n_t, 3, 3); None: the world's."""
    body = {"from": joint.a, "to": joint.b}.get(axes, GROUND)
    return states.R[:, body] if body != GROUND else None


def components(vectors: Array, R: Array | None) -> Array:
    """The components of vectors (..., n_t, 3) in the axes R."""
    return vectors if R is None else np.einsum("tji,...tj->...ti", R, vectors)


def components_of_shares(shares: Array, R: Array | None) -> Array:
    """The components in the axes R of shares of self-stresses, force and moment, (n_t, 6, k)."""
    if R is None:
        return shares
    return np.concatenate([np.einsum("tji,tjk->tik", R, part) for part in (shares[:, :3], shares[:, 3:])], axis=1)


def in_axes(load: JointLoads, states: BodyStates, axes: str) -> JointLoads:
    """A joint's loads, or their shares, with force and moment in these axes."""
    R = axes_at(load.joint, states, axes)
    if R is None:
        return load
    return replace(load, force=components(load.force, R), moment=components(load.moment, R))


def put_in_axes(block: Block, R: Array | None) -> None:
    """The force and moment of a joint's block, and of their shares by cause, in these axes, in place."""
    for own in (block, *block.get("shares", {}).values()):
        own |= {name: components(own[name], R) for name in ("force", "moment") if name in own}
