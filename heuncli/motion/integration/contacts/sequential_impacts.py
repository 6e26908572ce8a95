"""Solve impacts one after another: the limit of equal, vanishing gaps in all contacts that touch at an instant.

    v_i -> -e_i v_i,   z_i = -(1 + e_i) v_i / A_ii,   v -> v + A[:, i] z_i,      A = W M^-1 W'

Between two impacts only the rates of opening change the gaps, because finite forces do nothing in no time. The contact
whose gap closes next is struck next, with its own restitution. Contacts that close together are struck together
(`solve_impulses`). An impact never adds energy: its work is z_i v_i (1 - e_i) / 2 <= 0.

Whether the sequence ends: with restitution 1 the rates move on a sphere (in the metric of the masses). Contacts that
form the walls of a wedge are struck finitely often (Sinai 1978); in a cage without play there is no end. With less
restitution infinitely many impacts may end in a finite time, with rates that fall geometrically. So the sequence ends
where no rate of closing is above rounding, and is refused after MAX_IMPACTS.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.contacts.complementarity import is_coupled
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS, ImpactModel

MAX_IMPACTS = 20_000  # of one group at one instant: reached by a ball between a wall and a mass 4e7 times its own
UNSOLVED_FRACTION = 0.1  # fraction of a rate's rounding that may remain where contacts are solved together
MAX_PLASTIC_IMPACTS = 200  # consecutive plastic impacts without a flight, after which their limit is solved

# Solves the impulses of contacts that close together, from: rates of opening (k,), indices of the n contacts, their
# restitution (n,) and rounding (n,). Returns their impulses (n,), and which depend on others (n,).
Solver = Callable[[Array, Indices, Array, Array], tuple[Array, Mask]]


class EndlessImpacts(Exception):
    """A sequence of impacts does not end.

    contacts: which of the contacts take part
    most_struck: the one that is struck most often
    repetitions: after how many it was given up
    """

    def __init__(self, contacts: Indices, most_struck: int, repetitions: int) -> None:
        self.contacts, self.most_struck, self.repetitions = contacts, most_struck, repetitions


@record
class ImpactSequence:
    """The result of a sequence of impacts of k contacts.

    impulses (k,): their sums
    rate (k,): rates of opening after all impacts
    depends (k,): closed by others that were struck together with it, so that their shares are unknown
    count (k,): how often each was struck
    noise (k,): rounding error of the rates
    """

    impulses: Array
    rate: Array
    depends: Mask
    count: Indices
    noise: Array


class ContactRates:
    """Rates and gaps of contacts during a sequence; every flight and impact changes them.

    Plain numbers, because a few contacts may be struck thousands of times.

    v: rates of opening
    gap: gaps, in any unit of length
    widest: largest gap since the last impact, the scale of its rounding
    impulses: sums of the impulses so far
    largest_rates, rate_changes: largest value of each rate, and the sum of its changes, the scales of its rounding
    """

    def __init__(self, start: Array, lengths: Array, A: Array) -> None:
        """start (k,): rates
        lengths (k,): ratio of the unit of each gap to a length [m]
        A (k, k): rates of opening from unit impulses
        """
        self.v: list[float] = start.tolist()
        self.gap: list[float] = (1.0 / lengths).tolist()
        self.widest = self.gap.copy()
        self.total, self.rate_changes = [0.0] * len(start), [0.0] * len(start)
        self.largest_rates = [abs(v) for v in self.v]
        # impulses and impacts reach distant contacts by rounding alone
        self.min_rounding: list[float] = (tolerances.SUM_ROUNDING * np.abs(start * lengths).max() / lengths).tolist()
        self.responses: list[list[float]] = A.T.tolist()
        self.indices = range(len(start))

    def rate_rounding(self, i: int) -> float:
        """Return the rounding error of a rate."""
        return float(
            max(
                self.min_rounding[i],
                tolerances.SUM_ROUNDING * self.largest_rates[i],
                tolerances.EPS * self.rate_changes[i],
            )
        )

    def find_closing(self, movable: list[int]) -> list[int]:
        """Return the contacts that close."""
        return [i for i in movable if self.v[i] < 0.0 and self.v[i] < -self.rate_rounding(i)]

    def find_next_impacts(self, closing: list[int]) -> tuple[list[int], float]:
        """Return which closing contacts are struck next, those within CONTACT_TOGETHER together, and the time of
        flight.
        """
        times = [self.gap[i] / -self.v[i] for i in closing]
        time = min(times)
        doubts = [tolerances.CONTACT_TOGETHER * self.widest[i] / -self.v[i] for i in closing]
        limit = time + doubts[times.index(time)]
        return [
            i
            for i, time_to_impact, doubt in zip(closing, times, doubts, strict=True)
            if time_to_impact <= limit + doubt
        ], time

    def fly(self, time: float, struck_contacts: list[int]) -> None:
        """Change the gaps up to an impact; those of the contacts struck there become zero."""
        if time > 0.0:
            self.gap = [max(gap + v * time, 0.0) for gap, v in zip(self.gap, self.v, strict=True)]
            self.widest = [max(widest, gap) for widest, gap in zip(self.widest, self.gap, strict=True)]
        for i in struck_contacts:
            self.gap[i] = self.widest[i] = 0.0

    def add_impulse(self, i: int, z: float) -> None:
        """Add an impulse of one contact to all rates."""
        self.total[i] += z
        for k, response in zip(self.indices, self.responses[i], strict=True):
            if response:
                change = response * z
                self.v[k] += change
                self.rate_changes[k] += abs(change)
                self.largest_rates[k] = max(self.largest_rates[k], abs(self.v[k]))

    def strike_alone(self, i: int, restitution: float) -> None:
        """Strike one contact as if it were alone."""
        rebound = -restitution * self.v[i]
        self.add_impulse(i, -(1.0 + restitution) * self.v[i] / self.responses[i][i])
        self.v[i] = rebound


def strike_in_sequence(
    touching: TouchingContacts,
    A: Array,
    start: Array,
    noise: Array,
    moves: Mask,
    restitution: Array,
    solve_impulses: Solver,
) -> ImpactSequence:
    """Strike contacts one after another until none closes.

    touching: the contacts (k,)
    A (k, k): rates of opening from unit impulses
    start (k,): rates of opening after the given impulses
    noise (k,): rounding error of these rates
    moves (k,): whether an impulse moves anything
    solve_impulses: solves contacts that close together (`Solver`)

    Raises EndlessImpacts.
    """
    contact_rates = ContactRates(np.where(np.abs(start) <= noise, 0.0, start), touching.length, A)
    depends, count = np.zeros(len(start), dtype=bool), np.zeros(len(start), dtype=int)
    coupled, e, movable = is_coupled(A), restitution.tolist(), np.flatnonzero(moves).tolist()
    plastic_contacts: set[int] = set()  # plastic contacts struck since the last flight
    plastic_count = 0
    for _ in range(MAX_IMPACTS):
        closing = contact_rates.find_closing(movable)
        if not closing:
            rounding = np.array([contact_rates.rate_rounding(i) for i in contact_rates.indices])
            return ImpactSequence(
                np.array(contact_rates.total), np.array(contact_rates.v), depends, count, np.maximum(noise, rounding)
            )
        struck_contacts, time = contact_rates.find_next_impacts(closing)
        if time > 0.0 or any(e[i] for i in struck_contacts):
            plastic_count, plastic_contacts = 0, set()
        else:
            plastic_count, plastic_contacts = plastic_count + 1, plastic_contacts | set(struck_contacts)
        if plastic_count > MAX_PLASTIC_IMPACTS:
            struck_contacts, plastic_count = sorted(plastic_contacts), 0
        contact_rates.fly(time, struck_contacts)
        if any(coupled[i, k] for i in struck_contacts for k in struck_contacts if i != k):
            struck_indices, v = np.array(struck_contacts, dtype=int), np.array(contact_rates.v)
            effective_restitution = np.where(v[struck_indices] < 0.0, restitution[struck_indices], 0.0)
            unsolved = np.array([UNSOLVED_FRACTION * contact_rates.rate_rounding(i) for i in struck_contacts])
            z, is_dependent = solve_impulses(v, struck_indices, effective_restitution, unsolved)
            for i, impulse in zip(struck_contacts, z.tolist(), strict=True):
                contact_rates.add_impulse(i, impulse)
            for i, impulse, rebound in zip(
                struck_contacts, z.tolist(), (-effective_restitution * v[struck_indices]).tolist(), strict=True
            ):
                if impulse > 0.0 or not z.any():  # or the rest is rounding
                    contact_rates.v[i] = rebound
            depends[struck_indices[is_dependent]] = True
        else:
            for i in struck_contacts:
                contact_rates.strike_alone(i, e[i])
        count[struck_contacts] += 1
    raise EndlessImpacts(np.flatnonzero(count), int(np.argmax(count)), MAX_IMPACTS)


def find_independent(A: Array) -> Indices:
    """Return the contacts of a matrix A (k, k) whose responses are linearly independent, ascending."""
    size = np.sqrt(np.diag(A))
    remainder = A / (size[:, None] * size)
    selected: list[int] = []
    for _ in range(len(A)):
        i = int(np.argmax(np.diag(remainder)))
        if remainder[i, i] <= tolerances.CONTACT_BASIS:
            break
        selected.append(i)
        remainder = remainder - np.outer(remainder[:, i], remainder[i]) / remainder[i, i]
        remainder[i, :] = remainder[:, i] = 0.0
    return np.array(sorted(selected), dtype=int)


def make_endless_impacts_error(t: float, names: list[str], endless: EndlessImpacts, impacts: ImpactModel) -> SolveError:
    """Make the error of endless impacts; names (k,): of all touching contacts."""
    struck_names = dict.fromkeys(names[k] for k in endless.contacts.tolist())
    message = (
        f"at t = {t:.9g} s the impacts of {', '.join(struck_names)} do not end after {endless.repetitions} repetitions"
    )
    other = "simultaneous" if impacts != SIMULTANEOUS else "sequential"
    hint = f"use restitution below 1 for contacts without clearance, or analysis: {{impacts: {other}}}"
    return SolveError(Problem("endless-impacts", message, hint=hint, entry_path=names[endless.most_struck]))
