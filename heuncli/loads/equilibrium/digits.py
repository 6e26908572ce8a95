"""Estimate the error of a rest pose: find neighbouring poses that rounding cannot distinguish from it.

Each is found like the pose itself, by Newton's step from a pose moved by rounding. Others are as far off as rounding of
the sums pushes a soft direction; or as far across the closures as these are left open, which is far near a dead centre;
and, where only bending (a quartic potential) and no stiffness holds a direction, as far along it as the accelerations
are still rounding.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.equilibrium.coordinates import evaluate_at_rest, rounding_displacement
from heuncli.loads.equilibrium.search import RestPose
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import make_rounded_scene
from heuncli.motion.linearisation.indifference import ROUNDED_SCENES, Indifference
from heuncli.results.results import Array, Mask

PERTURBED_POSES = 2  # poses moved by rounding
REACHES = 10.0 ** np.arange(-8.0, -2.0)  # rad, or relative to the size: tried displacements
CUBIC_FACTOR = 3.0  # times Newton's step: distance to the rest pose under a purely cubic force
MAX_ROTATION_RATIO = 10.0  # largest rotation of a motion's direction over its displacement
NEWTON_STEPS = 6  # Newton's steps with the slopes at the pose itself; their error grows with the distance from it


def find_neighbour_poses(
    evaluator: Evaluator, rest_pose: RestPose, indifference: Indifference
) -> tuple[list[Array], Mask]:
    """Return the states (n_state,) of such poses, and which motions (g,) without stiffness are held, or pushed, by
    bending.
    """
    pose, slopes, coordinates = rest_pose.pose, rest_pose.slopes, rest_pose.coordinates
    displacements = np.array([rounding_displacement(coordinates, pose.state, k) for k in range(PERTURBED_POSES)])
    states = coordinates.displace(np.repeat(pose.state[None, :], PERTURBED_POSES, axis=0), displacements)
    perturbed = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    newton_steps = np.array([slopes.newton_step(a) for a in coordinates.accelerations(perturbed)])
    corrected = evaluate_at_rest(evaluator, pose.t, coordinates.displace(perturbed.states, newton_steps), pose.holding)
    sum_states = coordinates.displace(pose.state[None, :], rounding_in_sums(rest_pose)[None, :])
    far_states, bends = find_bending_poses(evaluator, rest_pose, indifference)
    open_states = coordinates.displace(pose.state[None, :], closure_displacement(evaluator, rest_pose)[None, :])
    return [
        *corrected.states,
        *evaluate_at_rest(evaluator, pose.t, sum_states, pose.holding).states,
        *open_states,
        *far_states,
    ], bends


def closure_displacement(evaluator: Evaluator, rest_pose: RestPose) -> Array:
    """Return a displacement (n,) across the closures, each open by its closing tolerance, so that it is largest
    somewhere.
    """
    across = rest_pose.slopes.law.opening_directions
    if not across.size:
        return np.zeros(len(across))
    size = rest_pose.coordinates.weights * np.abs(across).sum(axis=1)
    return np.asarray(tolerances.CLOSED * evaluator.size * (across @ np.sign(across[int(np.argmax(size))])))


def rounding_in_sums(rest_pose: RestPose) -> Array:
    """Return how far all directions together yield to the rounding in the sums of their accelerations, (n,)."""
    slopes = rest_pose.slopes
    push = CUBIC_FACTOR * tolerances.PLACE_ROUNDING / tolerances.SUM_ROUNDING * slopes.sum_rounding
    compliance = np.abs(slopes.directions.solve_compliance(push, slopes.eigenvalue_errors))
    displacement = np.asarray((slopes.T @ (slopes.V @ compliance)).real)
    return displacement / max(1.0, rest_pose.coordinates.max_magnitude(displacement))  # at most a radian, or the size


def find_bending_poses(
    evaluator: Evaluator, rest_pose: RestPose, indifference: Indifference
) -> tuple[list[Array], Mask]:
    """Return the farthest poses along motions without stiffness at which nothing pushes, where something does farther
    out.

    Also returns in which motions (g,) it does: by more than in scenes that rounding cannot distinguish from this one.
    """
    states, shapes = [], indifference.free_motions
    bends = np.zeros(shapes.shape[1], dtype=bool)
    others = (
        [Runner(make_rounded_scene(evaluator.layout, number)) for number in range(ROUNDED_SCENES)] if len(bends) else []
    )
    for k, shape in enumerate(shapes.T):
        size = rest_pose.coordinates.max_magnitude(shape)
        for sign in (1.0, -1.0) if size > 0.0 else ():
            displaced_states, accelerations_there = relax_displaced(
                evaluator, rest_pose, sign * REACHES[:, None] * shape / size
            )
            pushes = [
                project_on_motions(rest_pose, shapes, b)
                for b in (
                    accelerations_there,
                    *(rest_accelerations(other, rest_pose, displaced_states) for other in others),
                )
            ]
            uncertainty = tolerances.HELD * np.abs(np.array(pushes[1:]) - pushes[0]).max(axis=0)
            # the rotation of the motion's direction adds a part of the push along held directions
            rotation_effect = (
                MAX_ROTATION_RATIO
                * REACHES[:, None]
                * (np.abs(accelerations_there) @ np.abs(rest_pose.slopes.law.mass) @ np.abs(shapes))
            )
            significant = np.flatnonzero((np.abs(pushes[0]) > uncertainty + rotation_effect).any(axis=1))
            if len(significant):
                states.append(displaced_states[max(significant[0] - 1, 0)])
                bends[k] = True
    return states, bends


def project_on_motions(rest_pose: RestPose, shapes: Array, accelerations: Array) -> Array:
    """Return the components of accelerations (k, n) along motions (n, g), (k, g)."""
    return np.asarray(accelerations @ rest_pose.slopes.law.mass @ shapes)


def rest_accelerations(evaluator: Evaluator, rest_pose: RestPose, states: Array) -> Array:
    """Return the accelerations of states at rest, (k, n)."""
    return rest_pose.coordinates.accelerations(
        evaluate_at_rest(evaluator, rest_pose.pose.t, states, rest_pose.pose.holding)
    )


def relax_displaced(evaluator: Evaluator, rest_pose: RestPose, displacements: Array) -> tuple[Array, Array]:
    """Displace the pose by (k, n) and let all that is held relax; return the states and their accelerations, (k, n)."""
    pose, slopes, coordinates = rest_pose.pose, rest_pose.slopes, rest_pose.coordinates
    states = coordinates.displace(np.repeat(pose.state[None, :], len(displacements), axis=0), displacements)
    for _ in range(NEWTON_STEPS):
        evaluation = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
        states = coordinates.displace(
            evaluation.states, np.array([slopes.newton_step(a) for a in coordinates.accelerations(evaluation)])
        )
    evaluation = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    return evaluation.states, coordinates.accelerations(evaluation)
