"""How many freedoms poses have where wheels roll: their speeds are held, and their poses are not."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.response import jacobian
from heuncli.multibody.tree.held_speeds import holds_speed


def freedoms_of_pose(evaluator: Evaluator) -> int:
    """Those of the tree less the rank of the rows that hold poses, at the start."""
    layout = evaluator.layout
    rank = 0
    for island in layout.islands:
        rows = island.rows[~holds_speed(layout)[island.rows]]
        J = jacobian(evaluator.workspace, layout, np.zeros(1), layout.y0[None, :]).block(rows, island.freedoms)[0]
        J = J * layout.tables["closures"]["measure"][rows][:, None] * layout.measure[island.freedoms]
        rank += int(np.linalg.matrix_rank(J, tol=tolerances.RANK)) if J.size else 0
    return layout.tree_freedoms - rank
