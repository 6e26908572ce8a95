"""Impulses of contacts that are struck: small complementarity problems on columns of the one map.

    w = q + A z,   z >= 0,   w >= 0,   z . w = 0,      A = W M^-1 W'  (through all that holds both ways)
W are the contacts' unit loads, positive where they bear. Of impulses z, w are the rates of opening behind the blow and
those that Newton's restitution asks for: w = v+ + e v- of what is struck (v- < 0), v+ of what rests. A contact bears or
opens, never both (Moreau 1988; Pfeiffer and Glocker 1996). Several that touch are struck at the same time, or one after
another (sequential_impacts.py): rigid bodies alone do not say which.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import fields, record
from heuncli.motion.integration.contacts.complementarity import Pivots, complementary
from heuncli.motion.integration.contacts.sequential_impacts import EndlessImpacts, feels, strike_in_sequence
from heuncli.motion.integration.contacts.touching import Touching, spread
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel

MOST_ROUNDS = 60  # strikes that follow each other at one instant, before what is left of them is plastic


@record
class Struck:
    """Impulses of touching contacts (k,), the rates of opening behind them, and what is worth telling.

    depends (k,): those that others hold, so that how they share is not known; count (k,): how often each was struck;
    settled (k,): those that rebound, and yet rest behind endlessly many impacts in a sequence.
    """

    impulses: Array
    rate: Array
    depends: Mask
    count: Indices
    settled: Mask

    @property
    def closed(self) -> Mask:
        """Those that take part (k,)."""
        return np.asarray((self.impulses != 0.0) | self.depends)


def strikes(
    touch: Touching, A: Array, moves: Mask, pressed: Array, plastic: Mask, impacts: ImpactModel = SIMULTANEOUS
) -> Struck:
    """The impulses of contacts that are struck, or pressed by given blows (pressed: rates these add).

    What moves apart at the instant takes part only if it is struck in a later round. plastic: contacts that rest behind
    the blow, whatever their restitution, and though they would open by less than is seen. impacts: whether what touches
    is struck at the same time or in a sequence. Contacts that do not feel each other are struck as if each were alone.

    Neither adds energy: the work of an impulse is z (v- + v+) / 2, and what bears has v+ = -e v-, v- <= 0, e <= 1.
    Raises EndlessImpacts.
    """
    k = len(touch.which)
    none = np.zeros(k, dtype=bool)
    found = Struck(np.zeros(k), touch.rate.copy(), none.copy(), np.zeros(k, dtype=int), none.copy())
    strike = struck_together if impacts == SIMULTANEOUS else struck_in_sequence
    for own in feeling(A):
        try:
            part = strike(touch.some(own), A[np.ix_(own, own)], moves[own], pressed[own], plastic[own])
        except EndlessImpacts as endless:
            raise EndlessImpacts(own[endless.own], int(own[endless.most])) from None
        for name, values in fields(part).items():
            getattr(found, name)[own] = values
    return found


def feeling(A: Array) -> list[Indices]:
    """The groups of contacts that feel each other, by what one that bears does to the other, in their order."""
    felt = feels(A)
    np.fill_diagonal(felt, True)
    for _ in range(len(A)):
        reached = felt @ felt
        if np.array_equal(reached, felt):
            break
        felt = reached
    return [np.flatnonzero(row) for k, row in enumerate(felt) if not row[:k].any()]


def struck_together(touch: Touching, A: Array, moves: Mask, pressed: Array, plastic: Mask) -> Struck:
    """The impulses of contacts of which each feels the others; arguments as those of `strikes`."""
    v = touch.rate.copy()
    total, count = np.zeros(len(v)), np.zeros(len(v), dtype=int)
    depends = np.zeros(len(v), dtype=bool)
    noise, rounds = touch.noise + tolerances.CONTACT_RATE * np.abs(pressed), 0
    while rounds < 2 * MOST_ROUNDS:
        struck = v < -noise
        if not (struck.any() or (v + pressed < -noise).any()):
            v = v + pressed  # blows that lift what rests, say
            break
        e = np.where(plastic | (rounds >= MOST_ROUNDS), 0.0, touch.restitution)
        own = np.flatnonzero((v <= noise) & moves)
        found = one_round(A, v, pressed, own, np.where(struck, e, 0.0), noise)
        z = spread(found.z, own, len(v))
        depends[own[found.depends]] = True
        rebound, bears = np.where(struck, -e * v, 0.0), own[found.bears]
        v = v + pressed + A @ z
        v[bears] = rebound[bears]
        pressed = np.zeros(len(v))
        total += z
        count[bears] += 1
        rounds += 1
        noise = np.maximum(noise, tolerances.CONTACT_RATE * (np.abs(A) @ total))
    v = np.where(np.abs(v) <= noise, 0.0, v)
    total, v = brought_to_rest(A, total, v, moves, plastic)
    return Struck(total, v, depends & (total == 0.0), count, np.zeros(len(v), dtype=bool))


def struck_in_sequence(touch: Touching, A: Array, moves: Mask, pressed: Array, plastic: Mask) -> Struck:
    """The same, of contacts that are struck one after another (sequential_impacts.py)."""
    e = np.where(plastic, 0.0, touch.restitution)
    noise = touch.noise + tolerances.CONTACT_RATE * np.abs(pressed)

    def solve_impulses(v: Array, own: Indices, e: Array, noise: Array) -> tuple[Array, Mask]:
        part = A[np.ix_(own, own)]
        found = one_round(part, v[own], np.zeros(len(own)), np.arange(len(own)), e, noise)
        return found.z, found.depends

    found = strike_in_sequence(touch, A, touch.rate + pressed, noise, moves, e, solve_impulses)
    v = np.where(np.abs(found.rate) <= found.noise, 0.0, found.rate)
    settled = (found.count > 1) & (e > 0.0) & (v == 0.0)
    total, v = brought_to_rest(A, found.impulses, v, moves, plastic)
    return Struck(total, v, found.depends & (total == 0.0), found.count, settled)


def brought_to_rest(A: Array, total: Array, v: Array, moves: Mask, plastic: Mask) -> tuple[Array, Array]:
    """The impulses and rates with those of plastic contacts that would still open by less than is seen brought to 0."""
    if (plastic & (v > 0.0)).any():
        own = np.flatnonzero(moves & (v == 0.0) & (total > 0.0) | plastic & (v > 0.0))
        total[own] -= np.linalg.lstsq(A[np.ix_(own, own)], v[own], rcond=tolerances.CONTACT_DEPENDS)[0]
        v[own] = 0.0
    return total, v


def one_round(A: Array, v: Array, pressed: Array, own: Indices, e: Array, noise: Array) -> Pivots:
    """Impulses of one round: those that leave v+ >= -e v-."""
    q = (v + pressed + e * v)[own]
    return complementary(A[np.ix_(own, own)], q, noise[own])


def undecided(t: float, name: str) -> SolveError:
    """The problem of contacts that follow each other at one instant without an end; name: of the one most struck."""
    message = f"at t = {t:.9g} s stops and ropes strike and let go again and again without the time going on"
    hint = "contacts that work against each other: loosen one of them"
    return SolveError(Problem("chattering", message, hint=hint, about=name))
