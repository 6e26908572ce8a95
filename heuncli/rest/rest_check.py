"""Whether what is told as a rest pose is one, whatever its search made of it: nothing accelerates beyond rounding."""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import SolveError
from heuncli.integration.evaluator import Evaluator
from heuncli.kinetostatics.bodies import body_states
from heuncli.records import replace
from heuncli.rest.coordinates import Coordinates, resting, rounding_of
from heuncli.rest.pose import Pose
from heuncli.rest.reasons import no_rest
from heuncli.rest.slopes import of_springs, rounding
from heuncli.results import Array

BESIDE = 4  # poses moved by rounding
HINT = "please report it with the spec; start nearer to the pose, or run a motion with dampers"


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
    if (looked_at & ~(np.abs(at.accelerations) <= small)).any():
        raise SolveError(no_rest(f"the search ended where {fastest(evaluator, at)}", HINT))


def fastest(evaluator: Evaluator, at: Pose) -> str:
    """The body that accelerates most, and by how much."""
    layout = evaluator.layout
    states = body_states(layout, at.recovered)
    shift, turn = (np.sqrt(np.sum(a[0] ** 2, axis=1)) for a in (states.a_centre, states.alpha))
    k = int(np.argmax(np.maximum(shift, turn * evaluator.size)))
    how: Array = shift if shift[k] > 0.0 else turn
    unit = "m/s\u00b2" if shift[k] > 0.0 else "rad/s\u00b2"
    return f"bodies.{layout.mechanism.bodies[k].name} still accelerates by {how[k]:.3g} {unit}"
