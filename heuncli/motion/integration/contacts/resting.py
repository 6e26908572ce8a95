"""Which of the contacts that touch are held from an instant on, and which let go.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0
The problem of restitution.py once more, now of forces z of the contacts that open with no rate: w are the accelerations
of opening, q those with every contact open.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.complementarity import complementary
from heuncli.motion.integration.contacts.touching import CLOSED, LEANS, OPEN, Touching, spread
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask


def rests(touch: Touching, A: Array, moves: Mask, rate: Array, at: Recovered, layout: Layout) -> tuple[Array, Array]:
    """Which of the touching contacts are held from here on (k,), and the accelerations of opening of all (k,).

    at: the state behind all blows, every contact open. What rests is what does not open with a rate.
    """
    contacts = [layout.contacts[i] for i in touch.which.tolist()]
    rows = at.rows[0]
    q = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    noise = tolerances.CONTACT_ACCELERATION * acceleration_terms(layout, touch, A, at)
    still = rate == 0.0
    own = np.flatnonzero(still & moves)
    found = complementary(A[np.ix_(own, own)], q[own], noise[own])
    holding = np.full(len(contacts), OPEN)
    holding[own[found.bears]] = CLOSED
    holding[own[found.depends]] = LEANS
    holding[still & ~moves] = LEANS
    return holding, q + A @ spread(found.z, own, len(contacts))


def undecided_by_friction(
    touch: Touching, A: Array, holding: Array, rate: Array, at: Recovered, layout: Layout
) -> Mask:
    """Which of the touching contacts do not what `rests` found, (k,): w and z of that are those of given loads.

    Friction by what a joint carries changes as they bear. at: the state with those held that are said to be.
    """
    contacts = [layout.contacts[i] for i in touch.which.tolist()]
    rows = at.rows[0]
    noise = tolerances.CONTACT_ACCELERATION * acceleration_terms(layout, touch, A, at)
    z = np.array([-c.sense * float(rows["multiplier"][c.row]) for c in contacts])
    w = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    pulls = (holding == CLOSED) & (z * np.diag(A) < -noise)
    return np.asarray(pulls | ((holding == OPEN) & (rate == 0.0) & (w < -noise)))


def acceleration_terms(layout: Layout, touch: Touching, A: Array, at: Recovered) -> Array:
    """Sizes of the terms that accelerations of opening are sums of (k,): of motion, and of all loads and weights.

    Where a contact lets go these cancel: what bears nothing is known to the rounding of what it bore.
    """
    rows = [layout.contacts[i].row for i in touch.which.tolist()]
    weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
    load = weights + float(np.abs(at.loads["force"][0]).sum() + np.abs(at.loads["moment"][0]).sum() / layout.size)
    weight = layout.tables["closures"]["weight"][rows]
    return np.asarray(at.rows["terms"][0, rows] + np.diag(A) * weight * load)


def short_flights(touch: Touching, rate: Array, acceleration: Array, instant: float) -> Mask:
    """Whether what rebounds comes back before it is seen to leave: u^2 / 2 a within the rounding of its gap.

    Or in less time than instants are told apart.
    """
    a = -acceleration
    falls = (rate > 0.0) & (a > 0.0)
    a = np.where(falls, a, 1.0)
    return np.asarray(falls & ((rate * rate <= 2.0 * a * touch.reach) | (2.0 * rate <= a * instant)))
