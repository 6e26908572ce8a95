"""Solve which touching contacts are held and which let go, and the impulses of struck ones.

Both are complementarity problems (complementarity.py): z >= 0, w = q + A z >= 0, z . w = 0.

For contacts that touch, z are the forces of those that have no rate of opening, w the accelerations of opening, q those
with every contact open.

W are the contacts' unit loads, positive where they bear. For impulses z, w are the rates of opening after the impulse
plus those that Newton's restitution requires: w = v+ + e v- of what is struck (v- < 0), v+ of what rests. A contact
bears or opens, never both (Moreau 1988; Pfeiffer and Glocker 1996). Several touching contacts are struck at the same
time, or one after another (sequential_impacts.py): rigid bodies alone do not say which.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import fields, record
from heuncli.motion.integration.contacts.complementarity import (
    ComplementaritySolution,
    find_coupled_groups,
    solve_complementarity,
)
from heuncli.motion.integration.contacts.sequential_impacts import EndlessImpacts, strike_in_sequence
from heuncli.motion.integration.contacts.touching import TouchingContacts, find_free_response, scatter
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import CLOSED, CLOSED_BY_OTHERS, OPEN, Layout
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel

# Resting


def find_resting(
    touching: TouchingContacts, A: Array, moves: Mask, rate: Array, evaluation: Evaluation, layout: Layout
) -> tuple[Array, Array]:
    """Return which of the touching contacts are held from here on, and how (k,): OPEN, CLOSED or CLOSED_BY_OTHERS; and
    the accelerations of opening of all (k,).

    Only contacts without a rate of opening can rest.

    A (k, k): accelerations of opening from unit forces; moves (k,): whether a force moves anything
    rate (k,): rates of opening
    evaluation: the state after all impulses, every contact open
    """
    contacts = [layout.contacts[i] for i in touching.indices.tolist()]
    rows = evaluation.rows[0]
    q = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    noise = estimate_acceleration_noise(layout, touching, A, evaluation)
    is_still = rate == 0.0
    candidates = np.flatnonzero(is_still & moves)
    solution = solve_complementarity(A[np.ix_(candidates, candidates)], q[candidates], noise[candidates])
    touching_states = np.full(len(contacts), OPEN)
    touching_states[candidates[solution.bears]] = CLOSED
    touching_states[candidates[solution.depends]] = CLOSED_BY_OTHERS
    touching_states[is_still & ~moves & (q <= noise)] = CLOSED_BY_OTHERS  # beyond, a drive opens it
    return touching_states, q + A @ scatter(solution.z, candidates, len(contacts))


def find_contradicted(
    touching: TouchingContacts,
    A: Array,
    touching_states: Array,
    rate: Array,
    evaluation: Evaluation,
    layout: Layout,
) -> Mask:
    """Mark the touching contacts whose loads or accelerations contradict the result of `find_resting`, (k,).

    `find_resting` takes all applied loads as given, but load-dependent joint friction changes as contacts bear. A
    closed contact then may pull, or an open one accelerate inwards.

    touching_states (k,), rate (k,): what is held, and the rates of opening
    evaluation: the state with the contacts held that `touching_states` names
    """
    contacts = [layout.contacts[i] for i in touching.indices.tolist()]
    rows = evaluation.rows[0]
    noise = estimate_acceleration_noise(layout, touching, A, evaluation)
    z = np.array([-c.sense * float(rows["multiplier"][c.row]) for c in contacts])
    w = np.array([-c.sense * float(rows["acceleration"][c.row]) for c in contacts])
    is_pulling = (touching_states == CLOSED) & (z * np.diag(A) < -noise)
    return np.asarray(is_pulling | ((touching_states == OPEN) & (rate == 0.0) & (w < -noise)))


def estimate_acceleration_noise(layout: Layout, touching: TouchingContacts, A: Array, evaluation: Evaluation) -> Array:
    """Return the rounding of the accelerations of opening (k,), from the terms of motion, and all loads and weights.

    Where a contact lets go, these cancel: a force that has become zero is known only to the rounding of what it was.
    Where drives hold what a contact touches, loads move it by the rounding of a free body's response.
    """
    rows = [layout.contacts[i].row for i in touching.indices.tolist()]
    weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
    load = weights + float(
        np.abs(evaluation.loads["force"][0]).sum() + np.abs(evaluation.loads["moment"][0]).sum() / layout.size
    )
    load_effect = layout.tables["closures"]["weight"][rows] * load
    noise = tolerances.CONTACT_ACCELERATION * (evaluation.rows["terms"][0, rows] + np.diag(A) * load_effect)
    return np.asarray(noise + tolerances.NO_ANSWER * find_free_response(layout, touching.loads) * load_effect)


def is_short_flight(touching: TouchingContacts, rate: Array, acceleration: Array, shortest_time: float) -> Mask:
    """Return which rebounds come back before they are seen: u^2 / 2 a within the rounding of the gap, or too short a
    time.
    """
    a = -acceleration
    is_returning = (rate > 0.0) & (a > 0.0)
    a = np.where(is_returning, a, 1.0)
    return np.asarray(is_returning & ((rate * rate <= 2.0 * a * touching.reach) | (2.0 * rate <= a * shortest_time)))


# Impulses

# Rounds of simultaneous impacts at one instant: of MAX_ROUNDS, those after the first MAX_ELASTIC_ROUNDS are plastic, so
# that rebounds which strike each other again and again come to an end.
MAX_ELASTIC_ROUNDS = 60
MAX_ROUNDS = 2 * MAX_ELASTIC_ROUNDS


@record
class ContactImpulses:
    """Impulses of touching contacts (k,) and the rates of opening after them.

    depends (k,): closed by others, so that it is unknown how they share the impulse
    count (k,): how often each was struck
    comes_to_rest (k,): contacts with restitution that rest after infinitely many impacts in a sequence
    """

    impulses: Array
    rate: Array
    depends: Mask
    count: Indices
    comes_to_rest: Mask

    @property
    def takes_part(self) -> Mask:
        """The contacts that take part (k,)."""
        return np.asarray((self.impulses != 0.0) | self.depends)


def solve_contact_impulses(
    touching: TouchingContacts,
    A: Array,
    moves: Mask,
    added_rates: Array,
    is_plastic: Mask,
    impacts: ImpactModel = SIMULTANEOUS,
) -> ContactImpulses:
    """Solve the impulses of contacts that are struck, or pressed by given impulses.

    added_rates: rates that given impulses add
    is_plastic: contacts that rest after the impulse, whatever their restitution, though they would open by less than is
    seen
    impacts: whether touching contacts are struck at the same time or in a sequence

    A contact that opens at the instant takes part only if it is struck in a later round. Contacts that are not coupled
    are struck as if each were alone. Energy is never added: the work of an impulse is z (v- + v+) / 2, and what bears
    has v+ = -e v-, v- <= 0, e <= 1. Raises EndlessImpacts.
    """
    k = len(touching.indices)
    all_false = np.zeros(k, dtype=bool)
    result = ContactImpulses(
        np.zeros(k), touching.rate.copy(), all_false.copy(), np.zeros(k, dtype=int), all_false.copy()
    )
    strike = solve_simultaneous if impacts == SIMULTANEOUS else solve_sequence
    for group in find_coupled_groups(A):
        try:
            part = strike(
                touching.select(group),
                A[np.ix_(group, group)],
                moves[group],
                added_rates[group],
                is_plastic[group],
            )
        except EndlessImpacts as endless:
            raise EndlessImpacts(
                group[endless.contacts], int(group[endless.most_struck]), endless.repetitions
            ) from None
        for name, values in fields(part).items():
            getattr(result, name)[group] = values
    return result


def solve_simultaneous(
    touching: TouchingContacts, A: Array, moves: Mask, added_rates: Array, is_plastic: Mask
) -> ContactImpulses:
    """Solve the impulses of one coupled group at the same time; arguments as those of `solve_contact_impulses`."""
    v = touching.rate.copy()
    total, count = np.zeros(len(v)), np.zeros(len(v), dtype=int)
    depends = np.zeros(len(v), dtype=bool)
    noise, rounds = touching.noise + tolerances.CONTACT_RATE * np.abs(added_rates), 0
    while True:
        is_struck = v < -noise
        if not (is_struck.any() or (v + added_rates < -noise).any()):
            v = v + added_rates  # e.g. impulses that lift resting contacts
            break
        if rounds == MAX_ROUNDS:
            raise EndlessImpacts(np.flatnonzero(count), int(np.argmax(count)), rounds)
        e = np.where(is_plastic | (rounds >= MAX_ELASTIC_ROUNDS), 0.0, touching.restitution)
        candidates = np.flatnonzero((v <= noise) & moves)
        solution = solve_round(A, v, added_rates, candidates, np.where(is_struck, e, 0.0), noise)
        z = scatter(solution.z, candidates, len(v))
        depends[candidates[solution.depends]] = True
        rebound, bearing = np.where(is_struck, -e * v, 0.0), candidates[solution.bears]
        v = v + added_rates + A @ z
        v[bearing] = rebound[bearing]
        added_rates = np.zeros(len(v))
        total += z
        count[bearing] += 1
        rounds += 1
        noise = np.maximum(noise, tolerances.CONTACT_RATE * (np.abs(A) @ total))
    v = np.where(np.abs(v) <= noise, 0.0, v)
    total, v = bring_plastic_to_rest(A, total, v, moves, is_plastic)
    return ContactImpulses(total, v, depends & (total == 0.0), count, np.zeros(len(v), dtype=bool))


def solve_sequence(
    touching: TouchingContacts, A: Array, moves: Mask, added_rates: Array, is_plastic: Mask
) -> ContactImpulses:
    """Solve the impulses of contacts that are struck one after another (sequential_impacts.py)."""
    e = np.where(is_plastic, 0.0, touching.restitution)
    noise = touching.noise + tolerances.CONTACT_RATE * np.abs(added_rates)

    def solve_together(v: Array, own: Indices, e: Array, noise: Array) -> tuple[Array, Mask]:
        part = A[np.ix_(own, own)]
        sequence = solve_round(part, v[own], np.zeros(len(own)), np.arange(len(own)), e, noise)
        return sequence.z, sequence.depends

    sequence = strike_in_sequence(touching, A, touching.rate + added_rates, noise, moves, e, solve_together)
    v = np.where(np.abs(sequence.rate) <= sequence.noise, 0.0, sequence.rate)
    comes_to_rest = (sequence.count > 1) & (e > 0.0) & (v == 0.0)
    total, v = bring_plastic_to_rest(A, sequence.impulses, v, moves, is_plastic)
    return ContactImpulses(total, v, sequence.depends & (total == 0.0), sequence.count, comes_to_rest)


def bring_plastic_to_rest(A: Array, total: Array, v: Array, moves: Mask, is_plastic: Mask) -> tuple[Array, Array]:
    """Return impulses and rates in which plastic contacts that would still open by less than is seen are brought to
    rest.

    What this takes from an impulse is as small as those unseen rates. So the impulse of a contact that bore nothing, or
    hardly more, may become negative: it stands for the force of the contact's load during the flight that is left out.
    """
    if (is_plastic & (v > 0.0)).any():
        contacts = np.flatnonzero(moves & (v == 0.0) & (total > 0.0) | is_plastic & (v > 0.0))
        answers = A[np.ix_(contacts, contacts)]
        total[contacts] -= solve_least_squares(answers, v[contacts], tolerances.CONTACT_DEPENDS)
        v[contacts] = 0.0
    return total, v


def solve_round(
    A: Array, v: Array, added_rates: Array, candidates: Indices, e: Array, noise: Array
) -> ComplementaritySolution:
    """Solve the impulses of one round: those that leave v+ >= -e v-."""
    q = (v + added_rates + e * v)[candidates]
    return solve_complementarity(A[np.ix_(candidates, candidates)], q, noise[candidates])


def make_chattering_error(t: float, name: str) -> SolveError:
    """Make the error of contacts that follow each other endlessly at one instant; name: of the one most often
    struck.
    """
    message = f"at t = {t:.9g} s stops and ropes close and open endlessly without time advancing"
    hint = "contacts work against each other: give one of them more clearance"
    return SolveError(Problem("chattering", message, hint=hint, entry_path=name))
