"""Solve the impulses of struck contacts: small complementarity problems on columns of one linear map.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0,      A = W M^-1 W'  (through all bilateral constraints)

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
from heuncli.motion.integration.contacts.resting import ComplementaritySolution, solve_complementarity
from heuncli.motion.integration.contacts.sequential_impacts import EndlessImpacts, is_coupled, strike_in_sequence
from heuncli.motion.integration.contacts.touching import TouchingContacts, scatter
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel

MAX_ROUNDS = 60  # consecutive strikes at one instant, after which further ones are plastic


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
    contacts_touching: TouchingContacts,
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
    k = len(contacts_touching.indices)
    all_false = np.zeros(k, dtype=bool)
    result = ContactImpulses(
        np.zeros(k), contacts_touching.rate.copy(), all_false.copy(), np.zeros(k, dtype=int), all_false.copy()
    )
    strike = solve_simultaneous if impacts == SIMULTANEOUS else solve_sequence
    for group in find_coupled_groups(A):
        try:
            part = strike(
                contacts_touching.select(group),
                A[np.ix_(group, group)],
                moves[group],
                added_rates[group],
                is_plastic[group],
            )
        except EndlessImpacts as endless:
            raise EndlessImpacts(group[endless.contacts], int(group[endless.most_struck])) from None
        for name, values in fields(part).items():
            getattr(result, name)[group] = values
    return result


def find_coupled_groups(A: Array) -> list[Indices]:
    """Return the groups of contacts whose impulses change each other's rates, directly or through others, in their
    order.
    """
    coupling_matrix = is_coupled(A)
    np.fill_diagonal(coupling_matrix, True)
    for _ in range(len(A)):
        is_reached = coupling_matrix @ coupling_matrix
        if np.array_equal(is_reached, coupling_matrix):
            break
        coupling_matrix = is_reached
    return [np.flatnonzero(row) for k, row in enumerate(coupling_matrix) if not row[:k].any()]


def solve_simultaneous(
    contacts_touching: TouchingContacts, A: Array, moves: Mask, added_rates: Array, is_plastic: Mask
) -> ContactImpulses:
    """Solve the impulses of one coupled group at the same time; arguments as those of `solve_contact_impulses`."""
    v = contacts_touching.rate.copy()
    total, count = np.zeros(len(v)), np.zeros(len(v), dtype=int)
    depends = np.zeros(len(v), dtype=bool)
    noise, rounds = contacts_touching.noise + tolerances.CONTACT_RATE * np.abs(added_rates), 0
    while rounds < 2 * MAX_ROUNDS:
        is_struck = v < -noise
        if not (is_struck.any() or (v + added_rates < -noise).any()):
            v = v + added_rates  # e.g. impulses that lift resting contacts
            break
        e = np.where(is_plastic | (rounds >= MAX_ROUNDS), 0.0, contacts_touching.restitution)
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
    contacts_touching: TouchingContacts, A: Array, moves: Mask, added_rates: Array, is_plastic: Mask
) -> ContactImpulses:
    """Solve the impulses of contacts that are struck one after another (sequential_impacts.py)."""
    e = np.where(is_plastic, 0.0, contacts_touching.restitution)
    noise = contacts_touching.noise + tolerances.CONTACT_RATE * np.abs(added_rates)

    def solve_impulses(v: Array, own: Indices, e: Array, noise: Array) -> tuple[Array, Mask]:
        part = A[np.ix_(own, own)]
        sequence = solve_round(part, v[own], np.zeros(len(own)), np.arange(len(own)), e, noise)
        return sequence.z, sequence.depends

    sequence = strike_in_sequence(
        contacts_touching, A, contacts_touching.rate + added_rates, noise, moves, e, solve_impulses
    )
    v = np.where(np.abs(sequence.rate) <= sequence.noise, 0.0, sequence.rate)
    comes_to_rest = (sequence.count > 1) & (e > 0.0) & (v == 0.0)
    total, v = bring_plastic_to_rest(A, sequence.impulses, v, moves, is_plastic)
    return ContactImpulses(total, v, sequence.depends & (total == 0.0), sequence.count, comes_to_rest)


def bring_plastic_to_rest(A: Array, total: Array, v: Array, moves: Mask, is_plastic: Mask) -> tuple[Array, Array]:
    """Return impulses and rates in which plastic contacts that would still open by less than is seen are brought to
    rest.
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


def chattering_error(t: float, name: str) -> SolveError:
    """Make the error of contacts that follow each other endlessly at one instant; name: of the one most often
    struck.
    """
    message = f"at t = {t:.9g} s stops and ropes close and open endlessly without time advancing"
    hint = "contacts work against each other: give one of them more clearance"
    return SolveError(Problem("chattering", message, hint=hint, entry_path=name))
