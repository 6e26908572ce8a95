"""Decide which of the touching contacts are held from an instant on, and which let go.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0

This is the problem of restitution.py again, now with the forces z of the contacts that have no rate of opening: w are
the accelerations of opening, q those with every contact open.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.complementarity import solve_complementarity
from heuncli.motion.integration.contacts.touching import CLOSED, CLOSED_BY_OTHERS, OPEN, TouchingContacts, scatter
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask


def find_resting(
    contacts_touching: TouchingContacts, A: Array, moves: Mask, rate: Array, evaluation: Evaluation, layout: Layout
) -> tuple[Array, Array]:
    """Return which of the touching contacts are held from here on (k,), and the accelerations of opening of all (k,).

    Only contacts without a rate of opening can rest.

    evaluation: the state after all impulses, every contact open
    """
    contacts = [layout.contacts[i] for i in contacts_touching.indices.tolist()]
    rows = evaluation.rows[0]
    q = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    noise = tolerances.CONTACT_ACCELERATION * acceleration_terms(layout, contacts_touching, A, evaluation)
    is_still = rate == 0.0
    candidates = np.flatnonzero(is_still & moves)
    solution = solve_complementarity(A[np.ix_(candidates, candidates)], q[candidates], noise[candidates])
    holding = np.full(len(contacts), OPEN)
    holding[candidates[solution.bears]] = CLOSED
    holding[candidates[solution.depends]] = CLOSED_BY_OTHERS
    holding[is_still & ~moves & (q <= noise)] = CLOSED_BY_OTHERS  # beyond, a drive opens it
    return holding, q + A @ scatter(solution.z, candidates, len(contacts))


def find_contradicted(
    contacts_touching: TouchingContacts, A: Array, holding: Array, rate: Array, evaluation: Evaluation, layout: Layout
) -> Mask:
    """Mark the touching contacts whose loads or accelerations contradict the result of `find_resting`, (k,).

    `find_resting` takes all applied loads as given, but load-dependent joint friction changes as contacts bear. A
    closed contact then may pull, or an open one accelerate inwards.

    evaluation: the state with the contacts held that `holding` names
    """
    contacts = [layout.contacts[i] for i in contacts_touching.indices.tolist()]
    rows = evaluation.rows[0]
    noise = tolerances.CONTACT_ACCELERATION * acceleration_terms(layout, contacts_touching, A, evaluation)
    z = np.array([-c.sense * float(rows["multiplier"][c.row]) for c in contacts])
    w = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    is_pulling = (holding == CLOSED) & (z * np.diag(A) < -noise)
    return np.asarray(is_pulling | ((holding == OPEN) & (rate == 0.0) & (w < -noise)))


def acceleration_terms(layout: Layout, contacts_touching: TouchingContacts, A: Array, evaluation: Evaluation) -> Array:
    """Return the sizes of the terms of the accelerations of opening (k,): of motion, and of all loads and weights.

    Where a contact lets go, these cancel: a force that has become zero is known only to the rounding of what it was.
    """
    rows = [layout.contacts[i].row for i in contacts_touching.indices.tolist()]
    weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
    load = weights + float(
        np.abs(evaluation.loads["force"][0]).sum() + np.abs(evaluation.loads["moment"][0]).sum() / layout.size
    )
    weight = layout.tables["closures"]["weight"][rows]
    return np.asarray(evaluation.rows["terms"][0, rows] + np.diag(A) * weight * load)


def is_short_flight(
    contacts_touching: TouchingContacts, rate: Array, acceleration: Array, shortest_time: float
) -> Mask:
    """Return which rebounds come back before they are seen: u^2 / 2 a within the rounding of the gap, or too short a
    time.
    """
    a = -acceleration
    is_returning = (rate > 0.0) & (a > 0.0)
    a = np.where(is_returning, a, 1.0)
    return np.asarray(
        is_returning & ((rate * rate <= 2.0 * a * contacts_touching.reach) | (2.0 * rate <= a * shortest_time))
    )
