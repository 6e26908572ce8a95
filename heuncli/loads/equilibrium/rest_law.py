"""Linearise the accelerations at rest about a pose, decompose the linear law, and take a step by it.

    a(q + T z) = a + T A z,     A = V diag(lambda) V^-1,     c = V^-1 T+ a

T are displacements that the closures admit, orthonormal by the coordinates' weights
(motion/linearisation/linearise.py). c is the remaining acceleration along each direction; noise is its rounding error:
anything below counts as zero. Nearly parallel directions share a block instead of eigenvalues of their own
(directions.py).

A step along dq/ds = a(q, rates 0) is an exponential Rosenbrock step of third order:

    z(s) = s phi_1(s A) c + 2 s phi_3(s A) (s/h)^2 d,     d = rates at z(h) - c - A z(h)

z is the displacement within the closures from the pose where the linear law (A, c) holds. Without d the step is of
second order, follows stiff directions to their end and is exact where the law is; d is what the law misses at the
step's end, and its share of the step is the error estimate. Hochbruck, Ostermann, Schweitzer 2009: exprb32.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.loads.equilibrium.coordinates import Coordinates, evaluate_at_rest, make_rounding_displacement
from heuncli.loads.equilibrium.directions import SpectralDecomposition, decompose, decompose_with_null_space
from heuncli.loads.equilibrium.pose import Pose, make_no_value_problem
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.linearisation.indifference import Indifference
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.multibody.response import solve_columns
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask

# Rest law

PERTURBED_POSES = 4  # poses moved by rounding; it is unlikely that all of them hide a direction
EVALUATIONS_OF_LAW = 3 + PERTURBED_POSES  # evaluations of the kernel that a law takes


@record
class RestLaw:
    """The linear law at a pose: T (n, f), T+ (f, n), A (f, f) and its decomposition, c and its noise (f,).

    equations: the linearised equations that it was made from
    eigenvalue_errors (f,): rounding errors of the eigenvalues
    sum_rounding (f,): rounding of the sums in c alone, a part of its noise
    nonlinearity (f,): deviation from the law at poses moved by rounding; larger than rounding only for loads that jump
    pose_rounding (f,): effect of the rounding of a pose in the law
    """

    equations: LinearisedEquations
    T: Array
    T_inverse: Array
    A: Array
    directions: SpectralDecomposition
    c: Array
    noise: Array
    eigenvalue_errors: Array
    sum_rounding: Array
    nonlinearity: Array
    pose_rounding: Array

    @property
    def eigenvalues(self) -> Array:
        """Eigenvalues of A, (f,)."""
        return self.directions.eigenvalues

    @property
    def V(self) -> Array:
        """The directions as columns, (f, f)."""
        return self.directions.X

    @property
    def inverse(self) -> Array:
        """The inverse of V."""
        return self.directions.inverse

    @property
    def significant_c(self) -> Array:
        """c where it exceeds rounding, else 0, (f,); a block of directions counts as one."""
        is_significant = np.abs(self.c) > self.noise
        is_significant[self.directions.single_count :] = is_significant[self.directions.single_count :].any()
        return np.where(is_significant, self.c, 0.0)

    @property
    def is_decided(self) -> Mask:
        """Which directions are not indifferent, (f,)."""
        return np.asarray(np.abs(self.eigenvalues) > self.eigenvalue_errors)

    def project(self, accelerations: Array) -> Array:
        """Return the components of accelerations (n,) along the directions, (f,)."""
        return np.asarray(self.inverse @ (self.T_inverse @ accelerations))

    def follow(self, h: float, c: Array | None = None) -> Array:
        """Return the displacement by dq/ds = a at s = h in the linear law, (n,): z = V h phi(h lambda) c, phi(x) = (e^x
        - 1)/x.
        """
        return self.to_displacement(self.directions.integrate(h, self.significant_c if c is None else c))

    def to_displacement(self, z: Array) -> Array:
        """Return the displacement (n,) of coordinates z (f,) of the directions; not finite if they are not."""
        with np.errstate(over="ignore", invalid="ignore"):
            return np.asarray(self.T @ (self.V @ z).real)

    def newton_step(self, accelerations: Array) -> Array:
        """Return the displacement (n,) that cancels accelerations (n,), along all directions that are not
        indifferent.
        """
        c = self.project(accelerations)
        return self.to_displacement(self.directions.solve_compliance(c, self.eigenvalue_errors))


def make_rest_law(evaluator: Evaluator, coordinates: Coordinates, pose: Pose) -> RestLaw:
    """Make the linear law at a pose. Raises SolveError [no-rest-pose] where loads have no value or no slope."""
    equations = linearise(evaluator.layout, pose.t, pose.state, pose.holding)
    T = equations.tangent
    T_inverse = T.T * coordinates.weights**2
    A = T_inverse @ equations.by_place @ T
    displacements = np.array([make_rounding_displacement(coordinates, pose.state, k) for k in range(PERTURBED_POSES)])
    perturbed = evaluate_at_rest(
        evaluator,
        pose.t,
        coordinates.displace(np.repeat(pose.state[None, :], PERTURBED_POSES, axis=0), displacements),
        pose.holding,
    )
    change = (coordinates.accelerations(perturbed) - pose.accelerations) @ T_inverse.T
    if not (np.isfinite(A).all() and np.isfinite(change).all()):
        raise SolveError(make_no_value_problem(coordinates, change))
    decomposition = decompose(A, T.T @ equations.mass @ T)
    inverse = decomposition.inverse
    noise = np.abs(inverse @ change.T).max(axis=1, initial=0.0)
    sums = estimate_acceleration_rounding(evaluator, coordinates, pose)
    c = inverse @ (T_inverse @ pose.accelerations)
    terms = np.abs(T_inverse) @ np.abs(equations.by_place) @ np.abs(T)
    eigenvalue_errors = find_eigenvalue_errors(
        decomposition, terms, float(np.abs(pose.evaluation.bodies["omega"]).max(initial=0.0))
    )
    sum_rounding = np.abs(inverse) @ (np.abs(T_inverse) @ sums)
    sum_rounding = sum_rounding + np.abs(
        inverse @ (T_inverse @ estimate_spring_rounding(evaluator, coordinates, pose))
    ).sum(axis=1)
    nonlinearity = np.abs(inverse @ (change.T - A @ (T_inverse @ displacements.T))).max(axis=1, initial=0.0)
    pose_rounding = np.abs(inverse) @ (
        np.abs(T_inverse) @ (np.abs(equations.by_place) @ np.abs(displacements).max(axis=0))
    )
    return RestLaw(
        equations=equations, T=T, T_inverse=T_inverse, A=A, directions=decomposition, c=c,
        noise=tolerances.PUSHED_BY_ROUNDING * (noise + sum_rounding), eigenvalue_errors=eigenvalue_errors,
        sum_rounding=sum_rounding, nonlinearity=nonlinearity, pose_rounding=pose_rounding,
    )  # fmt: skip


def separate_indifferent(rest_law: RestLaw, indifference: Indifference) -> RestLaw:
    """Return the same law decomposed into the given indifferent directions and those of all that is held."""
    right_null, left_null = (
        rest_law.T_inverse @ indifference.free_motions,
        rest_law.T_inverse @ indifference.T @ indifference.elimination.left_null,
    )
    decomposition = decompose_with_null_space(
        rest_law.A, rest_law.T.T @ rest_law.equations.mass @ rest_law.T, right_null, left_null
    )
    if decomposition is None:
        return rest_law
    basis_change = np.abs(decomposition.inverse @ rest_law.V)
    noise, sum_rounding, nonlinearity, pose_rounding = (
        basis_change @ x for x in (rest_law.noise, rest_law.sum_rounding, rest_law.nonlinearity, rest_law.pose_rounding)
    )
    eigenvalue_errors = np.where(decomposition.eigenvalues == 0.0, 1.0, 0.0)
    eigenvalue_errors[is_massless(rest_law.T @ decomposition.X, indifference.T)] = np.inf
    c = decomposition.inverse @ (rest_law.V @ rest_law.c)
    return replace(
        rest_law,
        directions=decomposition,
        c=c,
        noise=noise,
        eigenvalue_errors=eigenvalue_errors,
        sum_rounding=sum_rounding,
        nonlinearity=nonlinearity,
        pose_rounding=pose_rounding,
    )


def is_massless(displacements: Array, massive: Array) -> Mask:
    """Return which displacements (n, f) are massless spins: no combination of those that move mass (n, m) makes
    them.
    """
    if not massive.shape[1]:
        return np.ones(displacements.shape[1], dtype=bool)
    remainder = displacements - massive @ solve_least_squares(massive, displacements)
    return np.asarray(np.sum(np.abs(remainder) ** 2, axis=0) > 0.5 * np.sum(np.abs(displacements) ** 2, axis=0))


def find_eigenvalue_errors(decomposition: SpectralDecomposition, terms: Array, fastest_spin: float) -> Array:
    """Return the rounding errors of the eigenvalues, (f,).

    terms (f, f): magnitudes of the terms of A
    fastest_spin: the fastest angular velocity

    For a single eigenvalue with left direction y and right direction x the error is |y' dA x|. Where k directions
    coincide with another one, it is |dA| to the power 1 / (k + 1), times |A| to the power k / (k + 1) (Elsner).
    """
    errors = tolerances.INDIFFERENT * ((np.abs(decomposition.inverse) @ terms) * np.abs(decomposition.X).T).sum(axis=1)
    # centrifugal terms cancel inside the sums, so `terms` does not contain them
    errors = (
        np.maximum(errors, tolerances.EPS * terms.max(initial=0.0))
        + tolerances.INDIFFERENT * fastest_spin * fastest_spin
    )
    if decomposition.defect:
        block_error, power = errors[decomposition.single_count :].sum(), 1.0 / (decomposition.defect + 1)
        errors[decomposition.single_count :] = block_error**power * (
            2.0 * np.linalg.norm(decomposition.B) + block_error
        ) ** (1.0 - power)
    return np.asarray(errors)


def estimate_acceleration_rounding(evaluator: Evaluator, coordinates: Coordinates, pose: Pose) -> Array:
    """Return the rounding errors of the accelerations from their sums, (n,): of each cause alone, and of weight."""
    terms = coordinates.acceleration_terms(
        evaluate_at_rest(evaluator, pose.t, pose.state[None, :], pose.holding, causes=True)
    )
    gravity = float(np.abs(evaluator.layout.mechanism.gravity).max()) / evaluator.size
    return tolerances.SUM_ROUNDING * (terms + gravity / coordinates.weights)


def estimate_spring_rounding(evaluator: Evaluator, coordinates: Coordinates, pose: Pose) -> Array:
    """Return the rounding error of the accelerations from the length of each spring and elastic rope, (n, k).

    Near its free length there is no other.
    """
    layout, evaluation = evaluator.layout, pose.evaluation
    rows = layout.tables["loads"]
    springs = [
        k for k in np.flatnonzero(rows["kind"] == kernel.SPRING).tolist() if evaluation.loads["span"][0, k] > 0.0
    ]
    ropes = np.flatnonzero(rows["kind"] == kernel.ROPE).tolist()
    if not springs and not ropes:
        return np.zeros((coordinates.count, 0))
    wrenches = np.array([
        *(_make_spring_wrenches(layout, evaluation, k) for k in springs),
        *(_make_rope_wrenches(layout, evaluation, k) for k in ropes),
    ])  # fmt: skip
    response = solve_columns(evaluator.workspace, pose.t, pose.state, wrenches, np.zeros(len(wrenches)))
    return coordinates.collect(response.bodies["alpha"], response.freedoms["udot"]).T


def _find_length_rounding(layout: Layout, evaluation: Evaluation, k: int) -> float:
    """Return the rounding of a spring's force from that of its length [N]."""
    row, span = layout.tables["loads"][k], evaluation.loads["span"][0, k]
    return float(tolerances.SUM_ROUNDING * row["stiffness"] * (span + row["length"]))


