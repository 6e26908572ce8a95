"""Collect the sentences on the contacts of a run, and count their strikes and the events at one instant."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.contact_problem import ContactOutcome
from heuncli.motion.integration.contacts.latches import LatchCatch
from heuncli.motion.integration.contacts.restitution import make_chattering_error
from heuncli.motion.integration.contacts.shared_impulses import SharedImpulse, join_names
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.multibody.tree.layout import Layout

MAX_SIMULTANEOUS = 16  # events at one instant, plus four per contact; more count as endless


class ContactNotes:
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
        if self.simultaneous_count > MAX_SIMULTANEOUS + 4 * len(self.layout.contacts):
            raise make_chattering_error(
                t, max(self.strike_counts, key=lambda name: self.strike_counts[name], default="")
            )

    def add_notes(
        self,
        t: float,
        contacts_touching: TouchingContacts,
        outcome: ContactOutcome,
        shared_impulses: tuple[SharedImpulse, ...],
    ) -> None:
        """Record notes on contacts that are struck together or come to rest."""
        contacts = [self.layout.contacts[i] for i in contacts_touching.indices.tolist()]
        struck_contacts = [
            contacts[k] for k in np.flatnonzero(outcome.impulses.takes_part & (contacts_touching.rate < 0.0))
        ]
        for contact in struck_contacts:
            self.strike_counts[contact.name] = self.strike_counts.get(contact.name, 0) + 1
        when = f"at t = {t:.6g} s"
        if len(struck_contacts) > 1 and not shared_impulses:
            names = join_names([contact.name for contact in struck_contacts])
            self.sentences[f"{when} {names} impact at the same time, and do not load each other"] = None
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
