"""Verify an equilibrium by searching for it again, ten times finer, until two searches agree.

`RestSearch` relaxes the mechanism along a heavily damped motion, so its end point carries the error of the path. Where
nothing is indifferent, two searches end in the same pose to its digits, or elsewhere. Along an indifferent direction
(zero stiffness), two searches whose tolerances differ by ten end at points whose distance is the error of the coarser
one, which bounds that of the finer one. By accident both may err alike (in one scene of some thousands), so a third
search is made there, and a tenth of the distance of the first two counts, too. Two searches that end in different
equilibria pass a ridge between them. If the finest two still do, the path depends on less than they resolve, and both
are reported.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.records import record
from heuncli.loads.equilibrium.coordinates import evaluate_at_rest
from heuncli.loads.equilibrium.search import RestPose, RestSearch
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

# rad, or relative to the size: distances from a path at which others are tried
PERTURBATIONS = 10.0 ** np.arange(-7.0, -1.0)
MAX_SEARCHES = 4  # each ten times finer than the one before
MIN_INDIFFERENT_SEARCHES = 2  # additional ones, where a direction is indifferent


@record
class VerifiedPose:
    """The equilibrium of the finest search.

    displacement (n,): to the end of the search before
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
        alternative = find_neighbour_pose(scene, evaluator, t, new)
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


def perturbed_states(evaluator: Evaluator, rest_pose: RestPose, displacement: Array) -> tuple[Array, ...]:
    """Return the states displaced by (n,) towards another search's pose, in both directions, with what is held at rest
    there.
    """
    if not displacement.any():
        return ()
    pose, coordinates = rest_pose.pose, rest_pose.coordinates
    states = coordinates.displace(np.repeat(pose.state[None, :], 2, axis=0), np.array([displacement, -displacement]))
    perturbed = evaluate_at_rest(evaluator, pose.t, states, pose.holding)
    newton_steps = np.array([rest_pose.slopes.newton_step(a) for a in coordinates.accelerations(perturbed)])
    return tuple(
        evaluate_at_rest(evaluator, pose.t, coordinates.displace(perturbed.states, newton_steps), pose.holding).states
    )


def is_certain(rest_pose: RestPose) -> bool:
    """Return whether the path stayed farther from ridges than its error; an unstable pose is on a ridge itself."""
    values, eigenvalue_errors = rest_pose.slopes.eigenvalues, rest_pose.slopes.eigenvalue_errors
    return bool(rest_pose.doubt <= tolerances.REST_DOUBT or (values.real > eigenvalue_errors).any())


def find_neighbour_pose(scene: PreparedScene, evaluator: Evaluator, t: float, rest_pose: RestPose) -> RestPose | None:
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
    slopes = rest_pose.slopes
    z, is_massless = slopes.inverse @ (slopes.T_inverse @ displacement), np.isinf(slopes.eigenvalue_errors)
    indifferent_part, massless_part = (
        (slopes.T @ (slopes.V @ np.where(is_selected, z, 0.0))).real
        for is_selected in (~slopes.is_decided & ~is_massless, is_massless)
    )
    return displacement - indifferent_part - massless_part, indifferent_part


def has_indifferent_direction(rest_pose: RestPose) -> bool:
    """Return whether a direction is indifferent, massless spins aside."""
    return bool((~rest_pose.slopes.is_decided & ~np.isinf(rest_pose.slopes.eigenvalue_errors)).any())


def is_same_pose(rest_pose: RestPose, stiff_part: Array, indifferent_part: Array) -> bool:
    """Return whether two searches ended in one pose, or close to each other along indifferent directions."""
    slopes, size = rest_pose.slopes, rest_pose.coordinates.max_magnitude
    compliance = np.abs(slopes.directions.solve_compliance(slopes.noise, slopes.eigenvalue_errors))
    soft_size = size(np.abs(slopes.T) @ (np.abs(slopes.V) @ compliance))
    indifferent_size = size(indifferent_part)
    # poses that differ along indifferent directions differ in the others by their curvature at most
    return (
        size(stiff_part) <= max(tolerances.REST_SAME, soft_size, indifferent_size)
        and indifferent_size <= tolerances.REST_SEARCHES_DIFFER
    )
