"""The end of a run in the global chart of Rodrigues' numbers, at a half turn. Imported only for an error.

cos(theta / 2) = w,  2 wdot = -sigma . v        of the quaternion (w, v): so long is the last way to w = 0
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.results.results import Array


def half_turn(moving: IntegratedScene, body: int, t: float, state: Array, *, itself: bool) -> SolveError:
    """The error of a body, by its place in the tree, whose kappa grows without bound in the state at t.

    itself: the scene is integrated as it is drawn, and no smaller one in its place.
    """
    layout = moving.layout
    row = layout.tables["bodies"][body]
    q = state[row["attitude_at"] :][:4]
    rate = -0.5 * float(np.dot(state[row["rate_at"] :][:3], q[1:]))
    w = float(q[0])
    left = -w / rate if abs(w) > tolerances.ZERO_COMPONENT and w * rate < 0.0 else 0.0  # else it is there already
    name = layout.mechanism.bodies[layout.spanning.hangs[body].body].name
    where = f"at t = {t + left:.9g} s: {name} comes to a half turn from its drawn attitude"
    hint = "DOP853 and DOP853-recentred have no such place"
    if not itself:
        hint += "; it is the body as it is integrated, with --no-reduce the one drawn"
    error = SolveError(Problem("half-turn", f"{where}: there the global chart ends", None, hint, f"bodies.{name}"))
    error.reached = t + left
    return error
