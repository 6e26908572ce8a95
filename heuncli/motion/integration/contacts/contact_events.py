"""Handle contact events: what is struck at an instant of a run, by which impulses, and what is held from then on.

touching.py finds the contacts that touch, latches.py what catches and releases, event_solution.py solves the event with
restitution.py, sticking.py decides what friction holds, contact_problem.py has the records and errors, event_notes.py
the sentences.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.motion.integration.contacts.contact_problem import (
    ContactOutcome,
    ContactProblem,
    EventSetting,
    require_caught,
    require_energy,
    require_smooth,
    require_yielding,
)
from heuncli.motion.integration.contacts.event_notes import EventNotes, find_event_shares
from heuncli.motion.integration.contacts.event_solution import solve_event
from heuncli.motion.integration.contacts.impulses import (
    SINGLE_INSTANT,
    GivenImpulse,
    ImpulseEvent,
    ImpulseResult,
    RightSides,
    compute_free_impulse_energy,
    make_impulse_event,
    make_right_sides,
)
from heuncli.motion.integration.contacts.latches import UNWATCHED, LatchCondition, Latches, add_catches
from heuncli.motion.integration.contacts.restitution import ContactImpulses
from heuncli.motion.integration.contacts.sequential_impacts import find_independent
from heuncli.motion.integration.contacts.shared_impulses import SharedImpulse
from heuncli.motion.integration.contacts.sticking import FrictionEvent, FrictionStates
from heuncli.motion.integration.contacts.touching import (
    TouchingContacts,
    can_move_bodies,
    find_opening_rates,
    find_touching,
)
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.response import ImpulseColumns, solve_impulses
from heuncli.multibody.tree.layout import CLOSED_BY_OTHERS
from heuncli.results.results import Array, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS

MAX_FRICTION_CHANGES = 8  # of friction that sticks beside touching contacts, which both depend on each other


def find_held_contacts(evaluator: Evaluator, t: float, state: Array) -> Array:
    """Return the contact states at a state, after the impulse that may happen there.

    There is no run: rounding counts as it does in one of a second.
    """
    contacts = Contacts(evaluator, SINGLE_INSTANT)
    contacts.handle_event(GivenImpulse(t, t, (), {}), state, t, None)
    return contacts.contact_states


class Contacts:
    """The contacts of one run: which are closed, and the notes on them. Changes with every event.

    contact_states: of all contacts; then for each latch and friction where it holds, or the sign of its slip; then for
    each friction the contact of its group's leader, counted from 1, and its transmission (Layout.open_contacts). The
    evaluator takes them as `holding`.
    """

    def __init__(self, evaluator: Evaluator, end_time: float) -> None:
        self.evaluator, self.end_time = evaluator, end_time
        self.layout = evaluator.layout
        self.contact_states = self.layout.open_contacts
        self.latches = Latches(self.layout, end_time)
        self.friction = FrictionStates(evaluator, end_time)
        self.notes = EventNotes(self.layout, end_time)

    def handle_event(
        self,
        given_impulse: GivenImpulse,
        state: Array,
        time: float,
        row: int | None,
        latch_conditions: Sequence[LatchCondition] | None = None,
    ) -> ImpulseEvent | None:
        """Handle an event and return the impulse that it causes, if any.

        First what is given and what touches (`set_up_event`), then the impulses and what is held (`find_outcome`), then
        the notes and the record of the impulse, whose energy balance is checked last.

        row: closure row of the contact that closed or opened there
        latch_conditions: the conditions of latches there; by default evaluated at the state
        """
        if latch_conditions is None:
            latch_conditions = self.latches.evaluate_conditions(given_impulse.before_time, state)
        released_names = self.latches.release(latch_conditions)
        event = self.set_up_event(given_impulse, state, row, latch_conditions)
        outcome = self.find_outcome(event)
        shared_impulses = find_event_shares(self.layout, event, outcome)
        self.notes.add_notes(time, event.problem.touching, outcome, shared_impulses)
        self.notes.add_latch_notes(time, released_names, event.catches)
        if not outcome.impulses.impulses.any() and not event.sides.loads:
            return None
        return self.make_event(time, event, outcome, shared_impulses)

    def set_up_event(
        self, given_impulse: GivenImpulse, state: Array, row: int | None, latch_conditions: Sequence[LatchCondition]
    ) -> EventSetting:
        """Set up what an event is solved from; arguments as those of `handle_event`. The order of the steps matters:

        1. What is closed, without what opens: a taut rope whose prescribed rate jumps is refused.
        2. Latches have been released, so what they held is free in all that follows.
        3. The right sides and the touching contacts are those of the state with the remaining latches holding.
        4. Latches catch what touches; a limit at which one holds is no contact any more.
        5. The contact problem has one column for each cause, those of catches included, and one for each contact.
        6. Catches and contacts that drives contradict are refused before anything is solved for them.
        """
        layout, latches, before_time = self.layout, self.latches, given_impulse.before_time
        is_closed = (self.contact_states > 0.0) & ~self.find_opening_redundant(row)
        require_smooth(layout, given_impulse, is_closed)
        sides = make_right_sides(self.evaluator, given_impulse, state, latches.make_states())
        touching = find_touching(layout, sides.still, is_closed, row, self.end_time)
        catches = latches.catch(latch_conditions, sides.still, touching)
        is_free = latches.find_unheld_contacts(touching)
        unwatched, touching = touching.indices[~is_free], touching.select(is_free)
        sides = add_catches(layout, sides, catches)
        units, problem = self.make_problem(given_impulse, sides, touching)
        require_caught(self.evaluator, sides, units, catches, before_time)
        require_yielding(layout, problem, touching.rate + problem.rates, touching.noise, before_time)
        shortest_flight = tolerances.SHORTEST_FLIGHT * self.end_time
        return EventSetting(
            given_impulse, sides, units, problem, catches, unwatched, latches.make_states(), row, shortest_flight
        )

    def find_opening_redundant(self, row: int | None) -> Mask:
        """Mark the contact (contacts,) that redundant others held closed and whose gap, now beyond rounding, opens."""
        is_left = np.zeros(len(self.contact_states), dtype=bool)
        for k, contact in enumerate(self.layout.contacts):
            is_left[k] = contact.row == row and self.contact_states[k] == CLOSED_BY_OTHERS
        return is_left

    def make_problem(
        self, given_impulse: GivenImpulse, sides: RightSides, touching: TouchingContacts
    ) -> tuple[ImpulseColumns, ContactProblem]:
        """Compute the columns of what is given and of each touching contact, and the contact problem they make."""
        self.evaluator.workspace.hold(self.latches.make_states())
        n, n_u = len(sides.loads), len(self.layout.freedoms) + len(self.layout.rows)
        loads = np.array([*sides.loads, *touching.loads]).reshape(-1, len(self.layout.place), 6)
        jumps = np.array([*sides.jumps, *([np.zeros(n_u)] * len(touching.indices))]).reshape(-1, n_u)
        units = solve_impulses(self.evaluator.workspace, given_impulse.before_time, sides.still.states[0], loads, jumps)
        rates = find_opening_rates(touching, units.columns.bodies)
        A = 0.5 * (rates[:, n:] + rates[:, n:].T)
        return units, ContactProblem(touching, A, can_move_bodies(self.layout, touching, A), rates[:, :n].sum(axis=1))

    def find_outcome(self, event: EventSetting) -> ContactOutcome:
        """Solve for the impulses and for what is held from then on, and store that.

        Contacts that rest are decided with the friction there is, then the friction with them: again, where that
        changes.
        """
        self.friction.begin_event()
        after_time = event.given_impulse.after_time
        for _ in range(MAX_FRICTION_CHANGES):
            outcome = solve_event(self.evaluator, event, self.friction.add_to(event.latch_states))
            self.contact_states = self.friction.add_to(event.latch_states)
            self.contact_states[event.problem.touching.indices] = outcome.touching_states
            self.contact_states[event.unwatched] = UNWATCHED
            if not self.friction.places.indices:
                return outcome
            before = self.contact_states.copy()
            is_struck = bool(event.sides.loads) or bool(outcome.impulses.impulses.any())
            friction_event = FrictionEvent(after_time, outcome.after_state, before, event.row, is_struck)
            sentences = self.friction.decide(friction_event)
            self.contact_states = self.friction.add_to(before)
            # nothing touches, or the friction leaves the contacts as they were: both agree
            if not len(outcome.touching_states) or np.array_equal(before, self.contact_states):
                self.notes.add(sentences)
                return outcome
        raise self.friction.unsettled_error(after_time)

    def make_event(
        self, time: float, event: EventSetting, outcome: ContactOutcome, shared_impulses: tuple[SharedImpulse, ...]
    ) -> ImpulseEvent:
        """Make the record of the impulse of an event. Raises SolveError if its energy balance is not met."""
        impulses, sides = outcome.impulses, event.sides
        result = self.make_result(time, event, outcome, shared_impulses)
        sides = replace(sides, still=self.add_active_contacts(sides.still, event.problem, impulses))
        impulse_event = make_impulse_event(self.evaluator, event.given_impulse, sides, result)
        energy_scale = 0.5 * float(impulses.impulses**2 @ np.diag(event.problem.A))
        require_energy(impulse_event, energy_scale + compute_free_impulse_energy(self.layout, sides.impulses))
        return impulse_event

    def make_result(
        self, time: float, event: EventSetting, outcome: ContactOutcome, shared_impulses: tuple[SharedImpulse, ...]
    ) -> ImpulseResult:
        """Make the result of an event: what is given and what bears, each with its column, and the state after it."""
        which, impulses, n = event.problem.touching.indices, outcome.impulses, len(event.sides.loads)
        bearing = np.flatnonzero(impulses.impulses)
        causes = (*event.sides.causes, *(self.layout.contacts[i].name for i in which[bearing]))
        used_columns = np.array([*range(n), *(n + bearing)], dtype=int)
        columns = outcome.columns.select(used_columns)
        struck_names = tuple(self.layout.contacts[i].name for i in which[impulses.takes_part])
        struck_names += tuple(self.layout.contacts[catch.contact].name for catch in event.catches if catch.rate != 0.0)
        return ImpulseResult(
            time,
            ImpulseColumns(columns, event.units.unmet[used_columns], event.units.massless_count),
            causes,
            outcome.after_state,
            outcome.work,
            self.contact_states.copy(),
            struck_names,
            shared_impulses,
        )

    def add_active_contacts(self, still: Evaluation, problem: ContactProblem, impulses: ContactImpulses) -> Evaluation:
        """Return the results before the impulse, with the contacts that take part in it, so that indeterminate shares
        are found.

        A sequence determines the impulses of contacts that others could replace; these leave nothing indeterminate.
        """
        touching, rows, contact_states = problem.touching, still.rows.copy(), self.latches.make_states()
        is_active = impulses.takes_part
        if self.layout.mechanism.impacts != SIMULTANEOUS:
            bearing = np.flatnonzero(impulses.impulses)
            is_active = impulses.depends.copy()
            is_active[bearing[find_independent(problem.A[np.ix_(bearing, bearing)])]] = True
        contact_states[touching.indices] = is_active
        if np.array_equal(self.layout.closed_contacts(contact_states), still.holding[0]):
            return still
        active_rows = self.evaluator.evaluate(still.times, still.states, holding=contact_states).rows
        for name in ("chosen", "closed"):
            rows[name] = active_rows[name]
        return replace(still, rows=rows)
