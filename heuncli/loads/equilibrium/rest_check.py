"""Check independently of its search that a reported rest pose is at rest: accelerations are no more than rounding."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest, rounding_displacement
from heuncli.loads.equilibrium.pose import Pose
from heuncli.loads.equilibrium.reasons import no_rest_problem, no_value_problem
from heuncli.loads.equilibrium.slopes import acceleration_rounding, spring_rounding
from heuncli.motion.integration.evaluator import Evaluator

PERTURBED_POSES = 4  # poses moved by rounding
HINT = "start nearer to the rest position, or run a motion with dampers until it comes to rest"


def require_at_rest(evaluator: Evaluator, coordinates: Coordinates, pose: Pose) -> None:
    """Raise SolveError [no-rest-pose] if a coordinate accelerates by more than the rounding of its loads over its mass.

    It must also exceed the difference to poses moved by rounding. Coordinates are relative to what drives turn and
    shift. What a drive turns about several axes at once has accelerations of its own, which belong to the steady state:
    turning bodies on ball joints are not checked there.
    """
    is_checked = np.ones(coordinates.count, dtype=bool)
    if evaluator.layout.has_laws:
        is_checked[:] = False
        is_checked[coordinates.numbers] = True
    terms = acceleration_rounding(evaluator, coordinates, pose) + np.abs(
        spring_rounding(evaluator, coordinates, pose)
    ).sum(axis=1)
    if pose.holding.any():
        # contact forces cancel in the accelerations, too; their size shows with the contacts open
        terms = terms + acceleration_rounding(
            evaluator, coordinates, replace(pose, holding=np.zeros_like(pose.holding))
        )
    displacements = np.array([rounding_displacement(coordinates, pose.state, k) for k in range(PERTURBED_POSES)])
    perturbed_states = coordinates.displace(np.repeat(pose.state[None, :], PERTURBED_POSES, axis=0), displacements)
    perturbed = evaluate_at_rest(evaluator, pose.t, perturbed_states, pose.holding)
    change = coordinates.max_magnitude(
        np.abs(coordinates.accelerations(perturbed) - pose.accelerations).max(axis=0, initial=0.0)
    )
    allowed = tolerances.STARTS_MOVING / tolerances.SUM_ROUNDING * terms
    allowed = allowed + tolerances.PUSHED_BY_ROUNDING * change / coordinates.weights
    if not (np.isfinite(pose.accelerations).all() and np.isfinite(allowed).all()):
        raise SolveError(no_value_problem(coordinates, np.stack([pose.accelerations, allowed])))
    excess = np.abs(pose.accelerations) - allowed
    if (is_checked & (excess > 0.0)).any():
        k = int(np.argmax(np.where(is_checked, excess * coordinates.weights, -np.inf)))
        raise SolveError(no_rest_problem(f"the search ended where {describe_acceleration(coordinates, pose, k)}", HINT))


def describe_acceleration(coordinates: Coordinates, pose: Pose, number: int) -> str:
    """Describe a coordinate that accelerates, and by how much: relative to its parent, where drives move that."""
    name, is_turn = coordinates.find_owner(number)
    unit = "rad/s\u00b2" if is_turn else "m/s\u00b2"
    return f"{name} still accelerates by {abs(float(pose.accelerations[number])):.3g} {unit}"
