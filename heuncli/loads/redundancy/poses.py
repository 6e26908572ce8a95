"""Count the freedoms of poses where wheels roll: these constrain speeds, but not poses."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.response import jacobian
from heuncli.multibody.tree.layout import find_speed_rows


def count_pose_freedoms(evaluator: Evaluator) -> int:
    """Return the freedoms of the tree minus the rank of the rows that constrain poses, at the start."""
    layout = evaluator.layout
    rank = 0
    for island in layout.islands:
        rows = island.rows[~find_speed_rows(layout)[island.rows]]
        J = jacobian(evaluator.workspace, layout, np.zeros(1), layout.y0[None, :]).block(rows, island.freedoms)[0]
        J = J * layout.tables["closures"]["measure"][rows][:, None] * layout.measure[island.freedoms]
        rank += int(np.linalg.matrix_rank(J, tol=tolerances.RANK)) if J.size else 0
    return layout.tree_freedoms - rank
