"""Condition of the mass matrix and of the closures: by how much a method loses digits that solves with them as a whole.

    M x = f,   J' lambda = ...      cond = largest / smallest singular value
Shifts are counted by the scene's size; of closed chains M is looked at on the motions that they admit, and of J what
holds what others hold is left out, as where multipliers are found. heun's sweep takes one body after the other and is
touched by neither; a code that factors M or J M^-1 J' is.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.probing.numerics.twists import closure_rows, mass_matrix, twists
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.equilibrium.coordinates import Coordinates
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def free_motions(J: Array, weights: Array) -> tuple[list[Array], Array]:
    """Of each instant an orthonormal basis, scaled, of what closure rows (n_t, rows, n) admit; the rows' condition.

    Rows of the order of 1, as where their rank is decided.
    """
    J = J / weights
    size = np.sqrt(np.sum(J * J, axis=2, keepdims=True))
    _, s, V = np.linalg.svd(J / np.maximum(size, 1.0), full_matrices=True)
    rank = (s > tolerances.RANK * s.max(axis=1, initial=0.0)[:, None]).sum(axis=1)
    least = np.take_along_axis(s, np.maximum(rank - 1, 0)[:, None], axis=1)[:, 0]
    conditions = np.where(rank > 0, s.max(axis=1, initial=1.0) / np.where(rank > 0, least, 1.0), 1.0)
    return [v[r:].T for v, r in zip(V, rank.tolist(), strict=True)], conditions


class ConditionNumbers(NamedTuple):
    """At instants: conditions of the mass matrix and of the closures (n_t,), and the lightest motion (n_t, n)."""

    mass: Array
    closure: Array
    light: Array


def conditions(layout: Layout, own: Coordinates, at: Recovered) -> ConditionNumbers:
    """Conditions at recovered instants; infinite where a motion moves no mass."""
    found = twists(layout, at)
    M = mass_matrix(found)[:, own.answers][:, :, own.answers] / np.outer(own.weights, own.weights)
    bases, closure = [np.eye(own.count)] * len(M), np.ones(len(M))
    if layout.rows:
        J = closure_rows(found, at)[:, :, own.answers] * (at.rows["closed"] > 0.0)[:, :, None]
        bases, closure = free_motions(J, own.weights)
    mass, light = np.ones(len(M)), np.zeros((len(M), own.count))
    for t, (m, T) in enumerate(zip(M, bases, strict=True)):
        if T.shape[1]:
            w, v = np.linalg.eigh(T.T @ m @ T)
            mass[t] = np.inf if w[0] <= tolerances.NO_INERTIA * w[-1] else w[-1] / w[0]
            light[t] = T @ v[:, 0]
    return ConditionNumbers(mass, closure, light)
