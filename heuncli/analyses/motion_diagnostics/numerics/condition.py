"""Condition of the mass matrix and of the closures: how many digits a method loses that factors them as a whole.
    M x = f,   J' lambda = ...      cond = largest / smallest singular value
Displacements are divided by the scene's size. With closed chains, M is restricted to the motions that they admit, and
redundant rows of J are left out, as in the solution for the multipliers. Neither affects heun's body-by-body recursion,
but a code that factors M or J M^-1 J'.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.motion_diagnostics.numerics.twists import closure_rows, compute_twists, mass_matrix
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def find_free_motions(J: Array, weights: Array) -> tuple[list[Array], Array]:
    """Return for each instant a scaled orthonormal basis of the motions that closure rows (n_t, rows, n) admit, and the
    condition of the rows.

    Rows are scaled to the order of 1, as where their rank is decided.
    """
    J = J / weights
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    _, s, V = np.linalg.svd(J / np.maximum(size, 1.0), full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=0.0)[:, None]).sum(axis=1)
    smallest = np.take_along_axis(s, np.maximum(rank - 1, 0)[:, None], axis=1)[:, 0]
    conditions = np.where(rank > 0, s.max(axis=1, initial=1.0) / np.where(rank > 0, smallest, 1.0), 1.0)
    return [v[r:].T for v, r in zip(V, rank.tolist(), strict=True)], conditions


class ConditionNumbers(NamedTuple):
    """Conditions of the mass matrix and of the closures (n_t,), and the motion with the least inertia (n_t, n)."""

    mass: Array
    closure: Array
    lightest_motion: Array


def compute_conditions(layout: Layout, layout_coordinates: Coordinates, recovered: Evaluation) -> ConditionNumbers:
    """Return the conditions at recovered instants; infinite if a motion moves no mass."""
    body_twists = compute_twists(layout, recovered)
    M = mass_matrix(body_twists)[:, layout_coordinates.result_indices][
        :, :, layout_coordinates.result_indices
    ] / np.outer(layout_coordinates.weights, layout_coordinates.weights)
    bases, closure = [np.eye(layout_coordinates.count)] * len(M), np.ones(len(M))
    if layout.rows:
        J = (
            closure_rows(body_twists, recovered)[:, :, layout_coordinates.result_indices]
            * (recovered.rows["closed"] > 0.0)[:, :, None]
        )
        bases, closure = find_free_motions(J, layout_coordinates.weights)
    mass, lightest_motion = np.ones(len(M)), np.zeros((len(M), layout_coordinates.count))
    for t, (m, T) in enumerate(zip(M, bases, strict=True)):
        if T.shape[1]:
            w, v = np.linalg.eigh(T.T @ m @ T)
            mass[t] = np.inf if w[0] <= tolerances.NO_INERTIA * w[-1] else w[-1] / w[0]
            lightest_motion[t] = T @ v[:, 0]
    return ConditionNumbers(mass, closure, lightest_motion)
