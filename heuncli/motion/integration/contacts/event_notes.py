"""Collect what is reported of contact events: sentences, contacts that share an impulse, strikes and their counts."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.spelling import join_names
from heuncli.motion.integration.contacts.complementarity import find_coupled_groups
from heuncli.motion.integration.contacts.contact_problem import ContactOutcome, EventSetting
from heuncli.motion.integration.contacts.latches import LatchCatch
from heuncli.motion.integration.contacts.restitution import make_chattering_error
from heuncli.motion.integration.contacts.shared_impulses import (
    LoadedContact,
    SharedImpulse,
    find_shared_impulses,
    list_bilateral_contacts,
    select_loaded,
)
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.multibody.tree.layout import Layout

# Events at one instant, and for each contact; more count as endless.
MAX_SIMULTANEOUS, MAX_PER_CONTACT = 16, 4


class EventNotes:
    """The sentences on the contacts of one run, and how often each contact is struck. Changes with every event."""

    def __init__(self, layout: Layout, end_time: float) -> None:
        self.layout, self.end_time = layout, end_time
        self.strike_counts: dict[str, int] = {}
        self.sentences: dict[str, None] = {}
        self.last_event_time, self.simultaneous_count = -1.0, 0

    def count_event(self, t: float) -> None:
        """Count an event at an instant. Raises SolveError for too many at one instant."""
        near = tolerances.KERNEL["least_step"] * self.end_time
        self.simultaneous_count = self.simultaneous_count + 1 if t - self.last_event_time <= near else 0
        self.last_event_time = t
        if self.simultaneous_count > MAX_SIMULTANEOUS + MAX_PER_CONTACT * len(self.layout.contacts):
            raise make_chattering_error(
                t, max(self.strike_counts, key=lambda name: self.strike_counts[name], default="")
            )

    def add_notes(
        self,
        t: float,
        touching: TouchingContacts,
        outcome: ContactOutcome,
        shared_impulses: tuple[SharedImpulse, ...],
    ) -> None:
        """Record notes on contacts that are struck together, come to rest, or pull instead of flying for an instant."""
        contacts = [self.layout.contacts[i] for i in touching.indices.tolist()]
        struck_contacts = [contacts[k] for k in np.flatnonzero(outcome.impulses.takes_part & (touching.rate < 0.0))]
        for contact in struck_contacts:
            self.strike_counts[contact.name] = self.strike_counts.get(contact.name, 0) + 1
        when = f"at t = {t:.6g} s"
        if len(struck_contacts) > 1 and not shared_impulses:
            names = join_names([contact.name for contact in struck_contacts])
            self.sentences[f"{when} {names} impact at the same time, and do not load each other"] = None
        for k in np.flatnonzero(outcome.impulses.impulses < 0.0):  # restitution.py, bring_plastic_to_rest
            self.sentences[
                f"{when} the impulse of {contacts[k].name} is negative: it replaces the load on it during a flight too "
                "short to be seen"
            ] = None
        for k in np.flatnonzero(outcome.at_rest):
            name = contacts[k].name
            count = self.strike_counts.get(name, 0)
            if not count:
                continue
            self.sentences[
                f"contact at {name} comes to rest {when} after {count} impact{'s' * (count > 1)}; "
                "further impacts are negligible"
            ] = None

    def add(self, sentences: list[str]) -> None:
        """Record other sentences."""
        self.sentences |= dict.fromkeys(sentences)

    def add_latch_notes(self, t: float, released_names: list[str], catches: list[LatchCatch]) -> None:
        """Record notes on what latches catch and release."""
        for name in released_names:
            self.sentences[f"{name} releases at t = {t:.6g} s"] = None
        for catch in catches:
            self.sentences[f"{self.layout.contacts[catch.contact].name} catches at t = {t:.6g} s"] = None


def find_event_shares(layout: Layout, event: EventSetting, outcome: ContactOutcome) -> tuple[SharedImpulse, ...]:
    """Find the contacts that share the impulse of an event: bearing ones, catching latches, and bilateral ones."""
    impulses, which = outcome.impulses, event.problem.touching.indices
    taking_part, n = np.flatnonzero(impulses.takes_part), len(event.sides.loads)
    contacts = [
        LoadedContact(
            contact.name,
            contact.row,
            n + int(k),
            impacts=int(impulses.count[k]),
            comes_to_rest=bool(impulses.comes_to_rest[k]),
        )
        for k, contact in ((k, layout.contacts[which[k]]) for k in taking_part)
    ]
    catching_contacts = [layout.contacts[catch.contact] for catch in event.catches if catch.rate != 0.0]
    first = n - len(catching_contacts)
    contacts += [
        LoadedContact(contact.name, contact.row, first + k, is_held=True) for k, contact in enumerate(catching_contacts)
    ]
    contacts += select_loaded(list_bilateral_contacts(layout), outcome.columns.multipliers)
    is_coupled = np.zeros((len(contacts), len(contacts)), dtype=bool)
    # also through contacts that bear nothing, which depends on the model, too
    for group in find_coupled_groups(event.problem.A):
        members = np.isin(taking_part, group)
        is_coupled[: len(taking_part), : len(taking_part)] |= members[:, None] & members
    return tuple(find_shared_impulses(contacts, is_coupled, outcome.columns.multipliers))
