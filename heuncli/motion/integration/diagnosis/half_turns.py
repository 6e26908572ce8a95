"""Explain the end of a run in the global chart of Rodrigues parameters, at a half turn. Imported only for an error.

cos(theta / 2) = w,  2 wdot = -sigma . v        of the quaternion (w, v): the time left until w = 0
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.results.results import Array


def half_turn_error(
    integrated_scene: IntegratedScene, body: int, t: float, state: Array, *, is_unreduced: bool
) -> SolveError:
    """Make the error of a body, by its number in the tree, whose kappa grows without bound in the state at t.

    is_unreduced: the scene is integrated as drawn, without a reduced one in its place
    """
    layout = integrated_scene.layout
    row = layout.tables["bodies"][body]
    q = state[row["attitude_at"] :][:4]
    rate = -0.5 * float(np.dot(state[row["rate_at"] :][:3], q[1:]))
    w = float(q[0])
    time_left = -w / rate if abs(w) > tolerances.ZERO_COMPONENT and w * rate < 0.0 else 0.0  # else it is there already
    name = layout.mechanism.bodies[layout.spanning.links[body].body].name
    where = f"at t = {t + time_left:.9g} s: {name} reaches half a revolution from its start orientation"
    hint = "use DOP853 or DOP853-recentred, which have no such limit"
    if not is_unreduced:
        hint += "; this is the body of the reduced model, --no-reduce integrates the one specified"
    error = SolveError(
        Problem("half-turn", f"{where}, the limit of the global rotation parametrisation", None, hint, f"bodies.{name}")
    )
    error.reached = t + time_left
    return error
