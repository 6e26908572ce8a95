"""Find the instants at which a joint whose point moves over a body passes a cut of it: there the cut's loads jump."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.actions import list_whole_joint_actions
from heuncli.loads.kinetostatics.couplings import list_coupling_actions
from heuncli.results.results import Array
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.search.extremes import sort_distinct

PARTS = 16  # into which a span with a passage is divided
ROUNDS = 14  # 16^14: down to neighbouring doubles


def has_moving_joints(setup: Setup) -> bool:
    """Whether any joint moves over a body that has a single cut; series of cuts are searched with the moving joint."""
    cut = {cuts.body for cuts in setup.cuts if cuts.s is None}
    return any(joint.a in cut and JOINTS[joint.kind].has_moving_contact for joint in setup.scene.mechanism.joints)


def find_passages(recover: Callable[[Array], Recovery], grid: Array) -> Array:
    """Return the last instants before passages and the first after them, as far as a grid shows them, ascending."""
    is_on_piece = find_points_on_pieces(recover(grid))
    k, j = np.nonzero(np.diff(is_on_piece, axis=0))
    a, b = grid[k], grid[k + 1]
    before_passage = is_on_piece[k, j]
    rows = np.arange(len(k))
    for _ in range(ROUNDS if len(k) else 0):
        probes = a[:, None] + (b - a)[:, None] * (np.arange(PARTS + 1) / PARTS)
        probes[:, -1] = b
        instants = sort_distinct(probes)
        probe_values = find_points_on_pieces(recover(instants))[np.searchsorted(instants, probes), j[:, None]]
        first = np.argmax(probe_values != before_passage[:, None], axis=1)
        a, b = probes[rows, np.maximum(first - 1, 0)], probes[rows, first]
        if (b - a <= 2.0 * tolerances.EPS * np.abs(b)).all():
            break
    return np.sort(np.concatenate([a, b]))


def find_points_on_pieces(recovery: Recovery) -> Array:
    """Return 1 where a point that moves over a body lies on the piece of a single cut of it, else 0, (n_t, m)."""
    from heuncli.loads.kinetostatics.sections import find_attachments, mark_points_on_pieces

    actions = [
        *list_whole_joint_actions(recovery.joints),
        *recovery.applied_actions,
        *list_coupling_actions(recovery.couplings),
    ]
    columns = [
        mark_points_on_pieces(cuts, a.point)[:, 0]
        for cuts in recovery.setup.cuts
        if cuts.s is None
        for a in find_attachments(cuts.body, recovery.states, actions)
        if a.point.ndim == 2
    ]
    return np.stack(columns, axis=1) if columns else np.zeros((len(recovery.states.x), 0))
