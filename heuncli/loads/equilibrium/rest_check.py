"""Whether what is told as a rest pose is one, whatever its search made of it: nothing accelerates beyond rounding."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.loads.equilibrium.coordinates import Coordinates, resting, rounding_of
from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.equilibrium.reasons import no_rest, no_value
from heuncli.loads.equilibrium.slopes import of_springs, rounding
from heuncli.motion.integration.evaluator import Evaluator

BESIDE = 4  # poses moved by rounding
HINT = "start nearer to the pose, or run a motion with dampers, which comes to rest there"


def require_still(evaluator: Evaluator, coordinates: Coordinates, at: Pose) -> None:
    """Raise SolveError [no-rest-pose] where a coordinate accelerates by more than rounding of its loads over its mass.

    By more, too, than poses moved by rounding differ. Coordinates count from what drives turn and shift; what a drive
    turns about several axes at once has accelerations of its own, which are the steady state's: turning bodies on balls
    are not looked at there.
    """
    looked_at = np.ones(coordinates.count, dtype=bool)
    if evaluator.layout.driven:
        looked_at[:] = False
        looked_at[coordinates.numbers] = True
    terms = rounding(evaluator, coordinates, at) + np.abs(of_springs(evaluator, coordinates, at)).sum(axis=1)
    if at.holding.any():
        # what closed contacts carry cancels in the accelerations, too: it is seen where they let go
        terms = terms + rounding(evaluator, coordinates, replace(at, holding=np.zeros_like(at.holding)))
    by = np.array([rounding_of(coordinates, at.state, k) for k in range(BESIDE)])
    beside = coordinates.displaced(np.repeat(at.state[None, :], BESIDE, axis=0), by)
    moved = resting(evaluator, at.t, beside, at.holding)
    change = coordinates.size(np.abs(coordinates.accelerations(moved) - at.accelerations).max(axis=0, initial=0.0))
    small = tolerances.SET_GOING / tolerances.SUM_ROUNDING * terms
    small = small + tolerances.PUSHED_BY_ROUNDING * change / coordinates.weights
    if not (np.isfinite(at.accelerations).all() and np.isfinite(small).all()):
        raise SolveError(no_value(coordinates, np.stack([at.accelerations, small])))
    beyond = np.abs(at.accelerations) - small
    if (looked_at & (beyond > 0.0)).any():
        k = int(np.argmax(np.where(looked_at, beyond * coordinates.weights, -np.inf)))
        raise SolveError(no_rest(f"the search ended where {acceleration_of(coordinates, at, k)}", HINT))


def acceleration_of(coordinates: Coordinates, at: Pose, number: int) -> str:
    """A coordinate that accelerates, and by how much: against what carries it, where drives move that."""
    name, is_turn = coordinates.owner(number)
    unit = "rad/s\u00b2" if is_turn else "m/s\u00b2"
    return f"{name} still accelerates by {abs(float(at.accelerations[number])):.3g} {unit}"
