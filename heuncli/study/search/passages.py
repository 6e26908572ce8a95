"""Instants at which a joint whose point moves over a body passes a cut of it: there the cut's loads jump."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.actions import whole_joint_actions
from heuncli.loads.kinetostatics.couplings import coupling_actions
from heuncli.results.results import Array
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.search.extremes import distinct

PARTS = 16  # into which a span with a passage is divided
ROUNDS = 14  # 16^14: down to neighbouring doubles


def may_pass(setup: Setup) -> bool:
    """Whether any joint moves over a body that has a single cut; runs of cuts are searched with what moves."""
    cut = {cuts.body for cuts in setup.cuts if cuts.s is None}
    return any(joint.a in cut and JOINTS[joint.kind].wanders for joint in setup.scene.mechanism.joints)


def passages(recover: Callable[[Array], Recovery], grid: Array) -> Array:
    """The last instants before passages and the first after them, as a grid shows them, ascending."""
    beyond = on_pieces(recover(grid))
    k, j = np.nonzero(np.diff(beyond, axis=0))
    a, b = grid[k], grid[k + 1]
    below = beyond[k, j]
    rows = np.arange(len(k))
    for _ in range(ROUNDS if len(k) else 0):
        at = a[:, None] + (b - a)[:, None] * (np.arange(PARTS + 1) / PARTS)
        at[:, -1] = b
        asked = distinct(at)
        there = on_pieces(recover(asked))[np.searchsorted(asked, at), j[:, None]]
        first = np.argmax(there != below[:, None], axis=1)
        a, b = at[rows, np.maximum(first - 1, 0)], at[rows, first]
        if (b - a <= 2.0 * tolerances.EPS * np.abs(b)).all():
            break
    return np.sort(np.concatenate([a, b]))


def on_pieces(recovery: Recovery) -> Array:
    """1 where a point that moves over a body lies on the piece of a single cut of it, else 0, (n_t, m)."""
    from heuncli.loads.kinetostatics.sections import attachments, on_piece

    actions = [*whole_joint_actions(recovery.joints), *recovery.applied, *coupling_actions(recovery.couplings)]
    columns = [
        on_piece(cuts, a.at)[:, 0]
        for cuts in recovery.setup.cuts
        if cuts.s is None
        for a in attachments(cuts.body, recovery.states, actions)
        if a.at.ndim == 2
    ]
    return np.stack(columns, axis=1) if columns else np.zeros((len(recovery.states.x), 0))
