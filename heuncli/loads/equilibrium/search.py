"""Search for the rest pose that a heavily damped motion from the start reaches.

    dq/ds = a(q, rates 0)

is that motion: damped in proportion to its mass, a scene moves arbitrarily slowly along the accelerations it would have
at rest. A step follows the linear law about its pose exactly (rest_law.py), stiff directions to their end and soft ones
as far as s goes, with a third-order correction; it is accepted if the correction is a small part of it, else a shorter
one is tried. Where all directions are near their end, s grows without bound, and the step is
Newton's. An unstable direction that nothing pushes stays as it is, as in that motion. Contacts close where their gap
closes, and open where they would pull. A finer search shows how far a search can be trusted (verification.py).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.loads.equilibrium.coordinates import Coordinates, find_coupled_pairs, make_coordinates
from heuncli.loads.equilibrium.pose import (
    Pose,
    count_dependent_rows,
    find_contact_force,
    find_contact_opening,
    make_bearing_pose,
    make_endless_search_problem,
    make_jumping_load_problem,
    make_pose,
    make_runaway_problem,
    make_singular_pose_problem,
)
from heuncli.loads.equilibrium.rest_law import (
    EVALUATIONS_OF_LAW,
    RestLaw,
    RosenbrockStep,
    make_rest_law,
    make_uncorrected_step,
    separate_indifferent,
)
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates as joint_coordinates
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.linearisation.indifference import find_indifference
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

MAX_STEPS = 2_000
MAX_GROWTH, MIN_GROWTH = 10.0, 0.2  # limits of the growth of s from step to step
RETRY_FACTOR = 0.5
SAFETY = 0.9  # times the step whose correction would just be allowed
MIN_ERROR = 1e-9  # relative: of a step, smaller ones count as that
MAX_TRIES = 60  # of one step
MAX_STANDING_STEPS = 20  # in a row that move by rounding only, at a singular position
MAX_CLOSURE_STEPS = 8  # of a displaced pose; each must reduce the miss to a tenth, or the step is too long
HALVINGS = 60  # of a step, to find where in it a contact closes or opens
CONTACT_SAMPLES = (0.25, 0.5, 0.75, 1.0)  # fractions of a step at which contacts are checked


@record
class RestPose:
    """A rest pose, with the linear law about it, and the cost of the search.

    doubt: how far the path may have deviated [rad, or relative to the size]
    slowest: the slowest point of the path before the deviation began to grow
    """

    pose: Pose
    law: RestLaw
    coordinates: Coordinates
    steps: int
    evaluations: int
    doubt: float
    slowest: SlowestPoint


@record
class SlowestPoint:
    """The slowest point of a path before it may deviate: its state (n_state,), and the possible deviation, (n,)."""

    state: Array
    deviation: Array
    push: float


class RestSearch:
    """A running search. Changes with every step."""

    def __init__(
        self, scene: PreparedScene, evaluator: Evaluator, t: float, tolerance: float, start: Array | None = None
    ) -> None:
        """tolerance: part of a step that the linear law may miss
        start (n_state,): used instead of the layout's
        """
        self.scene, self.evaluator, self.t, self.tolerance = scene, evaluator, t, tolerance
        self.coordinates = make_coordinates(evaluator.layout)
        self.coupled_pairs = find_coupled_pairs(evaluator.layout, self.coordinates.freedoms, self.coordinates.numbers)
        self.start = evaluator.layout.y0 if start is None else start
        self.deviation = np.zeros(self.coordinates.count)
        self.slowest = SlowestPoint(self.start, self.deviation, np.inf)
        self.doubt = self.relative_delay = 0.0
        self.total_displacement = np.zeros(self.coordinates.count)
        self.steps = self.evaluations = self.standing_steps = 0
        self.step_size = self.largest_terms = 0.0

    def find(self) -> RestPose:
        """Find the rest pose. Raises SolveError [no-rest-pose]."""
        current = self.start_pose()
        while True:
            law = make_rest_law(self.evaluator, self.coordinates, current)
            self.evaluations += EVALUATIONS_OF_LAW
            if not law.significant_c.any():
                self.require_held(current, law)
                pose, law = self.polish(current, law)
                cost = self.steps, self.evaluations
                return RestPose(pose, law, self.coordinates, *cost, self.doubt, self.slowest)
            self.require_bounded(current, law)
            current = self.advance(current, law)
            self.steps += 1

    def start_pose(self) -> Pose:
        """Return the start, at rest."""
        return make_bearing_pose(self.evaluator, self.coordinates, self.t, self.start)

    def require_held(self, pose: Pose, law: RestLaw) -> None:
        """Raise SolveError [no-rest-pose] if the remaining acceleration is no rounding: a load jumps just there."""
        terms = law.sum_rounding / tolerances.SUM_ROUNDING
        self.largest_terms = max(self.largest_terms, float(terms.max(initial=0.0)))
        remaining = np.where(np.abs(law.c) > tolerances.NOT_HELD**2 * self.largest_terms, np.abs(law.c), 0.0)
        allowed = tolerances.NOT_HELD * terms + law.pose_rounding
        is_driven = np.where((remaining > allowed) & (law.nonlinearity > 0.5 * remaining), remaining, 0.0)
        if is_driven.any():
            shape = (law.T @ law.V[:, int(np.argmax(is_driven))]).real
            raise SolveError(self.find_singularity(pose) or make_jumping_load_problem(self.coordinates, pose, shape))

    def require_bounded(self, pose: Pose, law: RestLaw) -> None:
        """Raise SolveError where something runs away, stands still at a singular position, or the steps are used up."""
        self.largest_terms = max(self.largest_terms, float(law.sum_rounding.max(initial=0.0)) / tolerances.SUM_ROUNDING)
        distances = np.abs(self.total_displacement) * self.coordinates.weights
        limit = np.where(self.coordinates.shifts, tolerances.RUN_AWAY, tolerances.TURNS_ON)
        relative_distances = self.coupled_pairs.take_minimum(distances / limit)
        if (relative_distances > 1.0).any():
            raise SolveError(make_runaway_problem(self.coordinates, self.total_displacement, relative_distances))
        if self.standing_steps >= MAX_STANDING_STEPS and (problem := self.find_singularity(pose)):
            raise SolveError(problem)
        if self.steps >= MAX_STEPS * np.sqrt(tolerances.REST_BENT / self.tolerance):
            raise SolveError(
                self.find_singularity(pose) or make_endless_search_problem(self.coordinates, pose, self.steps)
            )

    def advance(self, pose: Pose, law: RestLaw) -> Pose:
        """Take one step, as long as its correction allows. Raises SolveError [no-rest-pose] if none does."""
        if self.step_size == 0.0:
            first = self.coordinates.max_magnitude(law.T @ (law.V @ law.significant_c).real)
            self.step_size = tolerances.REST_FIRST / first if first > 0.0 else 1.0
        for _ in range(MAX_TRIES):
            step = make_uncorrected_step(law, self.step_size)
            displacement = step.displacement_at(self.step_size)
            if not np.isfinite(displacement).all():
                self.step_size *= RETRY_FACTOR
                continue
            size = self.coordinates.max_magnitude(displacement)
            step, new_pose = self.correct(pose, step, displacement)
            correction_size = (
                self.coordinates.max_magnitude(step.correction_at(self.step_size)) if new_pose is not None else np.inf
            )
            allowed = tolerances.REST_STRAIGHT if size > tolerances.REST_FARTHEST else self.tolerance
            if correction_size > allowed * size or new_pose is None:
                shorter = (
                    np.sqrt(self.tolerance * size / correction_size) if np.isfinite(correction_size) else RETRY_FACTOR
                )
                self.step_size *= float(np.clip(SAFETY * shorter, MIN_GROWTH, SAFETY))
                continue
            return self.accept(pose, step, new_pose, correction_size / size if size > 0.0 else 0.0)
        raise SolveError(self.find_singularity(pose) or make_endless_search_problem(self.coordinates, pose, self.steps))

    def correct(self, pose: Pose, step: RosenbrockStep, displacement: Array) -> tuple[RosenbrockStep, Pose | None]:
        """Return the step with its third-order correction, and the pose at its end, or None where it cannot be
        closed.
        """
        uncorrected = self.close(pose, step, displacement)
        if uncorrected is None:
            return step, None
        actual = self.coordinates.find_displacement(pose.state, uncorrected.state)
        step = step.with_correction(
            self.coordinates.transport_velocities(actual, uncorrected.accelerations), actual, pose.accelerations
        )
        correction = step.correction_at(self.step_size)
        if not np.isfinite(correction).all():
            return step, None
        return step, self.close(pose, step, displacement + correction) if correction.any() else uncorrected

    def close(self, pose: Pose, step: RosenbrockStep, displacement: Array) -> Pose | None:
        """Return the pose displaced by just that within the closures; None where they close on another branch.

        Closing leads across the tangent T, and slightly along it: the latter is compensated.
        """
        law, trial, size = step.law, displacement, self.coordinates.max_magnitude(displacement)
        rounding = tolerances.PUSHED_BY_ROUNDING * tolerances.START_ROUNDING
        for _ in range(MAX_CLOSURE_STEPS):
            new_pose = self.move(pose, trial)
            if new_pose is None:
                return None
            actual = self.coordinates.find_displacement(pose.state, new_pose.state)
            if self.coordinates.max_magnitude(actual - displacement) > np.sqrt(self.tolerance) * size + rounding:
                return None
            missed = law.T @ (law.T_inverse @ (displacement - actual))
            if self.coordinates.max_magnitude(missed) <= tolerances.REST_MISSED * self.tolerance * size + rounding:
                return new_pose
            trial = trial + missed
        return None

    def find_singularity(self, pose: Pose) -> Problem | None:
        """Return the problem if the search has run into a singular position; None if it started in one."""
        if count_dependent_rows(pose) <= count_dependent_rows(self.start_pose()):
            return None
        return make_singular_pose_problem(self.coordinates, pose)

    def move(self, pose: Pose, displacement: Array) -> Pose | None:
        """Return the displaced pose, with the same contacts; None where it cannot be closed."""
        state = self.coordinates.displace(pose.state[None, :], displacement[None, :])[0]
        new_pose = make_pose(self.evaluator, self.coordinates, self.t, state, pose.holding)
        self.evaluations += 1
        is_closed = new_pose.evaluation.gap[0] <= tolerances.OPEN_GAP * self.evaluator.size
        return new_pose if new_pose.is_finite and is_closed else None

    def accept(self, pose: Pose, step: RosenbrockStep, new_pose: Pose, relative_error: float) -> Pose:
        """Return the pose after a step, or that within it where the first contact changes; set s for the next step."""
        self.update_deviation(pose, step, relative_error)
        event = self.find_contact_change(pose, step) if self.evaluator.layout.contacts else None
        if event is None:
            self.step_size *= float(
                np.clip(SAFETY * np.sqrt(self.tolerance / max(relative_error, MIN_ERROR)), MIN_GROWTH, MAX_GROWTH)
            )
        else:
            new_pose = event
        moved = self.coordinates.find_displacement(pose.state, new_pose.state)
        self.total_displacement = self.total_displacement + moved
        rounding = tolerances.PUSHED_BY_ROUNDING * tolerances.START_ROUNDING
        self.standing_steps = self.standing_steps + 1 if self.coordinates.max_magnitude(moved) <= rounding else 0
        if not self.evaluator.layout.contacts:
            return self.count_turns(pose, new_pose)
        return self.count_turns(pose, make_bearing_pose(self.evaluator, self.coordinates, self.t, new_pose.state))

    def update_deviation(self, pose: Pose, step: RosenbrockStep, relative_error: float) -> None:
        """Update the possible deviation of the path: each step adds to it, and the linear law carries it on.

        The error of a step is about sqrt(relative_error) times its correction, the next order. A deviation along the
        path itself leads to the same pose, sooner or later; but a path that leaves a ridge may have left it for the
        other side.
        """
        law, acceleration = step.law, self.max_acceleration(pose)
        if self.doubt <= tolerances.REST_DOUBT and acceleration <= self.slowest.push:
            self.slowest = SlowestPoint(pose.state, self.deviation, acceleration)
        growth = law.directions.integrate(step.h, law.inverse @ (law.A @ (law.T_inverse @ self.deviation)))
        deviation = self.deviation + law.to_displacement(growth) + np.sqrt(relative_error) * step.correction_at(step.h)
        if not np.isfinite(deviation).all():
            self.doubt = float(np.fmax(self.doubt, self.coordinates.max_magnitude(deviation)))
            return
        weights = self.coordinates.weights
        direction, grows = (
            pose.accelerations * weights,
            law.T @ (law.A @ (law.T_inverse @ pose.accelerations)) * weights,
        )
        delay = float((deviation * weights) @ direction / (direction @ direction))
        # on a path that grows as e^(m s), a delay is a fraction m * delay of the distance from the rest pose
        self.relative_delay += abs(delay) * max(0.0, float(grows @ direction / (direction @ direction)))
        self.deviation = deviation - delay * pose.accelerations
        self.doubt = float(
            np.fmax(self.doubt, max(self.relative_delay, self.coordinates.max_magnitude(self.deviation)))
        )

    def find_contact_change(self, start: Pose, step: RosenbrockStep) -> Pose | None:
        """Find by halving the pose at which the first contact closes or opens on a step; None if none does."""
        low = high = 0.0
        for share in CONTACT_SAMPLES:
            pose = self.close(start, step, step.displacement_at(share * step.h))
            if pose is None or self.has_contact_change(start, pose):
                high = share * step.h
                break
            low = share * step.h
        if high == 0.0:
            return None
        new_pose = None
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            pose = self.close(start, step, step.displacement_at(middle))
            if pose is None or self.has_contact_change(start, pose):
                high, new_pose = middle, pose or new_pose
            else:
                low = middle
        return new_pose

    def has_contact_change(self, from_pose: Pose, to_pose: Pose) -> bool:
        """Return whether between two poses a contact was passed, or would have to pull."""
        for contact, holding in zip(self.evaluator.layout.contacts, from_pose.holding, strict=False):  # without latches
            if holding > 0.0 and find_contact_force(contact, to_pose) < min(
                0.0, find_contact_force(contact, from_pose)
            ):
                return True
            if (
                not holding > 0.0
                and find_contact_opening(contact, to_pose)
                < min(0.0, find_contact_opening(contact, from_pose)) - self.gap_tolerance
            ):
                return True
        return False

    @property
    def gap_tolerance(self) -> float:
        """A gap that counts as closed [m or rad]."""
        return tolerances.OPEN_GAP * max(self.evaluator.size, 1.0)

    def count_turns(self, previous: Pose, pose: Pose) -> Pose:
        """Return the pose with the angles of cut pins counted on from the previous pose, over half turns."""
        layout = self.evaluator.layout
        if not layout.counters:
            return pose
        state = pose.state.copy()
        for place in layout.counters.values():
            state[place] = previous.state[place]
        evaluation = replace(pose.evaluation, states=state[None, :])
        joint_values = joint_coordinates(layout, evaluation, make_body_states(layout, evaluation))
        for k, place in layout.counters.items():
            joint = layout.mechanism.joints[k]
            state[place] = joint_values[joint.name]["angle" if joint.path is None else "travel"][0]
        return replace(pose, state=state, evaluation=replace(evaluation, states=state[None, :]))

    def polish(self, pose: Pose, law: RestLaw) -> tuple[Pose, RestLaw]:
        """Take Newton's steps along all directions that are not indifferent, as long as they improve the pose."""
        law = self.decide(pose, law)
        while law.is_decided.any():
            displacement = law.newton_step(pose.accelerations)
            new_pose = self.move(pose, displacement)
            if new_pose is None or self.coordinates.max_magnitude(
                law.newton_step(new_pose.accelerations)
            ) >= 0.5 * self.coordinates.max_magnitude(displacement):
                break
            pose = self.count_turns(pose, new_pose)
            law = self.decide(pose, make_rest_law(self.evaluator, self.coordinates, pose))
            self.evaluations += EVALUATIONS_OF_LAW
            if self.coordinates.max_magnitude(displacement) <= tolerances.PLACE_ROUNDING:
                break  # a force without a linear term would continue endlessly
        return pose, law

    def decide(self, pose: Pose, law: RestLaw) -> RestLaw:
        """Return the law at a pose, separated by what is held there by more than rounding."""
        return separate_indifferent(
            law, find_indifference(self.scene, self.t, pose.holding, law.equations, is_at_rest=False)
        )

    def max_acceleration(self, pose: Pose) -> float:
        """Return the largest remaining acceleration [rad/s^2, or relative to the size 1/s^2]."""
        return self.coordinates.max_magnitude(pose.accelerations)