def _make_spring_wrenches(layout: Layout, evaluation: Evaluation, k: int) -> Array:
    """Return moment and force of that rounding ON each body, about its reference, (n_b, 6), tree order."""
    row, load, bodies = layout.tables["loads"][k], evaluation.loads[0, k], evaluation.bodies[0]
    wrenches = np.zeros((len(bodies), 6))
    force = _find_length_rounding(layout, evaluation, k) * ((load["at"] - load["from_at"]) / load["span"])
    for body, place, sign in ((int(row["b"]), load["at"], 1.0), (int(row["a"]), load["from_at"], -1.0)):
        if body >= 0:
            wrenches[body, :3] += sign * np.cross(place - bodies["r"][body], force)
            wrenches[body, 3:] += sign * force
    return wrenches


def _make_rope_wrenches(layout: Layout, evaluation: Evaluation, k: int) -> Array:
    """Return the same for an elastic rope, all of whose strands have that rounding."""
    row, bodies = layout.tables["loads"][k], evaluation.bodies[0]
    wrenches = np.zeros((len(bodies), 6))
    size = _find_length_rounding(layout, evaluation, k)
    for part in range(int(row["part"]), int(row["part"] + row["part_count"])):
        ends, result = layout.tables["parts"][part], evaluation.parts[0, part]
        for body, sign in ((int(ends["b"]), size), (int(ends["a"]), -size)):
            if body >= 0:
                lever = result["Q"] - bodies["r"][body]
                wrenches[body, :3] += sign * (result["m"] + np.cross(lever, result["f"]))
                wrenches[body, 3:] += sign * result["f"]
    return wrenches


