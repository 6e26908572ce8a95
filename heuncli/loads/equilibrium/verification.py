"""Verify an equilibrium by searching for it again, ten times finer, until two searches agree.

`RestSearch` relaxes the mechanism along a heavily damped motion, so its end point carries the error of the path. Where
nothing is indifferent, two searches end in the same pose to its digits, or elsewhere. Along an indifferent direction
(zero stiffness), two searches whose tolerances differ by ten end at points whose distance is the error of the coarser
one, which bounds that of the finer one. By accident both may err alike (in one scene of some thousands), so a third
search is made there, and a tenth of the distance of the first two counts, too. Two searches that end in different
equilibria pass a ridge between them. If the finest two still do, the path depends on less than they resolve, and both
are reported.

The error of a rest pose is the distance of neighbouring poses that rounding cannot distinguish from it. Each is found
like the pose itself, by Newton's step from a pose moved by rounding. Others are as far off as rounding of
the sums pushes a soft direction; or as far across the closures as these are left open, which is far near a dead centre;
and, where only bending (a quartic potential) and no stiffness holds a direction, as far along it as the accelerations
are still rounding.

A reported pose is checked independently of its search: accelerations are no more than rounding.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest, make_rounding_displacement
from heuncli.loads.equilibrium.pose import Pose, make_no_rest_problem, make_no_value_problem
from heuncli.loads.equilibrium.rest_law import estimate_acceleration_rounding, estimate_spring_rounding
from heuncli.loads.equilibrium.search import RestPose, RestSearch
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import make_rounded_scene
from heuncli.motion.linearisation.indifference import ROUNDED_SCENES, Indifference
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Mask

# Verification

# rad, or relative to the size: distances from a path at which others are tried
PERTURBATIONS = 10.0 ** np.arange(-7.0, -1.0)
MAX_SEARCHES = 4  # each ten times finer than the one before
MIN_INDIFFERENT_SEARCHES = 2  # additional ones, where a direction is indifferent


@record
class VerifiedPose:
    """The equilibrium of the finest search.

    displacement (n,): its estimated error, in the direction of the end of the search before
    alternative: another equilibrium to which the same start may lead, or None
    steps, evaluations: totals over all searches
    """

    equilibrium: RestPose
    displacement: Array
    alternative: RestPose | None
    steps: int
    evaluations: int


def find_verified_pose(scene: PreparedScene, evaluator: Evaluator, t: float) -> VerifiedPose:
    """Find the rest pose that the start leads to. Raises SolveError [no-rest-pose]."""
    all_found: list[RestPose] = []
    displacements: list[Array] = []
    for number in range(MAX_SEARCHES):
        tolerance = tolerances.REST_BENT * tolerances.REST_FINER**number
        new = RestSearch(scene, evaluator, t, tolerance).find()
        all_found.append(new)
        if new.steps == 0:
            return make_verified_pose(all_found, np.zeros(new.coordinates.count), None)
        if number == 0:
            continue
        displacements.append(new.coordinates.find_displacement(new.pose.state, all_found[-2].pose.state))
        stiff_part, indifferent_part = split_displacement(new, displacements[-1])
        agrees, distance = (
            is_same_pose(new, stiff_part, indifferent_part),
            new.coordinates.max_magnitude(indifferent_part),
        )
        has_enough_searches = number >= MIN_INDIFFERENT_SEARCHES or not has_indifferent_direction(new)
        if agrees and has_enough_searches and is_certain(new) and distance <= tolerances.REST_WAY:
            break
    alternative = None if agrees else all_found[-2]
    if alternative is None and not is_certain(new):
        alternative = find_alternative_pose(scene, evaluator, t, new)
    return make_verified_pose(
        all_found, estimate_error(new, displacements) if agrees else np.zeros(len(displacements[-1])), alternative
    )


def estimate_error(last: RestPose, displacements: list[Array]) -> Array:
    """Estimate the error of the last search, (n,): the distance to the one before, or a share of the distance before
    that.
    """
    shares = [
        displacement * tolerances.REST_FINER**steps_back
        for steps_back, displacement in enumerate(reversed(displacements[-2:]))
    ]
    return max(shares, key=last.coordinates.max_magnitude)


def perturb_states(evaluator: Evaluator, rest_pose: RestPose, displacement: Array) -> tuple[Array, ...]:
    """Return the states displaced by (n,) towards another search's pose, in both directions, with what is held at rest
    there.
    """
    if not displacement.any():
        return ()
    pose, coordinates = rest_pose.pose, rest_pose.coordinates
    states = coordinates.displace(np.repeat(pose.state[None, :], 2, axis=0), np.array([displacement, -displacement]))
    perturbed = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    newton_steps = np.array([rest_pose.law.newton_step(a) for a in coordinates.accelerations(perturbed)])
    return tuple(
        evaluate_at_rest(evaluator, pose.t, coordinates.displace(perturbed.states, newton_steps), pose.holding).states
    )


def is_certain(rest_pose: RestPose) -> bool:
    """Return whether the path stayed farther from ridges than its error; an unstable pose is on a ridge itself."""
    values, eigenvalue_errors = rest_pose.law.eigenvalues, rest_pose.law.eigenvalue_errors
    return bool(rest_pose.doubt <= tolerances.REST_DOUBT or (values.real > eigenvalue_errors).any())


def find_alternative_pose(scene: PreparedScene, evaluator: Evaluator, t: float, rest_pose: RestPose) -> RestPose | None:
    """Search again from both sides of the point where the path was slowest.

    Returns the first rest pose that differs from the one found, or None if all searches return to it.
    """
    deviation, size = rest_pose.slowest.deviation, rest_pose.coordinates.max_magnitude(rest_pose.slowest.deviation)
    for distance in PERTURBATIONS if size > 0.0 else ():
        for sign in (1.0, -1.0):
            start = rest_pose.coordinates.displace(
                rest_pose.slowest.state[None, :], sign * distance / size * deviation[None, :]
            )[0]
            try:
                other = RestSearch(scene, evaluator, t, tolerances.REST_BENT, start).find()
            except SolveError:
                continue
            displacement = rest_pose.coordinates.find_displacement(rest_pose.pose.state, other.pose.state)
            if not is_same_pose(rest_pose, *split_displacement(rest_pose, displacement)):
                return other
    return None


def make_verified_pose(all_found: list[RestPose], displacement: Array, alternative: RestPose | None) -> VerifiedPose:
    """Combine the result of the last search with the totals of all."""
    steps, evaluations = sum(found.steps for found in all_found), sum(found.evaluations for found in all_found)
    return VerifiedPose(all_found[-1], displacement, alternative, steps, evaluations)


def split_displacement(rest_pose: RestPose, displacement: Array) -> tuple[Array, Array]:
    """Split a displacement (n,) from a rest pose into its parts along stiff and along indifferent directions.

    Massless spins are in neither.
    """
    law = rest_pose.law
    z, is_massless = law.inverse @ (law.T_inverse @ displacement), np.isinf(law.eigenvalue_errors)
    indifferent_part, massless_part = (
        (law.T @ (law.V @ np.where(is_selected, z, 0.0))).real
        for is_selected in (~law.is_decided & ~is_massless, is_massless)
    )
    return displacement - indifferent_part - massless_part, indifferent_part


def has_indifferent_direction(rest_pose: RestPose) -> bool:
    """Return whether a direction is indifferent, massless spins aside."""
    return bool((~rest_pose.law.is_decided & ~np.isinf(rest_pose.law.eigenvalue_errors)).any())


def is_same_pose(rest_pose: RestPose, stiff_part: Array, indifferent_part: Array) -> bool:
    """Return whether two searches ended in one pose, or close to each other along indifferent directions."""
    law, size = rest_pose.law, rest_pose.coordinates.max_magnitude
    compliance = np.abs(law.directions.solve_compliance(law.noise, law.eigenvalue_errors))
    soft_size = size(np.abs(law.T) @ (np.abs(law.V) @ compliance))
    indifferent_size = size(indifferent_part)
    # poses that differ along indifferent directions differ in the others by their curvature at most
    return (
        size(stiff_part) <= max(tolerances.REST_SAME, soft_size, indifferent_size)
        and indifferent_size <= tolerances.REST_SEARCHES_DIFFER
    )


# Error of the pose

PERTURBED_POSES = 2  # poses moved by rounding
REACHES = 10.0 ** np.arange(-8.0, -2.0)  # rad, or relative to the size: tried displacements
CUBIC_FACTOR = 3.0  # times Newton's step: distance to the rest pose under a purely cubic force
MAX_ROTATION_RATIO = 10.0  # largest rotation of a motion's direction over its displacement
NEWTON_STEPS = 6  # Newton's steps with the law at the pose itself; their error grows with the distance from it


def find_indistinguishable_states(
    evaluator: Evaluator, rest_pose: RestPose, indifference: Indifference
) -> tuple[list[Array], Mask]:
    """Return the states (n_state,) of such poses, and which motions (g,) without stiffness are held, or pushed, by
    bending.
    """
    pose, law, coordinates = rest_pose.pose, rest_pose.law, rest_pose.coordinates
    displacements = np.array([make_rounding_displacement(coordinates, pose.state, k) for k in range(PERTURBED_POSES)])
    states = coordinates.displace(np.repeat(pose.state[None, :], PERTURBED_POSES, axis=0), displacements)
    perturbed = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    newton_steps = np.array([law.newton_step(a) for a in coordinates.accelerations(perturbed)])
    corrected = evaluate_at_rest(evaluator, pose.t, coordinates.displace(perturbed.states, newton_steps), pose.holding)
    sum_states = coordinates.displace(pose.state[None, :], find_sum_displacement(rest_pose)[None, :])
    far_states, bends = find_bending_poses(evaluator, rest_pose, indifference)
    open_states = coordinates.displace(pose.state[None, :], find_closure_displacement(evaluator, rest_pose)[None, :])
    return [
        *corrected.states,
        *evaluate_at_rest(evaluator, pose.t, sum_states, pose.holding).states,
        *open_states,
        *far_states,
    ], bends


def find_closure_displacement(evaluator: Evaluator, rest_pose: RestPose) -> Array:
    """Return a displacement (n,) across the closures, each open by its closing tolerance, so that it is largest
    somewhere.
    """
    across = rest_pose.law.equations.opening_directions
    if not across.size:
        return np.zeros(len(across))
    size = rest_pose.coordinates.weights * np.abs(across).sum(axis=1)
    return np.asarray(tolerances.CLOSED * evaluator.size * (across @ np.sign(across[int(np.argmax(size))])))


def find_sum_displacement(rest_pose: RestPose) -> Array:
    """Return how far all directions together yield to the rounding in the sums of their accelerations, (n,)."""
    law = rest_pose.law
    push = CUBIC_FACTOR * tolerances.PLACE_ROUNDING / tolerances.SUM_ROUNDING * law.sum_rounding
    compliance = np.abs(law.directions.solve_compliance(push, law.eigenvalue_errors))
    displacement = np.asarray((law.T @ (law.V @ compliance)).real)
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
                    *(evaluate_rest_accelerations(other, rest_pose, displaced_states) for other in others),
                )
            ]
            uncertainty = tolerances.REAL_STIFFNESS_FACTOR * np.abs(np.array(pushes[1:]) - pushes[0]).max(axis=0)
            # the rotation of the motion's direction adds a part of the push along held directions
            rotation_effect = (
                MAX_ROTATION_RATIO
                * REACHES[:, None]
                * (np.abs(accelerations_there) @ np.abs(rest_pose.law.equations.mass) @ np.abs(shapes))
            )
            significant = np.flatnonzero((np.abs(pushes[0]) > uncertainty + rotation_effect).any(axis=1))
            if len(significant):
                states.append(displaced_states[max(significant[0] - 1, 0)])
                bends[k] = True
    return states, bends


def project_on_motions(rest_pose: RestPose, shapes: Array, accelerations: Array) -> Array:
    """Return the components of accelerations (k, n) along motions (n, g), (k, g)."""
    return np.asarray(accelerations @ rest_pose.law.equations.mass @ shapes)


def evaluate_rest_accelerations(evaluator: Evaluator, rest_pose: RestPose, states: Array) -> Array:
    """Return the accelerations of states at rest, (k, n)."""
    return rest_pose.coordinates.accelerations(
        evaluate_at_rest(evaluator, rest_pose.pose.t, states, rest_pose.pose.holding)
    )


def relax_displaced(evaluator: Evaluator, rest_pose: RestPose, displacements: Array) -> tuple[Array, Array]:
    """Displace the pose by (k, n) and let all that is held relax; return the states and their accelerations, (k, n)."""
    pose, law, coordinates = rest_pose.pose, rest_pose.law, rest_pose.coordinates
    states = coordinates.displace(np.repeat(pose.state[None, :], len(displacements), axis=0), displacements)
    for _ in range(NEWTON_STEPS):
        evaluation = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
        states = coordinates.displace(
            evaluation.states, np.array([law.newton_step(a) for a in coordinates.accelerations(evaluation)])
        )
    evaluation = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    return evaluation.states, coordinates.accelerations(evaluation)


# Rest check

CHECKED_POSES = 4  # poses moved by rounding
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
    terms = estimate_acceleration_rounding(evaluator, coordinates, pose) + np.abs(
        estimate_spring_rounding(evaluator, coordinates, pose)
    ).sum(axis=1)
    if pose.holding.any():
        # contact forces cancel in the accelerations, too; their size shows with the contacts open
        terms = terms + estimate_acceleration_rounding(
            evaluator, coordinates, replace(pose, holding=np.zeros_like(pose.holding))
        )
    displacements = np.array([make_rounding_displacement(coordinates, pose.state, k) for k in range(CHECKED_POSES)])
    perturbed_states = coordinates.displace(np.repeat(pose.state[None, :], CHECKED_POSES, axis=0), displacements)
    perturbed = evaluate_at_rest(evaluator, pose.t, perturbed_states, pose.holding)
    change = coordinates.max_magnitude(
        np.abs(coordinates.accelerations(perturbed) - pose.accelerations).max(axis=0, initial=0.0)
    )
    allowed = tolerances.STARTS_MOVING / tolerances.SUM_ROUNDING * terms
    allowed = allowed + tolerances.PUSHED_BY_ROUNDING * change / coordinates.weights
    if not (np.isfinite(pose.accelerations).all() and np.isfinite(allowed).all()):
        raise SolveError(make_no_value_problem(coordinates, np.stack([pose.accelerations, allowed])))
    excess = np.abs(pose.accelerations) - allowed
    if (is_checked & (excess > 0.0)).any():
        k = int(np.argmax(np.where(is_checked, excess * coordinates.weights, -np.inf)))
        raise SolveError(
            make_no_rest_problem(f"the search ended where {describe_acceleration(coordinates, pose, k)}", HINT)
        )


def describe_acceleration(coordinates: Coordinates, pose: Pose, number: int) -> str:
    """Describe a coordinate that accelerates, and by how much: relative to its parent, where drives move that."""
    name, is_turn = coordinates.find_owner(number)
    unit = "rad/s\u00b2" if is_turn else "m/s\u00b2"
    return f"{name} still accelerates by {abs(float(pose.accelerations[number])):.3g} {unit}"
