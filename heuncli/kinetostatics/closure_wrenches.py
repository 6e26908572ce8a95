"""What the closure rows of cut joints carry: of each row the force and moment ON `to` by its multiplier λ.

    a direction d fixed in `from` along which the points keep together       f = λ d
    a direction d of `from` that stays perpendicular to e of `to`            m = λ e × d
    a distance that is kept                                                  f = λ D / |D|
These are the rows' derivatives by the twist of `to` against `from`, so that λ is a force or a moment; theory.md 2b.
"""

from __future__ import annotations

import numpy as np

from heuncli.joint_kinds import JOINTS
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.results import Array
from heuncli.tree.layout import Layout
from heuncli.tree.starts import joint_frame, to_direction


def closure_wrenches(layout: Layout, states: BodyStates, multipliers: Array) -> tuple[Array, Array]:
    """Force and moment ON `to` about the `to` point of every closure row, world axes, (n_t, m, 3) each."""
    force = np.zeros((len(states.x), len(layout.rows), 3))
    moment = np.zeros_like(force)
    r = 0
    for k in dict.fromkeys(layout.rows):
        joint = layout.mechanism.joints[k]
        kind = JOINTS[joint.kind]
        if kind.keeps_distance:
            D = states.place(joint.b, joint.q) - states.place(joint.a, joint.p)
            force[:, r] = multipliers[:, r, None] * D / np.sqrt(np.sum(D * D, axis=1))[:, None]
            r += 1
        for d in kind.guides:
            force[:, r] = multipliers[:, r, None] * states.direction(joint.a, joint_frame(joint, d))
            r += 1
        for d, e in kind.dots:
            on_to = states.direction(joint.b, to_direction(joint, layout.starts[k].R_ref, e))
            moment[:, r] = multipliers[:, r, None] * np.cross(on_to, states.direction(joint.a, joint_frame(joint, d)))
            r += 1
    return force, moment