# Rosenbrock step


@record
class RosenbrockStep:
    """The step from a pose up to s = h; d (f,): correction along the law's directions."""

    law: RestLaw
    h: float
    d: Array

    def displacement_at(self, s: float) -> Array:
        """Return the displacement (n,) at some s, up to h."""
        return np.asarray(self.law.follow(s) + self.correction_at(s))

    def correction_at(self, s: float) -> Array:
        """Return the part of the displacement from d, (n,)."""
        if not self.d.any():
            return np.zeros(len(self.law.T))
        return self.law.to_displacement(self.law.directions.integrate(s, 2.0 * (s / self.h) ** 2 * self.d, order=3))

    def with_correction(self, rates: Array, displacement: Array, accelerations: Array) -> RosenbrockStep:
        """Return the step with d, from the rates (n,) of its coordinates after a displacement (n,), and those
        before.
        """
        law = self.law
        d = law.project(rates - accelerations - law.T @ (law.A @ (law.T_inverse @ displacement)))
        # an unstable direction that only rounding pushes stays as it is
        return replace(self, d=np.where(np.abs(d) > law.noise, d, 0.0))


def make_uncorrected_step(law: RestLaw, h: float) -> RosenbrockStep:
    """Return the step by the linear law alone."""
    return RosenbrockStep(law, h, np.zeros(len(law.c)))
