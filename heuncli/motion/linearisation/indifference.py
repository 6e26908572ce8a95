"""Find which small motions no stiffness holds: the null space of K, decided by the rounding errors of all its terms.

    K x = 0,   K = -T' M da/dq T          of displacements T x, at rest in the frame of what moves steadily

Rest poses, their stability and small oscillations all use this one decision. The error of K is measured with scenes and
poses that rounding cannot distinguish from this one (displacements.py), each brought to its own rest: what cancels in
K, between loads or inside a law, differs there by the rounding of its terms, entry by entry. K is eliminated from its
largest entry down, in all these scenes alike, as long as an entry exceeds their differences: so soft entries are
compared with the terms of soft motions, and not with those of stiff neighbouring ones.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record, replace
from heuncli.motion.linearisation.displacements import displace, make_rounded_scene, make_rounded_state
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.motion.linearisation.reduced_equations import (
    ReducedEquations,
    find_ball_rates,
    find_ball_rotations,
    find_massless_spins,
    find_orthogonal_complement,
)
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Indices

ROUNDED_SCENES = 4  # perturbed by rounding; it is unlikely that all of them hide a term
MAX_DISPLACEMENT = 1.0  # rad, or relative to the size: limit of a displacement by rounding


@record
class Elimination:
    """A matrix (f, f) eliminated by its significant entries: their rows and columns, in pairs; the null spaces.

    right_null, left_null (f, g): K right_null = 0 = left_null' K except for rounding, which is at most `null_errors`
    (g, g) on them, `entry_errors` (f, f) on all
    """

    K: Array
    rows: Indices
    columns: Indices
    right_null: Array
    left_null: Array
    null_errors: Array
    entry_errors: Array

    def solve(self, forces: Array) -> Array:
        """Solve K x = forces (f, m) for forces that vanish on `left_null`; x is zero along what is indifferent."""
        x = np.zeros((len(self.K), forces.shape[1]))
        if len(self.rows):
            x[self.columns] = np.linalg.solve(self.K[np.ix_(self.rows, self.columns)], forces[self.rows])
        return x


@record
class Indifference:
    """The displacements that no stiffness holds; `free_motions` is a basis of them.

    T (n, f): displacements that the closures admit, each with a coordinate of its own
    elimination: K on these displacements, eliminated
    reach: how far rounding moves the pose, along what is held softly [rad, or relative to the size]
    """

    T: Array
    elimination: Elimination
    reach: float

    @property
    def free_motions(self) -> Array:
        """Basis of the indifferent displacements, (n, g)."""
        return np.asarray(self.T @ self.elimination.right_null)


@record
class IndifferentMotions:
    """What no stiffness holds, in coordinates x: K right_null = 0 = left_null' K, with orthonormal bases (f, g).

    error: the largest stiffness [1/s^2] that rounding may hide in it
    compliance (f, f): response to a force
    to_pivots (m, f): x to displacements with a coordinate each, on which the stiffness is K (m, m) with rounding errors
    of at most entry_errors (m, m); soft motions keep their digits there
    """

    right_null: Array
    left_null: Array
    error: float
    compliance: Array
    to_pivots: Array
    K: Array
    entry_errors: Array

    def find_mutual_stiffness(self, X: Array) -> Array:
        """Return the stiffness of motions (f, k) among each other, (k, k) [1/s^2]."""
        displacements = self.to_pivots @ X
        return np.asarray(displacements.T @ self.K @ displacements)

    def estimate_stiffness_error(self, X: Array) -> Array:
        """Return the rounding error of the stiffness of motions (f, k), (k,) [1/s^2]."""
        size = np.abs(self.to_pivots @ X)
        return np.asarray(np.sum(size * (self.entry_errors @ size), axis=0))


def find_indifference(
    scene: PreparedScene, t: float, holding: Array, law: LinearisedEquations, *, is_at_rest: bool = True
) -> Indifference:
    """Find the indifferent motions of a scene about a state; law: its linear equations there.

    is_at_rest: the state rests as well as rounding permits, so softness within the displacement by rounding counts as
    none
    """
    layout = scene.layout
    weights = find_freedom_weights(layout)
    tangent, drift = find_massive_displacements(scene, law)
    T, pivots = find_pivots(tangent, weights)
    if not T.shape[1]:
        return Indifference(T, eliminate(np.zeros((0, 0)), np.zeros((0, 0, 0))), 0.0)
    K, _ = find_stiffness(layout, law, T, drift)
    scenes = [replace(scene, layout=make_rounded_scene(layout, number)) for number in range(ROUNDED_SCENES)]
    states = [make_rounded_state(layout, law.state, number) for number in range(ROUNDED_SCENES)]
    perturbed_K, pushes = find_perturbed_stiffness(scenes, t, states, holding, weights, pivots)
    elimination, reach = eliminate(K, perturbed_K - K), 0.0
    if is_at_rest and len(elimination.rows):
        displacements = [T @ elimination.solve(push[:, None])[:, 0] for push in pushes]
        reach = max(float(np.abs(rounding_motion * weights).max()) for rounding_motion in displacements)
        states = [
            displace(layout, state, limit_displacement(rounding_motion, weights))
            for state, rounding_motion in zip(states, displacements, strict=True)
        ]
        perturbed_K, _ = find_perturbed_stiffness(scenes, t, states, holding, weights, pivots)
        elimination = eliminate(K, perturbed_K - K)
    return Indifference(T, elimination, reach)


def reduce_indifference(system: ReducedEquations, indifference: Indifference) -> IndifferentMotions:
    """Return the indifference of reduced equations, whose motions are some of those displacements, without massless
    spins.
    """
    projection = system.tangent.T @ system.mass
    right_null, left_null = (
        orthonormalise(projection @ indifference.T @ basis)
        for basis in (indifference.elimination.right_null, indifference.elimination.left_null)
    )
    # x by those displacements
    to_pivots = solve_least_squares(indifference.T, system.tangent)
    forces = solve_least_squares(to_pivots, np.eye(len(to_pivots)))
    compliance = projection @ indifference.T @ indifference.elimination.solve(forces.T)
    basis = (
        solve_least_squares(projection @ indifference.T @ indifference.elimination.right_null, right_null)
        if right_null.shape[1]
        else np.zeros((0, 0))
    )
    errors = np.abs(basis).T @ indifference.elimination.null_errors @ np.abs(basis) if basis.size else np.zeros((0, 0))
    return IndifferentMotions(
        right_null,
        left_null,
        float(np.abs(errors).max(initial=0.0)),
        compliance,
        to_pivots,
        indifference.elimination.K,
        indifference.elimination.entry_errors,
    )


def orthonormalise(columns: Array) -> Array:
    """Return an orthonormal basis of the span of independent columns, however different their sizes."""
    return np.asarray(np.linalg.qr(columns / np.sqrt(np.sum(columns**2, axis=0)))[0])


def find_perturbed_stiffness(
    scenes: list[PreparedScene], t: float, states: list[Array], holding: Array, weights: Array, pivots: Indices
) -> tuple[Array, Array]:
    """Return K of perturbed scenes, (s, f, f), and their remaining forces, (s, f)."""
    f = len(pivots)
    K, pushes = np.full((len(scenes), f, f), np.nan), np.zeros((len(scenes), f))
    for k, (scene, state) in enumerate(zip(scenes, states, strict=True)):
        law = linearise(scene.layout, t, state, holding)
        if not np.isfinite(law.by_place).all():
            continue
        tangent, drift = find_massive_displacements(scene, law)
        if tangent.shape[1] == f:
            K[k], pushes[k] = find_stiffness(scene.layout, law, normalise_on_pivots(tangent, weights, pivots), drift)
    return K, pushes


def limit_displacement(displacement: Array, weights: Array) -> Array:
    """Limit a displacement (n,) to MAX_DISPLACEMENT."""
    size = float(np.abs(displacement * weights).max(initial=0.0))
    if not np.isfinite(size):
        return np.zeros(len(displacement))
    return displacement * min(1.0, MAX_DISPLACEMENT / size) if size > 0.0 else displacement


def find_massive_displacements(scene: PreparedScene, law: LinearisedEquations) -> tuple[Array, Array]:
    """Return the displacements of the law that move mass, (n, f), and the rates that any displacement needs, (n, n)."""
    massless_spins = find_massless_spins(scene, law)
    drift = law.drift @ np.linalg.pinv(law.tangent)
    for spin in massless_spins:
        drift = drift - np.outer(law.tangent @ spin.tangent, spin.rate_change(law, np.eye(len(drift))))
    return law.tangent @ find_orthogonal_complement(
        np.array([spin.tangent for spin in massless_spins]), law.tangent.shape[1]
    ), drift


def find_freedom_weights(layout: Layout) -> Array:
    """Return the weights of the undriven freedoms: 1 for rotations, 1 / size for shifts, (n,)."""
    place = rate_indices(layout)
    return np.asarray(layout.weights[place[place >= 0]])


def find_stiffness(layout: Layout, law: LinearisedEquations, T: Array, drift: Array) -> tuple[Array, Array]:
    """Return K on displacements T (n, f), and the remaining forces along them, (f,).

    drift (n, n): rates that displacements need

    Seen from the frames of what moves steadily, as in reduced_equations.py: what stays there needs the rates `rates`.
    """
    spin, frame = find_ball_rotations(layout, law)
    P, change = T.T @ law.mass, law.by_place @ T
    if drift.any() or (spin != frame).any():
        S = drift @ T
        rates = S - T @ (np.linalg.pinv(T) @ (S + (spin - frame) @ T))
        change = change + (law.by_rate - frame) @ rates
    K = -P @ change
    return K, P @ (law.accelerations - frame @ find_ball_rates(layout, law))


def find_pivots(tangent: Array, weights: Array) -> tuple[Array, Indices]:
    """Return the same displacements (n, f), each with a coordinate in which the others have no part, and these pivots,
    (f,).
    """
    remainder = tangent * weights[:, None]
    pivots: list[int] = []
    for _ in range(tangent.shape[1]):
        sizes = np.sum(remainder**2, axis=1)
        k = int(np.argmax(sizes))
        pivots.append(k)
        direction = remainder[k] / np.sqrt(sizes[k])
        remainder = remainder - np.outer(remainder @ direction, direction)
    pivot_indices = np.array(pivots, dtype=int)
    return normalise_on_pivots(tangent, weights, pivot_indices), pivot_indices


def normalise_on_pivots(tangent: Array, weights: Array, pivots: Indices) -> Array:
    """Return the same displacements normalised on the given coordinates; parts within rounding become zero."""
    T = tangent * weights[:, None]
    if len(pivots):
        T = np.linalg.solve(T[pivots].T, T.T).T.astype(float)
        T = np.where(np.abs(T) > tolerances.EIGENVALUE, T, 0.0)
        T[pivots] = np.eye(len(pivots))
    return np.asarray(T / weights[:, None])


def eliminate(K: Array, changes: Array) -> Elimination:
    """Eliminate a matrix (f, f), given the differences of others that rounding cannot distinguish from it, (s, f,
    f).
    """
    f = len(K)
    changes = changes[np.isfinite(changes).all(axis=(1, 2))] if f else changes
    if f and not len(changes):
        changes = np.full((1, f, f), tolerances.EIGENVALUE * f * np.abs(K).max())
    entry_errors = tolerances.REAL_STIFFNESS_FACTOR * np.abs(changes).max(axis=0, initial=0.0)
    S, others = K.copy(), K + changes
    rows, columns = list(range(f)), list(range(f))
    right_null, left_null = np.eye(f), np.eye(f)
    pairs_taken: list[tuple[int, int]] = []
    while rows:
        errors = tolerances.REAL_STIFFNESS_FACTOR * np.abs(others - S).max(axis=0, initial=0.0)
        significant = np.where(np.abs(S) > errors, np.abs(S), 0.0)
        i, j = np.unravel_index(int(np.argmax(significant)), significant.shape)
        if significant[i, j] == 0.0:
            break
        pairs_taken.append((rows.pop(int(i)), columns.pop(int(j))))
        right_null = remove_column(right_null, int(j), S[i] / S[i, j])
        left_null = remove_column(left_null, int(i), S[:, j] / S[i, j])
        S, others = find_schur_complement(S[None], int(i), int(j))[0], find_schur_complement(others, int(i), int(j))
    errors = tolerances.REAL_STIFFNESS_FACTOR * np.abs(others - S).max(axis=0, initial=0.0)
    pairs = np.array(pairs_taken, dtype=int).reshape(-1, 2)
    return Elimination(K, pairs[:, 0], pairs[:, 1], right_null, left_null, errors, entry_errors)


def remove_column(basis: Array, k: int, shares: Array) -> Array:
    """Return a basis without its column k, of which the others take their shares."""
    return np.asarray(np.delete(basis - np.outer(basis[:, k], shares), k, axis=1))


def find_schur_complement(matrices: Array, i: int, j: int) -> Array:
    """Return matrices (s, f, f) after one step of elimination by the entry i, j."""
    pivot = matrices[:, i, j][:, None, None]
    remainder = matrices - matrices[:, :, j][:, :, None] * (matrices[:, i, :][:, None, :] / pivot)
    return np.asarray(np.delete(np.delete(remainder, i, axis=1), j, axis=2))
